"""A connected part of a rupture with its trailing edge: fields, and the largest slip velocity."""

from collections.abc import Callable

import numpy as np

from .curve import Point
from .trailing_edge import PartWithEdge
from .vector_roots import roots_between

# The largest velocity is first searched on a grid with this number of positions for each knot.
POSITIONS_PER_KNOT = 3
# Of knots that are nearer to each other than this, in units of `Part.scale`, only one counts.
MIN_KNOT_DISTANCE = 0.01
# Around the highest peaks it is searched on finer grids with this number of positions. The velocity
# of a position is sampled at the same number of times.
GRID_SIZE = 17
# Length of the last of these finer grids, in units of `Part.scale`.
MIN_INTERVAL = 1e-6
# At most this number of peaks is examined ...
MAX_PEAKS = 2
# ... and only those that reach this fraction of the highest one.
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
        """Return the stick times of positions, which are kept for the next call.

        NaN outside of the part, and where a block does not stick before the end.
        """
        if not np.array_equal(x, self._last_positions):
            times, is_covered = np.full(x.shape, np.nan), self.curve.covers(x)
            times[is_covered] = self._exact_stick_time(x[is_covered])
            self._last_positions, self._last_stick_times = x, times
        return self._last_stick_times

    def fill_fields(self, fields: dict, x: np.ndarray, index: np.ndarray, time: np.ndarray) -> None:
        """Write the values of fields at points into given arrays.

        fields has the name and the array of each field. The positions of the points are x[index],
        and their times are ``time``. Values change only at points that have been released in this
        part.
        """
        release, stick = self.curve.arrival(x), np.nan_to_num(self.stick_time(x), nan=np.inf)
        slides = (time > release[index]) & (time < stick[index])
        has_stuck = time >= stick[index]
        # After a stick, slip and strain do not change. So they are computed once for each position.
        stuck_index = np.unique(index[has_stuck])
        for name, values in fields.items():
            values[slides] = self.field(name, x[index[slides]], time[slides])
            if name != "slip_velocity" and stuck_index.size:
                at_stick = np.zeros(x.size)
                at_stick[stuck_index] = self.field(name, x[stuck_index], stick[stuck_index])
                values[has_stuck] = at_stick[index[has_stuck]]

    def falling_slip(self, horizon: Callable) -> list[Point]:
        """Return position and release time of each position whose slip would fall while it slides.

        Some positions are checked. Their slip must grow from the release to the middle of the
        sliding time, and from there to its end. This end is the stick, or the horizon if it is
        earlier. horizon(x) is the time up to which the slip at x is known.
        """
        # One knot in each cell of this length is checked.
        cell = np.floor(self.knots.x / (CHECK_DISTANCE * self.scale))
        _, first_of_cell = np.unique(cell, return_index=True)
        x = self.knots.x[first_of_cell]
        release = self.curve.arrival(x)
        end = np.minimum(self.approximate_stick_time(x), horizon(x))
        has_slipped = end > release
        x, end = x[has_slipped], end[has_slipped]
        release = release[has_slipped]
        slip_at_middle = self.field("slip", x, 0.5 * (release + end))
        slip_at_end = self.field("slip", x, end)
        smallest_gain = np.minimum(slip_at_middle, slip_at_end - slip_at_middle)
        falls = smallest_gain < -FALL_TOLERANCE * np.max(slip_at_end, initial=0.0)
        points = zip(x[falls].tolist(), release[falls].tolist(), strict=True)
        return [Point(*point) for point in points]

    def largest_velocity(self, until: float, horizon: Callable) -> float:
        """Return the largest slip velocity of the part, until a time and before a horizon.

        The largest velocity is searched on a grid of positions, and then on finer grids around the
        highest peaks. horizon(x) is the time up to which slip velocity at x is known.
        """

        def peak_velocity(x: np.ndarray) -> np.ndarray:
            """Return the largest slip velocity of each position until the time and the horizon."""
            return self._peak_velocity(x, np.minimum(horizon(x), until))

        x = self._positions_for_peaks()
        velocity = peak_velocity(x)
        largest = float(velocity.max())
        # Since the grid is coarse, the highest sample need not be at the highest peak. A peak is
        # higher than its neighbours; beyond the grid there is a 0.
        padded = np.pad(velocity, 1)
        is_peak = (velocity > padded[:-2]) & (velocity >= padded[2:])
        peaks = np.flatnonzero(is_peak & (velocity >= PEAK_FRACTION * largest))
        from_highest = peaks[np.argsort(-velocity[peaks], kind="stable")]
        for peak in from_highest[:MAX_PEAKS].tolist():
            start, end = x[max(peak - 1, 0)], x[min(peak + 1, x.size - 1)]
            # Within a shorter interval the largest value changes by rounding only.
            while end - start > MIN_INTERVAL * self.scale:
                grid = np.linspace(start, end, GRID_SIZE)
                velocity = peak_velocity(grid)
                top = int(np.argmax(velocity))
                largest = max(largest, float(velocity[top]))
                start, end = grid[max(top - 1, 0)], grid[min(top + 1, GRID_SIZE - 1)]
        return largest

    def _positions_for_peaks(self) -> np.ndarray:
        """Return the positions of the knots, and equally spaced ones between each two of them.

        For each knot there are POSITIONS_PER_KNOT positions. Knots that are very close to the one
        before are left out.
        """
        knots = self.knots.x
        knots = knots[np.diff(knots, prepend=-np.inf) > MIN_KNOT_DISTANCE * self.scale]
        # Positions are interpolated as a function of the number of the knot.
        last = knots.size - 1
        fractional_number = np.linspace(0.0, last, POSITIONS_PER_KNOT * last + 1)
        return np.interp(fractional_number, np.arange(knots.size), knots)

    def _peak_velocity(self, x: np.ndarray, last_time: np.ndarray) -> np.ndarray:
        """Return the largest slip velocity of each position until its stick, or until a last time.

        The velocity is sampled at GRID_SIZE times. Between the samples before and after the largest
        one, the peak is at the time at which the acceleration is 0.
        """
        release = self.curve.arrival(x)
        end = np.minimum(self.approximate_stick_time(x), last_time)
        # The axes are [position, time].
        time = np.linspace(release, np.maximum(release, end), GRID_SIZE, axis=1)
        velocity = self.velocity(np.repeat(x, GRID_SIZE), time.ravel()).reshape(time.shape)
        row, column = np.arange(x.size), np.argmax(velocity, axis=1)
        time_before = time[row, np.maximum(column - 1, 0)]
        time_after = time[row, np.minimum(column + 1, GRID_SIZE - 1)]

        def acceleration(row: np.ndarray, time: np.ndarray) -> np.ndarray:
            """Return the slip acceleration at the positions of some rows, each at a time."""
            by_xi, by_eta = self.domains(x[row], time).velocity_slopes()
            # At a fixed position, xi = t - x and eta = t + x grow as t does.
            return by_xi + by_eta

        at_before, at_after = acceleration(row, time_before), acceleration(row, time_after)
        with_peak = np.flatnonzero((at_before > 0.0) & (at_after < 0.0))
        peak_time = roots_between(
            lambda time, k: acceleration(with_peak[k], time),
            lower=time_before[with_peak],
            upper=time_after[with_peak],
            at_lower=at_before[with_peak],
            at_upper=at_after[with_peak],
            xtol=1e-7 * self.scale,
        )
        largest = velocity.max(axis=1)
        at_peak = self.velocity(x[with_peak], peak_time)
        largest[with_peak] = np.maximum(largest[with_peak], at_peak)
        return largest
