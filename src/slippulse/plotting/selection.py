"""Selection of the levels, runs and points that a figure has room for."""

import numpy as np
import pandas as pd


def spread_values(values: pd.Series, count: int) -> np.ndarray:
    """Return at most ``count`` different values, evenly from the smallest to the largest."""
    different = np.sort(values.unique())
    return different[np.unique(np.linspace(0, different.size - 1, count).round().astype(int))]


def spaced_indices(size: int, most: int) -> np.ndarray:
    """Return at most ``most`` regularly spaced indices from 0 to ``size`` - 1."""
    return np.arange(0, size, max(1, int(np.ceil(size / most))))
