"""Times and positions of the samples of a simulation."""

from dataclasses import dataclass

import numpy as np

from .checks import as_numbers

# Groups that a sweep may keep: release and stick times, fields at the end, samples on the way.
RECORDS = ("fronts", "fields", "samples")


@dataclass(frozen=True, eq=False)
class Samples:
    """Times and positions at which slip and slip velocity are recorded; it keeps copies of them.

    Parameters
    ----------
    times : array of shape (T,), units of H / wave speed
        Increasing, from 0 or later to the duration of the scene at most.
    positions : array of shape (P,), units of H
        On the lattice the nearest block is recorded; beyond its ends slip is 0.

    Raises
    ------
    ValueError
        If an array is not one-dimensional or has other numbers than these.

    Examples
    --------
    >>> import numpy as np
    >>> samples = sp.Samples(times=np.linspace(0.0, 10.0, 101), positions=[0.0, 5.0])
    """

    times: np.ndarray
    positions: np.ndarray

    def __post_init__(self) -> None:
        for name in ("times", "positions"):
            kept = as_numbers(f"samples.{name}", getattr(self, name)).copy()
            kept.setflags(write=False)
            object.__setattr__(self, name, kept)
        if self.times.ndim != 1 or self.positions.ndim != 1:
            raise ValueError("samples: times and positions; allowed: one-dimensional arrays")
        if np.any(np.diff(self.times) < 0.0) or np.any(self.times < 0.0):
            allowed = "increasing times >= 0"
            raise ValueError(f"samples.times: not increasing or negative; allowed: {allowed}")
