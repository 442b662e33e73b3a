"""Tabulate the front law on a grid for the explorer, whose cubic interpolation is exact to 1e-4."""

import numpy as np
import pandas as pd

from slippulse.model.release import RELEASES
from slippulse.theory.front_speeds import prestress_for_speed

NEEDS = {"sweeps": ()}

# Even steps of ln(v - 1).
LOG_EXCESS_SPEEDS = np.linspace(-8.0, 12.0, 61)
# Even steps of asinh(b/RATIO_SCALE), which is linear in b where b is small and logarithmic beyond.
RATIO_SCALE = 0.005
LARGEST_RATIO, RATIO_COUNT = 5.0, 33


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return one row per grid point, with the logit of the pre-stress, ln(tau/(1 - tau))."""
    arsinhs = np.linspace(0.0, np.arcsinh(LARGEST_RATIO / RATIO_SCALE), RATIO_COUNT)
    arsinh, excess = (
        grid.ravel() for grid in np.meshgrid(arsinhs, LOG_EXCESS_SPEEDS, indexing="ij")
    )
    ratio = RATIO_SCALE * np.sinh(arsinh)
    columns = {"damping_ratio": ratio, "ratio_arsinh": arsinh, "excess_log": excess}
    parts = []
    for release in RELEASES:
        tau = prestress_for_speed(1.0 + np.exp(excess), ratio, release)
        logit = np.round(np.log(tau) - np.log1p(-tau), 6)
        parts.append(pd.DataFrame({"release": release} | columns | {"logit": logit}))
    return pd.concat(parts, ignore_index=True)
