"""The runs of a sweep as one Dataset."""

from collections.abc import Sequence
from functools import cache
from importlib.metadata import version

import numpy as np
import xarray as xr

from .points import DIMENSIONS, Recorded, runs_in

PACKAGES = ("slippulse", "numpy", "numba", "scipy", "xarray", "h5netcdf")
FRONTS = ("release_time", "stick_time")
FIELDS = ("slip", "slip_velocity", "slip_acceleration")
FILE = {
    "Conventions": "CF-1.11",
    "title": "Ruptures of the minimal model for the onset of slip pulses",
    "source": "slippulse, simulations",
    "references": "https://doi.org/10.1103/PhysRevE.103.052802",
}


@cache
def versions() -> str:
    """Names and versions of packages, the same on every machine with the same lock."""
    return ", ".join(f"{package} {version(package)}" for package in PACKAGES)


def labelled(data: xr.Dataset, labels: Sequence[dict], record: Sequence[str]) -> xr.Dataset:
    """Return a sweep with additional numbers of each run; the same if there are none."""
    if not labels:
        return data
    runs = [*runs_in(data)]
    for run, label in zip(runs, labels, strict=True):
        run.attrs |= label
    return combine(runs, record)


def combine(runs: Sequence[Recorded], record: Sequence[str]) -> xr.Dataset:
    """Put the runs of a sweep into one Dataset, with what is to be recorded of each."""
    attributes = FILE | {"versions": runs[0].attrs["versions"]}
    variables: dict[str, tuple] = {}
    for name in filter("versions".__ne__, runs[0].attrs):
        variables[name] = "point", np.array([run.attrs[name] for run in runs])
    fields = [*FRONTS] if "fronts" in record else []
    fields += FIELDS if "fields" in record else []
    if fields:
        # Profiles over x, one run after the other: CF's contiguous ragged array.
        attributes["featureType"] = "profile"
        sizes = np.array([run["x"].size for run in runs])
        variables["row_size"] = "point", sizes, {"sample_dimension": "block"}
        for name in ("x", "prestress", *fields):
            variables[name] = "block", np.concatenate([run[name] for run in runs])
    for name in DIMENSIONS if "samples" in record else ():
        axes = [dimension.removeprefix("sample_") for dimension in DIMENSIONS[name]]
        variables[name] = ("point", *axes), np.stack([run[name] for run in runs])
    # A variable that is added to a Dataset is aligned with those that are there: all go in at once.
    return xr.Dataset(variables, attrs=attributes)
