"""One run out of a sweep. What measures and draws needs no more than this, and need not load the compiler."""

from __future__ import annotations

import numpy as np
import xarray as xr

FRONTS = ("release_time", "stick_time")
FIELDS = ("slip", "slip_velocity", "slip_acceleration")


def point(sweep: xr.Dataset, index: int) -> xr.Dataset:
    """One run of a sweep as `simulate` returned it, as far as it was recorded."""
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
    out.attrs = {name: sweep.variables[name].values[index].item() for name in scalars} | dict(sweep.attrs)
    return out
