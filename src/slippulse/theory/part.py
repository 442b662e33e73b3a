"""A connected part of a rupture behind one curve: fields at points that slide, and stick times."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .curve import Curve
from .riemann import Past, Rest, kernel_rate
from .stick_search import StickSearch

# Steps of a search in time, in units of `Part.scale`.
SEARCH = 0.2
# `Part.scale` without leaf springs and drag, as a fraction of the duration: no answer owes anything
# to it, and a length of the scene would make a long search expensive.
SCALE_WITHOUT_SPRINGS = 5.0 / 64.0


@dataclass
class Part:
    """A connected part of the rupture behind a curve, until a time."""

    curve: Curve
    gamma: float
    until: float
    # Positions from which waves come that change du/dt at once, or faster than a search steps.
    marks: Sequence[float] | np.ndarray = ()
    refinement: int = 1
    # The part is symmetric: x >= 0 tells everything.
    one_side: bool = False
    alpha: float = 0.0

    @property
    def scale(self) -> float:
        """Time over which du/dt changes, for want of leaf springs a fraction of the duration."""
        rate = kernel_rate(self.gamma, self.alpha)
        return 1.0 / rate if rate > 0.0 else SCALE_WITHOUT_SPRINGS * self.until

    @cached_property
    def rest(self) -> Rest:
        """A state at rest, for slip and strain."""
        return Rest(self.curve, self.gamma)

    def past(self, x: np.ndarray, time: np.ndarray) -> Past:
        """Domains of dependence of points that slide."""
        return Past(self.curve, self.gamma, self.alpha, x, time)

    def velocity(self, x: np.ndarray, time: np.ndarray) -> np.ndarray:
        """du/dt at points that slide."""
        return self.past(x, time).slip_velocity() if x.size else np.zeros(0)

    def field(self, name: str, x: np.ndarray, time: np.ndarray) -> np.ndarray:
        """A field at points that slide."""
        past = self.past(x, time)
        return past.slip_velocity() if name == "slip_velocity" else getattr(past, name)(self.rest)

    def search(self, x: np.ndarray, until: float | None = None) -> np.ndarray:
        """Stick times at positions, from release on, without help from other positions."""
        if not x.size:
            return np.zeros(0)
        marks = np.array(self.marks)
        arrivals = self.curve.arrival(marks) + np.abs(x[:, None] - marks)
        step = SEARCH * self.scale / self.refinement
        search = StickSearch(self.velocity, step, until or self.until)
        return search.stick_time(x, self.curve.arrival(x), arrivals)
