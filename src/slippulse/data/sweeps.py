"""The runs of a sweep as one Dataset."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from .points import DIMENSIONS, Recorded

FRONTS = ("release_time", "stick_time")
FIELDS = ("slip", "slip_velocity", "slip_acceleration")
# What every data file says of itself.
FILE = {
    "Conventions": "CF-1.11",
    "title": "Ruptures of the minimal model for the onset of slip pulses",
    "source": "slippulse, simulations",
    "references": "https://doi.org/10.1103/PhysRevE.103.052802",
}


def combine(runs: Sequence[Recorded], record: Sequence[str]) -> xr.Dataset:
    """Put the runs of a sweep into one Dataset."""
    versions = {"versions": runs[0].attrs["versions"]}
    names = [name for name in runs[0].attrs if name not in versions]
    variables: dict = {
        name: ("point", np.array([run.attrs[name] for run in runs])) for name in names
    }
    kept = (*(FRONTS if "fronts" in record else ()), *(FIELDS if "fields" in record else ()))
    if kept:
        # CF's contiguous ragged array: the profiles of the runs over x, one after the other.
        sizes = np.array([run["x"].size for run in runs])
        variables["row_size"] = "point", sizes, {"sample_dimension": "block"}
        for name in ("x", "prestress", *kept):
            variables[name] = "block", np.concatenate([run[name] for run in runs])
    if "samples" in record:
        for name, dimensions in DIMENSIONS.items():
            axes = ("point", *(dimension.removeprefix("sample_") for dimension in dimensions))
            variables[name] = axes, np.stack([run[name] for run in runs])
    # All at once: each variable that is added to a Dataset is aligned with those that are there.
    return xr.Dataset(
        variables, attrs=FILE | versions | ({"featureType": "profile"} if kept else {})
    )
