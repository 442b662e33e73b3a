"""Combine the runs of a sweep into one Dataset.

Numbers of a run lie along the dimension "point". The fields of all runs follow one another along
the dimension "block" (a contiguous ragged array of the CF conventions).
"""

from collections.abc import Sequence
from functools import cache
from importlib.metadata import version

import numpy as np
import xarray as xr

from .points import SAMPLE_DIMENSIONS, Recorded, runs_in

PACKAGES = ("slippulse", "numpy", "numba", "scipy", "xarray", "h5netcdf")
# Variables that the groups "fronts" and "fields" of a recorded sweep have.
FRONT_VARIABLES = ("release_time", "stick_time")
FIELD_VARIABLES = ("slip", "slip_velocity", "slip_acceleration")
FILE_ATTRIBUTES = {
    "Conventions": "CF-1.11",
    "title": "Ruptures of the minimal model for the onset of slip pulses",
    "source": "slippulse, simulations",
    "references": "https://doi.org/10.1103/PhysRevE.103.052802",
}


@cache
def versions() -> str:
    """Return the names and versions of the packages on which results depend, as text."""
    return ", ".join(f"{package} {version(package)}" for package in PACKAGES)


def with_run_labels(data: xr.Dataset, labels: Sequence[dict], record: Sequence[str]) -> xr.Dataset:
    """Return a sweep with additional numbers (labels) for each run.

    labels : one dict of numbers by name for each run; if empty, the sweep is returned as it is
    record : the groups that the sweep has recorded, of "fronts", "fields" and "samples"
    """
    if not labels:
        return data
    runs = list(runs_in(data))
    for run, labels_of_run in zip(runs, labels, strict=True):
        run.attrs |= labels_of_run
    return combine(runs, record)


def combine(runs: Sequence[Recorded], record: Sequence[str]) -> xr.Dataset:
    """Combine the runs of a sweep into one Dataset.

    record : the groups to keep, of "fronts", "fields" and "samples"
    """
    attributes = FILE_ATTRIBUTES | {"versions": runs[0].attrs["versions"]}
    variables: dict[str, tuple] = {}
    for name in runs[0].attrs:
        if name != "versions":
            values = [run.attrs[name] for run in runs]
            # An array of fixed-width texts would need the memory of the longest text for every run.
            dtype = object if isinstance(values[0], str) else None
            variables[name] = ("point", np.array(values, dtype=dtype))
    fields: list[str] = []
    if "fronts" in record:
        fields += FRONT_VARIABLES
    if "fields" in record:
        fields += FIELD_VARIABLES
    if fields:
        # This is how the CF conventions describe a contiguous ragged array of profiles.
        attributes["featureType"] = "profile"
        variables |= _block_variables(runs, fields)
    if "samples" in record:
        variables |= _sample_variables(runs)
    # All variables are passed at once. Adding them one by one would align each with the others.
    return xr.Dataset(variables, attrs=attributes)


def _block_variables(runs: Sequence[Recorded], fields: Sequence[str]) -> dict[str, tuple]:
    """Return the fields of all runs along "block", and the number of blocks of each run."""
    sizes = np.array([run["x"].size for run in runs])
    variables: dict[str, tuple] = {"row_size": ("point", sizes, {"sample_dimension": "block"})}
    for name in ("x", "prestress", *fields):
        values = np.concatenate([run[name] for run in runs])
        variables[name] = ("block", values)
    return variables


def _sample_variables(runs: Sequence[Recorded]) -> dict[str, tuple]:
    """Return the samples of all runs, along "point" and the dimensions "time" and "position".

    In a single run, the names of these two dimensions begin with "sample_".
    """
    variables: dict[str, tuple] = {}
    for name, dimensions in SAMPLE_DIMENSIONS.items():
        axes = [dimension.removeprefix("sample_") for dimension in dimensions]
        values = np.stack([run[name] for run in runs])
        variables[name] = (("point", *axes), values)
    return variables
