"""Numerical uncertainty by a grid study: three spacings, observed order, extrapolated value."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd

from ..model.roots import root_between

# Observed orders outside this range are not an order: the three values are then only a spread.
ORDERS = (0.5, 6.0)


class GridStudy(NamedTuple):
    """One number at three spacings."""

    value: float  # at the finest spacing
    extrapolated: float  # at spacing 0, by the observed order; the finest value where there is none
    observed_order: float  # NaN where the three values do not follow a power of the spacing
    uncertainty: float  # |value - extrapolated|, or of the lowest order where there is none


def grid_study(values: Sequence[float], factors: Sequence[float]) -> GridStudy:
    """Richardson's f(h) = f_0 + C h^p through values at dx, c_1 dx, c_2 dx; 1 < c_1 < c_2."""
    finest, middle, coarsest = (float(value) for value in values)
    if not all(map(math.isfinite, (finest, middle, coarsest))):
        return GridStudy(finest, finest, np.nan, np.nan)
    spread = max(finest, middle, coarsest) - min(finest, middle, coarsest)
    first, second = middle - finest, coarsest - finest

    def mismatch(order: float) -> float:
        return second * (factors[0] ** order - 1.0) - first * (factors[1] ** order - 1.0)

    low, high = ORDERS
    alike = spread <= 1e-14 * max(1.0, abs(finest))
    if alike or first * second <= 0.0 or mismatch(low) * mismatch(high) > 0.0:
        # The spread is taken for that of the lowest order.
        return GridStudy(finest, finest, np.nan, spread / (factors[1] ** low - 1.0))
    order = float(root_between(mismatch, low, high))
    extrapolated = finest - first / (factors[0] ** order - 1.0)
    return GridStudy(finest, extrapolated, order, abs(finest - extrapolated))


def quantities(table: pd.DataFrame, keys: Sequence[str]) -> list[str]:
    """Columns of a measured table, as read from its file, that a grid study has: no ``keys``."""
    numbers = table.drop(columns=[*keys], errors="ignore").select_dtypes("float").columns
    return [name for name in numbers if not name.startswith("paper_")]


def grid_tables(
    tables: Sequence[pd.DataFrame], factors: Sequence[float], keys: Sequence[str]
) -> pd.DataFrame:
    """Grid study of each measured number, from tables at three spacings, the finest first."""
    finest = tables[0]
    names = quantities(finest, keys)
    # One row a point and quantity, one column a spacing.
    values = np.stack([table[names].to_numpy().ravel() for table in tables], axis=1).tolist()
    numbers = pd.DataFrame([grid_study(three, factors) for three in values])
    points = pd.DataFrame({"point": range(len(finest))}).join(finest[list(keys)])
    points = points.loc[points.index.repeat(len(names))].reset_index(drop=True)
    return points.assign(quantity=names * len(finest)).join(numbers)
