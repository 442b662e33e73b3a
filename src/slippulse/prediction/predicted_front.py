"""Speed of both fronts of each run: the paper's, the exact one, and that on a coarse lattice."""

from functools import cache

import numpy as np
import pandas as pd

from ..model.release import RELEASES
from ..model.run import Run
from ..theory.front_speeds import front_speed
from ..theory.front_speeds_with_springs import lattice_front_speed
from .common import SIDES, level, or_nan, ratio

# Laws of friction that these numbers hold for: a term linear in slip rate leaves a front as it is.
LAWS = ("coulomb", "linear_rate")
# Below this gamma dx^2 leaf springs hardly change the speed of a damped front, and that speed takes
# 14 ms a run.
COARSE = 1e-3


def predictions(runs: list[Run], settings: dict) -> pd.DataFrame:
    """Columns KIND_front_speed_SIDE: paper, exact without leaf springs, lattice with them at dx."""
    undamped = [run._replace(beta=0.0) for run in runs]
    table: dict[str, np.ndarray | list[float]] = {}
    for side in SIDES:
        table[f"paper_front_speed_{side}"] = exact_speeds(undamped, side)
        table[f"exact_front_speed_{side}"] = exact_speeds(runs, side)
        table[f"lattice_front_speed_{side}"] = [
            _lattice_speed(level(run, side), run.gamma, run.dx, ratio(run), run.release)
            for run in runs
        ]
    return pd.DataFrame(table)


def exact_speeds(runs: list[Run], side: str) -> np.ndarray:
    """Speed of the front of each run without leaf springs; NaN where it is not supersonic."""
    levels = np.array([level(run, side) for run in runs])
    ratios = np.array([ratio(run) for run in runs])
    releases = np.array([run.release for run in runs])
    speeds = np.full(levels.shape, np.nan)
    for release in RELEASES:
        chosen = (levels > 0.0) & (releases == release)
        # Equal pairs are computed once.
        both = [levels[chosen], ratios[chosen]]
        pairs, indices = np.unique(both, axis=1, return_inverse=True)
        speeds[chosen] = front_speed(pairs[0], pairs[1], release)[indices.ravel()]
    return speeds


@cache
def _lattice_speed(level: float, gamma: float, dx: float, ratio: float, release: str) -> float:
    if gamma == 0.0 or (ratio > 0.0 and gamma * dx**2 < COARSE):
        return np.nan
    # Under strong springs no front is supersonic.
    return or_nan(lambda: lattice_front_speed(level, gamma, dx, ratio, release))
