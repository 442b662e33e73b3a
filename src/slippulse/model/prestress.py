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

from .checks import as_positions, check_number, check_that, short_repr
from .prestress_parts import (
    LEVEL_RANGE,
    check_order,
    convert_column,
    convert_part,
    convert_points,
)
from .removed import ExplainsRemovedNames

# Allowed ranges, in the form that `check_number` takes.
NUMBER_RANGES = {"left": LEVEL_RANGE, "right": LEVEL_RANGE, "width": {"above": 0.0}, "peak": {}}
# Centre, amplitude and width of each further Gaussian.
Bumps: TypeAlias = tuple[tuple[float, float, float], ...]
# The representation of a profile shows at most this number of points.
MAX_SHOWN_POINTS = 8
# A value that differs from the threshold 1 by at most the first number is set to 1, because the
# difference is due to rounding. The second number is for tables. It is larger, since positions
# between the points are rounded as well.
THRESHOLD_TOLERANCE, TABLE_THRESHOLD_TOLERANCE = 4.0 * sys.float_info.epsilon, 1e-12
# Beyond this number of widths from its centre, a bump cannot bring the pre-stress to the threshold.
BUMP_REACH_IN_WIDTHS = 4.0


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
    ``level`` is ``left`` for x < 0 and ``right`` for x >= 0. Each step replaces it beyond a
    position. If ``points`` are given, they are a table of the background, which is linear between
    them (see `through`). The rupture nucleates where the profile reaches 1, which usually is at
    x = 0.
    Source: section III of the paper; steps, bumps and points are an addition of this project.

    Parameters
    ----------
    left, right : float, units of the stress drop
        Levels at large distance on either side (tau_{0,l} and tau_{0,r}), < 1.
    width : float, units of H, or None
        Standard deviation W of the Gaussian at x = 0, > 0. None if there is no such Gaussian.
    peak : float, units of the stress drop
        Value at x = 0, without bumps. If it is 1, the block there is released at t = 0. If it is
        less, nothing moves.
    steps : sequence of (position, level)
        A step sets the background to its level from its position on, away from x = 0.
    bumps : sequence of (centre, amplitude, width)
        Gaussians that are added to the profile. A bump can be a barrier (amplitude < 0), an
        asperity (amplitude > 0), or a second nucleation.
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
        for name in ("steps", "bumps"):
            object.__setattr__(self, name, convert_part(name, getattr(self, name)))
        object.__setattr__(self, "points", convert_points(self.points))
        # A step at x = 0 is the difference of left and right.
        positions = [position for position, _ in self.steps]
        are_distinct = 0.0 not in positions and len({*positions}) == len(positions)
        allowed = "different positions, none of them 0; left and right give the step at 0"
        check_that(are_distinct, "prestress.steps", positions, allowed)
        is_peak_allowed = self.width is not None or self.peak == 1.0
        allowed = "1 unless a width is given: without a width there is no Gaussian"
        check_that(is_peak_allowed, "prestress.peak", self.peak, allowed)
        if self.points:
            self._check_points()

    def _check_points(self) -> None:
        """Raise ValueError if the points are not in order, or do not fit the other arguments."""
        check_that(not self.steps, "prestress.steps", self.steps, "no steps together with points")
        x, tau = self.point_arrays
        check_order(x)
        # The pre-stress is constant beyond the outermost points.
        for name, outermost_value in (("left", tau[0]), ("right", tau[-1])):
            allowed = f"{float(outermost_value)!r}, the outermost value of the points"
            level = getattr(self, name)
            check_that(level == outermost_value, f"prestress.{name}", level, allowed)

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
            Positions from left to right, at least two. The same position twice is a jump. At the
            jump itself, the value on the side away from x = 0 holds. At a jump at x = 0, the larger
            value holds.
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
        positions, values = convert_column("x", x), convert_column("tau", tau)
        size = len(positions)
        allowed = f"{size} values, one for each x"
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
            units. The unit of positions is H and that of values is S (the stress drop); both can
            also be written as 1 or -. Rows that begin with # are comments.
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
        """Return the call that makes this profile, without arguments that have their defaults.

        A long table of points is replaced by its length.
        """
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
        """Distance from x = 0 within which all bumps lie, and all ``points`` that can reach 1."""
        distances = [0.0]
        for centre, _, width in self.bumps:
            distances.append(abs(centre) + BUMP_REACH_IN_WIDTHS * width)
        # A point whose own value is below 1 reaches 1 if positive bumps add the rest.
        lowest_value = 1.0 - sum(max(amplitude, 0.0) for _, amplitude, _ in self.bumps)
        distances += [abs(x) for x, tau in self.points if tau >= lowest_value]
        return max(distances)

    @property
    def symmetric(self) -> bool:
        """True if tau(-x) = tau(x), so that it is enough to simulate half of the lattice."""
        # The first number of a step is its position, and that of a bump its centre. Lists instead
        # of sets count equal bumps, which are added to each other.
        parts = sorted([*self.steps, *self.bumps])
        mirrored_parts = sorted((-position, *others) for position, *others in parts)
        return self.left == self.right and parts == mirrored_parts and self._symmetric_table

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
            return self._interpolate_table(x)
        level = np.where(x < 0.0, self.left, self.right)
        # From x = 0 outwards, each step replaces the level beyond it, on its own side.
        outwards = sorted(self.steps, key=lambda step: abs(step[0]))
        for position, step_level in outwards:
            distance = x if position > 0.0 else -x
            level = np.where(distance >= abs(position), step_level, level)
        return level

    def _interpolate_table(self, x: np.ndarray) -> np.ndarray:
        """Return the background at positions x by linear interpolation of the table.

        Each side is interpolated from x = 0 outwards, so that a mirrored table gives mirrored
        values to the last bit.
        """
        positions, values = self.point_arrays
        right = np.interp(np.maximum(x, 0.0), positions, values)
        left = np.interp(np.maximum(-x, 0.0), -positions[::-1], values[::-1])
        # At a jump at x = 0, the larger of the two values holds.
        at_zero = np.maximum(left, right)
        return np.select([x > 0.0, x < 0.0], [right, left], at_zero)

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
        # At 0 the level on the left meets the one on the right.
        jumps = sorted({0.0}.union(position for position, _ in self.steps))
        # Between two jumps the background is constant, so one position within is enough.
        middles = [0.5 * (left + right) for left, right in pairwise(jumps)]
        positions_within = [jumps[0] - 1.0, *middles, jumps[-1] + 1.0]
        levels = self.level(np.array(positions_within)).tolist()
        left_ends, right_ends = [-math.inf, *jumps], [*jumps, math.inf]
        return tuple(map(Interval, left_ends, right_ends, levels, levels))

    @cached_property
    def interval_table(self) -> np.ndarray:
        """Array with one row for each interval, and the fields of `Interval` as columns.

        The array is cached, because building it from a long table takes as long as a run.
        """
        return np.array(self.intervals)

    @cached_property
    def parts_as_json(self) -> str:
        """Steps, bumps and points as JSON, for a data file.

        The text is cached, because 10,000 points take 10 ms.
        """
        parts = {"steps": self.steps, "bumps": self.bumps}
        return json.dumps(parts | {"points": self.points} if self.points else parts)

    @cached_property
    def _equal_bumps(self) -> list[EqualBumps]:
        """Bumps from x = 0 outwards. Mirror images of each other are combined into one entry.

        The sum of mirror images is added to the profile as a whole. A symmetric profile then has
        symmetric values to the last bit.
        """
        centres: dict[tuple[float, float, float], list[float]] = {}
        for centre, amplitude, width in self.bumps:
            shape = (abs(centre), amplitude, width)
            centres.setdefault(shape, []).append(centre)
        bumps = []
        for shape in sorted(centres):
            _, amplitude, width = shape
            bumps.append(EqualBumps(amplitude, width, sorted(centres[shape])))
        return bumps

    def __call__(self, x: np.ndarray | float) -> np.ndarray:
        """Return the pre-stress at positions x (units of H).

        At x = 0 it is exactly ``peak`` if there are no bumps.
        """
        x = as_positions("x", x)
        tau = self.level(x)
        if self.width is not None:
            # Equal to level + (peak - level) exp(-x^2 / 2 width^2). This form loses no digits near
            # x = 0, where the pre-stress is close to the threshold.
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
    return {
        "left": prestress.left,
        "right": prestress.right,
        "width": math.nan if prestress.width is None else prestress.width,
        "peak": prestress.peak,
        "steps_and_bumps": prestress.parts_as_json,
    }


def prestress_from(attributes: Mapping) -> Prestress:
    """Make the pre-stress that the attributes of a data file describe.

    Raises KeyError if an attribute is missing, and ValueError if its value is not allowed.
    """
    left, right = attributes["left"], attributes["right"]
    width, peak = attributes["width"], attributes["peak"]
    parts_as_json = attributes["steps_and_bumps"]
    # A data file has NaN if there is no Gaussian at x = 0.
    if isinstance(width, float) and math.isnan(width):
        width = None
    arguments = (parts_as_json, left, right, width, peak)
    # The result is cached, with the arguments as its key. A value that cannot be a key, such as a
    # list, is not allowed, and `_make_prestress` raises the error.
    if all(isinstance(value, Hashable) for value in arguments):
        return _cached_make_prestress(*arguments)
    return _make_prestress(*arguments)


def _make_prestress(parts_as_json: Any, left: Any, right: Any, width: Any, peak: Any) -> Prestress:
    """Make a pre-stress from its four numbers, and from its steps, bumps and points as JSON."""
    try:
        # A profile that is not a table has no points.
        recorded = {"points": ()} | json.loads(parts_as_json)
        parts = {name: recorded[name] for name in ("steps", "bumps", "points")}
    except (TypeError, ValueError, LookupError):
        allowed = "a JSON object of steps and bumps, and points of a table"
        text = short_repr(parts_as_json)
        raise ValueError(f"steps_and_bumps: {text}; allowed: {allowed}") from None
    # In a row of measured numbers, a digest (text) may take the place of many points.
    is_digest = isinstance(parts["points"], str)
    allowed = "the points themselves, which are in the data file of the run"
    check_that(not is_digest, "steps_and_bumps points", parts["points"], allowed)
    return Prestress(left=left, right=right, width=width, peak=peak, **parts)


# Every measurement of a run needs its pre-stress, which is therefore cached for a few runs.
_cached_make_prestress = lru_cache(maxsize=8, typed=True)(_make_prestress)
