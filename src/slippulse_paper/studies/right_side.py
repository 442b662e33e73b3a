"""Measure the right side of a rupture on a lattice: the sliding part and the slip behind it."""

import numpy as np
import xarray as xr

# Regimes of ruptures under other friction laws.
STICKING, CREEPING, CRACK = "sticking pulse", "creeping pulse", "crack"


def right_of_centre(run: xr.Dataset) -> xr.Dataset:
    """Return the blocks of a run on the right of the middle one."""
    return run.isel(x=run["x"].values > 0.5 * run.attrs["dx"])


def sliding_part(right: xr.Dataset, time: float) -> tuple[float, float]:
    """Return the outermost stuck block and the outermost released block at a time."""
    x = right["x"].values
    stuck = x[right["stick_time"].values <= time].max(initial=0.0)
    return stuck, x[right["release_time"].values <= time].max(initial=0.0)


def pulse_at(right: xr.Dataset, time: float) -> tuple[float, float]:
    """Return the width of the sliding part at a time, and the slip behind it."""
    stuck, front = sliding_part(right, time)
    return front - stuck, float(right["slip"].values[np.argmin(np.abs(right["x"].values - stuck))])
