"""Tabulate exact undamped transition times, for nucleation at a point and by a Gaussian."""

import numpy as np
import pandas as pd

from slippulse.model.prestress import Prestress
from slippulse.theory.exact_transition import exact_transition_displacement, uniform_transition_time

NEEDS = {"sweeps": ()}

LEVELS = np.concatenate([np.linspace(0.1, 0.25, 7), np.linspace(0.3, 0.9, 13)]).round(12)
GAMMAS = (0.01, 0.1, 0.65)


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the ratio `over_paper` for each level and gamma; gamma is NaN for a point."""
    rows = []
    for level in LEVELS:
        for gamma in (None, *GAMMAS):
            rows.append({"left": level, "over_paper": over_paper(level, gamma), "gamma": gamma})
    return pd.DataFrame(rows)


def over_paper(level: float, gamma: float | None = None) -> float:
    """Return the exact transition time divided by the paper's formula, pi/sqrt(gamma).

    Rupture begins at a Gaussian of W = 1. If gamma is None it begins at a point, where the ratio
    does not depend on gamma.
    """
    if gamma is None:
        return uniform_transition_time(level, 1.0) / np.pi
    exact = exact_transition_displacement(Prestress(level, level), gamma)
    return exact.time * np.sqrt(gamma) / np.pi
