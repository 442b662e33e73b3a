"""A crack under a stress boundary, in closed form, whose left front meets negative pre-stress.

Without leaf springs the velocity behind the fronts is a sum of two waves. The left front is slowed
by the negative pre-stress and approaches the position x_minus, but never arrives there.
"""

from functools import partial

import numpy as np

from ..model.balance import integral, prestress_balance_position
from ..model.checks import check_number
from ..model.prestress import Prestress
from ..model.removed import ExplainsRemovedNames
from ..model.roots import root_between
from .two_fronts import ExactTransition, fast_fronts

# Beyond this number of widths from its centre, a Gaussian is 0 to rounding.
GAUSSIAN_END_IN_WIDTHS = 48.0
# Number of characteristics in each of the three sections of the far pulse.
SAMPLES_PER_SECTION = 400


class ArrestingCrack(ExplainsRemovedNames):
    """A crack without leaf springs, whose left front slows down for ever.

    du/dt - du/dx grows by tau along x - t = const and du/dt + du/dx by tau along x + t = const,
    both from 0 on a front that outruns the waves. Where tau < 0, the left front is slower than the
    waves, and slip, slip velocity and strain vanish on it, because there is no fracture energy. So
    a characteristic that entered the rupture at e ends on the left front at X with

        Int_X^e tau dx = 0,   t = e + T(e) - X,

    and X -> x_minus only as e -> infinity: the left front never arrives, and the arrest time is
    infinite. Source: equation (11) and section III C of the paper for x_minus; the rest follows.
    Raises ValueError: if an argument, here or of a method, is outside of its range.

    Parameters
    ----------
    prestress : Prestress, tau(0) = 1, level 0 far to the right and negative far to the left
    damping_ratio, release : beta/dx, from 0 to 1e6; "total" or "elastic"

    Examples
    --------
    >>> crack = ArrestingCrack(Prestress(-0.75, 0.0, width=5.0))
    >>> crack.transition(0.9).time > abs(crack.balance_position)
    True
    """

    def __init__(
        self, prestress: Prestress, damping_ratio: float = 0.0, release: str = "total"
    ) -> None:
        self.balance_position = prestress_balance_position(prestress)
        self.prestress = prestress
        # Beyond this position the profile is 0 to rounding, and the right front runs at the wave
        # speed.
        width = prestress.width or 0.0
        self.end = max([GAUSSIAN_END_IN_WIDTHS * width, *(x for x, _ in prestress.points)])
        self.fronts = fast_fronts(
            prestress, damping_ratio=damping_ratio, release=release, reach=self.end
        )
        # The left end of the two fast fronts, where tau falls to 0.
        self.zero = float(self.fronts.edges[0])

    def _entry_of(self, position: float) -> float:
        """Return the entry of the characteristic that ends on the left front at a position.

        The integral of tau from the position to the entry is 0.
        """
        integral_to = partial(integral, self.prestress, position)
        # The entry lies on the two fast fronts, whose curve ends at self.end.
        last = self.end - 1e-9
        if integral_to(last) <= 0.0:
            limit = f"x_minus = {self.balance_position:.10g}, the limit of the left front"
            raise ValueError(f"position: {position!r}; allowed: a position farther from {limit}")
        return root_between(integral_to, self.zero, last, xtol=1e-13)

    def time_at(self, position: float) -> float:
        """Return the time at which the left front reaches a position.

        Parameters
        ----------
        position : float, in (x_minus, 0]

        Returns
        -------
        float
        """
        check_number("position", position, above=self.balance_position, at_most=0.0)
        if position >= self.zero:
            return float(self.fronts.arrival(position))
        entry = self._entry_of(position)
        # The formula for t in the docstring of the class.
        return entry + float(self.fronts.arrival(entry)) - position

    def transition(self, fraction: float) -> ExactTransition:
        """Return time and length when the left front has covered a fraction of ``|x_minus|``.

        Parameters
        ----------
        fraction : float, in (0, 1)

        Returns
        -------
        ExactTransition
        """
        check_number("fraction", fraction, above=0.0, below=1.0)
        left = fraction * self.balance_position
        time = self.time_at(left)
        # The front to the right of x = 0 at this time, or the end of its curve if that is passed.
        right = self.fronts.front_at(time, x=0.0, side=1.0)
        # From the end of its curve on, the right front runs at the wave speed, 1.
        end_time = float(self.fronts.edge_times[-1])
        if time > end_time:
            right = right + time - end_time
        return ExactTransition(time, right - left)

    @property
    def peak_velocity(self) -> float:
        """Largest slip velocity far away: half the integral of tau right of its zero."""
        return 0.5 * integral(self.prestress, self.zero, self.end)

    def far_pulse(self) -> tuple[np.ndarray, np.ndarray]:
        """Return x - t and du/dt on characteristics of the pulse that runs far to the right.

        Returns
        -------
        tuple of arrays : x - t of the characteristics, and du/dt on them
        """
        # Characteristics that enter on the right front, and on the fast part of the left front. On
        # them x - t is the value at the entry, e - T(e).
        on_right = np.linspace(0.5 * self.end, 0.0, SAMPLES_PER_SECTION)
        on_left = np.linspace(0.0, self.zero, SAMPLES_PER_SECTION)
        on_fast = np.concatenate([on_right, on_left[1:]])
        fast_phase = on_fast - self.fronts.arrival(on_fast)
        # Those that start on the slow part of the left front, at (X, t) with t = e + T(e) - X. The
        # samples are denser towards x_minus, which is never reached.
        fraction = 1.0 - np.geomspace(1.0, 1e-9, SAMPLES_PER_SECTION)[1:]
        on_slow = self.zero + (self.balance_position - self.zero) * fraction
        entries = np.array([self._entry_of(x) for x in on_slow])
        slow_phase = 2.0 * on_slow - entries - self.fronts.arrival(entries)
        # Beyond the end of the profile du/dt + du/dx is 0, and du/dt - du/dx is the integral of tau
        # from the position where its characteristic began.
        positions = np.concatenate([on_fast, on_slow])
        velocity = [0.5 * integral(self.prestress, x, self.end) for x in positions]
        return np.concatenate([fast_phase, slow_phase]), np.array(velocity)
