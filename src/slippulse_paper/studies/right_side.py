"""Measure the right side of a rupture on a lattice: the sliding part and the slip behind it."""

from typing import NamedTuple

import numpy as np
import xarray as xr

# Regimes of ruptures under other friction laws.
STICKING = "sticking pulse"
CREEPING = "creeping pulse"
CRACK = "crack"


class SlidingPart(NamedTuple):
    """Positions of the outermost block that has stuck and of the outermost released block.

    The blocks between them slide. A position is 0 if there is no such block.
    """

    trailing_edge: float
    front: float

    @property
    def width(self) -> float:
        """Distance between the trailing edge and the front."""
        return self.front - self.trailing_edge


class PulseSize(NamedTuple):
    """The width of the sliding part, and the slip at its trailing edge."""

    width: float
    slip: float


def right_of_centre(run: xr.Dataset) -> xr.Dataset:
    """Return the blocks of a run on the right of the middle one."""
    return run.isel(x=run["x"].values > 0.5 * run.attrs["dx"])


def sliding_part(right: xr.Dataset, time: float) -> SlidingPart:
    """Return the part of the right side that slides at a time."""
    x = right["x"].values
    stuck = x[right["stick_time"].values <= time]
    released = x[right["release_time"].values <= time]
    return SlidingPart(stuck.max(initial=0.0), released.max(initial=0.0))


def pulse_at(right: xr.Dataset, time: float) -> PulseSize:
    """Return the width of the sliding part at a time, and the slip behind it."""
    part = sliding_part(right, time)
    nearest_block = np.argmin(np.abs(right["x"].values - part.trailing_edge))
    return PulseSize(part.width, float(right["slip"].values[nearest_block]))
