"""The speed of both fronts of each run: the paper's, the exact one, and that of a lattice with leaf springs."""

from functools import cache

import numpy as np
import pandas as pd

from ..model.scene import Scene
from ..theory.front_speeds import front_speed, front_speed_undamped, lattice_front_speed
from .numbers import NAN, SIDES, level, or_nan, ratio

# Where blocks are smaller, gamma dx^2 below this, leaf springs hardly change the speed of a damped front, and finding
# how much takes 14 ms a run.
COARSE = 1e-3


def predictions(scenes: list[Scene], settings: dict) -> pd.DataFrame:
    """paper_front_speed_SIDE, exact_front_speed_SIDE (no leaf springs), lattice_front_speed_SIDE (with, at this dx)."""
    out: dict[str, np.ndarray] = {}
    for side in SIDES:
        levels = np.array([level(scene, side) for scene in scenes])
        outruns = (levels > 0.0) & (levels < 1.0)
        paper, lattice = np.full((2, levels.size), NAN)
        paper[outruns] = front_speed_undamped(levels[outruns])
        for i, scene in enumerate(scenes):
            damping = ratio(scene)
            if (
                outruns[i]
                and scene.gamma > 0.0
                and (damping == 0.0 or scene.gamma * scene.dx**2 >= COARSE)
            ):
                lattice[i] = _with_springs(levels[i], scene.gamma, scene.dx, damping, scene.release)
        kinds = {"paper": paper, "exact": exact_speeds(scenes, side), "lattice": lattice}
        out |= {f"{kind}_front_speed_{side}": speeds for kind, speeds in kinds.items()}
    return pd.DataFrame(out)


def exact_speeds(scenes: list[Scene], side: str) -> np.ndarray:
    """Speed of the front of each scene without leaf springs; NaN where none outruns the waves."""
    levels = np.array([level(scene, side) for scene in scenes])
    ratios = np.array([ratio(scene) for scene in scenes])
    speeds = np.full(levels.shape, NAN)
    for release in ("total", "elastic"):
        chosen = (levels > 0.0) & (levels < 1.0) & [scene.release == release for scene in scenes]
        if chosen.any():
            pairs, back = np.unique([levels[chosen], ratios[chosen]], axis=1, return_inverse=True)
            speeds[chosen] = front_speed(pairs[0], pairs[1], release)[back.ravel()]
    return speeds


@cache
def _with_springs(level: float, gamma: float, dx: float, ratio: float, release: str) -> float:
    # Under strong springs no front outruns the waves.
    return or_nan(lambda: lattice_front_speed(level, gamma, dx, ratio, release))
