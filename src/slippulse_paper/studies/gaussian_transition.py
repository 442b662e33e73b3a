"""Tabulate exact undamped transition times, for nucleation at a point and by a Gaussian."""

import numpy as np
import pandas as pd

from slippulse.model.prestress import Prestress
from slippulse.theory.exact_transition import exact_transition_displacement, uniform_transition_time

NEEDS = {"sweeps": ()}

LEVELS = np.concatenate([np.linspace(0.1, 0.25, 7), np.linspace(0.3, 0.9, 13)]).round(12)
GAMMAS = (0.01, 0.1, 0.65)


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return T_trans sqrt(gamma)/pi at Gamma = 1; gamma is NaN for nucleation at a point."""
    rows = []
    for left in LEVELS:
        rows += [(left, over_paper(left, gamma), gamma) for gamma in (None, *GAMMAS)]
    return pd.DataFrame(rows, columns=["left", "over_paper", "gamma"])


def over_paper(level: float, gamma: float | None = None) -> float:
    """Return T_trans sqrt(gamma)/pi for a Gaussian of W = 1, or for a point if gamma is None."""
    if gamma is None:
        return uniform_transition_time(level, 1.0) / np.pi
    exact = exact_transition_displacement(Prestress(level, level), gamma)
    return exact.time * np.sqrt(gamma) / np.pi
