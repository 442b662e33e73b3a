"""One connected part of a rupture, behind one curve: its fields, and its trailing edge."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from .curve import Curve, Point
from .riemann import Past, Rest
from .stick_search import StickSearch
from .trailing_edge import TrailingEdge

# Steps of a search in time, in units of `Part.scale`.
SEARCH = 0.2
SCALE_WITHOUT_SPRINGS = 5.0 / 64.0


# The grid for the largest velocity has so many positions a knot, where these are farther apart than
# a fraction of `Part.scale`.
DENSER, SAME_GRID = 3, 0.01
# Slip is checked at positions this far apart, in units of `Part.scale`, to this fraction of itself.
CHECKED, FALL = 0.25, 1e-6


class Points(NamedTuple):
    """Points at distinct positions; number is the number of the position of each point."""

    positions: np.ndarray
    number: np.ndarray
    time: np.ndarray


@dataclass
class Part:
    """A connected part of the rupture behind a curve, until a time."""

    curve: Curve
    gamma: float
    until: float
    # Positions from which waves come that change du/dt at once, or faster than a search steps.
    marks: Sequence[float] | np.ndarray = ()
    refinement: int = 1
    # The part is symmetric: x >= 0 tells everything.
    one_side: bool = False
    alpha: float = 0.0

    @property
    def rate(self) -> float:
        """The fastest rate at which the kernel changes."""
        return max(float(np.sqrt(self.gamma)), 0.5 * abs(self.alpha))

    @property
    def scale(self) -> float:
        """Time over which du/dt changes, for want of leaf springs a fraction of the duration."""
        return 1.0 / self.rate if self.rate > 0.0 else SCALE_WITHOUT_SPRINGS * self.until

    @cached_property
    def rest(self) -> Rest:
        """A state at rest, for slip and strain."""
        return Rest(self.curve, self.gamma)

    def past(self, x: np.ndarray, time: np.ndarray) -> Past:
        """Domains of dependence of points that slide."""
        return Past(self.curve, self.gamma, x, time, self.alpha)

    def velocity(self, x: np.ndarray, time: np.ndarray) -> np.ndarray:
        """du/dt at points that slide."""
        return self.past(x, time).slip_velocity()

    def field(self, name: str, x: np.ndarray, time: np.ndarray) -> np.ndarray:
        """A field at points that slide."""
        past = self.past(x, time)
        return past.slip_velocity() if name == "slip_velocity" else getattr(past, name)(self.rest)

    def fill(self, fields: dict[str, np.ndarray], points: Points) -> None:
        """Put the values of this part into arrays of fields, by name, that hold 0 before."""
        positions, number, time = points
        covered = np.flatnonzero(self.curve.covers(positions))
        if not covered.size:
            return
        release, stick = np.full((2, positions.size), np.inf)
        release[covered] = self.curve.arrival(positions[covered])
        stick[covered] = np.nan_to_num(self.edge.stick_time(positions[covered]), nan=np.inf)
        sliding = (time > release[number]) & (time < stick[number])
        stuck = (time >= stick[number]) & np.isfinite(release[number])
        # The part that has stuck is computed once for each position.
        ended = np.unique(number[stuck])
        for name, values in fields.items():
            values[sliding] = self.field(name, positions[number[sliding]], time[sliding])
            if name != "slip_velocity" and ended.size:
                last = np.zeros(positions.size)
                last[ended] = self.field(name, positions[ended], stick[ended])
                values[stuck] = last[number[stuck]]

    def search(self, x: np.ndarray) -> np.ndarray:
        """Stick times at positions, from release on, without help from other positions."""
        marks = np.array(self.marks)
        arrivals = self.curve.arrival(marks) + np.abs(x[:, None] - marks)
        search = StickSearch(self.velocity, SEARCH * self.scale / self.refinement, self.until)
        return search.stick_time(x, self.curve.arrival(x), arrivals)

    @cached_property
    def edge(self) -> TrailingEdge:
        """The trailing edge."""
        return TrailingEdge(self)

    def falling_slip(self, horizon: Callable[[np.ndarray], np.ndarray]) -> list[Point]:
        """Releases after which slip would fall before the stick and the horizon, in samples."""
        x = self.edge.knots.x
        x = x[np.unique(np.floor(x / (CHECKED * self.scale)), return_index=True)[1]]
        release = self.curve.arrival(x)
        last = np.minimum(self.edge.about(x), horizon(x))
        x, release, last = np.array([x, release, last])[:, last > release]
        middle, end = (self.field("slip", x, t) for t in (0.5 * (release + last), last))
        falls = np.minimum(middle, end - middle) < -FALL * np.max(end, initial=0.0)
        return [Point(*point) for point in np.stack([x, release], axis=1)[falls].tolist()]

    def largest_velocity(self, end: float, horizon: Callable[[np.ndarray], np.ndarray]) -> float:
        """Largest slip velocity until an end and before a horizon, on a grid that is refined there.

        The grid is one of positions and fractions of the time from release on.
        """
        knots = self.edge.knots
        apart = knots.x[np.diff(knots.x, prepend=-np.inf) > SAME_GRID * self.scale]
        number = np.arange(apart.size)
        x = np.interp(np.linspace(0.0, number[-1], DENSER * number[-1] + 1), number, apart)
        fraction = np.tile(np.linspace(0.0, 1.0, 17), (x.size, 1))
        steps = np.diff(x, prepend=x[:1], append=x[-1:])
        spacing = np.maximum(np.maximum(steps[1:], steps[:-1]), SAME_GRID * self.scale)
        reach_fraction = fraction[0, 1]
        window = np.linspace(-1.0, 1.0, 7)
        largest, reach_x, centre_x, centre_fraction, slope = 0.0, 0.0, 0.0, 0.0, 0.0
        # Beyond this fraction the largest value changes by rounding only.
        while reach_fraction > 1e-8:
            release = self.curve.arrival(x)[:, None]
            last = np.minimum(self.edge.about(x), np.minimum(horizon(x), end))
            time = release + (last[:, None] - release) * fraction
            after, values = np.nonzero(time > release), np.zeros(time.shape)
            values[after] = self.velocity(x[after[0]], time[after])
            row, column = np.unravel_index(np.argmax(values), values.shape)
            value = float(values[row, column])
            narrower = 1.2 if value > largest * (1.0 + 1e-10) else 0.4
            reach_x = reach_x or float(spacing[row])
            # The largest value may lie on a ridge across the grid: later grids are turned along it.
            if x.size == window.size:
                ridge = fraction[np.arange(x.size), np.argmax(values, axis=1)]
                ways = x - np.mean(x)
                slope = float(ways @ ridge / max(ways @ ways, 1e-300))
            if value > largest:
                largest, centre_x, centre_fraction = value, x[row], fraction[row, column]
            x = (centre_x + reach_x * window).clip(knots.x[0], knots.x[-1])
            fraction = centre_fraction + reach_fraction * window + slope * (x - centre_x)[:, None]
            fraction = fraction.clip(0.0, 1.0)
            reach_x, reach_fraction = narrower * reach_x, narrower * reach_fraction
        return largest
