"""Speed of both fronts of each run: the paper's, the exact one, and that on a coarse lattice."""

from functools import cache

import numpy as np
import pandas as pd

from ..model.run import Run
from ..theory.front_speeds import front_speed, front_speed_undamped, lattice_front_speed
from .numbers import NAN, SIDES, level, or_nan, ratio

# Below this gamma dx^2 leaf springs hardly change the speed of a damped front, and that speed takes
# 14 ms a run.
COARSE = 1e-3


def predictions(runs: list[Run], settings: dict) -> pd.DataFrame:
    """Columns KIND_front_speed_SIDE: paper, exact without leaf springs, lattice with them at dx."""
    table: dict[str, np.ndarray] = {}
    for side in SIDES:
        levels = np.array([level(run, side) for run in runs])
        supersonic = (levels > 0.0) & (levels < 1.0)
        paper = np.full(levels.shape, NAN)
        paper[supersonic] = front_speed_undamped(levels[supersonic])
        table[f"paper_front_speed_{side}"] = paper
        table[f"exact_front_speed_{side}"] = exact_speeds(runs, side)
        on_lattices = [
            _lattice_speed(stress, run.gamma, run.dx, ratio(run), run.release)
            for run, stress in zip(runs, levels.tolist(), strict=True)
        ]
        table[f"lattice_front_speed_{side}"] = np.array(on_lattices)
    return pd.DataFrame(table)


def exact_speeds(runs: list[Run], side: str) -> np.ndarray:
    """Speed of the front of each run without leaf springs; NaN where it is not supersonic."""
    levels = np.array([level(run, side) for run in runs])
    ratios = np.array([ratio(run) for run in runs])
    releases = np.array([run.release for run in runs])
    speeds = np.full(levels.shape, NAN)
    for release in ("total", "elastic"):
        chosen = (levels > 0.0) & (levels < 1.0) & (releases == release)
        if chosen.any():
            # Equal pairs are computed once.
            both = [levels[chosen], ratios[chosen]]
            pairs, indices = np.unique(both, axis=1, return_inverse=True)
            speeds[chosen] = front_speed(pairs[0], pairs[1], release)[indices.ravel()]
    return speeds


@cache
def _lattice_speed(level: float, gamma: float, dx: float, ratio: float, release: str) -> float:
    fine = ratio > 0.0 and gamma * dx**2 < COARSE
    if gamma == 0.0 or fine or not 0.0 < level < 1.0:
        return NAN
    # Under strong springs no front is supersonic.
    return or_nan(lambda: lattice_front_speed(level, gamma, dx, ratio, release))
