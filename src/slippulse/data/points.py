"""A sweep as one Dataset: its runs put together, and one of them taken out again. Loads no compiler."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import Any

import numpy as np
import xarray as xr

from ..model.checks import check_number, short_repr
from .variables import VARIABLES

FRONTS = ("release_time", "stick_time")
FIELDS = ("slip", "slip_velocity", "slip_acceleration")
# What every data file says of itself.
FILE = {
    "Conventions": "CF-1.11",
    "title": "Ruptures of the minimal model for the onset of slip pulses",
    "source": "slippulse, simulations",
    "references": "https://doi.org/10.1103/PhysRevE.103.052802",
}


def point(sweep: xr.Dataset, index: int) -> xr.Dataset:
    """One run of a sweep as `simulate` returned it, as far as it was recorded.

    Parameters
    ----------
    sweep : data of a sweep, such as ``xarray.open_dataset("results/data/arrest.nc")``
    index : number of the run, from 0

    Raises
    ------
    TypeError
        If it is not a sweep.
    ValueError
        If it has no such run, or its blocks are not those of its runs.
    """
    if not isinstance(sweep, xr.Dataset) or "point" not in sweep.sizes:
        raise TypeError(
            f"sweep: {short_repr(sweep)}; allowed: a Dataset that run_sweep returned, or of results/data"
        )
    check_number("index", index, whole=True, at_least=0, at_most=sweep.sizes["point"] - 1)
    values: dict[Hashable, np.ndarray] = {name: variable.values for name, variable in sweep.variables.items()}
    scalars = [
        name
        for name, variable in sweep.variables.items()
        if variable.dims == ("point",) and name != "row_size"
    ]
    fields: dict[Hashable, Any] = {}
    coordinates: dict[Hashable, Any] = {}
    if "row_size" in values:
        size = values["row_size"]
        if "x" not in values or np.any(size < 0) or np.sum(size) != values["x"].size:
            raise ValueError(
                f"row_size: {short_repr(size.tolist())}; allowed: numbers of blocks whose sum is the length of x"
            )
        end = int(np.sum(values["row_size"][: index + 1]))
        rows = slice(end - int(values["row_size"][index]), end)
        names = [name for name in ("x", "prestress", *FRONTS, *FIELDS) if name in values]
        fields = {name: ("x", values[name][rows]) for name in names}
        coordinates["x"] = fields.pop("x")
    if "sample_time" in values:
        axes = ("sample_time", "sample_position")
        coordinates |= {name: (name, values[name][index]) for name in axes}
        fields |= {name: (axes, values[name][index]) for name in ("sample_slip", "sample_velocity")}
    # All at once: each variable that is added to a Dataset is aligned with those that are there.
    out = xr.Dataset(fields, coordinates)
    of_the_file = (*FILE, "featureType", "configuration")
    of_the_run = {name: value for name, value in sweep.attrs.items() if name not in of_the_file}
    out.attrs = {name: values[name][index].item() for name in scalars} | of_the_run
    return out


def combine(results: Sequence[xr.Dataset], record: Sequence[str]) -> xr.Dataset:
    """Put the runs of a sweep into one Dataset."""
    first = results[0]
    per_point = {
        name: ("point", np.array([result.attrs[name] for result in results]))
        for name in first.attrs
        if name != "versions"
    }
    out = xr.Dataset(per_point)
    kept = (
        "x",
        "prestress",
        *(FRONTS if "fronts" in record else ()),
        *(FIELDS if "fields" in record else ()),
    )
    if len(kept) > 2:
        out["row_size"] = ("point", np.array([result.sizes["x"] for result in results]))
        for name in kept:
            out[name] = ("block", np.concatenate([result.variables[name].values for result in results]))
    if "samples" in record:
        out["sample_time"] = (
            ("point", "time"),
            np.stack([result.variables["sample_time"].values for result in results]),
        )
        out["sample_position"] = (
            ("point", "position"),
            np.stack([result.variables["sample_position"].values for result in results]),
        )
        for name in ("sample_slip", "sample_velocity"):
            out[name] = (
                ("point", "time", "position"),
                np.stack([result.variables[name].values for result in results]),
            )
    for name, variable in out.variables.items():
        variable.attrs = {"units": "1", "long_name": VARIABLES[str(name)][1]}
    out.attrs = FILE | {"versions": first.attrs["versions"]}
    if "row_size" in out:
        # CF's contiguous ragged array: the profiles of the runs over x, one after the other.
        out["row_size"].attrs["sample_dimension"] = "block"
        out.attrs["featureType"] = "profile"
    return out
