"""What a run records on its way."""

from dataclasses import dataclass

import numpy as np

from .checks import as_numbers

# What a run may keep: release and stick times, fields at the end, samples on its way.
RECORDS = ("fronts", "fields", "samples")


@dataclass
class Samples:
    """Where and when slip and slip velocity are recorded, of the nearest block; ValueError for other arrays than these.

    times, positions : of one dimension; times increase from 0 or later to the duration of the scene at most
    """

    times: np.ndarray
    positions: np.ndarray

    def __post_init__(self) -> None:
        self.times = as_numbers("samples.times", self.times)
        self.positions = as_numbers("samples.positions", self.positions)
        if self.times.ndim != 1 or self.positions.ndim != 1:
            raise ValueError("samples: times and positions; allowed: one-dimensional arrays")
        if np.any(np.diff(self.times) < 0.0) or np.any(self.times < 0.0):
            raise ValueError(
                "samples.times: not increasing or negative; allowed: increasing times >= 0"
            )

    def check_within(self, duration: float) -> None:
        """Refuse samples after the end of a run."""
        if np.any(self.times > duration):
            allowed = f"up to the duration of the scene, {duration:g}"
            raise ValueError(f"samples.times: {self.times[-1]:g}; allowed: {allowed}")
