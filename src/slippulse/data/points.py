"""The runs of a sweep, taken out of its Dataset. Loads no compiler."""

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
import xarray as xr

from ..model.checks import check_number, short_repr

AXES = ("sample_time", "sample_position")
DIMENSIONS = {name: (name,) for name in AXES} | dict.fromkeys(
    ("sample_slip", "sample_velocity"), AXES
)


class Recorded(dict[str, np.ndarray]):
    """The arrays of a run by name, and its numbers: what is read of its Dataset, without the time that one takes."""

    def __init__(self, arrays: dict[str, np.ndarray], attrs: dict[str, Any]) -> None:
        super().__init__(arrays)
        self.attrs = attrs

    def dataset(self) -> xr.Dataset:
        """The same as a Dataset over x, with samples over time and position."""
        variables = {name: (DIMENSIONS.get(name, "x"), values) for name, values in self.items()}
        return xr.Dataset(variables, attrs=self.attrs)


AnyRun = Recorded | xr.Dataset


def point(sweep: xr.Dataset, index: int) -> xr.Dataset:
    """One run of a sweep as `simulate` returned it, as far as it was recorded.

    sweep : data of a sweep, such as ``xarray.open_dataset("results/data/arrest.nc")``
    index : number of the run, from 0

    Raises TypeError: if it is not a sweep; ValueError: if it has no such run, or its blocks are not those of its runs.
    """
    if not isinstance(sweep, xr.Dataset) or "point" not in sweep.sizes:
        allowed = "a Dataset that run_sweep returned, or of results/data"
        raise TypeError(f"sweep: {short_repr(sweep)}; allowed: {allowed}")
    check_number("index", index, whole=True, at_least=0, at_most=sweep.sizes["point"] - 1)
    (run,) = runs_in(sweep, [index])
    return run.dataset()


def runs_in(sweep: xr.Dataset, indices: Iterable[int] | None = None) -> Iterator[Recorded]:
    """Some runs of a sweep by their numbers, or all; raises as `point` does where its blocks are not theirs."""
    found = [
        (str(name), variable.dims, variable.values) for name, variable in sweep.variables.items()
    ]
    numbers = {name: values for name, dimensions, values in found if dimensions == ("point",)}
    blocks = {name: values for name, dimensions, values in found if dimensions == ("block",)}
    samples = {name: values for name, _, values in found if name in DIMENSIONS}
    size = numbers.pop("row_size", np.zeros(sweep.sizes["point"], int))
    if np.any(size < 0) or np.sum(size) != blocks.get("x", size[:0]).size:
        allowed = "numbers of blocks whose sum is the length of x"
        raise ValueError(f"row_size: {short_repr(size.tolist())}; allowed: {allowed}")
    ends = np.cumsum(size)
    parts = [*map(slice, ends - size, ends)]
    versions = {name: value for name, value in sweep.attrs.items() if name == "versions"}
    for index in range(len(parts)) if indices is None else indices:
        arrays = {name: values[parts[index]] for name, values in blocks.items()}
        arrays |= {name: values[index] for name, values in samples.items()}
        yield Recorded(
            arrays, {name: values[index].item() for name, values in numbers.items()} | versions
        )
