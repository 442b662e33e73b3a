"""The runs of a sweep, read from its Dataset."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from ..model.checks import check_that

AXES = ("sample_time", "sample_position")
DIMENSIONS = {name: (name,) for name in AXES} | {"sample_slip": AXES, "sample_velocity": AXES}


class Recorded(dict[str, np.ndarray]):
    """The arrays of a run by name, and its numbers; made in less time than a Dataset."""

    def __init__(self, arrays: dict[str, np.ndarray], attrs: dict[str, Any]) -> None:
        super().__init__(arrays)
        self.attrs = attrs

    def dataset(self) -> xr.Dataset:
        """Return the run as a Dataset over x, with samples over time and position."""
        variables = {name: (DIMENSIONS.get(name, "x"), values) for name, values in self.items()}
        return xr.Dataset(variables, attrs=self.attrs)


AnyRun = Recorded | xr.Dataset


def runs_in(sweep: xr.Dataset) -> Iterator[Recorded]:
    """Yield the runs of a sweep; or ValueError."""
    sweep = over_points(sweep)
    numbers, blocks = _over(sweep, "point"), _over(sweep, "block")
    samples = {str(name): sweep.variables[name].values for name in DIMENSIONS if name in sweep}
    size = numbers.pop("row_size", np.zeros(sweep.sizes["point"], int))
    start = numbers.pop("row_start", None)
    numbers.pop("point", None)
    length = blocks.get("x", size[:0]).size
    if start is None:
        start = np.cumsum(size) - size
        fitting = np.all(size >= 0) and np.sum(size) == length
    else:
        # Some of the runs may have been selected.
        fitting = np.all(size >= 0) and np.all(start + size <= length)
    allowed = "numbers of blocks whose sum is the length of x"
    check_that(bool(fitting), "row_size", size.tolist(), allowed)
    versions = {name: value for name, value in sweep.attrs.items() if name == "versions"}
    for index in range(size.size):
        rows = slice(start[index], start[index] + size[index])
        arrays = {name: values[rows] for name, values in blocks.items()}
        arrays |= {name: values[index] for name, values in samples.items()}
        # Texts from a file may be objects of Python.
        attrs = {name: np.asarray(values[index]).item() for name, values in numbers.items()}
        yield Recorded(arrays, attrs | versions)


def over_points(sweep: xr.Dataset) -> xr.Dataset:
    """Return a grid of runs, or a single one that was selected, as a sweep over ``point``."""
    numbers = [name for name in ("row_start", "run_flags") if name in sweep.variables]
    axes = sweep[numbers[0]].dims if numbers else ("point",)
    if axes == ("point",):
        return sweep
    sweep = sweep.stack(point=axes).reset_index("point") if axes else sweep
    variables, size = {}, sweep.sizes.get("point", 1)
    for name, variable in sweep.variables.items():
        if "point" in variable.dims:
            variables[name] = variable.transpose("point", ...)
        elif "block" in variable.dims:
            variables[name] = variable
        else:
            # Of a single run, or of all runs that were selected.
            variables[name] = variable.set_dims({"point": size} | variable.sizes)
    return xr.Dataset(variables, attrs=sweep.attrs)


def _over(sweep: xr.Dataset, dimension: str) -> dict[str, np.ndarray]:
    """Arrays of the variables over one dimension alone."""
    variables = sweep.variables.items()
    return {str(name): one.values for name, one in variables if one.dims == (dimension,)}
