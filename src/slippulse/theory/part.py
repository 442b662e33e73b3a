"""A connected part of a rupture behind one curve: fields where it slides, and stick times.

`PartWithEdge` (module `trailing_edge`) adds the trailing edge to it, and `SolvedPart` the fields
where the part has stuck.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .curve import Curve
from .riemann import DependenceDomains, StaticSolution, kernel_rate
from .stick_search import QUIET_VELOCITY, StickSearch

# Time step of the search for sticks, in units of `Part.scale`.
SEARCH_STEP = 0.2
# `Part.scale` without leaf springs and drag, as a fraction of the duration. The results do not
# depend on it. As a fraction of the duration it keeps the number of search steps constant.
SCALE_WITHOUT_SPRINGS = 5.0 / 64.0


@dataclass
class Part:
    """A connected part of a rupture, behind the curve of its fronts, up to the time ``until``.

    marks are positions where the motion of a front changes suddenly. The waves from there change
    du/dt within less than a search step. refinement divides the search step. With one_side the part
    is symmetric, and only x >= 0 is computed. alpha is the coefficient of the drag -alpha du/dt.
    """

    curve: Curve
    gamma: float
    until: float
    marks: Sequence[float] | np.ndarray = ()
    refinement: int = 1
    one_side: bool = False
    alpha: float = 0.0

    @property
    def scale(self) -> float:
        """Time over which du/dt changes: about 1/sqrt(gamma).

        Without leaf springs and drag there is no such time. Then it is a fraction of the duration.
        """
        rate = kernel_rate(self.gamma, self.alpha)
        return 1.0 / rate if rate > 0.0 else SCALE_WITHOUT_SPRINGS * self.until

    @cached_property
    def static_solution(self) -> StaticSolution:
        """A static slip under the pre-stress, which the formulas for slip and strain contain."""
        return StaticSolution(self.curve, self.gamma)

    def domains(self, x: np.ndarray, time: np.ndarray) -> DependenceDomains:
        """Return the domains of dependence of points (x, time) that slide.

        This object computes the fields at the points, as integrals over the past of each point.
        """
        return DependenceDomains(
            curve=self.curve, gamma=self.gamma, alpha=self.alpha, y=x, time=time
        )

    def velocity(self, x: np.ndarray, time: np.ndarray) -> np.ndarray:
        """Return du/dt at points (x, time) that slide."""
        return self.domains(x, time).slip_velocity() if x.size else np.zeros(0)

    def field(self, name: str, x: np.ndarray, time: np.ndarray) -> np.ndarray:
        """Return "slip_velocity", "slip" or "strain" at points (x, time) that slide."""
        domains = self.domains(x, time)
        if name == "slip_velocity":
            return domains.slip_velocity()
        if name == "slip":
            return domains.slip(self.static_solution)
        return domains.strain(self.static_solution)

    def find_stick_times(self, x: np.ndarray, until: float | None = None) -> np.ndarray:
        """Return the stick times of positions; NaN if a position does not stick.

        Each position is searched independently of the others, from its release on, up to the time
        ``until`` (by default that of the part).
        """
        if not x.size:
            return np.zeros(0)
        # The times at which waves from the marks, where the motion of a front changes suddenly,
        # arrive at the positions. The axes are [position, mark].
        marks = np.array(self.marks)
        arrivals = self.curve.arrival(marks) + np.abs(x[:, None] - marks)
        step = SEARCH_STEP * self.scale / self.refinement
        end = self.until if until is None else until
        # Without leaf springs, blocks can come to rest because all waves have passed. Their du/dt
        # then stays 0, and rounding errors must not decide whether they stick.
        rounding_error = QUIET_VELOCITY if self.gamma == 0.0 else 0.0
        search = StickSearch(self.velocity, step, end, rounding_error)
        return search.find_stick_times(x, self.curve.arrival(x), arrivals)
