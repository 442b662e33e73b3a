"""The trailing edge: the first zero in time of du/dt, as long as it runs faster than the waves.

Then the past of a sliding point holds no stuck one, and Riemann's formula holds up to sticking. That is so where du/dt
falls along both characteristics, d/d(t - y) < 0 and d/d(t + y) < 0. The stress of a block that has stuck is then
d2u/dt2 (1 - (dt/dx)^2) < 0, with the acceleration just before, so that no block is ever released again.
"""

from __future__ import annotations

import numpy as np

from ..model.roots import roots_between
from .curve import Curve
from .riemann import Cones

# Times looked at together, and their distance: a share of 1/sqrt(gamma), or of the duration without leaf springs.
# Around a minimum of du/dt two such steps are cut into FINE parts, twice.
BATCH = 8
SCAN = 0.2
FINE = 24
SCAN_WITHOUT_SPRINGS = 1.0 / 64.0
# How far apart positions are whose stick times the others are found from: a share of the whole.
GRID = 192


class TrailingEdge:
    """Where and when the blocks behind one connected curve stick.

    Parameters
    ----------
    curve : of the fronts
    gamma : elasticity ratio, or 0
    until : time up to which stick times are wanted
    marks : positions where the curve has kinks
    refinement : how many times as many positions and times are looked at
    one_side : whether x >= 0 tells all

    Attributes
    ----------
    x, stick : a grid of positions, and the times of sticking there, NaN where not before ``until``
    by_xi, by_eta : derivatives of du/dt by t - x and t + x at sticking
    """

    def __init__(
        self,
        curve: Curve,
        gamma: float,
        until: float,
        marks: np.ndarray,
        refinement: int = 1,
        one_side: bool = False,
    ) -> None:
        self.curve, self.gamma, self.until, self.refinement = curve, gamma, until, refinement
        left, right = curve.edges[0], curve.edges[-1]
        if one_side:
            left = max(left, 0.0)
        inside = marks[(marks >= left) & (marks <= right)]
        self.x = np.unique(
            np.concatenate(
                [np.linspace(left, right, GRID * refinement // (2 if one_side else 1) + 1), inside]
            )
        )
        self.x = self.x[curve.arrival(self.x) < until]
        self.stick = self.scan(self.x)
        self.by_xi, self.by_eta = np.full((2, self.x.size), np.nan)
        stuck = np.flatnonzero(np.isfinite(self.stick))
        if stuck.size:
            cones = Cones(curve, gamma, self.x[stuck], self.stick[stuck])
            self.by_xi[stuck], self.by_eta[stuck] = cones.velocity_slopes()

    def velocity(self, x: np.ndarray, time: np.ndarray) -> np.ndarray:
        return Cones(self.curve, self.gamma, x, time).slip_velocity()

    def scan(self, x: np.ndarray) -> np.ndarray:
        """Stick times at positions, found without help from others."""
        out = np.full(x.shape, np.nan)
        release = self.curve.arrival(x)
        step = SCAN / np.sqrt(self.gamma) if self.gamma > 0.0 else SCAN_WITHOUT_SPRINGS * self.until
        step = step / self.refinement
        alive = np.flatnonzero(release < self.until)
        # The last two times and velocities of each: a velocity that turns may have been below 0 in between.
        times, velocity = (
            np.stack([release, release], axis=1),
            np.stack([np.full(x.shape, -1.0), np.zeros(x.shape)], 1),
        )
        while alive.size:
            new = np.minimum(times[alive, 1:] + step * np.arange(1, BATCH + 1), self.until)
            found = self.velocity(np.repeat(x[alive], BATCH), new.ravel()).reshape(new.shape)
            t, v = (
                np.concatenate([times[alive], new], axis=1),
                np.concatenate([velocity[alive], found], axis=1),
            )
            below = v[:, 2:] <= 0.0
            first = np.where(below.any(axis=1), 2 + np.argmax(below, axis=1), t.shape[1])
            dip = self._dips(x[alive], t, v, first)
            stuck = below.any(axis=1)
            rows, k = np.flatnonzero(stuck & ~np.isfinite(dip)), first[stuck & ~np.isfinite(dip)]
            low, high = (t[rows, k - 1], v[rows, k - 1]), (t[rows, k], v[rows, k])
            out[alive[rows]] = self._between(x[alive[rows]], low[0], high[0], low[1], high[1])
            rows = np.flatnonzero(np.isfinite(dip))
            out[alive[rows]] = dip[rows]
            times[alive], velocity[alive] = t[:, -2:], v[:, -2:]
            alive = alive[~stuck & ~np.isfinite(dip) & (t[:, -1] < self.until)]
        return out

    def _dips(self, x, t, v, first) -> np.ndarray:
        """Zeros between samples around a minimum above 0 before the first sample below it; NaN where there is none."""
        out = np.full(x.shape, np.nan)
        inner = v[:, 1:-1]
        turns = (inner < v[:, :-2]) & (inner <= v[:, 2:]) & (np.arange(1, v.shape[1] - 1) < first[:, None])
        rows, k = np.nonzero(turns & (t[:, 2:] > t[:, 1:-1]))
        low, high = t[rows, k], t[rows, k + 2]
        for _ in range(2):
            if not rows.size:
                break
            fine = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, FINE + 1)
            value = self.velocity(np.repeat(x[rows], FINE + 1), fine.ravel()).reshape(fine.shape)
            below = (value <= 0.0).any(axis=1)
            n, m = np.flatnonzero(below), np.argmax(value <= 0.0, axis=1)[below]
            good = m > 0
            n, m = n[good], m[good]
            zero = self._between(x[rows[n]], fine[n, m - 1], fine[n, m], value[n, m - 1], value[n, m])
            out[rows[n]] = np.fmin(out[rows[n]], zero)
            best = np.clip(np.argmin(value, axis=1), 1, FINE - 1)
            rest = np.flatnonzero(~below)
            rows, low, high = rows[rest], fine[rest, best[rest] - 1], fine[rest, best[rest] + 1]
        return out

    def _between(self, x, low, high, at_low, at_high) -> np.ndarray:
        """Zeros of du/dt in time; where it starts at 0, at release, from where it has risen."""
        out = np.full(x.shape, np.nan)
        low, at_low = low.copy(), at_low.copy()
        todo = np.flatnonzero(at_low <= 0.0)
        for _ in range(40):
            if not todo.size:
                break
            # A slow front that is about to stop: du/dt rises for a short while only.
            middle = 0.5 * (low[todo] + high[todo])
            velocity = self.velocity(x[todo], middle)
            risen = velocity > 0.0
            low[todo[risen]], at_low[todo[risen]] = middle[risen], velocity[risen]
            high[todo[~risen]], at_high[todo[~risen]] = middle[~risen], velocity[~risen]
            todo = todo[~risen]
        out[todo] = high[todo]
        good = np.flatnonzero(at_low > 0.0)
        out[good] = roots_between(
            lambda n, time: self.velocity(x[good][n], time),
            low[good],
            high[good],
            at_low[good],
            at_high[good],
        )
        return out

    def stick_time(self, x: np.ndarray) -> np.ndarray:
        """Stick times at positions in order, NaN where not before ``until``."""
        out = np.full(x.shape, np.nan)
        if self.x.size < 2:
            return self.scan(x)
        k = np.clip(np.searchsorted(self.x, x, side="right") - 1, 0, self.x.size - 2)
        rate = self.by_xi + self.by_eta
        pace = (self.by_xi - self.by_eta) / rate
        near = (
            np.isfinite(self.stick[k]) & np.isfinite(self.stick[k + 1]) & (x >= self.x[0]) & (x <= self.x[-1])
        )
        near &= np.maximum(np.abs(pace[k]), np.abs(pace[k + 1])) < 1.0
        # From the stick times on both sides and their slopes, by Hermite's cubic.
        span = self.x[k + 1] - self.x[k]
        s = (x - self.x[k]) / span
        a, b = self.stick[k], self.stick[k + 1]
        guess = (
            a
            + s**2 * (3.0 - 2.0 * s) * (b - a)
            + s * (1.0 - s) * span * ((1.0 - s) * pace[k] - s * pace[k + 1])
        )
        rate = rate[k] * (1.0 - s) + rate[k + 1] * s
        todo = np.flatnonzero(near)
        time = guess
        for _ in range(12):
            if not todo.size:
                break
            step = self.velocity(x[todo], time[todo]) / rate[todo]
            time[todo] -= step
            # What strays is looked for from the start.
            strayed = np.abs(time[todo] - guess[todo]) > 0.05 * span[todo]
            done = np.abs(step) < 1e-11
            near[todo[strayed]] = False
            out[todo[done & ~strayed]] = time[todo[done & ~strayed]]
            todo = todo[~done & ~strayed]
        near[todo] = False
        far = np.flatnonzero(~near)
        out[far] = self.scan(x[far])
        return np.where(out <= self.until, out, np.nan)

    def violations(self) -> list[tuple[float, float]]:
        """Positions and times of sticking where the trailing edge does not outrun the waves."""
        # What does not stick until then may stick right after.
        stick = np.where(np.isfinite(self.stick), self.stick, self.until)
        stuck = np.isfinite(self.stick)
        slow = np.zeros(stick.shape, dtype=bool)
        slow[stuck] = self._slow(self.x[stuck], stick[stuck], self.by_xi[stuck], self.by_eta[stuck])
        out = list(zip(self.x[slow].tolist(), stick[slow].tolist(), strict=True))
        jump = np.abs(np.diff(stick)) >= np.diff(self.x) * (1.0 + 1e-9)
        for k in np.flatnonzero(
            (jump | (slow[1:] != slow[:-1])) & (stuck[1:] | stuck[:-1]) & ~(slow[1:] & slow[:-1])
        ):
            ahead = slow[k] or (not slow[k + 1] and stick[k] >= stick[k + 1])
            fast = k + 1 if ahead else k
            if stuck[fast]:
                out.append(self._last_fast(fast, 2 * k + 1 - fast))
        return out

    def _slow(self, x, stick, by_xi, by_eta) -> np.ndarray:
        slow = (by_xi >= 0.0) | (by_eta >= 0.0)
        # Beside the point where a slow front has stopped, sliding lasts too short a time to tell.
        brief = 1e-3 / (np.sqrt(self.gamma) if self.gamma > 0.0 else 1.0)
        return slow & (stick - self.curve.arrival(x) > brief)

    def _last_fast(self, a: int, b: int) -> tuple[float, float]:
        """The end of the part of the edge that runs faster than the waves at grid point a, towards b."""
        fast, fast_time, other = self.x[a], self.stick[a], self.x[b]
        for _ in range(24):
            middle = 0.5 * (fast + other)
            time = self.scan(np.array([middle]))
            good = np.isfinite(time[0]) and abs(time[0] - fast_time) < abs(middle - fast)
            if good:
                slopes = Cones(self.curve, self.gamma, np.array([middle]), time).velocity_slopes()
                good = not self._slow(np.array([middle]), time, *slopes)[0]
            if good:
                fast, fast_time = middle, time[0]
            else:
                other = middle
        return float(fast), float(fast_time)
