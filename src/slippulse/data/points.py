"""A sweep as one Dataset: its runs put together, and one of them taken out again. Loads no compiler."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

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
    """
    out = xr.Dataset()
    scalars = [
        name
        for name, variable in sweep.variables.items()
        if variable.dims == ("point",) and name != "row_size"
    ]
    if "row_size" in sweep:
        ends = np.cumsum(sweep.variables["row_size"].values)
        rows = slice(int(ends[index] - sweep.variables["row_size"].values[index]), int(ends[index]))
        for name in ("x", "prestress", *FRONTS, *FIELDS):
            if name in sweep:
                out[name] = ("x", sweep.variables[name].values[rows])
        out = out.set_coords("x")
    if "sample_time" in sweep:
        out = out.assign_coords(
            sample_time=("sample_time", sweep.variables["sample_time"].values[index]),
            sample_position=("sample_position", sweep.variables["sample_position"].values[index]),
        )
        for name in ("sample_slip", "sample_velocity"):
            out[name] = (("sample_time", "sample_position"), sweep.variables[name].values[index])
    of_the_file = (*FILE, "featureType", "configuration")
    of_the_run = {name: value for name, value in sweep.attrs.items() if name not in of_the_file}
    out.attrs = {name: sweep.variables[name].values[index].item() for name in scalars} | of_the_run
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
            out[name] = ("block", np.concatenate([result[name].values for result in results]))
    if "samples" in record:
        out["sample_time"] = (
            ("point", "time"),
            np.stack([result["sample_time"].values for result in results]),
        )
        out["sample_position"] = (
            ("point", "position"),
            np.stack([result["sample_position"].values for result in results]),
        )
        for name in ("sample_slip", "sample_velocity"):
            out[name] = (("point", "time", "position"), np.stack([result[name].values for result in results]))
    for name in out.variables:
        out[name].attrs = {"units": "1", "long_name": VARIABLES[name][1]}
    out.attrs = FILE | {"versions": first.attrs["versions"]}
    if "row_size" in out:
        # CF's contiguous ragged array: the profiles of the runs over x, one after the other.
        out["row_size"].attrs["sample_dimension"] = "block"
        out.attrs["featureType"] = "profile"
    return out
