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
LARGEST_RATIO = 5.0
RATIO_COUNT = 33


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the front law: the pre-stress by release rule, damping ratio b and front speed v.

    There is one row per grid point. Coordinates and pre-stress are transformed so that they vary
    evenly: asinh(b/RATIO_SCALE), ln(v - 1), and the logit of the pre-stress, ln(tau/(1 - tau)).
    """
    arsinhs = np.linspace(0.0, np.arcsinh(LARGEST_RATIO / RATIO_SCALE), RATIO_COUNT)
    arsinh_grid, log_excess_grid = np.meshgrid(arsinhs, LOG_EXCESS_SPEEDS, indexing="ij")
    arsinh, log_excess = arsinh_grid.ravel(), log_excess_grid.ravel()
    ratio, speed = RATIO_SCALE * np.sinh(arsinh), 1.0 + np.exp(log_excess)
    columns = {"damping_ratio": ratio, "ratio_arsinh": arsinh, "excess_log": log_excess}
    parts = []
    for release in RELEASES:
        tau = prestress_for_speed(speed, ratio, release)
        logit = np.log(tau) - np.log1p(-tau)
        rows = {"release": release} | columns | {"logit": np.round(logit, 6)}
        parts.append(pd.DataFrame(rows))
    return pd.concat(parts, ignore_index=True)
