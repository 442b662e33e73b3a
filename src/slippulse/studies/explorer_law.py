"""The front law on a grid, for the scripts of the explorer: speeds found in it by cubics are exact to 1e-4."""

import numpy as np
import pandas as pd

from ..model.scene import RELEASES
from ..theory.front_speeds import prestress_for_speed

NEEDS = {"sweeps": ()}

# Even steps of ln(v - 1), and of asinh(b/SCALE), which is b where it is small and logarithmic beyond.
EXCESS = np.linspace(-8.0, 12.0, 61)
SCALE, LARGEST_RATIO, RATIOS = 0.005, 5.0, 33


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """One row a point of the grid: release, damping_ratio, ratio_arsinh (asinh(b/SCALE)), excess_log (ln(v - 1)), logit
    (ln(tau/(1 - tau)) of the pre-stress, to 6 decimals).
    """
    positions = np.linspace(0.0, np.arcsinh(LARGEST_RATIO / SCALE), RATIOS)
    position, excess = (grid.ravel() for grid in np.meshgrid(positions, EXCESS, indexing="ij"))
    ratio, parts = SCALE * np.sinh(position), []
    for release in RELEASES:
        tau = prestress_for_speed(1.0 + np.exp(excess), ratio, release)
        grid = {
            "release": release,
            "damping_ratio": ratio,
            "ratio_arsinh": position,
            "excess_log": excess,
        }
        parts.append(pd.DataFrame(grid | {"logit": np.round(np.log(tau) - np.log1p(-tau), 6)}))
    return pd.concat(parts, ignore_index=True)
