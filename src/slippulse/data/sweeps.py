"""The runs of a sweep as one Dataset."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

FRONTS = ("release_time", "stick_time")
FIELDS = ("slip", "slip_velocity", "slip_acceleration")
# What every data file says of itself.
FILE = {
    "Conventions": "CF-1.11",
    "title": "Ruptures of the minimal model for the onset of slip pulses",
    "source": "slippulse, simulations",
    "references": "https://doi.org/10.1103/PhysRevE.103.052802",
}


def combine(results: Sequence[xr.Dataset], record: Sequence[str]) -> xr.Dataset:
    """Put the runs of a sweep into one Dataset."""

    def of_all(name: str) -> list[np.ndarray]:
        return [result.variables[name].values for result in results]

    versions = {"versions": results[0].attrs["versions"]}
    names = [name for name in results[0].attrs if name not in versions]
    out = xr.Dataset({name: ("point", np.array([run.attrs[name] for run in results])) for name in names})
    kept = (*(FRONTS if "fronts" in record else ()), *(FIELDS if "fields" in record else ()))
    if kept:
        out["row_size"] = ("point", np.array([result.sizes["x"] for result in results]))
        for name in ("x", "prestress", *kept):
            out[name] = ("block", np.concatenate(of_all(name)))
    if "samples" in record:
        axes = {"sample_time": ("time",), "sample_position": ("position",)}
        for name in (*axes, "sample_slip", "sample_velocity"):
            out[name] = (("point", *axes.get(name, ("time", "position"))), np.stack(of_all(name)))
    out.attrs = FILE | versions
    if kept:
        # CF's contiguous ragged array: the profiles of the runs over x, one after the other.
        out["row_size"].attrs["sample_dimension"] = "block"
        out.attrs["featureType"] = "profile"
    return out
