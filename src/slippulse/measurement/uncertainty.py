"""Numerical uncertainty of a measured number, from runs at three spacings (a grid study).

If the error falls with a power of the spacing, three values determine that power (the observed
order) and the value at spacing 0 (Richardson extrapolation). The uncertainty is the difference
between the values at spacing 0 and at the finest spacing.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd

from ..model.roots import root_between

# If the observed order is outside this range, it is not trusted: the three values count as not
# following a power of the spacing.
ORDER_RANGE = (0.5, 6.0)
# Three values are equal if their relative spread is at most this.
EQUALITY_TOLERANCE = 1e-14


class GridStudy(NamedTuple):
    """Result of a grid study of one number."""

    value: float  # value at the finest spacing
    extrapolated: float  # value at spacing 0; the finest value if there is no observed order
    observed_order: float  # NaN if the three values do not follow a power of the spacing
    uncertainty: float  # |value - extrapolated|; without an order, see `grid_study`


def grid_study(values: Sequence[float], factors: Sequence[float]) -> GridStudy:
    """Extrapolate a number from three spacings to spacing 0 with f(h) = f_0 + C h^p.

    values : the number at the spacings dx, c_1 dx and c_2 dx, where 1 < c_1 < c_2
    factors : c_1 and c_2

    If no order p within ORDER_RANGE fits, the value is not extrapolated. The uncertainty is then
    (largest value - smallest value)/(c_2^p - 1) with the lowest p of this range, which gives the
    largest uncertainty. It is NaN if a value is missing.
    """
    c_1, c_2 = factors
    finest, middle, coarsest = (float(value) for value in values)
    if not all(map(math.isfinite, (finest, middle, coarsest))):
        return GridStudy(finest, extrapolated=finest, observed_order=np.nan, uncertainty=np.nan)
    spread = max(finest, middle, coarsest) - min(finest, middle, coarsest)
    middle_change, coarsest_change = middle - finest, coarsest - finest

    def mismatch(order: float) -> float:
        """Return 0 if the two changes have the ratio (c_1^p - 1)/(c_2^p - 1) of this order p."""
        return coarsest_change * (c_1**order - 1.0) - middle_change * (c_2**order - 1.0)

    # No order fits if the values do not rise or fall from spacing to spacing, apart from rounding,
    # or if the mismatch has the same sign at both ends of the range of orders.
    lowest, highest = ORDER_RANGE
    are_equal = spread <= EQUALITY_TOLERANCE * max(1.0, abs(finest))
    is_monotonic = middle_change * coarsest_change > 0.0
    if are_equal or not is_monotonic or mismatch(lowest) * mismatch(highest) > 0.0:
        uncertainty = spread / (c_2**lowest - 1.0)
        return GridStudy(finest, finest, observed_order=np.nan, uncertainty=uncertainty)
    order = float(root_between(mismatch, lowest, highest))
    extrapolated = finest - middle_change / (c_1**order - 1.0)
    return GridStudy(finest, extrapolated, order, abs(finest - extrapolated))


def studied_columns(table: pd.DataFrame, keys: Sequence[str]) -> list[str]:
    """Return the names of the columns of a measured table that a grid study examines.

    A grid study examines the columns of floats, except the ``keys`` and the predictions of the
    paper. The table must have been read from its file, because this decides the types of its
    columns.

    keys : columns that identify a run or describe its computation
    """
    numbers = table.drop(columns=[*keys], errors="ignore").select_dtypes("float").columns
    return [name for name in numbers if not name.startswith("paper_")]


def grid_tables(
    tables: Sequence[pd.DataFrame], factors: Sequence[float], keys: Sequence[str]
) -> pd.DataFrame:
    """Return a grid study of each measured number of each run.

    tables : measured tables at three spacings, the finest first
    factors : the second and third spacing divided by the finest
    keys : columns that identify a run or describe its computation

    The result has one row for each run and measured number (the columns ``point`` and
    ``quantity``), with the keys of the run and the fields of `GridStudy`.
    """
    finest = tables[0]
    names = studied_columns(finest, keys)
    # This array has all quantities of the first run, followed by those of the second run, and so
    # on. There is one row for each run and quantity, and one column for each spacing.
    values = np.stack([table[names].to_numpy().ravel() for table in tables], axis=1).tolist()
    studies = pd.DataFrame([grid_study(three_values, factors) for three_values in values])
    runs = pd.DataFrame({"point": range(len(finest))}).join(finest[list(keys)])
    # Each run is repeated once for each quantity.
    rows = runs.loc[runs.index.repeat(len(names))].reset_index(drop=True)
    return rows.assign(quantity=names * len(finest)).join(studies)
