r"""The trailing edge of one part of a rupture: the time at which each position sticks.

At each position the trailing edge is the first time after release at which du/dt is 0. The
construction holds as long as the edge runs faster than the waves, that is, as long as du/dt falls
along both characteristics, by xi = t - y and by eta = t + y. Then no stuck point lies in the past
of a sliding one, and Riemann's formula holds up to sticking. A block that has stuck is never
released again, because the stress on it is d2u/dt2 (1 - (dt/dx)^2) < 0, where the acceleration
d2u/dt2 is that just before sticking and dt/dx is the slope of the edge.

The edge is computed at knots and interpolated between them (`knots`). The first knots are the ends
of the panels of the curve, the marks (positions from which waves come that change du/dt at once)
and the middles between all of these. Then knots are added:

1. on both sides of each point where the wave from a mark meets the edge, because the edge has a
   kink there;
2. on both sides of each point where the edge reaches the final time;
3. in the middle of every interval whose interpolation does not predict its middle knot, again and
   again;
4. in small pieces around each jump of the edge.

No stick is missed between two positions that slide at the same time. A stuck region grows to both
sides faster than the waves. If neither position has felt it yet, it began in the triangle between
them and the point c from which their characteristics went apart:

        a           b      both slide at this time
         \         /
          \ ..... /        a stuck region would begin in here
           \     /
            \   /
              c

In this triangle du/dt has a lower bound (`lower_bound`). Every interval whose ends slide, at the
final time or when the first position sticks, is divided until the bound is positive or a stick is
found.
"""

from collections.abc import Sequence
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..model.roots import root_between
from .curve import EQUALITY_TOLERANCE, Point
from .knots import BRIEF_SLIP, FASTER_THAN_WAVES, SLIDING, SLOWER_THAN_WAVES, Knots
from .lower_bound import stuck_between
from .part import Part
from .vector_roots import roots_between

# Shortest interval that is halved, in units of `Part.scale`. A slip that takes less time counts as
# brief.
MIN_INTERVAL = 1e-3
# Shortest interval that is halved if the edge reaches the final time or a stopped front in it, in
# the same units.
MIN_INTERVAL_AT_END = 0.01
# Distance of two knots from the point between them where the wave from a mark meets the edge, in
# units of `Part.scale`.
LANDING_OFFSET = 1e-5
# Of several panel ends in a cell of this length, in units of `Part.scale`, only one becomes a knot.
CELL_LENGTH = 0.1
# A jump of the edge, or a change of its kind, is located to this fraction of the length of the
# part.
JUMP_TOLERANCE = 1e-10
# Number of pieces into which an interval with a jump is cut.
PIECES_PER_CUT = 8
# An interval at least this long, in units of JUMP_TOLERANCE times the length of the part, has at
# most one jump.
SINGLE_JUMP_LENGTH = 1e3
# Newton's method for a stick time ends when its last step is below this.
NEWTON_TOLERANCE = 1e-11
# It also ends when its next step, which is about the product of the last two, is below this
# fraction of the interval.
NEXT_STEP_TOLERANCE = 1e-14
# Stick times that differ by less than this are equal, and slip velocities below it are 0.
ROUNDING_ERROR = 1e-12
# Error of du/dt. It makes a stick time uncertain where du/dt falls through 0 slowly, as it does
# next to where a slow front has stopped.
VELOCITY_ERROR = 1e-11
# Uncertainties of stick times below this are neglected. Knots whose larger uncertainty does not
# exclude that they are the first all count as first.
TIME_ERROR = 1e-9


class FirstStick(NamedTuple):
    """Time and position of the first sticking."""

    time: float
    x: float


class PartWithEdge(Part):
    """A connected part of a rupture whose stick times are interpolated between knots."""

    @cached_property
    def knots(self) -> Knots:
        """Knots that are dense enough to interpolate the trailing edge between them."""
        x = self._first_positions()
        knots = self._make_knots(x, self.find_stick_times(x))
        if x.size < 2:
            return knots
        # Every second knot lies in the middle between its neighbours.
        outer = Knots._make(values[::2] for values in knots)
        middle = Knots._make(values[1::2] for values in knots)
        is_predicted = outer.predicts_middle(np.arange(middle.x.size), middle)
        # Left ends of the halves of the intervals that are not fine enough yet.
        left = x[:-1][~np.repeat(is_predicted, 2)]
        x = np.union1d(self._positions_of_landings(knots), self._positions_near_end(knots))
        knots = self._with_more_knots(knots, x=x, stick=self.find_stick_times(x), left=left)
        while (x := stuck_between(self, knots.sliding_intervals, self.until)).size:
            knots = self._with_more_knots(knots, x, self.find_stick_times(x))
        # An edge that may become slower than the waves between two knots is checked once more.
        x = knots.positions_to_recheck
        return self._with_more_knots(knots, x, self._stick_time(x, knots)) if x.size else knots

    def _first_positions(self) -> np.ndarray:
        """Return the positions of the first knots, every second of them in a middle.

        The others are ends of panels, marks, and the positions of the fronts at the final time.
        """
        curve = self.curve
        left, right = curve.edges[[0, -1]]
        if self.one_side:
            left = max(left, 0.0)
        last = self.until * (1.0 - EQUALITY_TOLERANCE)
        start = curve.edges[np.argmin(curve.edge_times)]
        fronts = [curve.front_at(last, start, side) for side in (-1.0, 1.0)]
        cell = np.floor(curve.edges / (CELL_LENGTH * self.scale))
        edges = curve.edges[np.diff(cell, prepend=-np.inf) > 0.0]
        x = np.unique([left, *edges, *self.marks, *fronts])
        x = x[(x >= left) & (x <= right) & (curve.arrival(x) < self.until)]
        x = x[np.diff(x, append=np.inf) > EQUALITY_TOLERANCE * (right - left)]
        return np.sort(np.append(x, 0.5 * (x[:-1] + x[1:])))

    def _with_more_knots(
        self, knots: Knots, x: np.ndarray, stick: np.ndarray, left: Sequence[float] = ()
    ) -> Knots:
        """Return knots with additional ones at x, refined until they predict the edge around these.

        stick holds the stick times at x, NaN where there is none. Intervals whose left ends are
        given are refined too.
        """
        todo = np.unique([*left, *x[x < knots.x[-1]], *knots.x[knots.interval_of(x)]])
        knots = knots.joined(self._make_knots(x, stick))
        while todo.size:
            knots, todo = self._refine(knots, todo)
        return knots

    def _make_knots(self, x: np.ndarray, stick: np.ndarray) -> Knots:
        """Return knots at x with stick times that are NaN for positions that do not stick."""
        sticks = np.isfinite(stick)
        time = np.where(sticks, stick, self.until)
        domains = self.domains(x, time)
        velocity = np.zeros(x.size) if sticks.all() else domains.slip_velocity()
        velocity[sticks] = 0.0
        by_xi, by_eta = domains.velocity_slopes()
        slow = (by_xi >= 0.0) | (by_eta >= 0.0)
        kind = np.where(sticks, np.where(slow, SLOWER_THAN_WAVES, FASTER_THAN_WAVES), SLIDING)
        kind[sticks & (time - self.curve.arrival(x) <= MIN_INTERVAL * self.scale)] = BRIEF_SLIP
        return Knots(
            x=x,
            stick=time,
            kind=kind,
            velocity=velocity,
            velocity_by_xi=by_xi,
            velocity_by_eta=by_eta,
        )

    def _positions_of_landings(self, knots: Knots) -> np.ndarray:
        """Return positions on both sides of where waves from the marks meet the trailing edge."""
        marks = np.array(self.marks)
        arrival = self.curve.arrival(marks)
        out, near = [], LANDING_OFFSET * self.scale
        for side in (-1.0, 1.0):
            # The phase is 0 where the wave that a mark sends to this side meets the edge.
            phase = (knots.stick - side * knots.x)[:, None] - (arrival - side * marks)
            fast = knots.outruns_waves(np.arange(knots.x.size - 1))[:, None]
            k, mark = np.nonzero((phase[1:] * phase[:-1] < 0.0) & fast)
            before, after = phase[k, mark], phase[k + 1, mark]
            left, right = knots.x[k], knots.x[k + 1]
            x = left + (right - left) * before / (before - after)
            # Two steps of Newton's method on du/dt along the wave.
            for _ in range(2 if x.size else 0):
                time = arrival[mark] + side * (x - marks[mark])
                domains = self.domains(x, time)
                x = x - 0.5 * side * domains.slip_velocity() / domains.velocity_slopes()[side > 0.0]
                x = x.clip(left, right)
            # The edge has a kink at x, so that a knot stands on either side of it.
            out.append(np.clip([x - near, x + near], left, right).ravel())
        return np.concatenate(out)

    def _velocity_at_end(self, x: np.ndarray, which: np.ndarray | None = None) -> np.ndarray:
        """Return du/dt at positions at the final time.

        The second argument is not used; `roots_between` passes it.
        """
        return self.velocity(x, np.full(x.size, self.until))

    def _positions_near_end(self, knots: Knots) -> np.ndarray:
        """Return positions on both sides of where the trailing edge reaches the final time."""
        k = np.arange(knots.x.size - 1)
        k = k[knots.has_end_kinds(k, FASTER_THAN_WAVES, SLIDING)]
        velocity = np.array([self._velocity_at_end(knots.x[ends]) for ends in (k, k + 1)])
        meets = velocity[0] * velocity[1] < 0.0
        at_left, at_right = velocity[:, meets]
        left, right = knots.x[k[meets]], knots.x[k[meets] + 1]
        near = 0.4 * MIN_INTERVAL_AT_END * self.scale
        x = roots_between(
            self._velocity_at_end,
            lower=left,
            upper=right,
            at_lower=at_left,
            at_upper=at_right,
            xtol=0.5 * near,
        )
        return np.clip([x - near, x + near], left, right).ravel()

    def _refine(self, knots: Knots, left: np.ndarray) -> tuple[Knots, np.ndarray]:
        """Add knots in the intervals with the given left ends, and return which to look at next.

        Intervals with a jump, or in which the edge reaches the final time, are cut into
        PIECES_PER_CUT pieces; others are halved. Halves are looked at again if the interpolation
        did not predict the middle, pieces if they contain the jump or the end.
        """
        k = self._not_behind_jumps(knots, np.searchsorted(knots.x, left))
        jumps = knots.has_jump(k)
        reaches_end = knots.has_end_kinds(k, FASTER_THAN_WAVES, SLIDING)
        min_length = np.full(k.size, MIN_INTERVAL * self.scale)
        min_length[reaches_end | knots.touches_brief_slip(k)] = MIN_INTERVAL_AT_END * self.scale
        min_length[jumps] = JUMP_TOLERANCE * self._length
        is_long = knots.x[k + 1] - knots.x[k] > min_length
        cut = k[is_long & (jumps | reaches_end)]
        halved = k[is_long & ~jumps & ~reaches_end]
        # Left ends of the pieces, [piece, interval], and the middles of the other intervals.
        pieces = np.linspace(knots.x[cut], knots.x[cut + 1], PIECES_PER_CUT + 1)[:-1]
        middle = 0.5 * (knots.x[halved] + knots.x[halved + 1])
        x = np.append(pieces[1:].ravel(), middle)
        if not x.size:
            return knots, x
        new = self._make_knots(x, self._stick_time(x, knots))
        in_middle = Knots._make(values[x.size - middle.size :] for values in new)
        is_predicted = knots.predicts_middle(halved, in_middle)
        refined = knots.joined(new)
        self._mark_steep_pieces(refined, pieces)
        halves = np.append(knots.x[halved], middle)
        left = np.append(halves, pieces)
        k = np.searchsorted(refined.x, left)
        look_again = refined.has_jump(k) | refined.has_end_kinds(k, FASTER_THAN_WAVES, SLIDING)
        look_again[: halves.size] = np.tile(~is_predicted, 2)
        return refined, left[look_again]

    @property
    def _length(self) -> float:
        """Length of the part."""
        return self.curve.edges[-1] - self.curve.edges[0]

    def _not_behind_jumps(self, knots: Knots, k: np.ndarray) -> np.ndarray:
        """Return those of the intervals k that are not completely in the future of a jump.

        Nothing is known in the future of a jump. Its position in its own interval is not known
        exactly, so that twice the interval length is added to its time.
        """
        ends, lengths = knots.ends_before_jumps(k)
        sides = np.array([k, k + 1])[..., None]
        delay = knots.stick[sides] - np.abs(knots.x[sides] - knots.x[ends])
        is_earlier = delay.min(axis=0) < knots.stick[ends] + 2.0 * lengths
        return k[is_earlier.all(axis=1)]

    def _mark_steep_pieces(self, knots: Knots, pieces: np.ndarray) -> None:
        """Set the kind SLOWER_THAN_WAVES at knots of intervals all of whose pieces are steep.

        Only one of the pieces contains a jump. If all of them are steep, the edge is slower than
        the waves, although its slopes at the knots are just below 1.
        """
        k = np.searchsorted(knots.x, pieces)
        is_long = pieces[1] - pieces[0] > SINGLE_JUMP_LENGTH * JUMP_TOLERANCE * self._length
        slow = k[:, knots.has_jump(k).all(axis=0) & is_long]
        knots.kind[slow] = knots.kind[slow[-1] + 1] = SLOWER_THAN_WAVES

    def approximate_stick_time(self, x: np.ndarray) -> np.ndarray:
        """Return stick times, accurate to a fraction of the knot spacing.

        For blocks that never stick it is the final time.
        """
        knots = self.knots
        k = knots.interval_of(x)
        return np.where(
            knots.outruns_waves(k), knots.interpolate(k, x), np.interp(x, knots.x, knots.stick)
        )

    def _stick_time(self, x: np.ndarray, knots: Knots | None = None) -> np.ndarray:
        """Return stick times at positions, using the knots; NaN if a block never sticks."""
        knots = knots or self.knots
        if knots.x.size < 2:
            return self.find_stick_times(x)
        k = knots.interval_of(x)
        inside = (x >= knots.x[0]) & (x <= knots.x[-1])
        out = self._stick_times_by_newton(
            knots, x=x, k=k, is_requested=inside & knots.outruns_waves(k)
        )
        # Where both neighbouring knots slide at the final time, a position whose du/dt is positive
        # then has not stuck before.
        slides = np.flatnonzero(inside & knots.has_end_kinds(k, SLIDING, SLIDING))
        slides = slides[self._velocity_at_end(x[slides]) > 0.0]
        unknown = np.setdiff1d(np.flatnonzero(~np.isfinite(out)), slides)
        out[unknown] = self.find_stick_times(x[unknown])
        return np.where(out <= self.until, out, np.nan)

    def _stick_times_by_newton(
        self, knots: Knots, x: np.ndarray, k: np.ndarray, is_requested: np.ndarray
    ) -> np.ndarray:
        """Return stick times in the intervals k by Newton's method, from the interpolated ones on.

        It is NaN where it is not requested and where the steps leave the neighbourhood of the
        start.
        """
        span = knots.x[k + 1] - knots.x[k]
        s = (x - knots.x[k]) / span
        guess = knots.interpolate(k, x)
        acceleration = knots.velocity_by_xi + knots.velocity_by_eta
        acceleration = acceleration[k] * (1.0 - s) + acceleration[k + 1] * s
        out, time = np.full(x.shape, np.nan), guess.copy()
        velocity, step = np.zeros(x.shape), np.zeros(x.shape)
        todo = np.flatnonzero(is_requested)
        for _ in range(12):
            if not todo.size:
                break
            earlier, velocity[todo] = velocity[todo], self.velocity(x[todo], time[todo])
            last = step[todo]
            # After the first step the acceleration is that of the secant.
            secant = (earlier - velocity[todo]) / np.where(last == 0.0, np.nan, last)
            acceleration[todo] = np.where(
                np.abs(last) > NEWTON_TOLERANCE, secant, acceleration[todo]
            )
            step[todo] = velocity[todo] / acceleration[todo]
            time[todo] -= step[todo]
            is_near = np.abs(time[todo] - guess[todo]) <= 0.05 * span[todo]
            size, before = np.abs(step[todo]), np.where(last == 0.0, 1.0, np.abs(last))
            next_size = size * before
            done = (size < NEWTON_TOLERANCE) | (next_size < NEXT_STEP_TOLERANCE * span[todo])
            done &= is_near
            out[todo[done]] = time[todo[done]]
            todo = todo[is_near & ~done]
        return out

    def slow_points(self) -> list[Point]:
        """Return the points where the trailing edge is not faster than the waves."""
        knots = self.knots
        ends, _ = knots.ends_before_jumps(np.arange(knots.x.size - 1))
        slow = np.union1d(ends, np.flatnonzero(knots.kind == SLOWER_THAN_WAVES))
        slow = np.union1d(slow, self._stops_without_edge()).astype(int)
        points = np.stack([knots.x, knots.stick], axis=1)[slow].tolist()
        return [Point(*point) for point in points]

    def _stops_without_edge(self) -> list[int]:
        """Return the outer knots where a front has stopped but no fast trailing edge begins."""
        knots = self.knots
        resolved = np.flatnonzero(knots.kind != BRIEF_SLIP)
        stops = []
        for end, nearest in ((0, resolved[:1]), (-1, resolved[-1:])):
            # A front that still moves at the final time has not stopped.
            stopped = knots.kind[end] == BRIEF_SLIP and self.curve.edge_times[end] < self.until
            if stopped and nearest.size:
                distance = abs((knots.x[nearest] - knots.x[end]).item())
                delay = abs((knots.stick[nearest] - knots.stick[end]).item())
                if delay > distance * (1.0 + EQUALITY_TOLERANCE):
                    stops.append(end % knots.x.size)
        return stops

    def first_stick(self) -> FirstStick | None:
        """Return the first sticking, or None if nothing sticks before the final time."""
        first = self._first_at_knots()
        # If the knots have missed an earlier one, more of them are added there.
        while first:
            x = self._positions_stuck_earlier(first)
            if not x.size:
                break
            self.knots = self._with_more_knots(self.knots, x, self.find_stick_times(x, first.time))
            first = self._first_at_knots()
        return first

    def _first_at_knots(self) -> FirstStick | None:
        """Return the first sticking according to the knots, or None if no knot sticks."""
        knots = self.knots
        stuck = knots.kind != SLIDING
        if not stuck.any():
            return None
        error = self._stick_time_errors()
        # If several positions stick first, the one nearest to x = 0 is returned.
        latest = np.where(stuck, knots.stick + error, np.inf)
        first = np.flatnonzero(latest <= np.min(latest) + 1e-10)
        nearest = int(first[np.argmin(np.abs(knots.x[first]))])
        out = FirstStick(float(knots.stick[nearest]), float(knots.x[nearest]))
        # An interval cannot contain a stick before this time.
        earliest = np.minimum(knots.stick[:-1], knots.stick[1:]) - 0.5 * np.diff(knots.x)
        for k in np.flatnonzero(self._may_have_minimum(error) & (earliest < out.time)).tolist():
            minimum = self._minimum_between(*knots.x[[k, k + 1]].tolist())
            # A kink or an equal time does not count as a minimum.
            if minimum and minimum.time < out.time - ROUNDING_ERROR:
                out = minimum
        return out

    def _stick_time_errors(self) -> np.ndarray:
        """Return the errors of the stick times of knots, 0 where they are negligible."""
        knots = self.knots
        fall = np.abs(knots.velocity_by_xi + knots.velocity_by_eta)
        # Where a front has stopped, the stick time is that of the front itself, which is exact.
        fall = np.where(knots.kind == BRIEF_SLIP, np.inf, fall)
        error = VELOCITY_ERROR / np.maximum(fall, ROUNDING_ERROR)
        error[error < TIME_ERROR] = 0.0
        return error

    def _may_have_minimum(self, error: np.ndarray) -> np.ndarray:
        """Return a mask of the intervals in which the trailing edge may have a minimum.

        Its slope, or du/dt at the final time, falls into such an interval from both ends.
        """
        knots = self.knots
        k = np.arange(knots.x.size - 1)
        falls_inwards = (knots.slope[:-1] < 0.0) & (knots.slope[1:] > 0.0)
        is_fast = knots.outruns_waves(k) | knots.has_end_kinds(k, FASTER_THAN_WAVES, SLIDING)
        return falls_inwards & is_fast & (error[:-1] + error[1:] == 0.0)

    def _positions_stuck_earlier(self, first: FirstStick) -> np.ndarray:
        """Return positions between knots that have stuck before the first stick at a knot."""
        knots, curve = self.knots, self.curve
        # A stick between two knots comes later than its waves need to reach both of them.
        earliest = 0.5 * (knots.stick[:-1] + knots.stick[1:] - np.diff(knots.x))
        slips = curve.arrival(knots.x) < first.time
        intervals: list[tuple[float, float]] = []
        for k in np.flatnonzero((earliest < first.time) & (slips[:-1] | slips[1:])):
            left, right = knots.x[k : k + 2].tolist()
            left = left if slips[k] else curve.front_at(first.time, right, -1.0)
            right = right if slips[k + 1] else curve.front_at(first.time, left, 1.0)
            inner = [first.x] if left < first.x < right else []
            intervals += pairwise([left, *inner, right])
        x = np.array(intervals).reshape(-1, 2).T
        return stuck_between(self, x=x, time=first.time, first=first.x)

    def _minimum_between(self, left: float, right: float) -> FirstStick | None:
        """Return the first sticking between two positions.

        It is None if the edge does not fall into the interval from both ends.
        """

        def edge_slope(position: float) -> float:
            """Return the slope of the trailing edge at a position."""
            x = np.array([position])
            return float(self._make_knots(x, self._stick_time(x)).slope[0])

        # If it falls only by rounding errors, one of the knots is the minimum.
        if not edge_slope(left) < 0.0 < edge_slope(right):
            return None
        x = root_between(edge_slope, left, right, xtol=NEWTON_TOLERANCE)
        return FirstStick(float(self._stick_time(np.array([x]))[0]), x)
