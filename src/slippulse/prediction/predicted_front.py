"""Predicted speeds of both fronts of each run: by the paper, exact, and with leaf springs."""

from functools import cache

import numpy as np
import pandas as pd

from ..model.release import RELEASES
from ..model.run import Run
from ..theory.front_speeds import front_speed
from ..theory.front_speeds_with_springs import lattice_front_speed
from .common import far_level, rounded_damping_ratio, value_or_nan

# Friction laws for which these numbers are valid. Friction that is linear in slip rate does not
# change the front speed.
LAWS = ("coulomb", "linear_rate")
# If gamma dx^2 is smaller than this, leaf springs hardly change the speed of a damped front. The
# speed with leaf springs is then not computed, since that takes about 1 ms for each run.
MIN_GAMMA_DX2 = 1e-3


def predictions(runs: list[Run], settings: dict) -> pd.DataFrame:
    """Return the front speeds of each run on both sides, one row for each run.

    The columns are paper_front_speed_SIDE, exact_front_speed_SIDE (without leaf springs) and
    lattice_front_speed_SIDE (with the leaf springs of a lattice of spacing dx), where SIDE is left
    or right. The settings, which other predictions need, are not used.
    """
    # Without damping the exact speed is that of the paper's formula.
    undamped = [run._replace(beta=0.0) for run in runs]
    table: dict[str, np.ndarray | list[float]] = {}
    for side in ("left", "right"):
        table[f"paper_front_speed_{side}"] = exact_front_speeds(undamped, side)
        table[f"exact_front_speed_{side}"] = exact_front_speeds(runs, side)
        table[f"lattice_front_speed_{side}"] = [
            _lattice_speed(
                level=far_level(run, side),
                gamma=run.gamma,
                dx=run.dx,
                damping_ratio=rounded_damping_ratio(run),
                release=run.release,
            )
            for run in runs
        ]
    return pd.DataFrame(table)


def exact_front_speeds(runs: list[Run], side: str) -> np.ndarray:
    """Return the front speed of each run on a side, "left" or "right", without leaf springs.

    Each speed is that into the pre-stress far from the nucleation point; NaN if this is not
    positive.
    """
    levels = np.array([far_level(run, side) for run in runs])
    ratios = np.array([rounded_damping_ratio(run) for run in runs])
    releases = np.array([run.release for run in runs])
    speeds = np.full(levels.shape, np.nan)
    for release in RELEASES:
        chosen = (levels > 0.0) & (releases == release)
        # Each different pair of level and damping ratio is computed once.
        all_pairs = [levels[chosen], ratios[chosen]]
        (levels_once, ratios_once), indices = np.unique(all_pairs, axis=1, return_inverse=True)
        speeds_once = front_speed(levels_once, ratios_once, release)
        speeds[chosen] = speeds_once[indices.ravel()]
    return speeds


@cache
def _lattice_speed(
    level: float, gamma: float, dx: float, damping_ratio: float, release: str
) -> float:
    """Return the front speed on a lattice with leaf springs, into pre-stress of a level.

    The result is NaN

    - without leaf springs (gamma = 0);
    - with damping, if gamma dx^2 is below MIN_GAMMA_DX2, where leaf springs hardly matter and the
      computation is slow. Without damping the speed has a closed form, and is always computed;
    - if leaf springs are so strong that no front outruns the waves.
    """
    if gamma == 0.0 or (damping_ratio > 0.0 and gamma * dx**2 < MIN_GAMMA_DX2):
        return np.nan
    return value_or_nan(lambda: lattice_front_speed(level, gamma, dx, damping_ratio, release))
