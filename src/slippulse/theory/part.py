"""One connected part of a rupture, behind one curve: its fields, and its trailing edge.

The trailing edge is the first zero in time of du/dt, as long as it runs faster than the waves. Then the past of a
sliding point holds no stuck one, and Riemann's formula holds up to sticking. That is so where du/dt falls along both
characteristics, d/d(t - y) < 0 and d/d(t + y) < 0. The stress of a block that has stuck is then
d2u/dt2 (1 - (dt/dx)^2) < 0, with the acceleration just before, so that no block is ever released again.
"""

from collections.abc import Callable, Iterable
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..model.roots import root_between, roots_between
from .curve import SAME, Curve
from .riemann import Past, Rest

# Times looked at together, and their distance: a fraction of 1/sqrt(gamma), or of the duration without leaf springs.
# Around a minimum of du/dt two such steps are cut into FINE parts, twice.
BATCH = 8
SCAN = 0.2
FINE = 24
SCAN_WITHOUT_SPRINGS = 1.0 / 64.0
# How many positions the stick times of the others are found from.
GRID = 192
# Errors of a root in time, and of Newton's last step to it.
TIME, STEP = 1e-12, 1e-11
# Slip velocities on a slow front are below this, and would be 0.
QUIET = 1e-12


class Edge(NamedTuple):
    """Positions, their stick times (NaN where there is none), and derivatives of du/dt by t - x and t + x then."""

    x: np.ndarray
    stick: np.ndarray
    by_xi: np.ndarray
    by_eta: np.ndarray

    @property
    def pace(self) -> np.ndarray:
        """Derivative of the stick time by position."""
        return (self.by_xi - self.by_eta) / (self.by_xi + self.by_eta)


class Part:
    """A connected part of the rupture, behind a curve with kinks at marks, until a time; one_side: x >= 0 tells all."""

    def __init__(
        self, curve: Curve, gamma: float, until: float, marks: Iterable[float] = (), refinement: int = 1,
        one_side: bool = False, alpha: float = 0.0,
    ) -> None:  # fmt: skip
        self.curve, self.gamma, self.until, self.alpha = curve, gamma, until, alpha
        self.rate = max(float(np.sqrt(gamma)), 0.5 * abs(alpha))
        self.marks, self.refinement, self.one_side = np.array([*marks]), refinement, one_side

    @cached_property
    def rest(self) -> Rest:
        """A state at rest, for slip and strain."""
        return Rest(self.curve, self.gamma)

    def past(self, x: np.ndarray, time: np.ndarray) -> Past:
        """Where points that slide depend on."""
        return Past(self.curve, self.gamma, x, time, self.alpha)

    def velocity(self, x: np.ndarray, time: np.ndarray) -> np.ndarray:
        """du/dt at points that slide."""
        return self.past(x, time).slip_velocity()

    def field(self, name: str, x: np.ndarray, time: np.ndarray) -> np.ndarray:
        """A field at points that slide."""
        past = self.past(x, time)
        return past.slip_velocity() if name == "slip_velocity" else getattr(past, name)(self.rest)

    @cached_property
    def edge(self) -> Edge:
        """The trailing edge on a grid."""
        left, right = self.curve.edges[[0, -1]]
        if self.one_side:
            left = max(left, 0.0)
        grid = np.linspace(left, right, GRID * self.refinement // (2 if self.one_side else 1) + 1)
        marks = self.marks[(self.marks >= left) & (self.marks <= right)]
        apart = np.abs(grid[:, None] - marks).min(axis=1, initial=np.inf) > SAME * (right - left)
        x = np.union1d(grid[apart], marks)
        x = x[self.curve.arrival(x) < self.until]
        return self._edge_at(x, self.scan(x))

    def _edge_at(self, x: np.ndarray, stick: np.ndarray) -> Edge:
        slopes = np.full((2, x.size), np.nan)
        stuck = np.isfinite(stick)
        if stuck.any():
            slopes[:, stuck] = self.past(x[stuck], stick[stuck]).velocity_slopes()
        return Edge(x, stick, *slopes)

    def scan(self, x: np.ndarray) -> np.ndarray:
        """Stick times at positions, found without help from others."""
        out = np.full(x.shape, np.nan)
        release = self.curve.arrival(x)
        step = (
            SCAN / self.rate if self.rate > 0.0 else SCAN_WITHOUT_SPRINGS * self.until
        ) / self.refinement
        alive = np.flatnonzero(release < self.until)
        # The last two times and velocities of each: a velocity that turns may have been below 0 in between.
        times = np.stack([release, release], axis=1)
        velocity = np.stack([np.full(x.shape, -1.0), np.zeros(x.shape)], axis=1)
        while alive.size:
            new = np.minimum(times[alive, 1:] + step * np.arange(1, BATCH + 1), self.until)
            found = self.velocity(np.repeat(x[alive], BATCH), new.ravel()).reshape(new.shape)
            t = np.concatenate([times[alive], new], axis=1)
            v = np.concatenate([velocity[alive], found], axis=1)
            below = v[:, 2:] <= 0.0
            stuck = below.any(axis=1)
            first = np.where(stuck, 2 + np.argmax(below, axis=1), t.shape[1])
            stick = self._dips(x[alive], t, v, first)
            rows = np.flatnonzero(stuck & ~np.isfinite(stick))
            around = (rows, first[rows] - 1), (rows, first[rows])
            stick[rows] = self._zero(x[alive[rows]], *(of[at] for of in (t, v) for at in around))
            out[alive] = stick
            times[alive], velocity[alive] = t[:, -2:], v[:, -2:]
            alive = alive[~np.isfinite(stick) & (t[:, -1] < self.until)]
        return out

    def _dips(self, x, t, v, first) -> np.ndarray:
        """Zeros between samples around a minimum above 0 before the first sample below it; NaN where there is none."""
        out = np.full(x.shape, np.nan)
        inner = v[:, 1:-1]
        turns = (
            (inner < v[:, :-2])
            & (inner <= v[:, 2:])
            & (np.arange(1, v.shape[1] - 1) < first[:, None])
        )
        rows, k = np.nonzero(turns & (t[:, 2:] > t[:, 1:-1]))
        low, high = t[rows, k], t[rows, k + 2]
        for _ in range(2):
            if not rows.size:
                break
            fine = np.linspace(low, high, FINE + 1, axis=1)
            value = self.velocity(np.repeat(x[rows], FINE + 1), fine.ravel()).reshape(fine.shape)
            m = np.argmax(value <= 0.0, axis=1)
            n = np.flatnonzero(m > 0)
            around = (n, m[n] - 1), (n, m[n])
            zero = self._zero(x[rows[n]], *(of[at] for of in (fine, value) for at in around))
            out[rows[n]] = np.fmin(out[rows[n]], zero)
            best = np.clip(np.argmin(value, axis=1), 1, FINE - 1)
            rest = np.flatnonzero((value > 0.0).all(axis=1))
            rows, low, high = rows[rest], fine[rest, best[rest] - 1], fine[rest, best[rest] + 1]
        return out

    def _zero(self, x, low, high, at_low, at_high) -> np.ndarray:
        """Zeros of du/dt in time; where it starts at 0, at release, from where it has risen."""
        level = np.where(at_low <= 0.0, QUIET, 0.0)
        flat = np.flatnonzero(level)
        for _ in range(40):
            if not flat.size:
                break
            # A slow front that is about to stop: du/dt rises for a short while only.
            middle = 0.5 * (low[flat] + high[flat])
            value = self.velocity(x[flat], middle)
            risen = value > QUIET
            low[flat[risen]], at_low[flat[risen]] = middle[risen], value[risen]
            flat, middle, value = (values[~risen] for values in (flat, middle, value))
            high[flat], at_high[flat] = middle, value
        rest = np.setdiff1d(np.arange(x.size), flat)
        x, level = x[rest], level[rest]
        out = high.copy()
        out[rest] = roots_between(
            lambda time, which: self.velocity(x[which], time) - level[which],
            low[rest], high[rest], at_low[rest] - level, at_high[rest] - level, TIME,
        )  # fmt: skip
        return out

    def stick_time(self, x: np.ndarray) -> np.ndarray:
        """Stick times at positions, NaN where not before ``until``."""
        edge = self.edge
        if edge.x.size < 2:
            return self.scan(x)
        k = np.clip(np.searchsorted(edge.x, x, side="right") - 1, 0, edge.x.size - 2)
        pace, rate = edge.pace, edge.by_xi + edge.by_eta
        on, stuck = (x >= edge.x[0]) & (x <= edge.x[-1]), np.isfinite(edge.stick)
        near = on & stuck[k] & stuck[k + 1]
        near &= np.maximum(np.abs(pace[k]), np.abs(pace[k + 1])) < 1.0
        # From the stick times on both sides and their slopes, by Hermite's cubic and Newton's steps.
        span = edge.x[k + 1] - edge.x[k]
        s = (x - edge.x[k]) / span
        a, b = edge.stick[k], edge.stick[k + 1]
        bow = span * ((1.0 - s) * pace[k] - s * pace[k + 1])
        guess = a + s**2 * (3.0 - 2.0 * s) * (b - a) + s * (1.0 - s) * bow
        rate = rate[k] * (1.0 - s) + rate[k + 1] * s
        out, time = np.full(x.shape, np.nan), guess.copy()
        todo = np.flatnonzero(near)
        for _ in range(12):
            if not todo.size:
                break
            step = self.velocity(x[todo], time[todo]) / rate[todo]
            time[todo] -= step
            # What strays is looked for from the start.
            good = np.abs(time[todo] - guess[todo]) <= 0.05 * span[todo]
            done = good & (np.abs(step) < STEP)
            out[todo[done]] = time[todo[done]]
            todo = todo[good & ~done]
        # What slides at the end, as its neighbours do, has not stuck.
        slides = np.flatnonzero(on & ~stuck[k] & ~stuck[k + 1])
        slides = slides[self.velocity(x[slides], np.full(slides.size, self.until)) > 0.0]
        far = np.setdiff1d(np.flatnonzero(~np.isfinite(out)), slides)
        out[far] = self.scan(x[far])
        return np.where(out <= self.until, out, np.nan)

    def violations(self) -> list[tuple[float, float]]:
        """Positions and times of sticking where the trailing edge does not outrun the waves."""
        edge = self.edge
        x, stuck = edge.x, np.isfinite(edge.stick)
        # What does not stick until then may stick right after.
        stick = np.where(stuck, edge.stick, self.until)
        slow = self._slow(edge)
        out = list(zip(x[slow].tolist(), stick[slow].tolist(), strict=True))
        jump = np.abs(np.diff(stick)) >= np.diff(x) * (1.0 + SAME)
        between = (
            (jump | (slow[1:] != slow[:-1])) & (stuck[1:] | stuck[:-1]) & ~(slow[1:] & slow[:-1])
        )
        for k in np.flatnonzero(between):
            ahead = slow[k] or (not slow[k + 1] and stick[k] >= stick[k + 1])
            fast = k + 1 if ahead else k
            if stuck[fast]:
                out.append(self._last_fast(int(fast), int(2 * k + 1 - fast)))
        return out

    def _slow(self, edge: Edge) -> np.ndarray:
        # Beside the point where a slow front has stopped, sliding lasts too short a time to tell.
        brief = 1e-3 / (self.rate or 1.0)
        lasting = edge.stick - self.curve.arrival(edge.x) > brief
        return ((edge.by_xi >= 0.0) | (edge.by_eta >= 0.0)) & lasting

    def _last_fast(self, a: int, b: int) -> tuple[float, float]:
        """The end of the part of the edge that runs faster than the waves at grid point a, towards b."""
        fast, fast_time, other = self.edge.x[a], self.edge.stick[a], self.edge.x[b]
        for _ in range(5):
            x = np.linspace(fast, other, 34)[1:-1]
            here = self._edge_at(x, self.scan(x))
            runs = np.abs(here.stick - fast_time) < np.abs(x - fast)
            # How many from the fast end on.
            n = int(np.argmin(np.append(runs & ~self._slow(here), False)))
            if n > 0:
                fast, fast_time = x[n - 1], here.stick[n - 1]
            if n < x.size:
                other = x[n]
        return float(fast), float(fast_time)

    def first_stick(self) -> tuple[float, float] | None:
        """Time and position of the first sticking."""
        edge = self.edge
        if not np.isfinite(edge.stick).any():
            return None
        # Where several are first, the one nearest to x = 0.
        first = np.flatnonzero(edge.stick <= np.nanmin(edge.stick) + 1e-10)
        k = int(first[np.argmin(np.abs(edge.x[first]))])
        time, x = float(edge.stick[k]), float(edge.x[k])

        def pace(position: float) -> float:
            at = np.array([position])
            return float(self._edge_at(at, self.stick_time(at)).pace[0])

        def beyond(j: int, sign: float) -> float:
            """Towards a neighbour, where the edge runs away from x; the neighbour may stick after the end."""
            inner, outer, away = x, float(edge.x[j]), sign * float(edge.pace[j])
            at = outer
            for _ in range(30):
                if away > 0.0 or (away <= 0.0 and at == outer):
                    break
                inner, outer = (at, outer) if away <= 0.0 else (inner, at)
                at = 0.5 * (inner + outer)
                away = sign * pace(at)
            return at if away > 0.0 else x

        if 0 < k < edge.x.size - 1 and (low := beyond(k - 1, -1.0)) < x < (
            high := beyond(k + 1, 1.0)
        ):
            lowest = root_between(pace, low, high, xtol=STEP)
            found = float(self.stick_time(np.array([lowest]))[0])
            # Not for a kink, nor for what is the same.
            if found < time - TIME:
                time, x = found, lowest
        return time, x

    def largest_velocity(self, end: float, horizon: Callable[[np.ndarray], np.ndarray]) -> float:
        """Largest slip velocity until an end and before a horizon, from a grid refined around its largest value."""
        edge = self.edge
        last = np.fmin(edge.stick, np.minimum(horizon(edge.x), end))
        x, fraction = edge.x, np.linspace(0.0, 1.0, 17)
        reach_x, reach_fraction = np.max(np.diff(x), initial=1e-3), fraction[1]
        best, around = 0.0, np.linspace(-1.0, 1.0, 7)
        # Until the largest value does not change by rounding.
        while reach_fraction > 1e-8:
            release = self.curve.arrival(x)[:, None]
            time = release + (np.interp(x, edge.x, last)[:, None] - release) * fraction
            row, column = np.nonzero(time > release)
            values = self.velocity(x[row], time[row, column])
            n = int(np.argmax(values))
            # The largest value may lie on a ridge across the grid: the search narrows where it no longer rises.
            narrower = 1.0 if values[n] > best * (1.0 + 1e-10) else 0.4
            if values[n] > best:
                best, centre, at = float(values[n]), x[row[n]], fraction[column[n]]
            x = (centre + reach_x * around).clip(edge.x[0], edge.x[-1])
            fraction = (at + reach_fraction * around).clip(0.0, 1.0)
            reach_x, reach_fraction = narrower * reach_x, narrower * reach_fraction
        return best
