"""The pre-stress profile: a background, a Gaussian peak at x = 0, and optional further Gaussians.

The background is constant on each side of x = 0, with optional steps, or it is linear between given
points. `attributes_of` and `prestress_from` convert a profile to the attributes of a data file and
back.
"""

import json
import math
import sys
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, fields
from functools import cached_property, lru_cache
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple, Self, TypeAlias

import numpy as np

from .checks import as_positions, check_number, check_that, first_true, refusal, short_repr
from .removed import ExplainsRemovedNames

# Allowed ranges, in the form that `check_number` takes. A side level of 1 would release infinitely
# many blocks at t = 0.
LEVEL_RANGE: dict[str, Any] = {"below": 1.0}
NUMBER_RANGES = {"left": LEVEL_RANGE, "right": LEVEL_RANGE, "width": {"above": 0.0}, "peak": {}}
PART_RANGES: dict[str, dict[str, dict[str, Any]]] = {
    "steps": {"position": {}, "level": LEVEL_RANGE},
    "bumps": {"centre": {}, "amplitude": {}, "width": {"above": 0.0}},
}
# Centre, amplitude and width of each further Gaussian.
Bumps: TypeAlias = tuple[tuple[float, float, float], ...]
# A table of more points would take more memory than the lattice itself.
MAX_TABLE_POINTS = 100_000
# The representation of a profile shows at most this number of points.
MAX_SHOWN_POINTS = 8
# A value that differs from the threshold 1 by at most this much is set to 1, because the difference
# is due to rounding. A table has a larger tolerance, since positions between its points are rounded
# as well.
THRESHOLD_TOLERANCE, TABLE_THRESHOLD_TOLERANCE = 4.0 * sys.float_info.epsilon, 1e-12


class Interval(NamedTuple):
    """An interval on which the background is linear; its ends may be infinite."""

    left: float
    right: float
    left_value: float
    right_value: float


class EqualBumps(NamedTuple):
    """Bumps of the same shape at the same distance from x = 0."""

    amplitude: float
    width: float
    centres: list[float]


@dataclass(frozen=True, repr=False)
class Prestress(ExplainsRemovedNames):
    """Non-dimensional pre-stress tau(x) along the interface.

    The profile is ``level(x) + (peak - level(x)) exp(-x^2 / 2 width^2) + bumps``. The background
    ``level`` is ``left`` for x < 0 and ``right`` for x >= 0, until a step replaces it. With
    ``points``, it is linear between them instead (see `through`). The rupture nucleates where the
    profile reaches 1: at x = 0, or wherever a table does. Source: section III of the paper; steps,
    bumps and points are an addition of this project.

    Parameters
    ----------
    left, right : float, units of the stress drop
        Levels at large distance on either side (tau_{0,l} and tau_{0,r}), < 1.
    width : float, units of H, or None
        Standard deviation W of the Gaussian, > 0. None if there is no Gaussian at x = 0.
    peak : float, units of the stress drop
        Value at x = 0. If it is 1, the block there is released at t = 0. If it is less, nothing
        moves.
    steps : sequence of (position, level)
        A step sets the background to its level from its position on, away from x = 0.
    bumps : sequence of (centre, amplitude, width)
        Gaussians that are added to the profile: a barrier (amplitude < 0), an asperity, or a second
        nucleation.
    points : sequence of (x, tau)
        Points, from left to right, between which the background is linear. The first and the last
        tau must equal ``left`` and ``right``. Two points at the same x are a jump.

    Raises
    ------
    ValueError
        If a value is not a finite number, a width is not positive, a step lies at x = 0, or the
        points are not in order.

    Examples
    --------
    >>> barrier = sp.Prestress(left=0.6, right=0.6, bumps=((8.0, -0.3, 0.5),))
    >>> float(barrier(0.0))
    1.0
    """

    left: float
    right: float
    width: float | None = 1.0
    peak: float = 1.0
    steps: tuple[tuple[float, float], ...] = ()
    bumps: Bumps = ()
    points: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        for name, bounds in NUMBER_RANGES.items():
            if name == "width" and self.width is None:
                continue
            check_number(f"prestress.{name}", getattr(self, name), **bounds)
            object.__setattr__(self, name, float(getattr(self, name)))
        for name, parts in PART_RANGES.items():
            rows = _number_tuples(f"prestress.{name}", getattr(self, name), parts)
            object.__setattr__(self, name, rows)
        object.__setattr__(self, "points", _points(self.points))
        positions = [position for position, _ in self.steps]
        are_distinct = 0.0 not in positions and len({*positions}) == len(positions)
        allowed = "different positions, none of them 0 (see left, right)"
        check_that(are_distinct, "prestress.steps", positions, allowed)
        peak_has_width = self.width is not None or self.peak == 1.0
        allowed = "1 without a width, since there is then no Gaussian"
        check_that(peak_has_width, "prestress.peak", self.peak, allowed)
        if self.points:
            self._check_points()

    def _check_points(self) -> None:
        """Raise ValueError if the points are not in order, or do not fit the other arguments."""
        check_that(not self.steps, "prestress.steps", self.steps, "none with points")
        x, tau = self.point_arrays
        _check_order(x)
        for name, outermost in (("left", tau[0]), ("right", tau[-1])):
            allowed = f"{float(outermost)!r}, the outermost value of the points"
            level = getattr(self, name)
            check_that(level == outermost, f"prestress.{name}", level, allowed)

    @classmethod
    def through(
        cls,
        x: Any,
        tau: Any,
        width: float | None = None,
        peak: float = 1.0,
        bumps: Bumps = (),
    ) -> Self:
        """Make a pre-stress that is linear between points, and constant before and after them.

        Parameters
        ----------
        x : sequence of float, units of H
            Positions from left to right, at least two. The same position twice is a jump. The value
            at the jump itself is the one on the side away from x = 0, or, for a jump at x = 0, the
            larger one.
        tau : sequence of float, units of the stress drop
            Value at each position. The first and the last must be < 1.
        width, peak, bumps
            Gaussian at x = 0 and further Gaussians, as in `Prestress`. Without a width there is no
            Gaussian at x = 0, and the rupture starts wherever the table is 1 or more.

        Returns
        -------
        Prestress

        Raises
        ------
        ValueError
            If the points are not finite numbers in order, or another argument is not allowed. The
            message names the row, the value and what is allowed.

        Examples
        --------
        >>> ramp = sp.Prestress.through([-10.0, 10.0], [0.2, 0.6], width=1.0)
        >>> float(ramp.level(0.0))
        0.4
        """
        positions, values = _column("x", x), _column("tau", tau)
        size = len(positions)
        allowed = f"{size} values, as many as of x"
        check_that(size == len(values), "prestress.points", len(values), allowed)
        return cls(
            left=values[0],
            right=values[-1],
            width=width,
            peak=peak,
            bumps=bumps,
            points=tuple(zip(positions, values, strict=True)),
        )

    @classmethod
    def from_file(
        cls,
        path: str | Path,
        x: str | None = None,
        prestress: str | None = None,
        width: float | None = None,
        peak: float = 1.0,
        bumps: Bumps = (),
    ) -> Self:
        """Read points from a CSV or netCDF file, and make a pre-stress as `through` does.

        Parameters
        ----------
        path : str or Path
            A CSV file has the names of its columns in the first row. The second row may have their
            units: H for positions and S (the stress drop) for values, or 1 or - for both. Rows that
            begin with # are comments.
        x, prestress : str, optional
            Names of the two columns (or netCDF variables). By default, the column of positions is
            named x, position or distance, and the column of values tau, prestress, shear_stress or
            stress.
        width, peak, bumps
            As in `through`.

        Returns
        -------
        Prestress

        Raises
        ------
        ValueError
            If the file cannot be read, or its contents are not allowed. The message names the file,
            the row and what is allowed.

        Examples
        --------
        >>> profile = sp.Prestress.from_file("stress.csv", width=1.0)  # doctest: +SKIP
        """
        from .stress_file import read_dimensionless

        table = read_dimensionless(path, x, prestress)
        try:
            return cls.through(table.x, table.prestress, width=width, peak=peak, bumps=bumps)
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None

    @classmethod
    def from_function(
        cls,
        function: Callable[[float], float],
        start: float,
        stop: float,
        tolerance: float,
        width: float | None = None,
        peak: float = 1.0,
        bumps: Bumps = (),
    ) -> Self:
        """Sample a function, and make a pre-stress from the samples as `through` does.

        Parameters
        ----------
        function : callable
            Returns the pre-stress (units of the stress drop) at a position (units of H).
        start, stop : float, units of H
            First and last position. The pre-stress is constant before and after them.
        tolerance : float, units of the stress drop
            Largest allowed error of linear interpolation between the samples. Features narrower
            than 1/256 of the range may be missed.
        width, peak, bumps
            As in `through`.

        Returns
        -------
        Prestress

        Raises
        ------
        ValueError
            If the function is not finite somewhere, or needs too many samples.

        Examples
        --------
        >>> profile = sp.Prestress.from_function(lambda x: 0.9 / (1.0 + x * x), -9.0, 9.0, 1e-3)
        """
        from .sampled_function import sample_function

        x, tau = sample_function(function, start, stop, tolerance)
        return cls.through(x, tau, width=width, peak=peak, bumps=bumps)

    def __repr__(self) -> str:
        """Show the arguments that differ from the defaults; of a long table only its length."""
        shown = []
        for entry in fields(self):
            value = getattr(self, entry.name)
            if value != entry.default:
                is_long = entry.name == "points" and len(value) > MAX_SHOWN_POINTS
                text = f"<{len(value)}>" if is_long else repr(value)
                shown.append(f"{entry.name}={text}")
        return f"{type(self).__name__}({', '.join(shown)})"

    @property
    def gaussians(self) -> list[tuple[float, float]]:
        """Centre and width of the peak at x = 0, if there is one, and of each bump."""
        peak: list[tuple[float, float]] = [] if self.width is None else [(0.0, self.width)]
        return peak + [(centre, width) for centre, _, width in self.bumps]

    @property
    def narrowest(self) -> float:
        """Width of the narrowest Gaussian; infinite if there is none."""
        return min((width for _, width in self.gaussians), default=math.inf)

    @cached_property
    def nucleation_reach(self) -> float:
        """Distance from x = 0 within which all bumps lie, and all points at which tau can be 1."""
        reach = max((abs(centre) + 4.0 * width for centre, _, width in self.bumps), default=0.0)
        # Together with the bumps, a smaller value of the table can reach 1 as well.
        threshold = 1.0 - sum(max(amplitude, 0.0) for _, amplitude, _ in self.bumps)
        return max([reach, *(abs(x) for x, tau in self.points if tau >= threshold)])

    @property
    def symmetric(self) -> bool:
        """True if tau(-x) = tau(x), so that it is enough to simulate half of the lattice."""
        parts = {*self.steps, *self.bumps}
        mirrored = {(-position, *rest) for position, *rest in parts}
        return self.left == self.right and parts == mirrored and self._symmetric_table

    @cached_property
    def _symmetric_table(self) -> bool:
        """True if the points are mirror images of each other, or if there are none."""
        # The order of the points matters: at a jump the two values change places.
        return self.points == tuple((-x, tau) for x, tau in reversed(self.points))

    @cached_property
    def point_arrays(self) -> tuple[np.ndarray, np.ndarray]:
        """Positions x and values tau of the points of a table, as two arrays."""
        x, tau = np.array(self.points).T
        return np.ascontiguousarray(x), np.ascontiguousarray(tau)

    def level(self, x: np.ndarray | float) -> np.ndarray:
        """Return the background at positions x (units of H), without peak and bumps."""
        x = as_positions("x", x)
        if self.points:
            return self._linear(x)
        level = np.where(x < 0.0, self.left, self.right)
        # From x = 0 outwards, each step replaces the level beyond it, on its own side.
        for position, value in sorted(self.steps, key=lambda step: abs(step[0])):
            distance = x if position > 0.0 else -x
            level = np.where(distance >= abs(position), value, level)
        return level

    def _linear(self, x: np.ndarray) -> np.ndarray:
        """Interpolate the table at positions x.

        Each side is computed from x = 0 outwards, so that a mirrored table gives mirrored values to
        the last bit.
        """
        positions, values = self.point_arrays
        right = np.interp(np.maximum(x, 0.0), positions, values)
        left = np.interp(np.maximum(-x, 0.0), -positions[::-1], values[::-1])
        # At a jump at x = 0, the larger of the two values holds.
        return np.select([x > 0.0, x < 0.0], [right, left], np.maximum(left, right))

    @cached_property
    def intervals(self) -> tuple[Interval, ...]:
        """Intervals on which the background is linear, from left to right.

        The first and the last interval are infinite, and the background is constant on them.
        """
        if self.points:
            knots = [(-math.inf, self.left), *self.points, (math.inf, self.right)]
            intervals = []
            for (left, left_value), (right, right_value) in pairwise(knots):
                # A jump of the table is an interval of length 0, which is left out.
                if left < right:
                    intervals.append(Interval(left, right, left_value, right_value))
            return tuple(intervals)
        jumps = sorted({0.0}.union(position for position, _ in self.steps))
        # The level of an interval is that at a position inside it.
        middles = [0.5 * (left + right) for left, right in pairwise(jumps)]
        levels = self.level(np.array([jumps[0] - 1.0, *middles, jumps[-1] + 1.0])).tolist()
        lefts, rights = [-math.inf, *jumps], [*jumps, math.inf]
        return tuple(map(Interval, lefts, rights, levels, levels))

    @cached_property
    def interval_table(self) -> np.ndarray:
        """Array with one row for each interval, and the fields of `Interval` as columns.

        It is kept, because building it from a long table takes as long as a run.
        """
        return np.array(self.intervals)

    @cached_property
    def parts_as_json(self) -> str:
        """Steps, bumps and points as JSON, for a data file.

        It is kept, because 10,000 points take 10 ms.
        """
        parts = {"steps": self.steps, "bumps": self.bumps}
        return json.dumps(parts | {"points": self.points} if self.points else parts)

    @cached_property
    def _equal_bumps(self) -> list[EqualBumps]:
        """Bumps from x = 0 outwards. Mirror images of each other are combined into one entry.

        The sum of mirror images is added to the profile as a whole. A symmetric profile then has
        symmetric values to the last bit.
        """
        centres_of: dict[tuple[float, float, float], list[float]] = {}
        for centre, amplitude, width in self.bumps:
            centres_of.setdefault((abs(centre), amplitude, width), []).append(centre)
        return [
            EqualBumps(amplitude, width, sorted(centres_of[distance, amplitude, width]))
            for distance, amplitude, width in sorted(centres_of)
        ]

    def __call__(self, x: np.ndarray | float) -> np.ndarray:
        """Return the pre-stress at positions x (units of H).

        At x = 0 it is exactly ``peak`` if there are no bumps.
        """
        x = as_positions("x", x)
        tau = self.level(x)
        if self.width is not None:
            # This form loses no digits near x = 0, where the pre-stress is close to the threshold.
            tau = self.peak + (tau - self.peak) * -np.expm1(-0.5 * (x / self.width) ** 2)
        if not self.bumps and not self.points:
            return tau
        for amplitude, width, centres in self._equal_bumps:
            gaussians = [np.exp(-0.5 * ((x - centre) / width) ** 2) for centre in centres]
            tau = tau + sum(amplitude * gaussian for gaussian in gaussians)
        # The tail of a distant bump can move the peak away from the threshold by rounding.
        tolerance = TABLE_THRESHOLD_TOLERANCE if self.points else THRESHOLD_TOLERANCE
        return np.where(np.abs(tau - 1.0) <= tolerance, 1.0, tau)


def attributes_of(prestress: Prestress) -> dict[str, float | str]:
    """Return the attributes that describe a pre-stress in a data file.

    The width is NaN if there is no Gaussian at x = 0.
    """
    attributes = {name: getattr(prestress, name) for name in NUMBER_RANGES}
    attributes["width"] = math.nan if prestress.width is None else prestress.width
    attributes["steps_and_bumps"] = prestress.parts_as_json
    return attributes


def prestress_from(attributes: Mapping) -> Prestress:
    """Make the pre-stress that the attributes of a data file describe.

    Raises KeyError if an attribute is missing, and ValueError if its value is not allowed.
    """
    left, right, width, peak = (attributes[name] for name in NUMBER_RANGES)
    text = attributes["steps_and_bumps"]
    if isinstance(width, float) and math.isnan(width):
        width = None
    # A value that cannot be a key of the cache, such as a list, is refused by `_from_text`.
    is_hashable = all(isinstance(value, Hashable) for value in (text, left, right, width, peak))
    read = _cached_from_text if is_hashable else _from_text
    return read(text, left, right, width, peak)


def _from_text(text: Any, left: Any, right: Any, width: Any, peak: Any) -> Prestress:
    """Make a pre-stress from four numbers, and from its steps, bumps and points as JSON."""
    try:
        given = {"points": ()} | json.loads(text)
        parts = {name: given[name] for name in (*PART_RANGES, "points")}
    except (TypeError, ValueError, LookupError):
        allowed = "a JSON object of steps and bumps, and points of a table"
        raise ValueError(f"steps_and_bumps: {short_repr(text)}; allowed: {allowed}") from None
    # A measured table replaces the points of a long table by a digest, which is text.
    is_digest = isinstance(parts["points"], str)
    allowed = "the points themselves, which are in the data file of the run"
    check_that(not is_digest, "steps_and_bumps points", parts["points"], allowed)
    return Prestress(left=left, right=right, width=width, peak=peak, **parts)


# Each measurement of a run starts from its pre-stress, which is therefore kept for a few runs.
_cached_from_text = lru_cache(maxsize=8, typed=True)(_from_text)


def _points(rows: Any) -> tuple[tuple[float, float], ...]:
    """Convert the points of a table to pairs of numbers; an empty tuple if there are none."""
    try:
        pairs = [(x, tau) for x, tau in rows]
    except (TypeError, ValueError):
        allowed = "a list of [x, tau]"
        raise ValueError(f"prestress.points: {short_repr(rows)}; allowed: {allowed}") from None
    if not pairs:
        return ()
    x, tau = zip(*pairs, strict=True)
    return tuple(zip(_column("x", x), _column("tau", tau), strict=True))


def _column(name: str, values: Any) -> list[float]:
    """Convert one column of a table to numbers; ValueError names the first row that fails."""
    key, listed = f"prestress.points {name}", values
    try:
        listed = np.asarray(values).tolist() if hasattr(values, "__array__") else [*values]
        size = len(listed)
    except TypeError:
        size = 0
    check_that(2 <= size <= MAX_TABLE_POINTS, key, size, f"2 to {MAX_TABLE_POINTS} numbers")
    # A check of the whole list is much faster than one of each value.
    if all(type(value) is float for value in listed) and np.all(np.isfinite(listed)):
        return listed
    for row, value in enumerate(listed, start=1):
        check_number(f"{key} in row {row}", value)
    return [*map(float, listed)]


def _check_order(x: np.ndarray) -> None:
    """Raise ValueError if positions decrease, or if more than two points have the same position."""
    # Rows are counted from 1 in messages.
    before = first_true(np.diff(x) < 0.0)
    if before is not None:
        allowed = f">= {x[before]:.10g}, the x of the row before"
        raise refusal(f"prestress.points x in row {before + 2}", float(x[before + 1]), allowed)
    first_of_three = first_true(x[2:] == x[:-2])
    if first_of_three is not None:
        row, position = first_of_three + 3, float(x[first_of_three + 2])
        allowed = "one x in at most 2 rows, between which the pre-stress jumps"
        raise refusal(f"prestress.points x in row {row}", position, allowed)


def _number_tuples(key: str, rows: Any, parts: Mapping[str, Mapping]) -> tuple[tuple, ...]:
    """Convert rows of numbers to tuples, and check each column against its range in ``parts``."""
    allowed = f"a list of [{', '.join(parts)}]"
    try:
        named = [dict(zip(parts, row, strict=True)) for row in rows]
    except (TypeError, ValueError):
        raise ValueError(f"{key}: {short_repr(rows)}; allowed: {allowed}") from None
    for row in named:
        for part, value in row.items():
            check_number(f"{key} {part}", value, **parts[part])
    return tuple(tuple(map(float, row.values())) for row in named)
