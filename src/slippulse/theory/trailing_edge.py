"""The trailing edge of one part of a rupture: when each position sticks, and the first that does.

The trailing edge is the first zero in time of du/dt, as long as it runs faster than the waves:
where du/dt falls along both characteristics, by xi = t - y and by eta = t + y. Then no stuck point
lies in the past of a sliding one, and Riemann's formula holds up to sticking. The stress of a block
that has stuck is then d2u/dt2 (1 - (dt/dx)^2) < 0, with the acceleration just before, so that no
block is ever released again.

The edge is known at knots: at the panels of the curve, and on both sides of where waves from its
marks meet the edge, then halfway between knots as long as these do not predict what is found there.
No stick lies unseen between two positions that slide at a time: what sticks grows to both sides
faster than the waves, so what neither has felt has begun in the triangle between them and the point
from which their characteristics went apart. There du/dt is bounded (`lower_bound`): intervals that
slide at the end, or when the first position sticks, are halved until the bound is above 0.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..model.roots import root_between
from .curve import SAME, Point
from .lower_bound import stuck_between
from .part import Part
from .vector_roots import roots_between

# Stick times halfway between knots are predicted to this fraction of the interval, their slopes to
# this.
PREDICTED, PREDICTED_SLOPE = 1e-5, 0.05
# The shortest interval that is halved, and the time below which sliding is brief, in units of
# `Part.scale`; and the shortest interval in which the edge reaches the end, or a stopped front.
SHORTEST, AT_END = 1e-3, 0.01
# Distance of knots from where a wave from a mark meets the edge, in units of `Part.scale`.
LANDED = 1e-5
# Panels of the curve give one knot at most in a cell of this length, in units of `Part.scale`.
CELL = 0.1
# Where the edge changes its kind or jumps is located to this fraction of the part, in intervals
# that are cut into CUTS pieces.
LOCATED, CUTS = 1e-10, 8
# So many intervals are looked at once: stick times beyond a limit may be ragged on any grid.
MOST = 5_000
# Where in its interval an edge that is nearly slow is looked at, apart from halfway.
SHIFTED = 0.382
# Size of Newton's last step to a stick time, and of the next one, about the product of the last
# two, in units of the interval.
STEP, NEXT_STEP = 1e-11, 1e-14
# Stick times that differ by less are equal, and slip velocities below this are 0.
ROUNDING = 1e-12
# Kinds of a knot: it slides at the end; it has stuck, where the edge outruns the waves or not; or
# it slid too briefly to tell, next to the point where a slow front has stopped.
SLIDES, FAST, SLOW, BRIEF = range(4)


class FirstStick(NamedTuple):
    """Time and position of the first sticking."""

    time: float
    x: float


class Knots(NamedTuple):
    """Positions, stick times (the end for none), kinds, and du/dt and its slopes by xi and eta.

    Interval k lies between the knots k and k + 1.
    """

    x: np.ndarray
    stick: np.ndarray
    kind: np.ndarray
    velocity: np.ndarray
    by_xi: np.ndarray
    by_eta: np.ndarray

    @property
    def pace(self) -> np.ndarray:
        """Derivative of the stick time by position."""
        fall = self.by_xi + self.by_eta
        return (self.by_xi - self.by_eta) / np.where(fall == 0.0, np.nan, fall)

    def joined(self, other: "Knots") -> "Knots":
        """These knots and others, in order."""
        _, first = np.unique(np.append(self.x, other.x), return_index=True)
        return Knots._make(np.append(a, b)[first] for a, b in zip(self, other, strict=True))

    def interval(self, x: np.ndarray) -> np.ndarray:
        """The interval of each position, the nearest one beyond the knots."""
        k = np.searchsorted(self.x, x, side="right") - 1
        return np.clip(k, 0, self.x.size - 2)

    @property
    def sliding(self) -> np.ndarray:
        """Ends [left and right, interval] of the intervals that slide at the end."""
        k = np.arange(self.x.size - 1)
        k = k[self.of_kinds(k, SLIDES, SLIDES)]
        return self.x[np.array([k, k + 1])]

    @property
    def nearly_slow(self) -> np.ndarray:
        """Positions in the intervals whose edge, if it turns on as it does, may become slow."""
        k = np.arange(self.x.size - 1)
        pace = np.abs([self.pace[:-1], self.pace[1:]])
        k = k[self.outruns(k) & (pace.max(axis=0) + np.abs(np.diff(self.pace)) > 1.0)]
        return self.x[k] + SHIFTED * (self.x[k + 1] - self.x[k])

    def of_kinds(self, k: np.ndarray, one: int, other: int) -> np.ndarray:
        """Mask of the intervals whose two ends have these kinds in any order."""
        left, right = self.kind[k], self.kind[k + 1]
        return ((left == one) & (right == other)) | ((left == other) & (right == one))

    def outruns(self, k: np.ndarray) -> np.ndarray:
        """Mask of the intervals in which the edge outruns the waves."""
        return self.of_kinds(k, FAST, FAST) & ~self.jumps(k)

    def brief(self, k: np.ndarray) -> np.ndarray:
        """Mask of the intervals with an end that slid too briefly."""
        return (self.kind[k] == BRIEF) | (self.kind[k + 1] == BRIEF)

    def jumps(self, k: np.ndarray) -> np.ndarray:
        """Mask of the intervals in which the edge jumps, or changes from fast to slow."""
        change = np.abs(self.stick[k + 1] - self.stick[k])
        steep = change >= (self.x[k + 1] - self.x[k]) * (1.0 + SAME)
        told = ~self.brief(k) & ~self.of_kinds(k, SLOW, SLOW)
        return (steep & told) | self.of_kinds(k, FAST, SLOW)

    def fast_ends(self, k: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Knots at which the edge last outruns the waves before it jumps, and lengths of jumps."""
        k = k[self.jumps(k)]
        left, right = self.kind[k], self.kind[k + 1]
        # The edge ends at the earlier of two knots, unless only the other one outruns the waves.
        right_first = self.stick[k] >= self.stick[k + 1]
        at_right = np.where(left == right, right_first, right == FAST)
        return np.where(at_right, k + 1, k), self.x[k + 1] - self.x[k]

    def stick_between(self, k: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Stick times by cubics in intervals."""
        span = self.x[k + 1] - self.x[k]
        s = (x - self.x[k]) / span
        bow = span * ((1.0 - s) * self.pace[k] - s * self.pace[k + 1])
        rise = self.stick[k + 1] - self.stick[k]
        return self.stick[k] + s**2 * (3.0 - 2.0 * s) * rise + s * (1.0 - s) * bow

    def predict(self, k: np.ndarray, middle: "Knots") -> np.ndarray:
        """Mask of the intervals whose ends predict the knot in the middle."""
        one_kind = (self.kind[k] == middle.kind) & (self.kind[k + 1] == middle.kind)
        half = middle.x - self.x[k]
        slope = 0.75 * (self.stick[k + 1] - self.stick[k]) / half
        slope -= 0.25 * (self.pace[k] + self.pace[k + 1])
        near = np.abs(middle.stick - self.stick_between(k, middle.x)) <= 2.0 * PREDICTED * half
        # The closer the edge is to the speed of the waves, the less it may turn unseen.
        steepest = np.abs([self.pace[k], middle.pace, self.pace[k + 1]]).max(axis=0)
        near &= np.abs(middle.pace - slope) <= np.minimum(PREDICTED_SLOPE, 1.0 - steepest)
        return one_kind & (near | (middle.kind != FAST))


@dataclass
class TrailingEdge:
    """Stick times of a part, known at knots and found in between with their help."""

    part: Part

    @cached_property
    def knots(self) -> Knots:
        """The trailing edge at knots that predict it in between."""
        curve = self.part.curve
        left, right = curve.edges[[0, -1]]
        if self.part.one_side:
            left = max(left, 0.0)
        last = self.part.until * (1.0 - SAME)
        start = curve.edges[np.argmin(curve.edge_times)]
        fronts = [curve.front_at(last, start, side) for side in (-1.0, 1.0)]
        cell = np.floor(curve.edges / (CELL * self.part.scale))
        edges = curve.edges[np.diff(cell, prepend=-np.inf) > 0.0]
        x = np.unique([left, *edges, *self.part.marks, *fronts])
        x = x[(x >= left) & (x <= right) & (curve.arrival(x) < self.part.until)]
        x = x[np.diff(x, append=np.inf) > SAME * (right - left)]
        # Knots halfway are found together with the others, and as independently.
        halfway = 0.5 * (x[:-1] + x[1:])
        x = np.sort(np.append(x, halfway))
        knots = self._knots_of(x, self.part.search(x))
        if x.size < 2:
            return knots
        apart = Knots._make(values[::2] for values in knots)
        predicted = apart.predict(np.arange(halfway.size), Knots._make(v[1::2] for v in knots))
        again = ~np.repeat(predicted, 2)
        x, left = np.union1d(self._landings(knots), self._near_end(knots)), x[:-1][again]
        knots = self._with(knots, x, self.part.search(x), left)
        while (x := stuck_between(self.part, knots.sliding, self.part.until)).size:
            knots = self._with(knots, x, self.part.search(x))
        # Where the edge may turn slow between knots it is looked at once more, not halfway.
        x = knots.nearly_slow
        return self._with(knots, x, self.stick_time(x, knots)) if x.size else knots

    def _with(
        self, knots: Knots, x: np.ndarray, stick: np.ndarray, left: Sequence[float] = ()
    ) -> Knots:
        """Knots with some more, and as many as predict them and the intervals right of others."""
        todo = np.unique([*left, *x[x < knots.x[-1]], *knots.x[knots.interval(x)]])
        knots = knots.joined(self._knots_of(x, stick))
        while 0 < todo.size < MOST:
            knots, todo = self._refined(knots, todo)
        return knots

    def _knots_of(self, x: np.ndarray, stick: np.ndarray) -> Knots:
        part, sticks = self.part, np.isfinite(stick)
        time = np.where(sticks, stick, part.until)
        past = part.past(x, time)
        velocity = np.zeros(x.size) if sticks.all() else past.slip_velocity()
        velocity[sticks] = 0.0
        by_xi, by_eta = past.velocity_slopes()
        slow = (by_xi >= 0.0) | (by_eta >= 0.0)
        kind = np.where(sticks, np.where(slow, SLOW, FAST), SLIDES)
        kind[sticks & (time - part.curve.arrival(x) <= SHORTEST * part.scale)] = BRIEF
        return Knots(x, time, kind, velocity, by_xi, by_eta)

    def _landings(self, knots: Knots) -> np.ndarray:
        """Positions on both sides of those where waves from the marks meet the trailing edge."""
        marks = np.array(self.part.marks)
        arrival = self.part.curve.arrival(marks)
        out, near = [], LANDED * self.part.scale
        for side in (-1.0, 1.0):
            phase = (knots.stick - side * knots.x)[:, None] - (arrival - side * marks)
            fast = knots.outruns(np.arange(knots.x.size - 1))[:, None]
            k, mark = np.nonzero((phase[1:] * phase[:-1] < 0.0) & fast)
            before, after = phase[k, mark], phase[k + 1, mark]
            left, right = knots.x[k], knots.x[k + 1]
            x = left + (right - left) * before / (before - after)
            for _ in range(2 if x.size else 0):
                time = arrival[mark] + side * (x - marks[mark])
                past = self.part.past(x, time)
                x = x - 0.5 * side * past.slip_velocity() / past.velocity_slopes()[side > 0.0]
                x = x.clip(left, right)
            # The edge has a kink there.
            out.append(np.clip([x - near, x + near], left, right).ravel())
        return np.concatenate(out)

    def _velocity_at_end(self, x: np.ndarray, which: np.ndarray | None = None) -> np.ndarray:
        return self.part.velocity(x, np.full(x.size, self.part.until))

    def _near_end(self, knots: Knots) -> np.ndarray:
        """Positions on both sides of those where the trailing edge reaches the end."""
        k = np.arange(knots.x.size - 1)
        k = k[knots.of_kinds(k, FAST, SLIDES)]
        velocity = np.array([self._velocity_at_end(knots.x[ends]) for ends in (k, k + 1)])
        meets = velocity[0] * velocity[1] < 0.0
        at_left, at_right = velocity[:, meets]
        left, right = knots.x[k[meets]], knots.x[k[meets] + 1]
        near = 0.4 * AT_END * self.part.scale
        x = roots_between(self._velocity_at_end, left, right, at_left, at_right, xtol=0.5 * near)
        return np.clip([x - near, x + near], left, right).ravel()

    def _refined(self, knots: Knots, left: np.ndarray) -> tuple[Knots, np.ndarray]:
        """More knots in some intervals, and the left ends of the intervals to look at next."""
        k = np.searchsorted(knots.x, left)
        # Nothing is known in the future of a jump, wherever it is in its interval.
        ends, lengths = knots.fast_ends(k)
        sides = np.array([k, k + 1])[..., None]
        earliest = knots.stick[sides] - np.abs(knots.x[sides] - knots.x[ends])
        k = k[(earliest.min(axis=0) < knots.stick[ends] + 2.0 * lengths).all(axis=1)]
        jumps, at_end = knots.jumps(k), knots.of_kinds(k, FAST, SLIDES)
        size, scale = self.part.curve.edges[-1] - self.part.curve.edges[0], self.part.scale
        short = np.full(k.size, SHORTEST * scale)
        short[at_end | knots.brief(k)] = AT_END * scale
        short[jumps] = LOCATED * size
        long = knots.x[k + 1] - knots.x[k] > short
        cut = k[long & (jumps | at_end)]
        halved = k[long & ~jumps & ~at_end]
        pieces = np.linspace(knots.x[cut], knots.x[cut + 1], CUTS + 1)[:-1]
        middle = 0.5 * (knots.x[halved] + knots.x[halved + 1])
        x = np.append(pieces[1:].ravel(), middle)
        if not x.size:
            return knots, x
        new = self._knots_of(x, self.stick_time(x, knots))
        in_middle = Knots._make(values[x.size - middle.size :] for values in new)
        surprise = ~knots.predict(halved, in_middle)
        halves = np.append(knots.x[halved], middle)
        refined, left = knots.joined(new), np.append(halves, pieces)
        k = np.searchsorted(refined.x, left)
        again = refined.jumps(k) | refined.of_kinds(k, FAST, SLIDES)
        again[: halves.size] = np.tile(surprise, 2)
        return refined, left[again]

    def about(self, x: np.ndarray) -> np.ndarray:
        """Stick times to a fraction of the distance of knots; the end for none."""
        knots = self.knots
        k = knots.interval(x)
        return np.where(
            knots.outruns(k), knots.stick_between(k, x), np.interp(x, knots.x, knots.stick)
        )

    def stick_time(self, x: np.ndarray, knots: Knots | None = None) -> np.ndarray:
        """Stick times at positions, with the help of knots; NaN where there is none."""
        knots = knots or self.knots
        if knots.x.size < 2:
            return self.part.search(x)
        k = knots.interval(x)
        inside = (x >= knots.x[0]) & (x <= knots.x[-1])
        out = self._between_knots(knots, x, k, inside & knots.outruns(k))
        # A position that slides at the end, as both knots do, has not stuck.
        slides = np.flatnonzero(inside & knots.of_kinds(k, SLIDES, SLIDES))
        slides = slides[self._velocity_at_end(x[slides]) > 0.0]
        unknown = np.setdiff1d(np.flatnonzero(~np.isfinite(out)), slides)
        out[unknown] = self.part.search(x[unknown])
        return np.where(out <= self.part.until, out, np.nan)

    def _between_knots(
        self, knots: Knots, x: np.ndarray, k: np.ndarray, wanted: np.ndarray
    ) -> np.ndarray:
        """Stick times by Newton's steps; NaN where not wanted, and where the steps go astray."""
        span = knots.x[k + 1] - knots.x[k]
        s = (x - knots.x[k]) / span
        guess = knots.stick_between(k, x)
        acceleration = knots.by_xi + knots.by_eta
        acceleration = acceleration[k] * (1.0 - s) + acceleration[k + 1] * s
        out, time = np.full(x.shape, np.nan), guess.copy()
        velocity, step = np.zeros(x.shape), np.zeros(x.shape)
        todo = np.flatnonzero(wanted)
        for _ in range(12):
            if not todo.size:
                break
            earlier, velocity[todo] = velocity[todo], self.part.velocity(x[todo], time[todo])
            last = step[todo]
            # Secants follow the first step.
            secant = (earlier - velocity[todo]) / np.where(last == 0.0, np.nan, last)
            acceleration[todo] = np.where(np.abs(last) > STEP, secant, acceleration[todo])
            step[todo] = velocity[todo] / acceleration[todo]
            time[todo] -= step[todo]
            good = np.abs(time[todo] - guess[todo]) <= 0.05 * span[todo]
            size, before = np.abs(step[todo]), np.where(last == 0.0, 1.0, np.abs(last))
            done = good & ((size < STEP) | (size * before < NEXT_STEP * span[todo]))
            out[todo[done]] = time[todo[done]]
            todo = todo[good & ~done]
        return out

    def slow_points(self) -> list[Point]:
        """Points of the trailing edge where it does not outrun the waves."""
        knots = self.knots
        ends, _ = knots.fast_ends(np.arange(knots.x.size - 1))
        slow = np.union1d(ends, np.flatnonzero(knots.kind == SLOW))
        points = np.stack([knots.x, knots.stick], axis=1)[slow].tolist()
        return [Point(*point) for point in points]

    def first_stick(self) -> FirstStick | None:
        """The first sticking; None where nothing sticks before the end."""
        first = self._first()
        # The knots may have missed one: then they become more.
        while first and (x := self._earlier(first)).size:
            self.knots = self._with(self.knots, x, self.part.search(x, first.time))
            first = self._first()
        return first

    def _first(self) -> FirstStick | None:
        """The first sticking that the knots show."""
        knots = self.knots
        stuck = knots.kind != SLIDES
        if not stuck.any():
            return None
        # The position nearest to x = 0 counts, of several that stick first.
        earliest = np.min(knots.stick[stuck])
        first = np.flatnonzero(stuck & (knots.stick <= earliest + 1e-10))
        nearest = int(first[np.argmin(np.abs(knots.x[first]))])
        out = FirstStick(float(knots.stick[nearest]), float(knots.x[nearest]))
        k = np.arange(knots.x.size - 1)
        # A minimum may lie in each interval at whose ends the edge, or du/dt, goes down into it.
        down = (knots.pace[:-1] < 0.0) & (knots.pace[1:] > 0.0)
        down &= knots.outruns(k) | knots.of_kinds(k, FAST, SLIDES)
        lowest = np.minimum(knots.stick[:-1], knots.stick[1:]) - 0.5 * np.diff(knots.x)
        for low in np.flatnonzero(down & (lowest < out.time)).tolist():
            minimum = self._minimum(*knots.x[[low, low + 1]].tolist())
            # Neither a kink nor an equal time is taken for a minimum.
            if minimum and minimum.time < out.time - ROUNDING:
                out = minimum
        return out

    def _earlier(self, first: FirstStick) -> np.ndarray:
        """Positions between the knots that have stuck before the first that the knots show."""
        knots, curve = self.knots, self.part.curve
        # What begins between two knots comes later than its waves may come to both.
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
        return stuck_between(self.part, x, first.time, first.x)

    def _minimum(self, left: float, right: float) -> FirstStick | None:
        """The first sticking between two positions, if the edge goes down into the interval."""

        def pace(position: float) -> float:
            x = np.array([position])
            return float(self._knots_of(x, self.stick_time(x)).pace[0])

        # Where rounding alone says that it does, the knot itself is the minimum.
        if not pace(left) < 0.0 < pace(right):
            return None
        x = root_between(pace, left, right, xtol=STEP)
        return FirstStick(float(self.stick_time(np.array([x]))[0]), x)
