"""The published space-time figure: what the exact solution, and a lattice, have of each of its readings.

The figure was drawn from a lattice. A trial is the exact solution of the continuum limit; what a finite spacing adds
to each reading is taken from a lattice run of the same trial (`studies.published_figure`). The largest velocity needs
that most: it is the largest value over all blocks, still grows when the figure ends, and falls with the spacing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

import numpy as np
import xarray as xr

from ..measure.fronts import front_speed, position_at
from ..theory.rupture import Rupture

# A lattice's front is a straight line over this last fraction of its path; the exact one is beyond the Gaussian.
WINDOW = 0.3
# Positions of the trailing edge and of the last profile of slip velocity.
EDGE, PROFILE = 241, 401
TRAILING = "trailing_edge_"


def exact_values(rupture: Rupture, quantities: Iterable[str]) -> np.ndarray:
    """Readings of an exact rupture, symmetric and under a displacement boundary, that ends where the figure does.

    Parameters
    ----------
    rupture : its duration is where the figure ends
    quantities : names as in a measured table

    Raises
    ------
    ValueError
        Naming a quantity that is not predicted here.

    Source: `Rupture`.
    """
    end = rupture.front_ends[-1][1]
    before = (1.0 - WINDOW) * end.x
    speed = (end.x - before) / (end.time - float(rupture.release_time(before)))
    x = np.linspace(0.0, end.x, EDGE)
    stick = rupture.stick_time(x)
    edge = stick[np.isfinite(stick)], x[np.isfinite(stick)]
    at_end = rupture.slip_velocity(np.linspace(0.0, end.x, PROFILE), rupture.duration)
    known = {
        "front_speed_right": speed,
        "front_intercept_right": end.x - speed * end.time,
        "first_stick_time": rupture.transition_time,
        "largest_velocity": max(rupture.largest_velocity, float(np.max(at_end))),
    }
    return _chosen(quantities, known, lambda time: float(np.interp(time, *edge)))


def lattice_values(run: xr.Dataset, quantities: Iterable[str]) -> np.ndarray:
    """The same of a lattice run whose samples are its blocks."""
    speed, intercept, _ = front_speed(run, WINDOW)
    known = {
        "front_speed_right": speed,
        "front_intercept_right": intercept,
        "first_stick_time": run.attrs["first_stick_time"],
        "largest_velocity": float(run["sample_velocity"].max()),
    }
    return _chosen(quantities, known, lambda time: float(position_at(run, time, edge="stick_time")))


def _chosen(
    quantities: Iterable[str], known: Mapping[str, float], trailing_edge: Callable[[float], float]
) -> np.ndarray:
    out = []
    for name in quantities:
        if name.startswith(TRAILING):
            out.append(trailing_edge(float(name.removeprefix(TRAILING))))
        elif name in known:
            out.append(known[name])
        else:
            raise ValueError(f"quantity: {name!r}; allowed: {', '.join(known)}, {TRAILING}TIME")
    return np.array(out)
