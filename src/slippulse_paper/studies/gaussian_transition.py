"""Tabulate exact transition times without damping, divided by the paper's formula.

Exact times depend on how the rupture begins: at a single point, or at a Gaussian of the pre-stress.
"""

import numpy as np
import pandas as pd

from slippulse.model.prestress import Prestress
from slippulse.theory.exact_transition import exact_transition_displacement, uniform_transition_time

NEEDS = {"sweeps": ()}

LEVELS = np.concatenate([np.linspace(0.1, 0.25, 7), np.linspace(0.3, 0.9, 13)]).round(12)
GAMMAS = (0.01, 0.1, 0.65)


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the exact time divided by the paper's formula, for each level and gamma.

    The column gamma is NaN if the rupture begins at a point.
    """
    rows = []
    for level in LEVELS:
        for gamma in (None, *GAMMAS):
            ratio = time_divided_by_formula(level, gamma)
            rows.append({"left": level, "over_paper": ratio, "gamma": gamma})
    return pd.DataFrame(rows)


def time_divided_by_formula(level: float, gamma: float | None = None) -> float:
    """Return the exact transition time divided by the paper's formula, pi/sqrt(gamma).

    The rupture begins at a Gaussian of width W = 1, or at a point if gamma is None. For a point,
    the ratio does not depend on gamma.
    """
    if gamma is None:
        return uniform_transition_time(level, gamma=1.0) / np.pi
    exact = exact_transition_displacement(Prestress(level, level), gamma)
    return exact.time * np.sqrt(gamma) / np.pi
