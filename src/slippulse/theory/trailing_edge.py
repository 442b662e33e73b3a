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
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..model.roots import root_between
from .curve import SAME, Point
from .knots import BRIEF, FAST, SLIDES, SLOW, Knots
from .lower_bound import stuck_between
from .part import Part
from .vector_roots import roots_between

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
# An interval as long as this, in units of LOCATED, has at most one jump.
FAR_APART = 1e3
# Size of Newton's last step to a stick time, and of the next one, about the product of the last
# two, in units of the interval.
STEP, NEXT_STEP = 1e-11, 1e-14
# Stick times that differ by less are equal, and slip velocities below this are 0.
ROUNDING = 1e-12
# Error of du/dt, and the error of a stick time above which another knot counts as the first: next
# to where a slow front has stopped du/dt hardly falls through 0.
VELOCITY_ERROR, TIME_ERROR = 1e-11, 1e-9


class FirstStick(NamedTuple):
    """Time and position of the first sticking."""

    time: float
    x: float


class EdgedPart(Part):
    """A connected part whose stick times are known at knots, and found in between by their help."""

    @cached_property
    def knots(self) -> Knots:
        """The trailing edge at knots that predict it in between."""
        curve = self.curve
        left, right = curve.edges[[0, -1]]
        if self.one_side:
            left = max(left, 0.0)
        last = self.until * (1.0 - SAME)
        start = curve.edges[np.argmin(curve.edge_times)]
        fronts = [curve.front_at(last, start, side) for side in (-1.0, 1.0)]
        cell = np.floor(curve.edges / (CELL * self.scale))
        edges = curve.edges[np.diff(cell, prepend=-np.inf) > 0.0]
        x = np.unique([left, *edges, *self.marks, *fronts])
        x = x[(x >= left) & (x <= right) & (curve.arrival(x) < self.until)]
        x = x[np.diff(x, append=np.inf) > SAME * (right - left)]
        # Knots halfway are found together with the others, and as independently.
        halfway = 0.5 * (x[:-1] + x[1:])
        x = np.sort(np.append(x, halfway))
        knots = self._knots_of(x, self.search(x))
        if x.size < 2:
            return knots
        apart = Knots._make(values[::2] for values in knots)
        predicted = apart.predict(np.arange(halfway.size), Knots._make(v[1::2] for v in knots))
        again = ~np.repeat(predicted, 2)
        x, left = np.union1d(self._landings(knots), self._near_end(knots)), x[:-1][again]
        knots = self._with(knots, x, self.search(x), left)
        while (x := stuck_between(self, knots.sliding, self.until)).size:
            knots = self._with(knots, x, self.search(x))
        # Where the edge may turn slow between knots it is looked at once more, not halfway.
        x = knots.nearly_slow
        return self._with(knots, x, self._stick_time(x, knots)) if x.size else knots

    def _with(
        self, knots: Knots, x: np.ndarray, stick: np.ndarray, left: Sequence[float] = ()
    ) -> Knots:
        """Knots with some more, and as many as predict them and the intervals right of others."""
        todo = np.unique([*left, *x[x < knots.x[-1]], *knots.x[knots.interval(x)]])
        knots = knots.joined(self._knots_of(x, stick))
        while todo.size:
            knots, todo = self._refined(knots, todo)
        return knots

    def _knots_of(self, x: np.ndarray, stick: np.ndarray) -> Knots:
        sticks = np.isfinite(stick)
        time = np.where(sticks, stick, self.until)
        past = self.past(x, time)
        velocity = np.zeros(x.size) if sticks.all() else past.slip_velocity()
        velocity[sticks] = 0.0
        by_xi, by_eta = past.velocity_slopes()
        slow = (by_xi >= 0.0) | (by_eta >= 0.0)
        kind = np.where(sticks, np.where(slow, SLOW, FAST), SLIDES)
        kind[sticks & (time - self.curve.arrival(x) <= SHORTEST * self.scale)] = BRIEF
        return Knots(x, time, kind, velocity, by_xi, by_eta)

    def _landings(self, knots: Knots) -> np.ndarray:
        """Positions on both sides of those where waves from the marks meet the trailing edge."""
        marks = np.array(self.marks)
        arrival = self.curve.arrival(marks)
        out, near = [], LANDED * self.scale
        for side in (-1.0, 1.0):
            phase = (knots.stick - side * knots.x)[:, None] - (arrival - side * marks)
            fast = knots.outruns(np.arange(knots.x.size - 1))[:, None]
            k, mark = np.nonzero((phase[1:] * phase[:-1] < 0.0) & fast)
            before, after = phase[k, mark], phase[k + 1, mark]
            left, right = knots.x[k], knots.x[k + 1]
            x = left + (right - left) * before / (before - after)
            for _ in range(2 if x.size else 0):
                time = arrival[mark] + side * (x - marks[mark])
                past = self.past(x, time)
                x = x - 0.5 * side * past.slip_velocity() / past.velocity_slopes()[side > 0.0]
                x = x.clip(left, right)
            # The edge has a kink there.
            out.append(np.clip([x - near, x + near], left, right).ravel())
        return np.concatenate(out)

    def _velocity_at_end(self, x: np.ndarray, which: np.ndarray | None = None) -> np.ndarray:
        return self.velocity(x, np.full(x.size, self.until))

    def _near_end(self, knots: Knots) -> np.ndarray:
        """Positions on both sides of those where the trailing edge reaches the end."""
        k = np.arange(knots.x.size - 1)
        k = k[knots.of_kinds(k, FAST, SLIDES)]
        velocity = np.array([self._velocity_at_end(knots.x[ends]) for ends in (k, k + 1)])
        meets = velocity[0] * velocity[1] < 0.0
        at_left, at_right = velocity[:, meets]
        left, right = knots.x[k[meets]], knots.x[k[meets] + 1]
        near = 0.4 * AT_END * self.scale
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
        size, scale = self.curve.edges[-1] - self.curve.edges[0], self.scale
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
        new = self._knots_of(x, self._stick_time(x, knots))
        in_middle = Knots._make(values[x.size - middle.size :] for values in new)
        surprise = ~knots.predict(halved, in_middle)
        halves = np.append(knots.x[halved], middle)
        refined, left = knots.joined(new), np.append(halves, pieces)
        k = np.searchsorted(refined.x, left)
        # A jump is in one of the pieces: where all of them are steep, the edge is slow, though its
        # slopes say that it just outruns the waves.
        parted, far_apart = k[halves.size :].reshape(CUTS, -1), FAR_APART * LOCATED * size
        slow = refined.jumps(parted).all(axis=0) & (pieces[1] - pieces[0] > far_apart)
        refined.kind[parted[:, slow]] = refined.kind[parted[-1, slow] + 1] = SLOW
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

    def _stick_time(self, x: np.ndarray, knots: Knots | None = None) -> np.ndarray:
        """Stick times at positions, with the help of knots; NaN where there is none."""
        knots = knots or self.knots
        if knots.x.size < 2:
            return self.search(x)
        k = knots.interval(x)
        inside = (x >= knots.x[0]) & (x <= knots.x[-1])
        out = self._between_knots(knots, x, k, inside & knots.outruns(k))
        # A position that slides at the end, as both knots do, has not stuck.
        slides = np.flatnonzero(inside & knots.of_kinds(k, SLIDES, SLIDES))
        slides = slides[self._velocity_at_end(x[slides]) > 0.0]
        unknown = np.setdiff1d(np.flatnonzero(~np.isfinite(out)), slides)
        out[unknown] = self.search(x[unknown])
        return np.where(out <= self.until, out, np.nan)

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
            earlier, velocity[todo] = velocity[todo], self.velocity(x[todo], time[todo])
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
        slow = np.union1d(slow, self._undone_stops()).astype(int)
        points = np.stack([knots.x, knots.stick], axis=1)[slow].tolist()
        return [Point(*point) for point in points]

    def _undone_stops(self) -> list[int]:
        """Knots where a front stops, but no trailing edge that outruns the waves begins."""
        knots, told = self.knots, np.flatnonzero(self.knots.kind != BRIEF)
        undone = []
        for end, nearest in ((0, told[:1]), (-1, told[-1:])):
            # A front that goes on at the end has not stopped.
            stopped = knots.kind[end] == BRIEF and self.curve.edge_times[end] < self.until
            if stopped and nearest.size:
                distance = abs((knots.x[nearest] - knots.x[end]).item())
                delay = abs((knots.stick[nearest] - knots.stick[end]).item())
                if delay > distance * (1.0 + SAME):
                    undone.append(end % knots.x.size)
        return undone

    def first_stick(self) -> FirstStick | None:
        """The first sticking; None where nothing sticks before the end."""
        first = self._first()
        # The knots may have missed one: then they become more.
        while first and (x := self._earlier(first)).size:
            self.knots = self._with(self.knots, x, self.search(x, first.time))
            first = self._first()
        return first

    def _first(self) -> FirstStick | None:
        """The first sticking that the knots show."""
        knots = self.knots
        stuck = knots.kind != SLIDES
        if not stuck.any():
            return None
        # The stick time of a front that has stopped is that of the front itself.
        fall = np.where(knots.kind == BRIEF, np.inf, np.abs(knots.by_xi + knots.by_eta))
        error = VELOCITY_ERROR / np.maximum(fall, ROUNDING)
        error[error < TIME_ERROR] = 0.0
        # The position nearest to x = 0 counts, of several that stick first.
        latest = np.where(stuck, knots.stick + error, np.inf)
        first = np.flatnonzero(latest <= np.min(latest) + 1e-10)
        nearest = int(first[np.argmin(np.abs(knots.x[first]))])
        out = FirstStick(float(knots.stick[nearest]), float(knots.x[nearest]))
        k = np.arange(knots.x.size - 1)
        # A minimum may lie in each interval at whose ends the edge, or du/dt, goes down into it.
        down = (knots.pace[:-1] < 0.0) & (knots.pace[1:] > 0.0)
        down &= knots.outruns(k) | knots.of_kinds(k, FAST, SLIDES)
        down &= error[:-1] + error[1:] == 0.0
        lowest = np.minimum(knots.stick[:-1], knots.stick[1:]) - 0.5 * np.diff(knots.x)
        for low in np.flatnonzero(down & (lowest < out.time)).tolist():
            minimum = self._minimum(*knots.x[[low, low + 1]].tolist())
            # Neither a kink nor an equal time is taken for a minimum.
            if minimum and minimum.time < out.time - ROUNDING:
                out = minimum
        return out

    def _earlier(self, first: FirstStick) -> np.ndarray:
        """Positions between the knots that have stuck before the first that the knots show."""
        knots, curve = self.knots, self.curve
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
        return stuck_between(self, x, first.time, first.x)

    def _minimum(self, left: float, right: float) -> FirstStick | None:
        """The first sticking between two positions, if the edge goes down into the interval."""

        def pace(position: float) -> float:
            x = np.array([position])
            return float(self._knots_of(x, self._stick_time(x)).pace[0])

        # Where rounding alone says that it does, the knot itself is the minimum.
        if not pace(left) < 0.0 < pace(right):
            return None
        x = root_between(pace, left, right, xtol=STEP)
        return FirstStick(float(self._stick_time(np.array([x]))[0]), x)
