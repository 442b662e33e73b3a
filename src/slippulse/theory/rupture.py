"""A whole rupture in the continuum limit, dx -> 0 at fixed beta/dx.

A front outruns the waves while tau(x) > 0: T(x) is the integral of 1/v(tau(x), beta/dx), and the
damping, beta = (beta/dx) dx -> 0, acts at the front alone (`fast_front`). Where tau < 0 the front
is a free boundary (`slow_front`). The undamped equation behind the fronts has Riemann's solution
(`riemann`), up to the trailing edge (`trailing_edge`).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from ..model.checks import as_numbers, check_choice, check_number, short_repr
from ..model.prestress import Prestress
from ..model.removed import ExplainsRemovedNames
from ..model.roots import root_between
from .curve import SAME
from .domains import broadcast_numbers, check_domains
from .fast_front import FastFront
from .solved_part import SolvedPart
from .spreading import LEFT, RIGHT, Stretch, spread
from .trailing_edge import FirstStick
from .two_fronts import ExactTransition

# The construction goes on beyond the duration, relative, so that the end is a time like any other.
BEYOND = 1e-6
# The largest exponent, alpha times the duration, with room to the end of floating point.
MOST_DECAY = 600.0
FIELDS = ("slip_velocity", "slip", "strain")
# The largest map, which takes 100 bytes a point.
MOST_POINTS = 10**7
SLOW_EDGE = "the trailing edge is slower than the waves"
FALLING_SLIP = "the slip would fall"


@dataclass(frozen=True)
class Limit:
    """A point in whose future the construction says nothing."""

    x: float
    time: float
    reason: str


class FrontEnd(Limit):
    """The last point of a front: where it stops, or at the end of the time asked for."""


class Rupture(ExplainsRemovedNames):
    """The exact rupture of a pre-stress in the continuum limit.

    Parameters
    ----------
    prestress : Prestress that reaches 1 somewhere: each such position is a nucleation point
    gamma : float, elasticity ratio, > 0; or 0 for the stress boundary
    damping_ratio, release : beta/dx, from 0 to 1e6, at which dx -> 0; "total" or "elastic"
    duration : float, time up to which the rupture is wanted, >= 1e-9
    refinement : int, from 1 to 10, of the panels, to see what the result owes to them
    rate_strengthening : float, alpha of a term -alpha du/dt, at most 600/duration; above the value
        where slip runs away

    Methods take positions x and times up to ``duration``, numbers or arrays, and return arrays of
    their shape, NaN where nothing is known: beyond `horizon`, and for what has not come until
    ``duration``.
    Raises ValueError: if a value is outside its domain, the pre-stress nowhere reaches 1, or a
    front needs more than 20000 panels; of a search for sticks, if it would take more than 3 GB (a
    minute); of every method, if a position or a time is not finite.
    Source: derived in the supplement; the lattice tends to it at first order in dx.

    Examples
    --------
    >>> rupture = Rupture(Prestress(0.25, 0.25), 0.55, 0.1)
    >>> round(rupture.transition.time, 4), round(rupture.transition.length, 4)
    (3.9312, 10.0541)
    """

    def __init__(
        self,
        prestress: Prestress,
        gamma: float,
        damping_ratio: float = 0.0,
        release: str = "total",
        duration: float = 10.0,
        refinement: int = 1,
        rate_strengthening: float = 0.0,
    ) -> None:
        check_domains(duration=duration)
        self.law = FastFront(
            prestress, gamma, damping_ratio, release, refinement, rate_strengthening
        )
        check_number("rate_strengthening", rate_strengthening, at_most=MOST_DECAY / duration)
        self.prestress = prestress
        self.gamma = self.law.gamma
        self.duration = float(duration)
        # A time up to here is the duration but for rounding.
        self._last = self.duration * (1.0 + SAME)
        until = self.duration * (1.0 + BEYOND)
        self.stretches, self._unknown = spread(self.law, until)
        self._parts = []
        for stretch in self.stretches:
            curve, law = stretch.curve(), self.law
            restarts = [*stretch.restarts[LEFT], *stretch.restarts[RIGHT]]
            ends = [stretch.ends[side].x for side in (LEFT, RIGHT)]
            marks = np.unique(
                [0.0, *law.marks, *restarts, *stretch.joins, *ends, *law.narrow_features]
            )
            marks = marks[curve.covers(marks)]
            keys = curve, self.gamma, until, marks, law.refinement, prestress.symmetric, law.alpha
            self._parts.append(SolvedPart(*keys))
        # A symmetric scene is solved at x >= 0.
        one_side = prestress.symmetric
        self._solved = [part for part in self._parts if part.curve.edges[-1] > 0.0 or not one_side]

    @property
    def front_ends(self) -> list[tuple[FrontEnd, FrontEnd]]:
        """Left and right end of each connected part: "stops" for good, or "duration"."""
        pairs = zip(self._parts, self.stretches, strict=True)
        return [(self._front_end(*pair, LEFT), self._front_end(*pair, RIGHT)) for pair in pairs]

    def _front_end(self, part: SolvedPart, stretch: Stretch, side: float) -> FrontEnd:
        (x, time), reason = stretch.ends[side], str(stretch.end_reason[side])
        if reason != "duration" and time <= self._last:
            return FrontEnd(float(x), float(min(time, self.duration)), reason)
        edges = part.curve.edges[part.curve.edge_times <= self.duration]
        x = part.curve.front_at(self.duration, edges[-1 if side > 0.0 else 0], side)
        return FrontEnd(x, self.duration, "duration")

    def release_time(self, x) -> np.ndarray:
        """T(x): when the first front reaches x.

        Parameters
        ----------
        x : float or array, positions

        Returns
        -------
        array, NaN where no front arrives until ``duration``
        """
        x = as_numbers("x", x)
        times = [part.curve.arrival(x) for part in self._parts]
        return self._until_end(x, np.fmin.reduce(times))

    def fronts_at(self, time: float, x: float = 0.0) -> tuple[float, float]:
        """Left and right front of the connected part that holds x, which must slip by then.

        Parameters
        ----------
        time, x : a time in (0, duration], and a position that has slipped by then, or ValueError

        Returns
        -------
        tuple of float, left and right
        """
        time = self._time(time)
        check_number("x", x)
        for part in self._parts:
            if part.curve.arrival(x) <= time * (1.0 + SAME):
                return part.curve.front_at(time, x, LEFT), part.curve.front_at(time, x, RIGHT)
        raise ValueError(f"x: {x!r}; allowed: positions released before {time:g}")

    def stick_time(self, x) -> np.ndarray:
        """Time at which x first sticks; it may be released again beyond the horizon.

        Parameters
        ----------
        x : float or array, positions

        Returns
        -------
        array, NaN where x does not stick until ``duration``, or beyond the horizon
        """
        x = as_numbers("x", x)
        return self._until_end(x, self._stick(x))

    def _distinct(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distinct positions (of one side, if symmetric), and the index of each x in them."""
        x = np.abs(x) if self.prestress.symmetric else x
        positions, index = np.unique(x, return_inverse=True)
        return positions, index.reshape(x.shape)

    def _stick(self, x: np.ndarray) -> np.ndarray:
        """Stick times, also a little beyond the end and beyond the horizon; NaN for none."""
        positions, index = self._distinct(x)
        times = [part.stick_time(positions) for part in self._solved]
        return np.fmin.reduce(times)[index]

    def final_slip(self, x) -> np.ndarray:
        """Slip at x after sticking, 0 where nothing has slipped.

        Parameters
        ----------
        x : float or array, positions

        Returns
        -------
        array, 0 where nothing has slipped, NaN where x has not stuck until ``duration``, and where
        the horizon comes until then
        """
        x = as_numbers("x", x)
        stick = self.stick_time(x)
        slides = np.isfinite(self.release_time(x)) & ~np.isfinite(stick)
        slip = self.slip(x, np.where(np.isfinite(stick), stick, self.duration))
        unknown = slides | self._is_beyond_horizon(x, self.duration)
        return np.where(unknown, np.nan, slip)

    @cached_property
    def first_stick(self) -> FirstStick | None:
        """Time and position of the first sticking; None for none until ``duration``."""
        first = min(filter(None, (part.first_stick() for part in self._solved)), default=None)
        # Something may have stuck elsewhere, after a limit; at a limit the edge is still known.
        last = self.limit.time * (1.0 + SAME) if self.limit else np.inf
        if not first or first.time > min(last, self._last):
            return None
        return FirstStick(min(first.time, self.duration), first.x)

    @cached_property
    def transition(self) -> ExactTransition:
        """T_trans and L_trans; NaN for none until ``duration``."""
        if not self.first_stick:
            return ExactTransition(np.nan, np.nan)
        left, right = self.fronts_at(*self.first_stick)
        return ExactTransition(self.first_stick.time, right - left)

    def pulse_width(self, time: float, side: str = "right") -> float:
        """Distance between the "right" or "left" front and the trailing edge behind it.

        Parameters
        ----------
        time, side : a time in (0, duration]; "right" or "left"

        Returns
        -------
        float, NaN before anything sticks
        """
        check_choice("side", side, ("right", "left"))
        time = self._time(time)
        if not self.first_stick or time <= self.first_stick.time * (1.0 + SAME):
            return np.nan
        x = self.first_stick.x
        front = self.fronts_at(time, x)[side == "right"]

        def late(position: float) -> float:
            stick = np.nan_to_num(self._stick(np.array(position)), nan=2.0 * self.duration)
            return float(stick) - time

        # Of several trailing edges that of the pulse is next to its front.
        knots = np.concatenate([part.knots.x for part in self._solved])
        knots = np.append(knots, -knots) if self.prestress.symmetric else knots
        inner = np.append(knots[(knots - x) * (knots - front) < 0.0], x)
        inner = inner[np.argsort(np.abs(inner - front))]
        first = int(np.argmax(self._stick(inner) <= time))
        ahead = inner[first - 1] if first else front
        trailing = front
        if late(front) > 0.0:
            trailing = root_between(late, float(inner[first]), float(ahead), xtol=1e-11)
        unknown = self._is_beyond_horizon(np.array([trailing, front]), time).any()
        return np.nan if unknown else abs(front - trailing)

    @cached_property
    def largest_velocity(self) -> float:
        """Largest slip velocity until ``duration``, where the construction holds."""
        return max(part.largest_velocity(self.duration, self.horizon) for part in self._solved)

    def slip_velocity(self, x, time) -> np.ndarray:
        """du/dt at points.

        Parameters
        ----------
        x, time : float or array, positions and times up to ``duration``, broadcast

        Returns
        -------
        array, NaN beyond the horizon
        """
        return self._points(("slip_velocity",), x, time)["slip_velocity"]

    def slip(self, x, time) -> np.ndarray:
        """u at points.

        Parameters
        ----------
        x, time : float or array, as for `slip_velocity`

        Returns
        -------
        array, NaN beyond the horizon
        """
        return self._points(("slip",), x, time)["slip"]

    def strain(self, x, time) -> np.ndarray:
        """du/dx at points.

        Parameters
        ----------
        x, time : float or array, as for `slip_velocity`

        Returns
        -------
        array, NaN beyond the horizon
        """
        return self._points(("strain",), x, time)["strain"]

    def map(self, times, positions, fields: tuple[str, ...] = FIELDS) -> dict[str, np.ndarray]:
        """Some of FIELDS on a grid of at most 1e7 points, by name: arrays [time, position].

        Parameters
        ----------
        times, positions : arrays of one dimension, together at most 1e7 points
        fields : tuple of str, some of "slip_velocity", "slip" and "strain"

        Returns
        -------
        dict of arrays [time, position], NaN beyond the horizon
        """
        if not isinstance(fields, Sequence) or isinstance(fields, str):
            allowed = f"a list of {', '.join(FIELDS)}"
            raise ValueError(f"fields: {short_repr(fields)}; allowed: {allowed}")
        for name in fields:
            check_choice("fields", name, FIELDS)
        x, time = as_numbers("positions", positions), as_numbers("times", times)
        if x.ndim != 1 or time.ndim != 1:
            raise ValueError(f"times, positions: {time.ndim}-d, {x.ndim}-d; allowed: one dimension")
        check_number("times and positions", x.size * time.size, at_most=MOST_POINTS)
        return self._points(tuple(fields), x[None, :], time[:, None])

    def _points(self, fields: tuple[str, ...], x, time) -> dict[str, np.ndarray]:
        """Fields at points, broadcast."""
        x, time = broadcast_numbers(x=x, time=time)
        time = self._until_duration(time)
        positions, index = self._distinct(x)
        out = {name: np.zeros(x.shape) for name in fields}
        for part in self._solved:
            part.fill(out, positions, index, time)
        if "strain" in out and self.prestress.symmetric:
            out["strain"] *= np.where(x < 0.0, -1.0, 1.0)
        unknown = self._is_beyond_horizon(x, time)
        return {name: np.where(unknown, np.nan, values) for name, values in out.items()}

    def _time(self, time: float) -> float:
        check_number("time", time, above=0.0)
        return float(self._until_duration(np.array(time)))

    def _until_duration(self, time: np.ndarray) -> np.ndarray:
        if np.any(time > self._last):
            latest = float(np.max(time))
            raise ValueError(f"time: {latest!r}; allowed: <= duration = {self.duration:g}")
        return np.minimum(time, self.duration)

    def _until_end(self, x: np.ndarray, time: np.ndarray) -> np.ndarray:
        """Times of events; NaN where they are not known to come until the duration."""
        known = (time <= self._last) & ~self._is_beyond_horizon(x, time)
        return np.where(known, np.minimum(time, self.duration), np.nan)

    def _is_beyond_horizon(self, x: np.ndarray, time: np.ndarray | float) -> np.ndarray:
        return time * (1.0 + SAME) >= self.horizon(x)

    @cached_property
    def _limits(self) -> list[Limit]:
        """All points in whose future the construction says nothing."""
        limits = [Limit(*point, reason) for point, reason in self._unknown]
        for part in self._solved:
            slow = [Limit(*point, SLOW_EDGE) for point in part.slow_points()]
            falling = part.falling_slip(partial(_horizon, limits + slow))
            new = slow + [Limit(*point, FALLING_SLIP) for point in falling]
            if self.prestress.symmetric:
                new += [Limit(-limit.x, limit.time, limit.reason) for limit in new]
            limits += new
        return [limit for limit in limits if limit.time <= self._last]

    @property
    def limit(self) -> Limit | None:
        """The earliest point in whose future the construction says nothing, or None."""
        return min(self._limits, key=lambda limit: limit.time, default=None)

    def horizon(self, x) -> np.ndarray:
        """Time from which on the construction says nothing at x; inf for none.

        Parameters
        ----------
        x : float or array, positions

        Returns
        -------
        array, inf where there is no such time
        """
        return _horizon(self._limits, as_numbers("x", x))


def _horizon(limits: list[Limit], x: np.ndarray) -> np.ndarray:
    horizons = [limit.time + np.abs(x - limit.x) for limit in limits]
    return np.min(horizons, axis=0, initial=np.inf)
