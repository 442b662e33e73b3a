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

    # The last requested positions and their stick times are kept, since several fields are
    # requested at the same positions one after another.
    _last_positions: np.ndarray = np.empty(0)
    _last_stick_times: np.ndarray = np.empty(0)

    def stick_time(self, x: np.ndarray) -> np.ndarray:
        """Return stick times at positions.

        NaN outside of the part, and if a block does not stick before the end.
        """
        if not np.array_equal(x, self._last_positions):
            times, covered = np.full(x.shape, np.nan), self.curve.covers(x)
            times[covered] = self._stick_time(x[covered])
            self._last_positions, self._last_stick_times = x, times
        return self._last_stick_times

    def fill_fields(self, fields: dict, x: np.ndarray, index: np.ndarray, time: np.ndarray) -> None:
        """Write values into arrays of fields, by name, at points of this part.

        A point is a time and the index of one of the distinct positions x. Other points are not
        changed.
        """
        release, stick = self.curve.arrival(x), np.nan_to_num(self.stick_time(x), nan=np.inf)
        is_sliding = (time > release[index]) & (time < stick[index])
        has_stuck = time >= stick[index]
        # Where a block has stuck, its slip and strain are computed once for each position.
        stuck_index = np.unique(index[has_stuck])
        for name, values in fields.items():
            values[is_sliding] = self.field(name, x[index[is_sliding]], time[is_sliding])
            if name != "slip_velocity" and stuck_index.size:
                at_stick = np.zeros(x.size)
                at_stick[stuck_index] = self.field(name, x[stuck_index], stick[stuck_index])
                values[has_stuck] = at_stick[index[has_stuck]]

    def falling_slip(self, horizon: Callable) -> list[Point]:
        """Return points of release after which slip would fall before the stick and the horizon.

        Slip is checked at some positions, from the release to the middle of its time and from there
        to the end. horizon returns the time until which it is known at positions.
        """
        cell = np.floor(self.knots.x / (CHECK_DISTANCE * self.scale))
        _, first_of_cell = np.unique(cell, return_index=True)
        x = self.knots.x[first_of_cell]
        release = self.curve.arrival(x)
        end = np.minimum(self.approximate_stick_time(x), horizon(x))
        x, release, end = np.array([x, release, end])[:, end > release]
        slip_at_middle = self.field("slip", x, 0.5 * (release + end))
        slip_at_end = self.field("slip", x, end)
        smallest_gain = np.minimum(slip_at_middle, slip_at_end - slip_at_middle)
        falls = smallest_gain < -FALL_TOLERANCE * np.max(slip_at_end, initial=0.0)
        return [Point(*point) for point in np.stack([x, release], axis=1)[falls].tolist()]

    def largest_velocity(self, until: float, horizon: Callable) -> float:
        """Return the largest slip velocity until a time and before a horizon."""

        def peak_velocity_before_limits(x: np.ndarray) -> np.ndarray:
            """Return the largest slip velocity of each position until the time and the horizon."""
            return self._peak_velocity(x, np.minimum(horizon(x), until))

        # Positions at the knots of the trailing edge and between them.
        knots = self.knots.x
        knots = knots[np.diff(knots, prepend=-np.inf) > MIN_KNOT_DISTANCE * self.scale]
        last = knots.size - 1
        fractional_index = np.linspace(0.0, last, POSITIONS_PER_KNOT * last + 1)
        x = np.interp(fractional_index, np.arange(knots.size), knots)
        velocity = peak_velocity_before_limits(x)
        largest = float(velocity.max())
        # The highest sample may belong to a peak that is not the highest.
        padded = np.pad(velocity, 1)
        is_peak = (velocity > padded[:-2]) & (velocity >= padded[2:])
        peaks = np.flatnonzero(is_peak & (velocity >= PEAK_FRACTION * largest))
        from_highest = peaks[np.argsort(-velocity[peaks], kind="stable")]
        for peak in from_highest[:MAX_PEAKS].tolist():
            start, end = x[max(peak - 1, 0)], x[min(peak + 1, x.size - 1)]
            # Within a shorter interval the largest value changes by rounding only.
            while end - start > MIN_INTERVAL * self.scale:
                grid = np.linspace(start, end, GRID_SIZE)
                velocity = peak_velocity_before_limits(grid)
                top = int(np.argmax(velocity))
                largest = max(largest, float(velocity[top]))
                start, end = grid[max(top - 1, 0)], grid[min(top + 1, GRID_SIZE - 1)]
        return largest

    def _peak_velocity(self, x: np.ndarray, last: np.ndarray) -> np.ndarray:
        """Return the largest slip velocity of each position before its stick and a last time.

        The velocity is sampled at GRID_SIZE times. Next to the largest sample, the peak is where
        the acceleration is 0.
        """
        release = self.curve.arrival(x)
        end = np.minimum(self.approximate_stick_time(x), last)
        time = np.linspace(release, np.maximum(release, end), GRID_SIZE, axis=1)
        velocity = self.velocity(np.repeat(x, GRID_SIZE), time.ravel()).reshape(time.shape)
        row, column = np.arange(x.size), np.argmax(velocity, axis=1)
        before = time[row, np.maximum(column - 1, 0)]
        after = time[row, np.minimum(column + 1, GRID_SIZE - 1)]

        def acceleration(time: np.ndarray, which: np.ndarray) -> np.ndarray:
            """Return the slip acceleration at times, for some of the positions."""
            by_xi, by_eta = self.domains(x[which], time).velocity_slopes()
            return by_xi + by_eta

        rise, fall = acceleration(before, row), acceleration(after, row)
        has_peak = np.flatnonzero((rise > 0.0) & (fall < 0.0))
        peak = roots_between(
            lambda time, k: acceleration(time, has_peak[k]),
            lower=before[has_peak],
            upper=after[has_peak],
            at_lower=rise[has_peak],
            at_upper=fall[has_peak],
            xtol=1e-7 * self.scale,
        )
        largest = velocity.max(axis=1)
        largest[has_peak] = np.maximum(largest[has_peak], self.velocity(x[has_peak], peak))
        return largest
