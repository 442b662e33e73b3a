"""Times and positions at which a simulation is sampled."""

from dataclasses import dataclass

import numpy as np

from .checks import as_numbers

# Groups of results that a sweep may record. "fronts" are release and stick times, "fields" are slip
# and its time derivatives at the end, and "samples" are slip and slip velocity during the run.
RECORD_GROUPS = ("fronts", "fields", "samples")


@dataclass(frozen=True, eq=False)
class Samples:
    """Times and positions at which slip and slip velocity are recorded.

    The arrays are copied and cannot be changed afterwards.

    Parameters
    ----------
    times : array of shape (T,), units of H / wave speed
        Increasing times between 0 and the duration of the scene.
    positions : array of shape (P,), units of H
        A lattice records the nearest block. Beyond its ends slip is 0.

    Raises
    ------
    ValueError
        If an array is not one-dimensional, or its numbers are not as described above.

    Examples
    --------
    >>> import numpy as np
    >>> samples = sp.Samples(times=np.linspace(0.0, 10.0, 101), positions=[0.0, 5.0])
    """

    times: np.ndarray
    positions: np.ndarray

    def __post_init__(self) -> None:
        # Copies are made, so that a later change of the caller's arrays has no effect.
        for name in ("times", "positions"):
            copy = as_numbers(f"samples.{name}", getattr(self, name)).copy()
            copy.setflags(write=False)
            object.__setattr__(self, name, copy)
        if self.times.ndim != 1 or self.positions.ndim != 1:
            raise ValueError(
                "samples: times or positions are not one-dimensional; allowed: 1-d arrays"
            )
        if np.any(np.diff(self.times) < 0.0) or np.any(self.times < 0.0):
            allowed = "increasing times >= 0"
            raise ValueError(f"samples.times: decreasing or negative; allowed: {allowed}")
