"""A crack under a stress boundary, in closed form, whose left front meets negative pre-stress.

Without leaf springs the velocity behind the fronts is a sum of two waves. The left front is slowed
by the negative pre-stress and approaches the position x_minus, but never arrives there.
"""

from functools import partial
from itertools import pairwise

import numpy as np

from ..model.balance import integral, prestress_balance_position
from ..model.checks import check_number
from ..model.prestress import Prestress
from ..model.removed import ExplainsRemovedNames
from ..model.roots import root_between
from .prestress_pieces import split_into_pieces
from .two_fronts import ExactTransition, fast_fronts

# At this number of widths from its centre, a Gaussian is smaller than any positive number.
GAUSSIAN_END_IN_WIDTHS = 48.0
# At this number of widths, the integral of the rest of a Gaussian is below 1e-120.
NEGLIGIBLE_REST_IN_WIDTHS = 24.0
# The fronts have three sections: the right front, and the fast and the slow part of the left front.
# The far pulse is computed on this number of characteristics from each section.
SAMPLES_PER_SECTION = 400


class ArrestingCrack(ExplainsRemovedNames):
    """A crack without leaf springs, whose left front slows down for ever.

    The front arrives at x at the time T(x), and du/dt = du/dx = 0 on it. Behind it, the sum
    du/dt + du/dx changes by the integral of tau along each characteristic x + t = const, which runs
    to the left. Where tau < 0, the left front is slower than the waves, and such characteristics
    arrive at it. So one that enters the rupture at x = e ends on the left front, at x = X, with

        Int_X^e tau dx = 0,   t = e + T(e) - X.

    X tends to x_minus only as e -> infinity: the left front never arrives there, and the arrest
    time is infinite. Source: equation (11) and section III C of the paper for x_minus; the rest
    follows from it.
    Raises ValueError: if an argument, here or of a method, is outside of its range.

    Parameters
    ----------
    prestress : Prestress, tau(0) = 1, negative on the left of some position and nowhere else, and 0
        far to the right
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
        # If tau changed its sign again, the right front would be slowed by negative pre-stress, or
        # the left front would become fast again in positive pre-stress.
        pieces = [piece for piece in split_into_pieces(prestress) if piece.left < piece.right]
        sign_changes = sum(piece.is_above != after.is_above for piece, after in pairwise(pieces))
        if sign_changes != 1:
            allowed = "profiles that change their sign once, from negative on the left"
            raise ValueError(
                f"prestress: changes its sign {sign_changes} times; allowed: {allowed}"
            )
        self.prestress = prestress
        # Beyond this position the pre-stress is 0, and the right front runs at the wave speed.
        self.end = _right_end(prestress, GAUSSIAN_END_IN_WIDTHS)
        # The right front up to there, and the left front as far as it is faster than the waves.
        self.fronts = fast_fronts(
            prestress, damping_ratio=damping_ratio, release=release, reach=self.end
        )
        # The left front becomes slow where its fast section ends, because tau falls to 0 there.
        left_end_of_fast_fronts = self.fronts.edges[0]
        self.slow_start = float(left_end_of_fast_fronts)

    def _entry_of(self, position: float) -> float:
        """Return where the wave that meets the left front at a position has entered the rupture.

        The wave runs to the left. So it entered farther right, through one of the fast fronts,
        which are known from slow_start to end. The integral of tau between the two positions is 0.
        """
        integral_from_position_to = partial(integral, self.prestress, position)
        # The search stays a little inside of the right end of the fast fronts. At its left end, the
        # integral is negative, because tau < 0 between the position and slow_start.
        last_entry = self.end - 1e-9
        if integral_from_position_to(last_entry) <= 0.0:
            limit = f"x_minus = {self.balance_position:.10g}, which the left front approaches"
            raise ValueError(f"position: {position!r}; allowed: a position farther from {limit}")
        return root_between(integral_from_position_to, self.slow_start, last_entry, xtol=1e-13)

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
        if position >= self.slow_start:
            return float(self.fronts.arrival(position))
        # A wave enters the rupture when the fast front arrives at the entry. From there it runs
        # left to the position, at the wave speed 1.
        entry = self._entry_of(position)
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
        left_front = fraction * self.balance_position
        time = self.time_at(left_front)
        # The curve of the right front ends where the pre-stress ends. `front_at` returns this end
        # for any later time.
        right_front = self.fronts.front_at(time, x=0.0, side=1.0)
        # The last edge of a panel is the end of the curve on the right.
        time_at_end = float(self.fronts.edge_times[-1])
        if time > time_at_end:
            # From there on the right front runs at the wave speed 1.
            right_front = right_front + time - time_at_end
        return ExactTransition(time, right_front - left_front)

    @property
    def peak_velocity(self) -> float:
        """Largest slip velocity of the pulse that runs to the right, far from the nucleation.

        This velocity is half the integral of the positive pre-stress.
        """
        return 0.5 * integral(self.prestress, self.slow_start, self.end)

    def far_pulse(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the pulse that runs to the right, far from the nucleation.

        Far away the pulse is a wave that keeps its shape: du/dt depends on x - t alone.

        Returns
        -------
        tuple of arrays : values of x - t, from the front to the rear, and du/dt there
        """
        # The pulse consists of waves that run to the right. Each of them starts on a front when the
        # front arrives, and x - t does not change on it.
        first_start = _right_end(self.prestress, NEGLIGIBLE_REST_IN_WIDTHS)
        on_right_front = np.linspace(first_start, 0.0, SAMPLES_PER_SECTION)
        on_fast_left_front = np.linspace(0.0, self.slow_start, SAMPLES_PER_SECTION)
        on_fast_fronts = np.concatenate([on_right_front, on_fast_left_front[1:]])
        x_minus_t_of_fast = on_fast_fronts - self.fronts.arrival(on_fast_fronts)
        # On the slow section of the left front the samples are denser towards x_minus, which the
        # front never reaches.
        fraction = 1.0 - np.geomspace(1.0, 1e-9, SAMPLES_PER_SECTION)[1:]
        on_slow_front = self.slow_start + (self.balance_position - self.slow_start) * fraction
        # The slow front arrives at t = e + T(e) - x, where e is the entry of the wave that meets it
        # (see `time_at`).
        entries = np.array([self._entry_of(x) for x in on_slow_front])
        x_minus_t_of_slow = 2.0 * on_slow_front - entries - self.fronts.arrival(entries)
        # Along a wave, du/dt - du/dx grows by the integral of the pre-stress that it crosses. Far
        # away du/dt + du/dx is 0, so that du/dt is half of this integral.
        starts = np.concatenate([on_fast_fronts, on_slow_front])
        velocity = [0.5 * integral(self.prestress, x, self.end) for x in starts]
        return np.concatenate([x_minus_t_of_fast, x_minus_t_of_slow]), np.array(velocity)


def _right_end(prestress: Prestress, widths: float) -> float:
    """Return the position where all Gaussians, steps and points of a pre-stress have ended.

    A Gaussian ends at this number of widths on the right of its centre.
    """
    ends_of_gaussians = [centre + widths * width for centre, width in prestress.gaussians]
    steps_and_points = [x for x, _ in (*prestress.steps, *prestress.points)]
    return max([0.0, *ends_of_gaussians, *steps_and_points])
