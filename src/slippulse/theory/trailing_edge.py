"""The trailing edge of one part of a rupture: when each position sticks, and the first that does.

The trailing edge is the first zero in time of du/dt, as long as it runs faster than the waves:
where du/dt falls along both characteristics, by xi = t - y and by eta = t + y. Then no stuck point
lies in the past of a sliding one, and Riemann's formula holds up to sticking. The stress of a block
that has stuck is then d2u/dt2 (1 - (dt/dx)^2) < 0, with the acceleration just before, so that no
block is ever released again.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..model.roots import root_between
from .curve import SAME, Point

if TYPE_CHECKING:
    from .part import Part

# Number of positions at which stick times are searched without help from others.
GRID = 192
# Error of Newton's last step to a stick time.
STEP = 1e-11
# Stick times that differ by less are equal.
ROUNDING = 1e-12


class FirstStick(NamedTuple):
    """Time and position of the first sticking."""

    time: float
    x: float


class Knots(NamedTuple):
    """Positions, stick times (NaN for none), and the derivatives of du/dt by xi and eta then."""

    x: np.ndarray
    stick: np.ndarray
    by_xi: np.ndarray
    by_eta: np.ndarray

    @property
    def stuck(self) -> np.ndarray:
        """Mask of the positions that have stuck."""
        return np.isfinite(self.stick)

    @property
    def pace(self) -> np.ndarray:
        """Derivative of the stick time by position."""
        return (self.by_xi - self.by_eta) / (self.by_xi + self.by_eta)


@dataclass
class TrailingEdge:
    """Stick times of a part, known at knots and found in between with their help."""

    part: "Part"

    @cached_property
    def knots(self) -> Knots:
        """The trailing edge on a grid that holds the marks of the part."""
        curve, count = self.part.curve, GRID * self.part.refinement
        left, right = curve.edges[[0, -1]]
        if self.part.one_side:
            left, count = max(left, 0.0), count // 2
        grid = np.linspace(left, right, count + 1)
        marks = np.array(self.part.marks)
        marks = marks[(marks >= left) & (marks <= right)]
        distance = np.abs(grid[:, None] - marks).min(axis=1, initial=np.inf)
        x = np.union1d(grid[distance > SAME * (right - left)], marks)
        x = x[curve.arrival(x) < self.part.until]
        return self._knots_at(x, self.part.search(x))

    def _knots_at(self, x: np.ndarray, stick: np.ndarray) -> Knots:
        slopes = np.full((2, x.size), np.nan)
        stuck = np.isfinite(stick)
        if stuck.any():
            slopes[:, stuck] = self.part.past(x[stuck], stick[stuck]).velocity_slopes()
        return Knots(x, stick, *slopes)

    def stick_time(self, x: np.ndarray) -> np.ndarray:
        """Stick times at positions; NaN where there is none before the end."""
        knots, until = self.knots, self.part.until
        if knots.x.size < 2:
            return self.part.search(x)
        k = np.clip(np.searchsorted(knots.x, x, side="right") - 1, 0, knots.x.size - 2)
        inside = (x >= knots.x[0]) & (x <= knots.x[-1])
        stuck, pace = knots.stuck, np.abs(knots.pace)
        both = inside & stuck[k] & stuck[k + 1] & (np.maximum(pace[k], pace[k + 1]) < 1.0)
        out = self._between_knots(x, k, both)
        # A position that slides at the end, as both knots do, has not stuck.
        slides = np.flatnonzero(inside & ~stuck[k] & ~stuck[k + 1])
        slides = slides[self.part.velocity(x[slides], np.full(slides.size, until)) > 0.0]
        unknown = np.setdiff1d(np.flatnonzero(~np.isfinite(out)), slides)
        out[unknown] = self.part.search(x[unknown])
        return np.where(out <= until, out, np.nan)

    def _between_knots(self, x: np.ndarray, k: np.ndarray, wanted: np.ndarray) -> np.ndarray:
        """Stick times by Newton's steps; NaN where not wanted, and where the steps go astray.

        The steps start from the cubic with the stick times and slopes of the knots k and k + 1.
        """
        knots = self.knots
        span = knots.x[k + 1] - knots.x[k]
        s = (x - knots.x[k]) / span
        stick, pace = knots.stick, knots.pace
        bow = span * ((1.0 - s) * pace[k] - s * pace[k + 1])
        guess = stick[k] + s**2 * (3.0 - 2.0 * s) * (stick[k + 1] - stick[k]) + s * (1.0 - s) * bow
        rate = knots.by_xi + knots.by_eta
        rate = rate[k] * (1.0 - s) + rate[k + 1] * s
        out, time = np.full(x.shape, np.nan), guess.copy()
        todo = np.flatnonzero(wanted)
        for _ in range(12):
            if not todo.size:
                break
            step = self.part.velocity(x[todo], time[todo]) / rate[todo]
            time[todo] -= step
            good = np.abs(time[todo] - guess[todo]) <= 0.05 * span[todo]
            done = good & (np.abs(step) < STEP)
            out[todo[done]] = time[todo[done]]
            todo = todo[good & ~done]
        return out

    def violations(self) -> list[Point]:
        """Points of the trailing edge where it does not outrun the waves."""
        knots, stuck = self.knots, self.knots.stuck
        # A position that has not stuck may stick right after the end.
        stick = np.where(stuck, knots.stick, self.part.until)
        slow = self._slow(knots)
        points = zip(knots.x[slow].tolist(), stick[slow].tolist(), strict=True)
        out = [Point(x, time) for x, time in points]
        jump = np.abs(np.diff(stick)) >= np.diff(knots.x) * (1.0 + SAME)
        changes = jump | (slow[1:] != slow[:-1])
        any_stuck, all_slow = stuck[1:] | stuck[:-1], slow[1:] & slow[:-1]
        for left in np.flatnonzero(changes & any_stuck & ~all_slow).tolist():
            fast, other = left, left + 1
            if slow[left] or (not slow[left + 1] and stick[left] >= stick[left + 1]):
                fast, other = other, fast
            if stuck[fast]:
                out.append(self._end_of_fast_part(fast, other))
        return out

    def _slow(self, knots: Knots) -> np.ndarray:
        # Sliding lasts too short a time to tell next to the point where a slow front has stopped.
        brief = 1e-3 / (self.part.rate or 1.0)
        lasting = knots.stick - self.part.curve.arrival(knots.x) > brief
        return ((knots.by_xi >= 0.0) | (knots.by_eta >= 0.0)) & lasting

    def _end_of_fast_part(self, knot: int, towards: int) -> Point:
        """The last point from one knot towards another up to which the edge outruns the waves."""
        fast = Point(self.knots.x[knot], self.knots.stick[knot])
        other = self.knots.x[towards]
        for _ in range(5):
            x = np.linspace(fast.x, other, 34)[1:-1]
            inner = self._knots_at(x, self.part.search(x))
            runs = np.abs(inner.stick - fast.time) < np.abs(x - fast.x)
            # The number of fast positions, counted from the fast knot on.
            count = int(np.argmin(np.append(runs & ~self._slow(inner), False)))
            if count > 0:
                fast = Point(x[count - 1], inner.stick[count - 1])
            if count < x.size:
                other = x[count]
        return Point(float(fast.x), float(fast.time))

    def first_stick(self) -> FirstStick | None:
        """The first sticking; None where nothing sticks before the end."""
        knots = self.knots
        if not knots.stuck.any():
            return None
        # Of several that stick first, the one nearest to x = 0 counts.
        first = np.flatnonzero(knots.stick <= np.nanmin(knots.stick) + 1e-10)
        k = int(first[np.argmin(np.abs(knots.x[first]))])
        at_knot = FirstStick(float(knots.stick[k]), float(knots.x[k]))
        if not 0 < k < knots.x.size - 1:
            return at_knot
        low = self._later_position(k, k - 1)
        if not low < at_knot.x:
            return at_knot
        high = self._later_position(k, k + 1)
        if not high > at_knot.x:
            return at_knot
        x = root_between(self._pace, low, high, xtol=STEP)
        time = float(self.stick_time(np.array([x]))[0])
        # Neither a kink nor an equal time is taken for a minimum.
        return FirstStick(time, x) if time < at_knot.time - ROUNDING else at_knot

    def _pace(self, position: float) -> float:
        x = np.array([position])
        return float(self._knots_at(x, self.stick_time(x)).pace[0])

    def _later_position(self, k: int, neighbour: int) -> float:
        """A position towards a neighbour where the stick time grows away from knot k, or that of k.

        The neighbour itself may stick after the end.
        """
        side = float(neighbour - k)
        inner, outer = float(self.knots.x[k]), float(self.knots.x[neighbour])
        position, growth = outer, side * float(self.knots.pace[neighbour])
        if growth <= 0.0:
            return inner
        for _ in range(30):
            if growth > 0.0:
                return position
            if growth <= 0.0:
                inner = position
            else:
                outer = position
            position = 0.5 * (inner + outer)
            growth = side * self._pace(position)
        return position if growth > 0.0 else float(self.knots.x[k])
