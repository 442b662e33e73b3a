"""Selection of a few values or points, so that a figure does not show too many of them."""

import numpy as np
import pandas as pd


def spread_values(values: pd.Series, count: int) -> np.ndarray:
    """Return at most ``count`` of the different values, among them the smallest and the largest.

    In the sorted list of different values, those returned are evenly spaced.
    """
    different = np.sort(values.unique())
    indices = np.linspace(0, different.size - 1, count).round().astype(int)
    return different[np.unique(indices)]


def spaced_indices(size: int, max_count: int) -> np.ndarray:
    """Return at most ``max_count`` evenly spaced indices of an array of this size, from 0 on."""
    step = max(1, int(np.ceil(size / max_count)))
    return np.arange(0, size, step)
