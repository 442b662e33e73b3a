"""Split the Dataset of a sweep into its runs.

In the Dataset the blocks of all runs follow one another along the dimension "block". The variable
``row_size`` has the number of blocks of each run.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from ..model.checks import check_that

SAMPLE_AXES = ("sample_time", "sample_position")
# Dimensions of the samples of a run. All other arrays of a run have the dimension "x".
SAMPLE_DIMENSIONS = {name: (name,) for name in SAMPLE_AXES} | {
    "sample_slip": SAMPLE_AXES,
    "sample_velocity": SAMPLE_AXES,
}


class Recorded(dict[str, np.ndarray]):
    """The arrays of one run by name, and its single numbers as ``attrs``.

    Such an object can be read like a Dataset, and is much faster to build.
    """

    def __init__(self, arrays: dict[str, np.ndarray], attrs: dict[str, Any]) -> None:
        super().__init__(arrays)
        self.attrs = attrs

    def dataset(self) -> xr.Dataset:
        """Return the run as a Dataset: fields as functions of x, samples of time and position."""
        variables = {
            name: (SAMPLE_DIMENSIONS.get(name, "x"), values) for name, values in self.items()
        }
        return xr.Dataset(variables, attrs=self.attrs)


# One run in either form.
AnyRun = Recorded | xr.Dataset


def runs_in(sweep: xr.Dataset) -> Iterator[Recorded]:
    """Yield the runs of a sweep.

    Raises ValueError if the numbers of blocks of the runs do not fit the arrays.
    """
    sweep = over_points(sweep)
    # Single numbers of each run. The three that only describe the sweep are taken out.
    numbers = _arrays_along(sweep, "point")
    numbers.pop("point", None)
    sizes = numbers.pop("row_size", np.zeros(sweep.sizes["point"], int))
    recorded_starts = numbers.pop("row_start", None)
    block_arrays = _arrays_along(sweep, "block")
    # The times, positions and values of samples, in arrays whose first axis is the run.
    sample_arrays = {
        str(name): sweep.variables[name].values for name in SAMPLE_DIMENSIONS if name in sweep
    }
    number_of_blocks = block_arrays["x"].size if "x" in block_arrays else 0
    starts = _starts_of_runs(sizes, recorded_starts, number_of_blocks)
    for index in range(sizes.size):
        blocks = slice(starts[index], starts[index] + sizes[index])
        arrays = {name: values[blocks] for name, values in block_arrays.items()}
        arrays |= {name: values[index] for name, values in sample_arrays.items()}
        # A file may have its texts as Python objects, which have no method `item`.
        attrs = {name: np.asarray(values[index]).item() for name, values in numbers.items()}
        if "versions" in sweep.attrs:
            attrs["versions"] = sweep.attrs["versions"]
        yield Recorded(arrays, attrs)


def _starts_of_runs(
    sizes: np.ndarray, recorded_starts: np.ndarray | None, number_of_blocks: int
) -> np.ndarray:
    """Return the number of the first block of each run.

    Raises ValueError if the blocks of the runs do not fit the arrays.

    sizes : number of blocks of each run
    recorded_starts : the numbers that the sweep has recorded (its variable row_start); if None, the
        blocks of the runs follow one another
    number_of_blocks : length of the arrays that contain the blocks of all runs
    """
    if recorded_starts is None:
        # Each run begins where the previous one ends.
        starts = np.cumsum(sizes) - sizes
        is_consistent = np.all(sizes >= 0) and np.sum(sizes) == number_of_blocks
        allowed = "numbers of blocks whose sum is the length of x"
    else:
        # If runs were selected from a sweep, the arrays still contain the blocks of all its runs.
        starts = recorded_starts
        is_consistent = np.all(sizes >= 0) and np.all(starts + sizes <= number_of_blocks)
        allowed = "numbers of blocks that fit into x, counted from row_start on"
    check_that(bool(is_consistent), "row_size", sizes.tolist(), allowed)
    return starts


def over_points(sweep: xr.Dataset) -> xr.Dataset:
    """Convert a grid of runs, or a single selected run, to a sweep along the dimension "point"."""
    # These two variables (the first block and the flags of each run) have one value for each run.
    # So their dimensions are "point", or the axes of a grid of runs. For a single selected run they
    # have no dimension.
    run_dimensions: tuple = ("point",)
    if "row_start" in sweep.variables:
        run_dimensions = sweep["row_start"].dims
    elif "run_flags" in sweep.variables:
        run_dimensions = sweep["run_flags"].dims
    if run_dimensions == ("point",):
        return sweep
    if run_dimensions:
        sweep = sweep.stack(point=run_dimensions).reset_index("point")
    number_of_runs = sweep.sizes.get("point", 1)
    variables = {}
    for name, variable in sweep.variables.items():
        if "point" in variable.dims:
            variables[name] = variable.transpose("point", ...)
        elif "block" in variable.dims:
            # The fields already contain the blocks of all runs, one run after another.
            variables[name] = variable
        else:
            # The variable does not depend on the run, and is repeated for each of them.
            variables[name] = variable.set_dims({"point": number_of_runs} | variable.sizes)
    return xr.Dataset(variables, attrs=sweep.attrs)


def _arrays_along(sweep: xr.Dataset, dimension: str) -> dict[str, np.ndarray]:
    """Return the variables that have one given dimension and no other, as arrays by name."""
    arrays = {}
    for name, variable in sweep.variables.items():
        if variable.dims == (dimension,):
            arrays[str(name)] = variable.values
    return arrays
