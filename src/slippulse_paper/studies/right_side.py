"""The right side of a rupture on a lattice: the part that slides, and the slip behind it."""

import numpy as np
import xarray as xr

# What a rupture turns into under another friction.
STICKING, CREEPING, CRACK = "sticking pulse", "creeping pulse", "crack"


def right_of_centre(run: xr.Dataset) -> xr.Dataset:
    """Blocks of a run on the right of the middle one."""
    return run.isel(x=run["x"].values > 0.5 * run.attrs["dx"])


def sliding_part(right: xr.Dataset, time: float) -> tuple[float, float]:
    """Outermost blocks that have stuck and that have been released by a time."""
    x = right["x"].values
    stuck = x[right["stick_time"].values <= time].max(initial=0.0)
    return stuck, x[right["release_time"].values <= time].max(initial=0.0)


def pulse_at(right: xr.Dataset, time: float) -> tuple[float, float]:
    """Width of the sliding part at a time, and slip behind it."""
    stuck, front = sliding_part(right, time)
    return front - stuck, float(right["slip"].values[np.argmin(np.abs(right["x"].values - stuck))])
