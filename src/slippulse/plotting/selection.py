"""Few of many: the levels, runs and points that a figure has room for."""

import numpy as np
import pandas as pd


def spread_values(values: pd.Series, count: int) -> np.ndarray:
    """At most ``count`` different values of a column, evenly from the smallest to the largest."""
    different = np.sort(values.unique())
    return different[np.unique(np.linspace(0, different.size - 1, count).round().astype(int))]


def spaced_indices(size: int, most: int) -> np.ndarray:
    """Regularly spaced indices below ``size``, at most ``most`` of them."""
    return np.arange(0, size, max(1, int(np.ceil(size / most))))
