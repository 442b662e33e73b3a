"""Every prediction for every run of a sweep, one row a run."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from ..model.scene import Scene
from ..theory.front_law import front_speed


def predictions(scenes: Sequence[Scene], fraction: float) -> pd.DataFrame:
    """What the paper and the exact theory predict of each run; NaN where they say nothing.

    Parameters
    ----------
    scenes : in the order of the sweep
    fraction : of |x_minus| that the left front covers at T_trans under a stress boundary
    """
    return pd.DataFrame(
        [{f"exact_front_speed_{side}": _speed(scene, side) for side in ("left", "right")} for scene in scenes]
    )


def _speed(scene: Scene, side: str) -> float:
    level = float(scene.prestress.level(np.asarray(-1e300 if side == "left" else 1e300)))
    return (
        float(front_speed(level, scene.damping_ratio, scene.release)) if 0.0 < level < 1.0 else float("nan")
    )
