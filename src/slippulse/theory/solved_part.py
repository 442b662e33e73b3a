"""A connected part of a rupture with its trailing edge: fields at all its points, and extremes."""

from collections.abc import Callable

import numpy as np

from .curve import Point
from .trailing_edge import PartWithEdge
from .vector_roots import roots_between

# Number of positions for each knot in the grid for the largest velocity.
POSITIONS_PER_KNOT = 3
# Knots nearer to each other than this, in units of `Part.scale`, count once in this grid.
MIN_KNOT_DISTANCE = 0.01
# Number of positions, and of times, of the finer grids around a peak of the velocity.
GRID_SIZE = 17
# Length of the last of these grids, in units of `Part.scale`.
MIN_INTERVAL = 1e-6
# At most this number of peaks is followed ...
MAX_PEAKS = 2
# ... of those that reach this fraction of the highest.
PEAK_FRACTION = 0.97
# Slip is checked at positions this far apart, in units of `Part.scale`.
CHECK_DISTANCE = 0.25
# Slip falls if it decreases by more than this fraction of the largest slip.
FALL_TOLERANCE = 1e-6


class SolvedPart(PartWithEdge):
    """A connected part of a rupture, where it slides and where it has stuck."""

    # Several fields are requested at the same positions: the last positions and their stick times.
    _last_stick_times: tuple[np.ndarray, np.ndarray] = np.empty(0), np.empty(0)

    def stick_time(self, x: np.ndarray) -> np.ndarray:
        """Return stick times at positions.

        NaN outside of the part, and if a block does not stick before the end.
        """
        if not np.array_equal(x, self._last_stick_times[0]):
            out, covered = np.full(x.shape, np.nan), self.curve.covers(x)
            out[covered] = self._stick_time(x[covered])
            self._last_stick_times = x, out
        return self._last_stick_times[1]

    def fill_fields(self, fields: dict, x: np.ndarray, index: np.ndarray, time: np.ndarray) -> None:
        """Write values into arrays of fields, by name, at points of this part.

        A point is a time and the index of one of the distinct positions x. Other points are not
        changed.
        """
        release, stick = self.curve.arrival(x), np.nan_to_num(self.stick_time(x), nan=np.inf)
        sliding = (time > release[index]) & (time < stick[index])
        stuck = time >= stick[index]
        # Where a block has stuck, its slip and strain are computed once for each position.
        ended = np.unique(index[stuck])
        for name, values in fields.items():
            values[sliding] = self.field(name, x[index[sliding]], time[sliding])
            if name != "slip_velocity" and ended.size:
                last = np.zeros(x.size)
                last[ended] = self.field(name, x[ended], stick[ended])
                values[stuck] = last[index[stuck]]

    def falling_slip(self, horizon: Callable) -> list[Point]:
        """Return points of release after which slip would fall before the stick and the horizon.

        Slip is checked at samples of positions, in the middle and at the end of its time.
        """
        x = self.knots.x
        x = x[np.unique(np.floor(x / (CHECK_DISTANCE * self.scale)), return_index=True)[1]]
        release = self.curve.arrival(x)
        last = np.minimum(self.approximate_stick_time(x), horizon(x))
        x, release, last = np.array([x, release, last])[:, last > release]
        middle, end = (self.field("slip", x, t) for t in (0.5 * (release + last), last))
        falls = np.minimum(middle, end - middle) < -FALL_TOLERANCE * np.max(end, initial=0.0)
        return [Point(*point) for point in np.stack([x, release], axis=1)[falls].tolist()]

    def largest_velocity(self, until: float, horizon: Callable) -> float:
        """Return the largest slip velocity until a time and before a horizon."""
        # Positions at the knots of the trailing edge and between them.
        knots = self.knots.x
        knots = knots[np.diff(knots, prepend=-np.inf) > MIN_KNOT_DISTANCE * self.scale]
        index = np.arange(knots.size)
        x = np.interp(np.linspace(0.0, index[-1], POSITIONS_PER_KNOT * index[-1] + 1), index, knots)
        highest = self._peak_velocity(x, np.minimum(horizon(x), until))
        largest = float(highest.max())
        # The highest sample may belong to a peak that is not the highest.
        padded = np.pad(highest, 1)
        higher = (
            (highest > padded[:-2]) & (highest >= padded[2:]) & (highest >= PEAK_FRACTION * largest)
        )
        peaks = np.flatnonzero(higher)
        for row in peaks[np.argsort(-highest[peaks], kind="stable")[:MAX_PEAKS]].tolist():
            start, end = x[max(row - 1, 0)], x[min(row + 1, x.size - 1)]
            # Within a shorter interval the largest value changes by rounding only.
            while end - start > MIN_INTERVAL * self.scale:
                inner = np.linspace(start, end, GRID_SIZE)
                highest = self._peak_velocity(inner, np.minimum(horizon(inner), until))
                top = int(np.argmax(highest))
                largest = max(largest, float(highest[top]))
                start, end = inner[max(top - 1, 0)], inner[min(top + 1, GRID_SIZE - 1)]
        return largest

    def _peak_velocity(self, x: np.ndarray, last: np.ndarray) -> np.ndarray:
        """Return the largest slip velocity of each position before its stick and a last time."""
        release, last = self.curve.arrival(x), np.minimum(self.approximate_stick_time(x), last)
        time = np.linspace(release, np.maximum(release, last), GRID_SIZE, axis=1)
        values = self.velocity(np.repeat(x, GRID_SIZE), time.ravel()).reshape(time.shape)
        row, column = np.arange(x.size), np.argmax(values, axis=1)
        start = time[row, np.maximum(column - 1, 0)]
        end = time[row, np.minimum(column + 1, GRID_SIZE - 1)]

        def acceleration(time: np.ndarray, which: np.ndarray) -> np.ndarray:
            """Return the slip acceleration at times, for some of the positions."""
            return np.add(*self.domains(x[which], time).velocity_slopes())

        rise, fall = acceleration(start, row), acceleration(end, row)
        row = np.flatnonzero((rise > 0.0) & (fall < 0.0))
        start, end, rise, fall = np.array([start, end, rise, fall])[:, row]
        peak = roots_between(
            lambda time, k: acceleration(time, row[k]),
            lower=start,
            upper=end,
            at_lower=rise,
            at_upper=fall,
            xtol=1e-7 * self.scale,
        )
        out = values.max(axis=1)
        out[row] = np.maximum(out[row], self.velocity(x[row], peak))
        return out
