"""A connected part of a rupture with its trailing edge: fields at all its points, and extremes."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .curve import Point
from .part import Part
from .trailing_edge import TrailingEdge

# The grid for the largest velocity has DENSER positions for each knot, where knots are farther
# apart than this fraction of `Part.scale`.
DENSER, SAME_GRID = 3, 0.01
# Where a finer grid finds more, the next one is wider by this factor, and else narrower by this.
WIDER, NARROWER = 1.2, 0.4
# Slip is checked at positions this far apart, in units of `Part.scale`, to this fraction of itself.
CHECKED, FALL = 0.25, 1e-6


@dataclass
class SolvedPart(Part):
    """A connected part of the rupture and its trailing edge."""

    def __post_init__(self) -> None:
        # One field after another is wanted at the same positions: the last ones, and their sticks.
        self._last: tuple[np.ndarray, np.ndarray] = np.empty(0), np.empty(0)

    @cached_property
    def edge(self) -> TrailingEdge:
        """The trailing edge."""
        return TrailingEdge(self)

    def stick_time(self, x: np.ndarray) -> np.ndarray:
        """Stick times at positions; NaN outside the part, and for none before the end."""
        if not np.array_equal(x, self._last[0]):
            out, covered = np.full(x.shape, np.nan), self.curve.covers(x)
            out[covered] = self.edge.stick_time(x[covered])
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
        x = self.edge.knots.x
        x = x[np.unique(np.floor(x / (CHECKED * self.scale)), return_index=True)[1]]
        release = self.curve.arrival(x)
        last = np.minimum(self.edge.about(x), horizon(x))
        x, release, last = np.array([x, release, last])[:, last > release]
        middle, end = (self.field("slip", x, t) for t in (0.5 * (release + last), last))
        falls = np.minimum(middle, end - middle) < -FALL * np.max(end, initial=0.0)
        return [Point(*point) for point in np.stack([x, release], axis=1)[falls].tolist()]

    def largest_velocity(self, end: float, horizon: Callable) -> float:
        """Largest slip velocity until an end and before a horizon."""

        def sampled(x: np.ndarray, fraction: np.ndarray) -> np.ndarray:
            release = self.curve.arrival(x)[:, None]
            last = np.minimum(self.edge.about(x), np.minimum(horizon(x), end))
            time = release + (last[:, None] - release) * fraction
            after, values = np.nonzero(time > release), np.zeros(time.shape)
            values[after] = self.velocity(x[after[0]], time[after])
            return values

        # The grid is one of positions and fractions of the time from release on.
        x = self._positions_by_knots()
        fraction = np.tile(np.linspace(0.0, 1.0, 17), (x.size, 1))
        values = sampled(x, fraction)
        row, column = np.unravel_index(np.argmax(values), values.shape)
        largest = values[row, column]
        centre_x, centre_fraction = x[row], fraction[row, column]
        nearest = np.diff(x)[max(row - 1, 0) : row + 1]
        reach_x = float(np.max(nearest, initial=SAME_GRID * self.scale))
        reach_fraction = float(fraction[0, 1])
        window = np.linspace(-1.0, 1.0, 7)
        slope, factor = 0.0, WIDER
        # Beyond this fraction the largest value changes by rounding only.
        while factor * reach_fraction > 1e-8:
            x = (centre_x + reach_x * window).clip(*self.edge.knots.x[[0, -1]])
            fraction = centre_fraction + reach_fraction * window + slope * (x - centre_x)[:, None]
            fraction = fraction.clip(0.0, 1.0)
            reach_x, reach_fraction = factor * reach_x, factor * reach_fraction
            values = sampled(x, fraction)
            row, column = np.unravel_index(np.argmax(values), values.shape)
            # The largest value may lie on a ridge across the grid: later grids are turned along it.
            ridge = fraction[np.arange(x.size), np.argmax(values, axis=1)]
            away = x - np.mean(x)
            slope = float(away @ ridge / max(away @ away, 1e-300))
            value = values[row, column]
            factor = WIDER if value > largest * (1.0 + 1e-10) else NARROWER
            if value > largest:
                largest = value
                centre_x, centre_fraction = x[row], fraction[row, column]
        return float(largest)

    def _positions_by_knots(self) -> np.ndarray:
        """Positions as dense as the knots of the trailing edge, and between them."""
        x = self.edge.knots.x
        apart = x[np.diff(x, prepend=-np.inf) > SAME_GRID * self.scale]
        index = np.arange(apart.size)
        return np.interp(np.linspace(0.0, index[-1], DENSER * index[-1] + 1), index, apart)
