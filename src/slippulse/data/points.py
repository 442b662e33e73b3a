"""One run taken out of the Dataset of a sweep. Loads no compiler."""

from collections.abc import Hashable
from typing import Any

import numpy as np
import xarray as xr

from ..model.checks import check_number, short_repr


def point(sweep: xr.Dataset, index: int, indexes: bool = True) -> xr.Dataset:
    """One run of a sweep as `simulate` returned it, as far as it was recorded.

    sweep : data of a sweep, such as ``xarray.open_dataset("results/data/arrest.nc")``
    index : number of the run, from 0
    indexes : whether to choose by coordinate in it (`sel`); without, it takes half the time to make, and to read

    Raises TypeError: if it is not a sweep; ValueError: if it has no such run, or its blocks are not those of its runs.
    """
    if not isinstance(sweep, xr.Dataset) or "point" not in sweep.sizes:
        allowed = "a Dataset that run_sweep returned, or of results/data"
        raise TypeError(f"sweep: {short_repr(sweep)}; allowed: {allowed}")
    check_number("index", index, whole=True, at_least=0, at_most=sweep.sizes["point"] - 1)
    values: dict[Hashable, np.ndarray] = {name: variable.values for name, variable in sweep.variables.items()}
    names: dict[tuple, list] = {}
    for name, variable in sweep.variables.items():
        names.setdefault(variable.dims, []).append(name)
    fields: dict[Hashable, Any] = {}
    coordinates: dict[Hashable, Any] = {}
    if "row_size" in values:
        names["point",].remove("row_size")
        size = values["row_size"]
        if "x" not in values or np.any(size < 0) or np.sum(size) != values["x"].size:
            allowed = "numbers of blocks whose sum is the length of x"
            raise ValueError(f"row_size: {short_repr(size.tolist())}; allowed: {allowed}")
        end = int(np.sum(size[: index + 1]))
        fields = {name: ("x", values[name][end - int(size[index]) : end]) for name in names["block",]}
        coordinates["x"] = fields.pop("x")
    if "sample_time" in values:
        axes = ("sample_time", "sample_position")
        coordinates |= {name: (name, values[name][index]) for name in axes}
        fields |= {name: (axes, values[name][index]) for name in ("sample_slip", "sample_velocity")}
    # All at once: each variable that is added to a Dataset is aligned with those that are there.
    out = xr.Dataset(fields, xr.Coordinates(coordinates, None if indexes else {}))
    out.attrs = {name: values[name][index].item() for name in names["point",]}
    out.attrs |= {name: value for name, value in sweep.attrs.items() if name == "versions"}
    return out
