"""An xarray index that selects the runs of a sweep by any of their parameters.

An index of xarray itself has one coordinate. If several of them lie along one dimension, a
selection cannot combine them, and before xarray 2025 arithmetic was not possible.
"""

import math
from collections.abc import Hashable, Mapping, Sequence
from typing import Any, Self

import numpy as np
import pandas as pd
import xarray as xr
from xarray.core.indexing import IndexSelResult

from ..model.checks import check_that, short_repr
from ..model.scene import ATTRIBUTES

# `independent_parameters` tries the parameters in this order, each of them once.
PARAMETER_ORDER = tuple(dict.fromkeys(["boundary", "gamma", "damping_ratio", "dx", *ATTRIBUTES]))
# Two values of a parameter are taken as equal up to this relative difference. The ratio beta/dx is
# computed by a division, so that equal ratios can differ by rounding.
EQUALITY_TOLERANCE = 1e-9


class ParameterIndex(xr.Index):
    """Index along the dimension ``point`` that holds the values of all parameters of the runs.

    A selection can use any number of parameters. If the sweep is converted to a pandas table, the
    index of the table consists of the parameters that differ between the runs.
    """

    def __init__(self, values: Mapping[Hashable, np.ndarray]) -> None:
        self.values = dict(values)

    @classmethod
    def from_variables(
        cls, variables: Mapping[Any, xr.Variable], *, options: Mapping[str, Any]
    ) -> Self:
        """Make the index from the variables of the parameters, which lie along ``point``."""
        return cls({name: variable.values for name, variable in variables.items()})

    @classmethod
    def concat(
        cls,
        indexes: Sequence[Self],
        dim: Hashable,
        positions: Any = None,
    ) -> Self:
        """Join indexes of the same parameters.

        positions : for each index, the numbers of its runs in the result; by default the runs
            follow one another
        """
        joined = {}
        for name in indexes[0].values:
            joined[name] = np.concatenate([index.values[name] for index in indexes])
        if positions is None:
            return cls(joined)
        order = np.argsort(np.concatenate([np.asarray(numbers) for numbers in positions]))
        return cls({name: values[order] for name, values in joined.items()})

    def create_variables(
        self, variables: Mapping[Any, xr.Variable] | None = None
    ) -> dict[Hashable, xr.Variable]:
        """Return the coordinates of the index, with the attributes of the given variables."""
        attributes = {name: variable.attrs for name, variable in (variables or {}).items()}
        coordinates = {}
        for name, values in self.values.items():
            coordinates[name] = xr.Variable("point", values, attributes.get(name))
        return coordinates

    def rename(self, name_dict: Mapping[Any, Hashable], dims_dict: Mapping[Any, Hashable]) -> Self:
        """Return the index with other names of parameters."""
        renamed = {name_dict.get(name, name): values for name, values in self.values.items()}
        return type(self)(renamed)

    def to_pandas_index(self) -> pd.Index:
        """Return an index of the parameters that distinguish the runs.

        If no parameter differs, it has the numbers of the runs.
        """
        names = independent_parameters(self.values) or ["point"]
        if len(names) == 1:
            return pd.Index(self.values[names[0]], name=names[0])
        return pd.MultiIndex.from_arrays([self.values[name] for name in names], names=names)

    def equals(self, other: xr.Index, **options: Any) -> bool:
        """Return True if another index has the same values of the same parameters."""
        if not isinstance(other, ParameterIndex) or self.values.keys() != other.values.keys():
            return False
        for name, values in self.values.items():
            other_values = other.values[name]
            # Only numbers can be NaN, and numpy refuses to look for NaN in texts.
            are_numbers = values.dtype.kind == "f" and other_values.dtype.kind == "f"
            if not np.array_equal(values, other_values, equal_nan=are_numbers):
                return False
        return True

    def isel(self, indexers: Mapping[Any, Any]) -> Self | None:
        """Return the index of the runs at some row numbers, which xarray calls an indexer.

        Returns None if the result has no dimension ``point`` to index: for a single run, and for
        row numbers along another dimension.
        """
        rows = indexers["point"]
        if isinstance(rows, xr.Variable):
            if rows.dims != ("point",):
                return None
            rows = rows.values
        is_single_run = np.ndim(rows) == 0 and not isinstance(rows, slice)
        if is_single_run:
            return None
        return type(self)({name: values[rows] for name, values in self.values.items()})

    def sel(self, labels: dict[Any, Any], method: Any = None, tolerance: Any = None):
        """Select the runs at values of parameters: one value, several, or a slice.

        Raises KeyError if no run matches.

        labels : the values by the name of the parameter
        method : "nearest" selects the nearest number that occurs
        tolerance : xarray passes this argument, but only None is allowed
        """
        check_that(method in (None, "nearest"), "method", method, "None or 'nearest'")
        check_that(tolerance is None, "tolerance", tolerance, "None")
        number_of_runs = len(next(iter(self.values.values())))
        is_selected = np.ones(number_of_runs, dtype=bool)
        for name, label in labels.items():
            is_selected &= self._matches(name, label, method == "nearest")
        if not is_selected.any():
            requested = [f"{name} = {short_repr(label)}" for name, label in labels.items()]
            present = {name: np.unique(self.values[name]).tolist() for name in labels}
            allowed = f"the runs have {short_repr(present)}"
            raise KeyError(f"{', '.join(requested)}: no such run; {allowed}")
        return IndexSelResult({"point": np.flatnonzero(is_selected)})

    def _matches(self, name: Hashable, label: Any, nearest: bool) -> np.ndarray:
        """Return a mask of the runs that a label selects by their values of one parameter.

        A label is one value, several values, or a slice, which includes both of its ends. Numbers
        match up to rounding, or, if ``nearest`` is True, the nearest number that occurs matches.
        None and NaN match the runs without a value, such as those with ``width=None``.
        """
        values = self.values[name]
        if isinstance(label, slice):
            matches = np.ones(values.shape, dtype=bool)
            if label.start is not None:
                matches &= values >= label.start
            if label.stop is not None:
                matches &= values <= label.stop
            return matches
        has_numbers = values.dtype.kind in "if"
        matches = np.zeros(values.shape, dtype=bool)
        for value in np.atleast_1d(np.asarray(label)).tolist():
            if not has_numbers or isinstance(value, str):
                matches |= values == value
                continue
            if value is None or math.isnan(value):
                matches |= np.isnan(values)
                continue
            if nearest:
                # A run without this parameter has the value NaN, and is never the nearest.
                distances = np.nan_to_num(np.abs(values - value), nan=np.inf)
                value = values[np.argmin(distances)]
            matches |= np.isclose(values, value, rtol=EQUALITY_TOLERANCE, atol=0.0)
        return matches


def independent_parameters(values: Mapping[Any, np.ndarray]) -> list[str]:
    """Return the parameters that differ between the runs and are not determined by others.

    A parameter is kept if it distinguishes runs that the parameters kept before it do not.

    values : for each parameter, its values in all runs
    """
    candidates = [name for name in PARAMETER_ORDER if name in values]
    kept_names: list[str] = []
    # Number of different combinations of the kept parameters.
    count = 1
    for name in candidates:
        count_with_name = len(distinct_combinations(values, [*kept_names, name]))
        if count_with_name > count:
            kept_names.append(name)
            count = count_with_name
    return kept_names


def distinct_combinations(values: Mapping[Any, np.ndarray], names: Sequence[str]) -> np.ndarray:
    """Return the different combinations of some parameters that occur among the runs.

    Each row is one combination. In place of a value it has the number of the value in the sorted
    list of all values of the parameter.

    values : for each parameter, its values in all runs
    """
    value_numbers = [np.unique(values[name], return_inverse=True)[1] for name in names]
    return np.unique(np.stack(value_numbers, axis=-1), axis=0)
