"""A crack under a stress boundary, in closed form: its left front meets negative pre-stress."""

from functools import partial

import numpy as np

from ..model.balance import prestress_balance_position
from ..model.checks import check_number
from ..model.prestress import Prestress
from ..model.roots import root_between
from .fronts import Fronts


class ArrestingCrack:
    """The crack whose left front slows for ever, without leaf springs.

    du/dt - du/dx grows by tau along x - t = const and du/dt + du/dx by tau along x + t = const,
    both from 0 where a front outruns the waves. Where tau < 0 the left front is slower than the
    waves and, with no fracture energy, slip, slip velocity and strain vanish there. So a
    characteristic that entered at e ends on the left front at X with

        Int_X^e tau dx = 0,   t = e + T(e) - X,

    and X -> x_minus only as e -> infinity: the left front never arrives, and the arrest time is
    infinite. Source: equation (11) and section III C of the paper for x_minus; the rest follows.
    Raises ValueError: outside these ranges; of every method, outside those that it states.

    Parameters
    ----------
    prestress : Prestress, tau(0) = 1, level 0 far to the right and negative far to the left
    damping_ratio, release : beta/dx, from 0 to 1e6; "total" or "elastic"

    Examples
    --------
    >>> crack = ArrestingCrack(Prestress(-0.75, 0.0, width=5.0))
    >>> crack.time_at_fraction(0.9) > abs(crack.balance_position)
    True
    """

    def __init__(
        self, prestress: Prestress, damping_ratio: float = 0.0, release: str = "total"
    ) -> None:
        self.balance_position = prestress_balance_position(prestress)
        self.prestress = prestress
        # Beyond this the profile is 0 to rounding and the right front runs at the wave speed.
        self.reach = 12.0 * prestress.width
        self.end = 4.0 * self.reach
        self.fronts = Fronts(prestress, damping_ratio, release, self.end)
        self.zero = -float(self.fronts.ends[-1.0])

    def _entry(self, position: float) -> float:
        """Where the characteristic that ends on the left front, from x_minus to x*, entered."""
        last, balance = self.end - 1e-9, partial(self.prestress.integral, position)
        if balance(last) <= 0.0:
            limit = f"x_minus = {self.balance_position:.10g}, for entries <= {last:g}"
            raise ValueError(f"position: {position!r}; allowed: farther from {limit}")
        return root_between(balance, self.zero, last, xtol=1e-13)

    def time_at(self, position: float) -> float:
        """Time when the left front reaches a position, in (x_minus, 0].

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
        entry = self._entry(position)
        return entry + float(self.fronts.arrival(entry)) - position

    def time_at_fraction(self, fraction: float) -> float:
        """Time when the left front has covered a fraction, in (0, 1), of |x_minus|.

        Parameters
        ----------
        fraction : float, in (0, 1)

        Returns
        -------
        float
        """
        check_number("fraction", fraction, above=0.0, below=1.0)
        return self.time_at(fraction * self.balance_position)

    def length_at_fraction(self, fraction: float) -> float:
        """Distance between the fronts at `time_at_fraction`.

        Parameters
        ----------
        fraction : float, in (0, 1)

        Returns
        -------
        float
        """
        time, curve = self.time_at_fraction(fraction), self.fronts.curve
        last, last_time = float(curve.edges[-1]), float(curve.edge_times[-1])
        right = last + time - last_time if time >= last_time else self.fronts.reached(time, 1.0)
        return right - fraction * self.balance_position

    @property
    def peak_velocity(self) -> float:
        """Largest slip velocity far away: half the integral of tau to the right of its zero x*."""
        return 0.5 * self.prestress.integral(self.zero, self.end)

    def far_pulse(self, count: int = 400) -> tuple[np.ndarray, np.ndarray]:
        """Arrays of x - t and du/dt on characteristics of the pulse that runs far to the right.

        Parameters
        ----------
        count : int, points of each third, 2 to 10000

        Returns
        -------
        tuple of arrays : x - t of the characteristics, and du/dt on them
        """
        check_number("count", count, integer=True, at_least=2, at_most=10_000)
        right, left = np.linspace(2.0 * self.reach, 0.0, count), np.linspace(0.0, self.zero, count)
        entries = np.concatenate([right, left[1:]])
        delay = entries - self.fronts.arrival(entries)
        # Denser towards x_minus, which is never reached.
        fraction = 1.0 - np.geomspace(1.0, 1e-9, count)[1:]
        slow = self.zero + (self.balance_position - self.zero) * fraction
        entered = np.array([self._entry(x) for x in slow])
        slow_delay = 2.0 * slow - entered - self.fronts.arrival(entered)
        positions = np.concatenate([entries, slow])
        velocity = [0.5 * self.prestress.integral(x, self.end) for x in positions]
        return np.concatenate([delay, slow_delay]), np.array(velocity)
