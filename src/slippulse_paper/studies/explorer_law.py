"""Tabulate the front law on a grid, for the page with sliders that solves ruptures in the browser.

The front law gives the front speed as a function of pre-stress, damping ratio and release rule. The
cubic interpolation of the page has errors below 1e-4.
"""

import numpy as np
import pandas as pd

from slippulse.model.release import RELEASES
from slippulse.theory.front_speeds import prestress_for_speed

NEEDS = {"sweeps": ()}

# The grid has even steps of ln(v - 1), where v is the front speed.
LOG_EXCESS_SPEEDS = np.linspace(-8.0, 12.0, 61)
# The other coordinate of the grid is the damping ratio b, in even steps of asinh(b/RATIO_SCALE).
# This function is linear where b is smaller than RATIO_SCALE, and logarithmic where b is larger.
RATIO_SCALE = 0.005
LARGEST_RATIO = 5.0
RATIO_COUNT = 33


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the pre-stress at which a front has a given speed, one row for each grid point.

    The columns are:

    damping_ratio : b = beta/dx
    ratio_arsinh : asinh(b/RATIO_SCALE), one coordinate of the grid
    excess_log : ln(v - 1), the other coordinate
    logit : ln(tau/(1 - tau)), where tau is the pre-stress. Unlike tau, it varies evenly over the
        grid, which interpolation needs.
    """
    arsinhs = np.linspace(0.0, np.arcsinh(LARGEST_RATIO / RATIO_SCALE), RATIO_COUNT)
    arsinh_grid, log_excess_grid = np.meshgrid(arsinhs, LOG_EXCESS_SPEEDS, indexing="ij")
    arsinh, log_excess = arsinh_grid.ravel(), log_excess_grid.ravel()
    damping_ratio = RATIO_SCALE * np.sinh(arsinh)
    speed = 1.0 + np.exp(log_excess)
    columns = {"damping_ratio": damping_ratio, "ratio_arsinh": arsinh, "excess_log": log_excess}
    parts = []
    for release in RELEASES:
        tau = prestress_for_speed(speed, damping_ratio, release)
        logit = np.log(tau) - np.log1p(-tau)
        rows = {"release": release} | columns | {"logit": np.round(logit, 6)}
        parts.append(pd.DataFrame(rows))
    return pd.concat(parts, ignore_index=True)
