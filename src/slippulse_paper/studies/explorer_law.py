"""The front law on a grid: cubics between its points, as in the explorer, are exact to 1e-4."""

import numpy as np
import pandas as pd

from slippulse.model.release import RELEASES
from slippulse.theory.front_speeds import prestress_for_speed

NEEDS = {"sweeps": ()}

# Even steps of ln(v - 1).
EXCESS = np.linspace(-8.0, 12.0, 61)
# Even steps of asinh(b/SCALE), which is linear in b where b is small and logarithmic beyond.
SCALE = 0.005
LARGEST_RATIO, RATIOS = 5.0, 33


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """One row a point of the grid, with the logit of the pre-stress, ln(tau/(1 - tau))."""
    arsinhs = np.linspace(0.0, np.arcsinh(LARGEST_RATIO / SCALE), RATIOS)
    arsinh, excess = (grid.ravel() for grid in np.meshgrid(arsinhs, EXCESS, indexing="ij"))
    ratio = SCALE * np.sinh(arsinh)
    columns = {"damping_ratio": ratio, "ratio_arsinh": arsinh, "excess_log": excess}
    parts = []
    for release in RELEASES:
        tau = prestress_for_speed(1.0 + np.exp(excess), ratio, release)
        logit = np.round(np.log(tau) - np.log1p(-tau), 6)
        parts.append(pd.DataFrame({"release": release} | columns | {"logit": logit}))
    return pd.concat(parts, ignore_index=True)
