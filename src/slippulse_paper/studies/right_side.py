"""Measure the right side of a rupture on a lattice: the sliding part and the slip behind it.

Studies of other friction laws use this module. It also names the regimes of their ruptures.
"""

from typing import NamedTuple

import numpy as np
import xarray as xr

from slippulse.measurement.regime import is_pulse

# Regimes: the blocks behind the pulse stick, they only slide ever more slowly, or no pulse forms.
STICKING = "sticking pulse"
CREEPING = "creeping pulse"
CRACK = "crack"


class SlidingPart(NamedTuple):
    """The part of the right side that slides at some time, between two positions.

    trailing_edge : position of the outermost block that has stuck, or 0 if none has
    front : position of the outermost block that has been released, or 0 if none has
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
    """Return the blocks of a run to the right of the block at x = 0."""
    return run.isel(x=run["x"].values > 0.5 * run.attrs["dx"])


def sliding_part(right: xr.Dataset, time: float) -> SlidingPart:
    """Return the part of the right side that slides at a time.

    right : the right side of a run, from `right_of_centre`
    """
    x = right["x"].values
    stuck = x[right["stick_time"].values <= time]
    released = x[right["release_time"].values <= time]
    return SlidingPart(stuck.max(initial=0.0), released.max(initial=0.0))


def pulse_at(right: xr.Dataset, time: float) -> PulseSize:
    """Return the width of the sliding part at a time, and the slip behind it.

    right : the right side of a run, from `right_of_centre`
    """
    part = sliding_part(right, time)
    nearest_block = np.argmin(np.abs(right["x"].values - part.trailing_edge))
    return PulseSize(part.width, float(right["slip"].values[nearest_block]))


def regime_without_sticks(
    centre_velocity: float, largest_velocity: float, still_fraction: float
) -> str:
    """Return the regime of a rupture in which no block sticks behind a pulse.

    The regime is a creeping pulse if the centre is nearly at rest at the end, otherwise a crack.

    still_fraction : fraction of the largest velocity below which the centre counts as at rest
    """
    return CREEPING if is_pulse(centre_velocity, largest_velocity, still_fraction) else CRACK
