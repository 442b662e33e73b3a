r"""The trailing edge of one part of a rupture: the time at which each position sticks.

A position sticks at the first time after the release at which du/dt is 0. The construction is valid
as long as the edge runs faster than the waves. This is so if du/dt falls along both
characteristics, that is, with xi = t - y and with eta = t + y. Then no stuck point lies in the past
of a sliding one, and Riemann's formula is valid up to the stick. A block that has stuck is never
released again, because the stress on it is negative. This stress is d2u/dt2 (1 - (dt/dx)^2), with
the acceleration d2u/dt2 just before the stick, and the slope dt/dx of the edge.

The edge is computed at knots and interpolated between them (`knots`). The first knots are the ends
of the panels of the curve, the marks, and the middles between all of these. (The marks are the
positions from which waves come that change du/dt at once.) Then knots are added:

1. on both sides of each point where the wave from a mark meets the edge, because the edge has a
   kink there;
2. on both sides of each point where the edge reaches the final time;
3. in the middle of each interval whose interpolation does not predict its middle, until it does;
4. around each jump of the edge, which is cut into smaller and smaller pieces.

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
from typing import NamedTuple

import numpy as np

from ..model.roots import root_between
from .curve import EQUALITY_TOLERANCE, Point
from .knots import BRIEF_SLIP, FASTER_THAN_WAVES, SLIDING, SLOWER_THAN_WAVES, Knots
from .lower_bound import stuck_between
from .part import Part
from .vector_roots import roots_between

# Shortest interval that is halved, in units of `Part.scale`. A slip that takes a shorter time, in
# the same units, is brief.
MIN_INTERVAL = 1e-3
# Shortest interval that is halved, in the same units, if the edge reaches the final time or a
# stopped front in it.
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
# The largest number of knots. Stick times of usual scenes take about 2000 knots at most. Where the
# pre-stress is almost 0, stick times may be so irregular that refinement would go on for hours.
MAX_KNOTS = 30_000
# The most steps of Newton's method for a stick time.
MAX_NEWTON_STEPS = 12
# Newton's method fails if it moves farther from its start than this fraction of the interval
# length.
MAX_CORRECTION = 0.05
# Newton's method ends when its last step is below this.
NEWTON_TOLERANCE = 1e-11
# Newton's method also ends when its next step, which is about the product of the last two, is below
# this fraction of the interval length.
NEXT_STEP_TOLERANCE = 1e-14
# Stick times that differ by less than this are equal, and slip velocities below it are 0.
ROUNDING_ERROR = 1e-12
# Error of du/dt. This error makes a stick time uncertain where du/dt falls slowly through 0, as it
# does next to where a slow front has stopped.
VELOCITY_ERROR = 1e-11
# Errors of stick times below this are neglected.
TIME_ERROR = 1e-9


class FirstStick(NamedTuple):
    """Time and position of the first stick."""

    time: float
    x: float


class PartWithEdge(Part):
    """A connected part of a rupture whose stick times are interpolated between knots."""

    @cached_property
    def knots(self) -> Knots:
        """Positions and their stick times, dense enough to interpolate the trailing edge."""
        x = self._first_positions()
        knots = self._make_knots(x, self.find_stick_times(x))
        if x.size < 2:
            return knots
        # Every second knot lies in the middle between its neighbours. If interpolation between the
        # neighbours does not predict it, the intervals on both sides of it are refined.
        outer, middle = knots.select(np.s_[::2]), knots.select(np.s_[1::2])
        is_predicted = outer.predicts_middle(np.arange(middle.x.size), middle)
        left_ends = x[:-1]
        unresolved = left_ends[~np.repeat(is_predicted, 2)]
        # The edge has kinks where waves meet it that change du/dt at once. At the final time it
        # ends.
        x = np.union1d(self._positions_near_waves(knots), self._positions_near_end(knots))
        knots = self._with_more_knots(
            knots, x=x, stick=self.find_stick_times(x), unresolved=unresolved
        )
        # Two neighbouring knots may still slide at the final time, although a position between them
        # has stuck. Such positions become knots, until none is left.
        while (x := stuck_between(self, knots.sliding_intervals, self.until)).size:
            knots = self._with_more_knots(knots, x, self.find_stick_times(x))
        # An edge that may become slower than the waves between two knots is checked once more.
        x = knots.positions_to_recheck
        if not x.size:
            return knots
        return self._with_more_knots(knots, x, self._exact_stick_time(x, knots))

    def _first_positions(self) -> np.ndarray:
        """Return the positions of the first knots.

        The positions are the ends of panels, the marks, the positions of the two fronts at the
        final time, and the middles between all of these. So every second one is a middle.
        """
        curve = self.curve
        left, right = curve.edges[[0, -1]]
        if self.one_side:
            # The part is symmetric, and is computed only at x >= 0.
            left = max(left, 0.0)
        # The fronts are followed from the position that was released first.
        just_before_end = self.until * (1.0 - EQUALITY_TOLERANCE)
        nucleation = curve.edges[np.argmin(curve.edge_times)]
        fronts = [curve.front_at(just_before_end, nucleation, side) for side in (-1.0, 1.0)]
        # One end of a panel in each cell of the length CELL_LENGTH is sufficient.
        cell = np.floor(curve.edges / (CELL_LENGTH * self.scale))
        is_first_of_cell = np.diff(cell, prepend=-np.inf) > 0.0
        x = np.unique([left, *curve.edges[is_first_of_cell], *self.marks, *fronts])
        x = x[(x >= left) & (x <= right) & (curve.arrival(x) < self.until)]
        is_distinct = np.diff(x, append=np.inf) > EQUALITY_TOLERANCE * (right - left)
        x = x[is_distinct]
        middles = 0.5 * (x[:-1] + x[1:])
        return np.sort(np.append(x, middles))

    def _with_more_knots(
        self,
        knots: Knots,
        x: np.ndarray,
        stick: np.ndarray,
        unresolved: Sequence[float] | np.ndarray = (),
    ) -> Knots:
        """Return the knots and new ones at x, with the intervals next to the new ones refined.

        Refined means: divided by further knots until interpolation is accurate. stick has the stick
        times at x, NaN where there is none. unresolved has the left ends of other intervals that
        are refined too.
        """
        # An interval is identified by the position of its left end, since numbers change when knots
        # are added. A new knot divides an interval into two. One of them begins at the old knot on
        # its left, and the other one at the new knot itself.
        old_left_ends = knots.x[knots.interval_of(x)]
        new_left_ends = x[x < knots.x[-1]]
        left_ends = np.unique([*unresolved, *old_left_ends, *new_left_ends])
        knots = knots.joined(self._make_knots(x, stick))
        while left_ends.size:
            knots, left_ends = self._refine(knots, left_ends)
            if knots.x.size > MAX_KNOTS:
                raise ValueError(
                    f"prestress: the stick times need more than {MAX_KNOTS} interpolation points,"
                    " since some slip velocities are as small as rounding errors;"
                    " allowed: a pre-stress with more regular stick times"
                )
        return knots

    def _make_knots(self, x: np.ndarray, stick: np.ndarray) -> Knots:
        """Return knots at positions x with given stick times, NaN where a position does not stick.

        The function computes du/dt and its derivatives at the stick time, and from them the kind of
        each knot: it slides until the end, or the trailing edge is faster or slower than the waves
        there, or its slip is too brief to decide between these two.
        """
        sticks = np.isfinite(stick)
        time = np.where(sticks, stick, self.until)
        domains = self.domains(x, time)
        # The velocity is 0 at a stick. It is computed only if a position slides at the final time.
        velocity = np.zeros(x.size) if sticks.all() else domains.slip_velocity()
        velocity[sticks] = 0.0
        by_xi, by_eta = domains.velocity_slopes()
        # The edge is faster than the waves where du/dt falls along both characteristics.
        is_slow = (by_xi >= 0.0) | (by_eta >= 0.0)
        is_brief = time - self.curve.arrival(x) <= MIN_INTERVAL * self.scale
        kind = np.full(x.size, SLIDING)
        kind[sticks] = FASTER_THAN_WAVES
        kind[sticks & is_slow] = SLOWER_THAN_WAVES
        kind[sticks & is_brief] = BRIEF_SLIP
        return Knots(
            x=x,
            stick=time,
            kind=kind,
            velocity=velocity,
            velocity_by_xi=by_xi,
            velocity_by_eta=by_eta,
        )

    def _positions_near_waves(self, knots: Knots) -> np.ndarray:
        """Return positions on both sides of each point where a wave from a mark meets the edge.

        A mark is a position where the motion of a front changes suddenly. When the front arrives
        there, one wave starts to each side.
        """
        sides = (-1.0, 1.0)
        return np.concatenate([self._positions_near_waves_to(knots, side) for side in sides])

    def _positions_near_waves_to(self, knots: Knots, side: float) -> np.ndarray:
        """Return positions on both sides of each point where a wave meets the trailing edge.

        The waves start at the marks when the front arrives there, and run to the left (side = -1)
        or to the right (side = +1).
        """
        marks = np.array(self.marks)
        start_times = self.curve.arrival(marks)
        # Time from the passage of each wave to the stick, [knot, mark]. This delay changes its sign
        # where the wave meets the edge.
        delay = (knots.stick - side * knots.x)[:, None] - (start_times - side * marks)
        meets_edge = delay[1:] * delay[:-1] < 0.0
        # An edge that is slower than the waves is not interpolated by cubics, so that its kinks do
        # not matter.
        is_fast = knots.outruns_waves(np.arange(knots.x.size - 1))
        k, mark = np.nonzero(meets_edge & is_fast[:, None])
        if not k.size:
            return np.zeros(0)
        at_left, at_right = delay[k, mark], delay[k + 1, mark]
        left, right = knots.x[k], knots.x[k + 1]
        # By linear interpolation of the delay, the wave meets the edge near this position.
        x = left + (right - left) * at_left / (at_left - at_right)
        # Two steps of Newton's method find the position on the wave where du/dt is 0. They need the
        # derivative of du/dt along the wave. On a wave to the right, t = x + const, so that t - x
        # is constant and t + x changes by 2 dx. On a wave to the left, t = -x + const, so that
        # t + x is constant and t - x changes by -2 dx.
        for _ in range(2):
            time = start_times[mark] + side * (x - marks[mark])
            domains = self.domains(x, time)
            by_xi, by_eta = domains.velocity_slopes()
            slope_on_wave = 2.0 * by_eta if side > 0.0 else -2.0 * by_xi
            x = x - domains.slip_velocity() / slope_on_wave
            x = x.clip(left, right)
        # The wave meets the edge between the two positions.
        offset = LANDING_OFFSET * self.scale
        return np.clip([x - offset, x + offset], left, right).ravel()

    def _velocity_at_end(self, x: np.ndarray, which: np.ndarray | None = None) -> np.ndarray:
        """Return du/dt at positions at the final time.

        ``which`` is not used; `roots_between` passes it.
        """
        return self.velocity(x, np.full(x.size, self.until))

    def _positions_near_end(self, knots: Knots) -> np.ndarray:
        """Return positions on both sides of where the trailing edge reaches the final time."""
        # Only one of the two ends of these intervals sticks before the final time.
        k = np.arange(knots.x.size - 1)
        k = k[knots.has_end_kinds(k, FASTER_THAN_WAVES, SLIDING)]
        at_left = self._velocity_at_end(knots.x[k])
        at_right = self._velocity_at_end(knots.x[k + 1])
        # At the final time the computed du/dt is positive where a block slides, and negative where
        # it has stuck before. The edge is in between.
        has_edge = at_left * at_right < 0.0
        left, right = knots.x[k[has_edge]], knots.x[k[has_edge] + 1]
        # The new knots are so near to each other that the interval between them is not divided.
        offset = 0.4 * MIN_INTERVAL_AT_END * self.scale
        x = roots_between(
            self._velocity_at_end,
            lower=left,
            upper=right,
            at_lower=at_left[has_edge],
            at_upper=at_right[has_edge],
            xtol=0.5 * offset,
        )
        return np.clip([x - offset, x + offset], left, right).ravel()

    def _refine(self, knots: Knots, left_ends: np.ndarray) -> tuple[Knots, np.ndarray]:
        """Divide some intervals once by new knots, and return all knots.

        The intervals are given by the positions of their left ends. An interval in which the edge
        jumps or reaches the final time is cut into pieces, and any other one is halved. Also return
        the left ends of the new intervals to divide next: pieces in which the edge jumps or reaches
        the final time, and both halves if interpolation did not predict the middle.
        """
        k = self._not_in_future_of_jumps(knots, np.searchsorted(knots.x, left_ends))
        cut, halved = self._intervals_to_divide(knots, k)
        # The first piece of an interval starts at the left end of the interval. The axes of these
        # positions are [piece, interval].
        piece_starts = np.linspace(knots.x[cut], knots.x[cut + 1], PIECES_PER_CUT + 1)[:-1]
        inner_piece_starts = piece_starts[1:].ravel()
        middles = 0.5 * (knots.x[halved] + knots.x[halved + 1])
        x = np.append(inner_piece_starts, middles)
        if not x.size:
            return knots, x
        new_knots = self._make_knots(x, self._exact_stick_time(x, knots))
        # The new knots in the middles follow those at the starts of pieces.
        middle_knots = new_knots.select(np.s_[inner_piece_starts.size :])
        refined = knots.joined(new_knots)
        # The kinds of some knots are changed in place.
        self._set_kind_of_slow_intervals(refined, piece_starts)
        is_unresolved = ~knots.predicts_middle(halved, middle_knots)
        unresolved_halves = [knots.x[halved[is_unresolved]], middles[is_unresolved]]
        pieces = np.searchsorted(refined.x, piece_starts.ravel())
        reaches_end = refined.has_end_kinds(pieces, FASTER_THAN_WAVES, SLIDING)
        pieces_with_event = piece_starts.ravel()[refined.has_jump(pieces) | reaches_end]
        return refined, np.concatenate([*unresolved_halves, pieces_with_event])

    def _intervals_to_divide(self, knots: Knots, k: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return which of the intervals k are cut into pieces, and which are halved.

        An interval is cut if the edge jumps or reaches the final time in it, and halved otherwise.
        """
        has_jump = knots.has_jump(k)
        # An interval is divided if it is longer than this. Jumps are located much more accurately
        # than the edge next to the final time or a stopped front (brief slip).
        min_length = np.full(k.size, MIN_INTERVAL * self.scale)
        # Only one of the two knots of the interval sticks before the final time.
        reaches_end = knots.has_end_kinds(k, FASTER_THAN_WAVES, SLIDING)
        min_length[reaches_end | knots.touches_brief_slip(k)] = MIN_INTERVAL_AT_END * self.scale
        min_length[has_jump] = JUMP_TOLERANCE * self._length
        is_long = knots.x[k + 1] - knots.x[k] > min_length
        has_event = has_jump | reaches_end
        return k[is_long & has_event], k[is_long & ~has_event]

    @property
    def _length(self) -> float:
        """Length of the part: the distance between its two fronts at the end."""
        return self.curve.edges[-1] - self.curve.edges[0]

    def _not_in_future_of_jumps(self, knots: Knots, k: np.ndarray) -> np.ndarray:
        """Return the intervals k, except those that lie completely in the future of a jump.

        A knot counts as in the future of a jump of the edge if a wave from the jump certainly
        arrives there before the knot sticks. Nothing is known about the edge there.

        k : numbers of intervals; interval k lies between the knots k and k + 1
        """
        is_kept = np.full(k.size, True)
        jumps = k[knots.has_jump(k)]
        for jump, before_jump in zip(jumps, knots.ends_before_jumps(jumps), strict=True):
            # At this time at the latest, a wave from the jump arrives at the knot before the jump.
            # The edge ran from this knot to the jump faster than the waves, whose speed is 1. So
            # neither the way there nor the way back takes longer than the length of the interval.
            length = knots.x[jump + 1] - knots.x[jump]
            latest_return = knots.stick[before_jump] + 2.0 * length
            # From there the wave runs on to the other knots.
            wave_arrival = latest_return + np.abs(knots.x - knots.x[before_jump])
            sticks_before_wave = knots.stick < wave_arrival
            is_kept &= sticks_before_wave[k] | sticks_before_wave[k + 1]
        return k[is_kept]

    def _set_kind_of_slow_intervals(self, knots: Knots, piece_starts: np.ndarray) -> None:
        """Change the kind of knots to SLOWER_THAN_WAVES where a slow edge looked like a jump.

        An interval in which the edge takes longer than a wave seems to have a jump, and was cut
        into pieces. A jump would be in only one of them. So if the edge takes longer than a wave in
        every piece, it is slower than the waves, although its slopes at the knots are just below 1.
        Then the kinds of all knots of the interval are changed in place.

        piece_starts has the left ends of the pieces of each interval, [piece, interval].
        """
        k = np.searchsorted(knots.x, piece_starts)
        is_longer_in_all = knots.has_jump(k).all(axis=0)
        # If the pieces are short, each may have a jump of its own, and the interval is not changed.
        piece_length = piece_starts[1] - piece_starts[0]
        is_long = piece_length > SINGLE_JUMP_LENGTH * JUMP_TOLERANCE * self._length
        slow = k[:, is_longer_in_all & is_long]
        # Each piece has its left end, and the last piece also its right end.
        knots.kind[slow] = SLOWER_THAN_WAVES
        knots.kind[slow[-1] + 1] = SLOWER_THAN_WAVES

    def approximate_stick_time(self, x: np.ndarray) -> np.ndarray:
        """Return stick times that are interpolated between knots, without further computation.

        The stick times are accurate to a fraction of the knot spacing. The stick time of a block
        that does not stick is the final time.
        """
        knots = self.knots
        k = knots.interval_of(x)
        by_cubic, by_line = knots.interpolate(k, x), np.interp(x, knots.x, knots.stick)
        # The cubic is right only where the edge is faster than the waves.
        return np.where(knots.outruns_waves(k), by_cubic, by_line)

    def _exact_stick_time(self, x: np.ndarray, knots: Knots | None = None) -> np.ndarray:
        """Return the exact stick times of positions; NaN if a block does not stick.

        Between knots (by default those of this part) where the edge is faster than the waves, stick
        times are found from the interpolated times. Elsewhere stick times are searched from the
        release on, which takes longer.
        """
        knots = knots or self.knots
        if knots.x.size < 2:
            return self.find_stick_times(x)
        # The interval between two knots that contains each position.
        k = knots.interval_of(x)
        is_between_knots = (x >= knots.x[0]) & (x <= knots.x[-1])
        stick_times = self._stick_times_by_newton(
            knots, x=x, k=k, is_requested=is_between_knots & knots.outruns_waves(k)
        )
        # Between two knots that slide at the final time, a position with positive du/dt at this
        # time has not stuck before.
        slides = np.flatnonzero(is_between_knots & knots.has_end_kinds(k, SLIDING, SLIDING))
        slides = slides[self._velocity_at_end(x[slides]) > 0.0]
        unknown = np.setdiff1d(np.flatnonzero(~np.isfinite(stick_times)), slides)
        stick_times[unknown] = self.find_stick_times(x[unknown])
        return np.where(stick_times <= self.until, stick_times, np.nan)

    def _stick_times_by_newton(
        self, knots: Knots, x: np.ndarray, k: np.ndarray, is_requested: np.ndarray
    ) -> np.ndarray:
        """Return the stick times of positions x in the intervals k, by Newton's method for du/dt.

        The method starts from the interpolated stick times. The result is NaN where no stick time
        is requested, and where the steps lead too far away from the interpolated time.
        """
        length = knots.x[k + 1] - knots.x[k]
        fraction = (x - knots.x[k]) / length
        guess = knots.interpolate(k, x)
        # The first step uses the acceleration at the stick, interpolated between the knots.
        at_knots = knots.velocity_by_xi + knots.velocity_by_eta
        acceleration = at_knots[k] * (1.0 - fraction) + at_knots[k + 1] * fraction
        stick_times, time = np.full(x.shape, np.nan), guess.copy()
        velocity, step = np.zeros(x.shape), np.zeros(x.shape)
        # Numbers of the positions whose stick times are not found yet.
        missing = np.flatnonzero(is_requested)
        for _ in range(MAX_NEWTON_STEPS):
            if not missing.size:
                break
            # Before the first step, both are 0. This step has no secant.
            velocity_before, step_before = velocity[missing], step[missing]
            velocity[missing] = self.velocity(x[missing], time[missing])
            # In the next steps the acceleration is replaced by the secant, the change of velocity
            # divided by the last step, unless this step was tiny.
            secant = velocity_before - velocity[missing]
            secant /= np.where(step_before == 0.0, np.nan, step_before)
            has_secant = np.abs(step_before) > NEWTON_TOLERANCE
            acceleration[missing] = np.where(has_secant, secant, acceleration[missing])
            step[missing] = velocity[missing] / acceleration[missing]
            time[missing] -= step[missing]
            # A time that is far from the interpolated one may belong to another zero of du/dt.
            is_near = np.abs(time[missing] - guess[missing]) <= MAX_CORRECTION * length[missing]
            # The search also ends if the next step will be tiny. Its size is about the product of
            # the last two steps. After the first step, the size of this step is used instead.
            step_size = np.abs(step[missing])
            next_size = step_size * np.where(step_before == 0.0, 1.0, np.abs(step_before))
            is_tiny = step_size < NEWTON_TOLERANCE
            is_next_tiny = next_size < NEXT_STEP_TOLERANCE * length[missing]
            is_found = is_near & (is_tiny | is_next_tiny)
            stick_times[missing[is_found]] = time[missing[is_found]]
            missing = missing[is_near & ~is_found]
        return stick_times

    def slow_points(self) -> list[Point]:
        """Return the points where the trailing edge is not faster than the waves.

        These points are the knots just before a jump of the edge, the knots of the kind
        SLOWER_THAN_WAVES, and the points where a front has stopped and no fast edge begins.
        """
        knots = self.knots
        k = np.arange(knots.x.size - 1)
        before_jumps = knots.ends_before_jumps(k[knots.has_jump(k)])
        slow = np.union1d(before_jumps, np.flatnonzero(knots.kind == SLOWER_THAN_WAVES))
        slow = np.union1d(slow, self._stops_without_edge()).astype(int)
        return [Point(float(knots.x[k]), float(knots.stick[k])) for k in slow]

    def _stops_without_edge(self) -> list[int]:
        """Return the numbers of the outermost knots where a front stops and no fast edge begins.

        The slip next to a stopped front is too brief to show the edge (knots of the kind
        BRIEF_SLIP). No fast edge begins there if the nearest other knot sticks so much later that
        the edge takes longer than a wave to it.
        """
        knots = self.knots
        not_brief = np.flatnonzero(knots.kind != BRIEF_SLIP)
        if not not_brief.size:
            return []
        stops = []
        left_time, right_time = self.curve.edge_times[[0, -1]]
        left_side = (0, not_brief[0], left_time)
        right_side = (knots.x.size - 1, not_brief[-1], right_time)
        for outermost, nearest, time_of_front in (left_side, right_side):
            distance = abs(knots.x[nearest] - knots.x[outermost])
            delay = abs(knots.stick[nearest] - knots.stick[outermost])
            # A front that still moves at the final time has not stopped.
            still_moves = time_of_front >= self.until
            has_stopped = knots.kind[outermost] == BRIEF_SLIP and not still_moves
            if has_stopped and delay > distance * (1.0 + EQUALITY_TOLERANCE):
                stops.append(outermost)
        return stops

    def first_stick(self) -> FirstStick | None:
        """Return where and when something first sticks; None if nothing does before the end."""
        first = self._first_at_knots()
        # The knots need not show the first stick. Positions between them that have stuck earlier
        # become knots too, until there are none.
        while first:
            x = self._positions_stuck_earlier(first)
            if not x.size:
                break
            stick_times = self.find_stick_times(x, until=first.time)
            self.knots = self._with_more_knots(self.knots, x, stick_times)
            first = self._first_at_knots()
        return first

    def _first_at_knots(self) -> FirstStick | None:
        """Return where and when something first sticks, as far as the knots show it.

        The first stick is at a knot, or at a minimum of the trailing edge between two knots. The
        result is None if no knot sticks.
        """
        knots = self.knots
        has_stuck = knots.kind != SLIDING
        if not has_stuck.any():
            return None
        # The stick time of a knot may be later than computed, by its error. So several knots may
        # stick first. The one nearest to x = 0 is chosen, so that rounding does not decide.
        error = self._stick_time_errors()
        latest_stick = np.where(has_stuck, knots.stick + error, np.inf)
        may_be_first = np.flatnonzero(latest_stick <= np.min(latest_stick) + 1e-10)
        nearest = int(may_be_first[np.argmin(np.abs(knots.x[may_be_first]))])
        first = FirstStick(float(knots.stick[nearest]), float(knots.x[nearest]))
        # In an interval nothing sticks before this time, since the edge is faster than the waves,
        # whose speed is 1.
        earliest = np.minimum(knots.stick[:-1], knots.stick[1:]) - 0.5 * np.diff(knots.x)
        may_contain_first = self._may_have_minimum(error) & (earliest < first.time)
        for k in np.flatnonzero(may_contain_first).tolist():
            minimum = self._minimum_between(float(knots.x[k]), float(knots.x[k + 1]))
            # A difference that is a rounding error does not count.
            if minimum and minimum.time < first.time - ROUNDING_ERROR:
                first = minimum
        return first

    def _stick_time_errors(self) -> np.ndarray:
        """Return the errors of the stick times of knots, 0 where they are negligible.

        An error is the rounding error of du/dt, divided by the rate at which du/dt falls through 0.
        """
        knots = self.knots
        deceleration = np.abs(knots.velocity_by_xi + knots.velocity_by_eta)
        # A slip is brief only next to the point where a front has stopped. The stick time of a
        # brief slip is the time at which the front arrives, which has no such error.
        deceleration = np.where(knots.kind == BRIEF_SLIP, np.inf, deceleration)
        error = VELOCITY_ERROR / np.maximum(deceleration, ROUNDING_ERROR)
        error[error < TIME_ERROR] = 0.0
        return error

    def _may_have_minimum(self, error: np.ndarray) -> np.ndarray:
        """Return a mask of the intervals between knots in which the edge may have a minimum.

        Stick times fall from both ends towards the inside of such an interval, and at least one end
        sticks before the final time. Intervals are left out if the stick time at an end has an
        error (an element of ``error``).
        """
        knots = self.knots
        k = np.arange(knots.x.size - 1)
        falls_inwards = (knots.slope[:-1] < 0.0) & (knots.slope[1:] > 0.0)
        is_fast = knots.outruns_waves(k) | knots.has_end_kinds(k, FASTER_THAN_WAVES, SLIDING)
        is_certain = (error[:-1] == 0.0) & (error[1:] == 0.0)
        return falls_inwards & is_fast & is_certain

    def _positions_stuck_earlier(self, first: FirstStick) -> np.ndarray:
        """Return positions between knots that have stuck before the first stick that is known.

        Such positions are searched in each interval where a stick before this time is possible.
        """
        knots, curve = self.knots, self.curve
        # A stick between two knots makes both of them stick, at the latest when waves from it
        # arrive there. The travel times of these waves add up to the length of the interval. So the
        # stick is not earlier than this time.
        earliest = 0.5 * (knots.stick[:-1] + knots.stick[1:] - np.diff(knots.x))
        is_released = curve.arrival(knots.x) < first.time
        is_partly_released = is_released[:-1] | is_released[1:]
        left_ends: list[float] = []
        right_ends: list[float] = []
        for k in np.flatnonzero((earliest < first.time) & is_partly_released):
            # If a front is in this interval at the time, only its released part is examined.
            left, right = knots.x[k : k + 2].tolist()
            if not is_released[k]:
                left = curve.front_at(first.time, right, side=-1.0)
            if not is_released[k + 1]:
                right = curve.front_at(first.time, left, side=1.0)
            # If the first stick lies in this interval, both sides of it are examined.
            inner = [first.x] if left < first.x < right else []
            left_ends += [left, *inner]
            right_ends += [*inner, right]
        x = np.array([left_ends, right_ends])
        return stuck_between(self, x=x, time=first.time, first_x=first.x)

    def _minimum_between(self, left: float, right: float) -> FirstStick | None:
        """Return the minimum of the trailing edge between two positions.

        The result is None if the edge does not fall into the interval from both ends.
        """

        def edge_slope(position: float) -> float:
            """Return the slope of the trailing edge at a position."""
            x = np.array([position])
            return float(self._make_knots(x, self._exact_stick_time(x)).slope[0])

        # If the edge falls only by rounding errors, one of the two positions is the minimum.
        if not edge_slope(left) < 0.0 < edge_slope(right):
            return None
        x = root_between(edge_slope, left, right, xtol=NEWTON_TOLERANCE)
        return FirstStick(float(self._exact_stick_time(np.array([x]))[0]), x)
