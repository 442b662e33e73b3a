"""A connected part of a rupture with its trailing edge: fields at all its points, and extremes."""

from collections.abc import Callable

import numpy as np

from .curve import Point
from .trailing_edge import EdgedPart
from .vector_roots import roots_between

# The grid for the largest velocity has DENSER positions for each knot, where knots are farther
# apart than this fraction of `Part.scale`.
DENSER, SAME_GRID = 3, 0.01
# Positions and times of each grid, and the last interval of positions, in units of `Part.scale`.
FINER, NARROWEST = 17, 1e-6
# This number of peaks between positions is followed, of those that reach this fraction of the top.
PEAKS, PEAK = 2, 0.97
# Slip is checked at positions this far apart, in units of `Part.scale`, to this fraction of itself.
CHECKED, FALL = 0.25, 1e-6


class SolvedPart(EdgedPart):
    """A connected part of the rupture, where it slides and where it has stuck."""

    # One field after another is wanted at the same positions: the last ones, and their sticks.
    _last: tuple[np.ndarray, np.ndarray] = np.empty(0), np.empty(0)

    def stick_time(self, x: np.ndarray) -> np.ndarray:
        """Stick times at positions; NaN outside the part, and for none before the end."""
        if not np.array_equal(x, self._last[0]):
            out, covered = np.full(x.shape, np.nan), self.curve.covers(x)
            out[covered] = self._stick_time(x[covered])
            self._last = x, out
        return self._last[1]

    def fill(self, fields: dict, x: np.ndarray, index: np.ndarray, time: np.ndarray) -> None:
        """Put values into arrays of fields, by name, at distinct positions, by index, and times."""
        release, stick = self.curve.arrival(x), np.nan_to_num(self.stick_time(x), nan=np.inf)
        sliding = (time > release[index]) & (time < stick[index])
        stuck = time >= stick[index]
        # The part that has stuck is computed once for each position.
        ended = np.unique(index[stuck])
        for name, values in fields.items():
            values[sliding] = self.field(name, x[index[sliding]], time[sliding])
            if name != "slip_velocity" and ended.size:
                last = np.zeros(x.size)
                last[ended] = self.field(name, x[ended], stick[ended])
                values[stuck] = last[index[stuck]]

    def falling_slip(self, horizon: Callable) -> list[Point]:
        """Releases after which slip would fall before the stick and the horizon, in samples."""
        x = self.knots.x
        x = x[np.unique(np.floor(x / (CHECKED * self.scale)), return_index=True)[1]]
        release = self.curve.arrival(x)
        last = np.minimum(self.about(x), horizon(x))
        x, release, last = np.array([x, release, last])[:, last > release]
        middle, end = (self.field("slip", x, t) for t in (0.5 * (release + last), last))
        falls = np.minimum(middle, end - middle) < -FALL * np.max(end, initial=0.0)
        return [Point(*point) for point in np.stack([x, release], axis=1)[falls].tolist()]

    def largest_velocity(self, until: float, horizon: Callable) -> float:
        """Largest slip velocity until a time and before a horizon."""
        # Positions as dense as the knots of the trailing edge, and between them.
        knots = self.knots.x
        knots = knots[np.diff(knots, prepend=-np.inf) > SAME_GRID * self.scale]
        index = np.arange(knots.size)
        x = np.interp(np.linspace(0.0, index[-1], DENSER * index[-1] + 1), index, knots)
        highest = self._highest(x, np.minimum(horizon(x), until))
        largest = float(highest.max())
        # The samples of the highest peak may be lower than those of another one.
        padded = np.pad(highest, 1)
        higher = (highest > padded[:-2]) & (highest >= padded[2:]) & (highest >= PEAK * largest)
        peaks = np.flatnonzero(higher)
        for row in peaks[np.argsort(-highest[peaks], kind="stable")[:PEAKS]].tolist():
            start, end = x[max(row - 1, 0)], x[min(row + 1, x.size - 1)]
            # The largest value in a shorter interval differs by rounding only.
            while end - start > NARROWEST * self.scale:
                inner = np.linspace(start, end, FINER)
                highest = self._highest(inner, np.minimum(horizon(inner), until))
                top = int(np.argmax(highest))
                largest = max(largest, float(highest[top]))
                start, end = inner[max(top - 1, 0)], inner[min(top + 1, FINER - 1)]
        return largest

    def _highest(self, x: np.ndarray, last: np.ndarray) -> np.ndarray:
        """Largest slip velocity at each position before it sticks and before a last time."""
        release, last = self.curve.arrival(x), np.minimum(self.about(x), last)
        time = np.linspace(release, np.maximum(release, last), FINER, axis=1)
        values = self.velocity(np.repeat(x, FINER), time.ravel()).reshape(time.shape)
        row, column = np.arange(x.size), np.argmax(values, axis=1)
        start = time[row, np.maximum(column - 1, 0)]
        end = time[row, np.minimum(column + 1, FINER - 1)]

        def acceleration(time: np.ndarray, which: np.ndarray) -> np.ndarray:
            return np.add(*self.past(x[which], time).velocity_slopes())

        rise, fall = acceleration(start, row), acceleration(end, row)
        row = np.flatnonzero((rise > 0.0) & (fall < 0.0))
        start, end, rise, fall = np.array([start, end, rise, fall])[:, row]
        peak = roots_between(
            lambda time, k: acceleration(time, row[k]), start, end, rise, fall, 1e-7 * self.scale
        )
        out = values.max(axis=1)
        out[row] = np.maximum(out[row], self.velocity(x[row], peak))
        return out
