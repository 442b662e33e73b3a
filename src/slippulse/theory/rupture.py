"""A whole rupture in the continuum limit, dx -> 0 at fixed beta/dx.

The construction has four steps, each in a module of its own:

1. Where the pre-stress tau is positive, a front is faster than the waves (`fast_front`). Its
   arrival time is the integral of 1/v, where the front speed v depends on tau and beta/dx. The
   damping beta itself tends to 0, and acts at the front alone.
2. Where the pre-stress is negative, a front is slower than the waves. Its path is unknown, and
   follows from the waves that arrive at it (`slow_front`).
3. Behind the fronts, slip obeys the undamped equation, which has Riemann's solution (`riemann`).
4. This solution holds up to the trailing edge, where blocks stick (`trailing_edge`).

`spreading` combines the first two steps for all nucleation points. `Rupture` contains the result
and computes slip, velocity and strain from it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from ..model.checks import as_numbers, check_choice, check_number, short_repr
from ..model.prestress import Prestress
from ..model.removed import ExplainsRemovedNames
from ..model.roots import root_between
from .curve import EQUALITY_TOLERANCE
from .domains import broadcast_numbers, check_domains
from .fast_front import FastFront
from .solved_part import SolvedPart
from .spreading import LEFT, RIGHT, Stretch, spread
from .trailing_edge import FirstStick
from .two_fronts import ExactTransition

# The construction continues beyond the duration by this fraction of it. So its end does not
# coincide with the last time for which results are requested.
EXTRA_DURATION = 1e-6
# The largest product of alpha and the duration, for which exponentials are far from overflow.
MAX_DECAY = 600.0
# Names of the fields.
FIELDS = ("slip_velocity", "slip", "strain")
# The largest number of points of a map. Each point takes 100 bytes.
MAX_MAP_POINTS = 10**7
# Reasons of limits that come from the trailing edge.
SLOW_EDGE = "the trailing edge is slower than the waves"
FALLING_SLIP = "the slip would fall"


@dataclass(frozen=True)
class Limit:
    """A point (x, time) from which on the construction is not valid, and the reason.

    Nothing is known in the future of this point: where a wave from it has arrived.
    """

    x: float
    time: float
    reason: str


class FrontEnd(Limit):
    """The last point of a front: where it stops, or where it is at the end of the duration."""


class Rupture(ExplainsRemovedNames):
    """The exact rupture of a pre-stress in the continuum limit.

    Parameters
    ----------
    prestress : Prestress that reaches 1 somewhere: each such position is a nucleation point
    gamma : float, elasticity ratio, > 0; or 0 for the stress boundary
    damping_ratio, release : beta/dx, from 0 to 1e6, which is constant as dx -> 0; "total" or
        "elastic"
    duration : float, time up to which the rupture is computed, >= 1e-9
    refinement : int, from 1 to 10, factor of the numbers of panels and of search steps, to check
        that the result does not depend on them
    rate_strengthening : float, alpha of a term -alpha du/dt, at most 600/duration, and above the
        value at which slip runs away

    Methods take positions x and times up to ``duration``, as numbers or arrays, and return arrays
    of the same shape. A value is NaN where it is not known (beyond `horizon`), and if it is the
    time of an event that has not happened until ``duration``.
    Raises ValueError: if a value is outside its domain, the pre-stress nowhere reaches 1, or a
    front needs more than 20000 panels. Methods raise it if a position or a time is not finite, or
    if the search for sticks would take more than 3 GB (a minute).
    Source: derived in the supplement. Results on a lattice tend to it at first order in dx.

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
        self._fast_front = FastFront(
            prestress=prestress,
            gamma=gamma,
            damping_ratio=damping_ratio,
            release=release,
            refinement=refinement,
            alpha=rate_strengthening,
        )
        # With a larger alpha, exponentials such as exp(alpha t) could overflow before the duration.
        check_number("rate_strengthening", rate_strengthening, at_most=MAX_DECAY / duration)
        self.prestress = prestress
        self.gamma = self._fast_front.gamma
        self.duration = float(duration)
        # A later time than this is beyond the duration, apart from rounding.
        self._latest_time = self.duration * (1.0 + EQUALITY_TOLERANCE)
        # The construction goes a little beyond the duration.
        until = self.duration * (1.0 + EXTRA_DURATION)
        # A stretch has the two fronts of one connected part of the rupture. The unknown points are
        # those beyond which a front could not be followed, each with the reason.
        self.stretches, self._unknown_points = spread(self._fast_front, until)
        # A part adds the motion behind these two fronts.
        self._parts = [self._make_part(stretch, until) for stretch in self.stretches]
        self._solved_parts = self._parts
        if prestress.symmetric:
            # A symmetric scene is computed at x >= 0 only. A part on the left, whose right end (the
            # last panel edge) is at x <= 0, is not solved.
            self._solved_parts = [part for part in self._parts if part.curve.edges[-1] > 0.0]

    def _make_part(self, stretch: Stretch, until: float) -> SolvedPart:
        """Return the connected part of the rupture behind both fronts of a stretch, up to a time.

        The marks of the part are all positions where the motion of a front may change suddenly: the
        nucleation point of most scenes, x = 0, changes of the pre-stress, points where a slow front
        became fast again (restarts) or where two fronts met (joins), and the ends of both fronts.
        """
        curve, fast_front = stretch.curve(), self._fast_front
        changes_of_prestress = [*fast_front.marks, *fast_front.narrow_features]
        restarts = [*stretch.restarts[LEFT], *stretch.restarts[RIGHT]]
        ends = [stretch.ends[LEFT].x, stretch.ends[RIGHT].x]
        marks = np.unique([0.0, *changes_of_prestress, *restarts, *stretch.joins, *ends])
        return SolvedPart(
            curve=curve,
            gamma=self.gamma,
            until=until,
            marks=marks[curve.covers(marks)],
            refinement=fast_front.refinement,
            one_side=self.prestress.symmetric,
            alpha=fast_front.alpha,
        )

    @property
    def front_ends(self) -> list[tuple[FrontEnd, FrontEnd]]:
        """Last point of the left and of the right front of each connected part, with a reason.

        The reason is "stops" for a front that has stopped, and "duration" for one that still moves
        at the end. Any other reason says why the front was not followed further.
        """
        ends = []
        for part, stretch in zip(self._parts, self.stretches, strict=True):
            left = self._front_end(part, stretch, LEFT)
            right = self._front_end(part, stretch, RIGHT)
            ends.append((left, right))
        return ends

    def _front_end(self, part: SolvedPart, stretch: Stretch, side: float) -> FrontEnd:
        """Return the last point of the front on one side of a part, not later than the duration."""
        end, reason = stretch.ends[side], str(stretch.end_reason[side])
        if reason != "duration" and end.time <= self._latest_time:
            return FrontEnd(float(end.x), float(min(end.time, self.duration)), reason)
        # The curve t = T(x) of the fronts continues a little beyond the duration. The front is
        # searched beyond the outermost panel end (edge) that it has reached at the duration.
        curve = part.curve
        reached_edges = curve.edges[curve.edge_times <= self.duration]
        outermost = reached_edges[-1] if side == RIGHT else reached_edges[0]
        return FrontEnd(curve.front_at(self.duration, outermost, side), self.duration, "duration")

    def release_time(self, x) -> np.ndarray:
        """Return T(x), the time at which the first front reaches x.

        Parameters
        ----------
        x : float or array, positions

        Returns
        -------
        array, NaN where no front arrives before ``duration``
        """
        x = as_numbers("x", x)
        # NaN outside of a part; fmin ignores NaN.
        times = [part.curve.arrival(x) for part in self._parts]
        return self._nan_where_unknown(x, np.fmin.reduce(times))

    def fronts_at(self, time: float, x: float = 0.0) -> tuple[float, float]:
        """Return the left and right front of the connected part that contains x.

        Parameters
        ----------
        time, x : a time in (0, duration], and a position that has been released by then

        Returns
        -------
        tuple of float, left and right; NaN for a front that was not followed up to this time
        """
        time = self._checked_time(time)
        check_number("x", x)
        for part, ends in zip(self._parts, self.front_ends, strict=True):
            if part.curve.arrival(x) <= time * (1.0 + EQUALITY_TOLERANCE):
                left, right = (part.curve.front_at(time, x, side) for side in (LEFT, RIGHT))
                # A front that has stopped stays where it is. If it was not followed to the duration
                # for any other reason, it is unknown after its end.
                is_left_lost, is_right_lost = (
                    end.reason not in ("stops", "duration") and end.time < time for end in ends
                )
                return np.nan if is_left_lost else left, np.nan if is_right_lost else right
        raise ValueError(f"x: {x!r}; allowed: positions that are released before t = {time:g}")

    def stick_time(self, x) -> np.ndarray:
        """Return the time at which x first sticks.

        Beyond the horizon the block at x may be released again.

        Parameters
        ----------
        x : float or array, positions

        Returns
        -------
        array, NaN where x does not stick before ``duration``, and beyond the horizon
        """
        x = as_numbers("x", x)
        return self._nan_where_unknown(x, self._stick_time_even_after_end(x))

    def _distinct_positions(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the distinct positions among x, and for each x its index in them.

        If the scene is symmetric, positions on the left are mirrored to the right.
        """
        x = np.abs(x) if self.prestress.symmetric else x
        distinct_x, index = np.unique(x, return_inverse=True)
        return distinct_x, index.reshape(x.shape)

    def _stick_time_even_after_end(self, x: np.ndarray) -> np.ndarray:
        """Return the stick time at each x, even if it is after the duration or beyond the horizon.

        NaN where no stick is found until slightly after the duration.
        """
        distinct_x, index = self._distinct_positions(x)
        # NaN outside of a part; fmin ignores NaN.
        times = [part.stick_time(distinct_x) for part in self._solved_parts]
        stick_times = np.fmin.reduce(times)
        return stick_times[index]

    def final_slip(self, x) -> np.ndarray:
        """Return the slip at x after sticking.

        Parameters
        ----------
        x : float or array, positions

        Returns
        -------
        array, 0 where nothing has slipped. NaN where x still slides at the end (``duration``), or
        where the slip at the end is not known
        """
        x = as_numbers("x", x)
        stick = self.stick_time(x)
        has_stuck = np.isfinite(stick)
        slides_at_end = np.isfinite(self.release_time(x)) & ~has_stuck
        slip = self.slip(x, np.where(has_stuck, stick, self.duration))
        # Beyond the horizon nothing is known about x.
        is_unknown = slides_at_end | self._is_beyond_horizon(x, self.duration)
        return np.where(is_unknown, np.nan, slip)

    @cached_property
    def first_stick(self) -> FirstStick | None:
        """Time and position of the first sticking; None if nothing is known to stick.

        It is None if nothing sticks before ``duration``. It is also None if the first known
        sticking is later than ``limit``, the earliest point from which on the construction is not
        valid, because another position may have stuck before it.
        """
        first_of_parts = [part.first_stick() for part in self._solved_parts]
        # The earliest one. The result is None for a part in which nothing sticks.
        first = min(filter(None, first_of_parts), default=None)
        if first is None or first.time > self._latest_time:
            return None
        if self.limit and first.time > self.limit.time * (1.0 + EQUALITY_TOLERANCE):
            return None
        return FirstStick(min(first.time, self.duration), first.x)

    @cached_property
    def transition(self) -> ExactTransition:
        """T_trans and L_trans of the transition from crack to pulse, which is the first stick.

        T_trans and L_trans are NaN if ``first_stick`` is None.
        """
        stick = self.first_stick
        if stick is None:
            return ExactTransition(np.nan, np.nan)
        left_front, right_front = self.fronts_at(stick.time, stick.x)
        return ExactTransition(stick.time, right_front - left_front)

    def pulse_width(self, time: float, side: str = "right") -> float:
        """Return the distance between the "right" or "left" front and its trailing edge.

        Parameters
        ----------
        time, side : a time in (0, duration]; "right" or "left"

        Returns
        -------
        float, NaN before anything sticks, and where the front or the edge is not known
        """
        check_choice("side", side, ("right", "left"))
        time = self._checked_time(time)
        if not self.first_stick or time <= self.first_stick.time * (1.0 + EQUALITY_TOLERANCE):
            return np.nan
        # The fronts of the part that sticks first, if the rupture has several parts.
        left, right = self.fronts_at(time, self.first_stick.x)
        front = right if side == "right" else left
        trailing_edge = self._trailing_edge_behind(front, time, self.first_stick.x)
        ends = np.array([trailing_edge, front])
        is_unknown = self._is_beyond_horizon(ends, time).any()
        return np.nan if is_unknown else abs(front - trailing_edge)

    def _trailing_edge_behind(self, front: float, time: float, stuck_position: float) -> float:
        """Return where the trailing edge (the rear end of the pulse) behind a front is at a time.

        front is the position of the front at this time, and stuck_position is one that has stuck
        before. The result is the front itself if the front has stopped and its pulse has ended.
        """

        def time_until_stick(position: float) -> float:
            """Return the stick time of a position minus ``time``; negative if it has stuck.

            If the position never sticks, any time after the end of the rupture is its stick time.
            """
            stick = float(self._stick_time_even_after_end(np.array(position)))
            if np.isnan(stick):
                stick = 2.0 * self.duration
            return stick - time

        if time_until_stick(front) <= 0.0:
            return front
        # There may be several trailing edges. That of the pulse is the nearest one to the front. So
        # the knots, at which stick times are stored, are examined from the front to stuck_position.
        knots = np.concatenate([part.knots.x for part in self._solved_parts])
        if self.prestress.symmetric:
            knots = np.append(knots, -knots)
        lower, upper = sorted((front, stuck_position))
        examined = np.append(knots[(knots > lower) & (knots < upper)], stuck_position)
        examined = examined[np.argsort(np.abs(examined - front))]
        has_stuck = self._stick_time_even_after_end(examined) <= time
        # The edge lies between the first position that has stuck and the one before it.
        first_stuck = int(np.argmax(has_stuck))
        still_slides = examined[first_stuck - 1] if first_stuck > 0 else front
        return root_between(
            time_until_stick, float(examined[first_stuck]), float(still_slides), xtol=1e-11
        )

    @cached_property
    def largest_velocity(self) -> float:
        """Largest slip velocity until ``duration``, of all points before the horizon."""
        parts = self._solved_parts
        return max(part.largest_velocity(self.duration, self.horizon) for part in parts)

    def slip_velocity(self, x, time) -> np.ndarray:
        """Return the slip velocity du/dt at points.

        Parameters
        ----------
        x, time : float or array, positions and times up to ``duration``, broadcast

        Returns
        -------
        array, NaN beyond the horizon
        """
        return self._fields_at_points(("slip_velocity",), x, time)["slip_velocity"]

    def slip(self, x, time) -> np.ndarray:
        """Return the slip u at points.

        Parameters
        ----------
        x, time : float or array, as for `slip_velocity`

        Returns
        -------
        array, NaN beyond the horizon
        """
        return self._fields_at_points(("slip",), x, time)["slip"]

    def strain(self, x, time) -> np.ndarray:
        """Return the strain du/dx at points.

        Parameters
        ----------
        x, time : float or array, as for `slip_velocity`

        Returns
        -------
        array, NaN beyond the horizon
        """
        return self._fields_at_points(("strain",), x, time)["strain"]

    def map(self, times, positions, fields: tuple[str, ...] = FIELDS) -> dict[str, np.ndarray]:
        """Return fields on a grid of times and positions, by name.

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
            dimensions = f"{time.ndim} and {x.ndim} dimensions"
            raise ValueError(f"times, positions: {dimensions}; allowed: one dimension each")
        check_number("number of times and positions", x.size * time.size, at_most=MAX_MAP_POINTS)
        return self._fields_at_points(tuple(fields), x[None, :], time[:, None])

    def _fields_at_points(self, fields: tuple[str, ...], x, time) -> dict[str, np.ndarray]:
        """Return the named fields at points, whose positions and times are broadcast."""
        x, time = broadcast_numbers(x=x, time=time)
        time = self._limited_to_duration(time)
        distinct_x, index = self._distinct_positions(x)
        # All fields are 0 at points that have not been released.
        values_by_name = {name: np.zeros(x.shape) for name in fields}
        for part in self._solved_parts:
            # This writes the values at the points that have been released in this part.
            part.fill_fields(values_by_name, x=distinct_x, index=index, time=time)
        if "strain" in values_by_name and self.prestress.symmetric:
            # The fields were computed at |x|. At x < 0 only the strain has another sign.
            values_by_name["strain"] *= np.where(x < 0.0, -1.0, 1.0)
        is_unknown = self._is_beyond_horizon(x, time)
        return {
            name: np.where(is_unknown, np.nan, values) for name, values in values_by_name.items()
        }

    def _checked_time(self, time: float) -> float:
        """Return a time, checked to be positive and not later than the duration."""
        check_number("time", time, above=0.0)
        return float(self._limited_to_duration(np.array(time)))

    def _limited_to_duration(self, time: np.ndarray) -> np.ndarray:
        """Return times, at most the duration; raise ValueError if one is later.

        A time that is later only by rounding is set to the duration.
        """
        if np.any(time > self._latest_time):
            latest = float(np.max(time))
            raise ValueError(f"time: {latest!r}; allowed: <= duration = {self.duration:g}")
        return np.minimum(time, self.duration)

    def _nan_where_unknown(self, x: np.ndarray, time: np.ndarray) -> np.ndarray:
        """Return times of events at positions x; NaN if an event is not known to happen.

        Events are not known to happen after the duration, or beyond the horizon, which is the time
        from which on nothing is known at x.
        """
        is_before_end = time <= self._latest_time
        is_known = is_before_end & ~self._is_beyond_horizon(x, time)
        return np.where(is_known, np.minimum(time, self.duration), np.nan)

    def _is_beyond_horizon(self, x: np.ndarray, time: np.ndarray | float) -> np.ndarray:
        """Return a mask of the points that have one of the limits in their past."""
        return time * (1.0 + EQUALITY_TOLERANCE) >= self.horizon(x)

    @cached_property
    def _limits(self) -> list[Limit]:
        """All points from which on the construction is not valid, with their reasons.

        There a front could not be followed, the trailing edge becomes slower than the waves, or the
        slip would decrease.
        """
        limits = [Limit(point.x, point.time, reason) for point, reason in self._unknown_points]
        for part in self._solved_parts:
            limits_of_part = [Limit(point.x, point.time, SLOW_EDGE) for point in part.slow_points()]
            # Beyond the horizon the solution is not valid. The horizon is the time at which, for a
            # position x, the first wave arrives from one of the limits that have been found so far.
            horizon = partial(_earliest_wave_arrival, limits + limits_of_part)
            for point in part.falling_slip(horizon):
                limits_of_part.append(Limit(point.x, point.time, FALLING_SLIP))
            limits += limits_of_part
            if self.prestress.symmetric:
                # The solved part is the one at x >= 0. The same holds at x <= 0.
                limits += [Limit(-limit.x, limit.time, limit.reason) for limit in limits_of_part]
        return [limit for limit in limits if limit.time <= self._latest_time]

    @property
    def limit(self) -> Limit | None:
        """The earliest point from which on the construction is not valid; None if there is none."""
        return min(self._limits, key=lambda limit: limit.time, default=None)

    def horizon(self, x) -> np.ndarray:
        """Return the time from which on nothing is known at x.

        Parameters
        ----------
        x : float or array, positions

        Returns
        -------
        array, infinite where there is no such time
        """
        return _earliest_wave_arrival(self._limits, as_numbers("x", x))


def _earliest_wave_arrival(limits: list[Limit], x: np.ndarray) -> np.ndarray:
    """Return the earliest time at which waves from one of the limits reach x."""
    horizons = [limit.time + np.abs(x - limit.x) for limit in limits]
    return np.min(horizons, axis=0, initial=np.inf)
