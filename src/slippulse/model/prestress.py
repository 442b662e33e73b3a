"""The pre-stress profile: a Gaussian peak on a background, with optional bumps.

The background is two side levels with optional steps, or piecewise linear through given points.
"""

import json
import math
import sys
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, fields
from functools import cached_property, lru_cache
from itertools import groupby, pairwise
from operator import itemgetter
from pathlib import Path
from typing import Any, NamedTuple, Self

import numpy as np

from .checks import as_positions, check_number, check_that, short_repr
from .removed import AnswersRemoved

# Bounds, for `check_number`. A level at the threshold would release block after block at t = 0,
# without end.
LEVEL: dict[str, Any] = {"below": 1.0}
NUMBERS = {"left": LEVEL, "right": LEVEL, "width": {"above": 0.0}, "peak": {}}
PARTS: dict[str, dict[str, dict[str, Any]]] = {
    "steps": {"position": {}, "level": LEVEL},
    "bumps": {"centre": {}, "amplitude": {}, "width": {"above": 0.0}},
}
# A table of more points takes more memory than the lattice that it is for.
MOST_POINTS = 100_000
# A value this close to the threshold, which the profile meets but for rounding, counts as 1: with
# bumps, and with a table, between whose points positions are rounded, too.
ROUNDING, ROUNDING_OF_TABLE = 4.0 * sys.float_info.epsilon, 1e-12


class Interval(NamedTuple):
    """An interval on which the background is linear; its ends may be infinite."""

    left: float
    right: float
    left_value: float
    right_value: float


@dataclass(frozen=True, repr=False)
class Prestress(AnswersRemoved):
    """Non-dimensional pre-stress tau(x), with nucleation at x = 0 or wherever a table reaches 1.

    The profile is ``level(x) + (peak - level(x)) exp(-x^2 / 2 width^2) + bumps``. The background
    ``level`` is ``left`` for x < 0 and ``right`` for x >= 0 until a step replaces it, or linear
    between ``points`` (see `through`). A block is released where the profile reaches 1. Source:
    section III of the paper; steps, bumps and points are an addition of this project.

    Parameters
    ----------
    left, right : float, units of the stress drop
        Levels at large distance on either side (tau_{0,l} and tau_{0,r}), < 1.
    width : float, units of H, or None
        Standard deviation W of the Gaussian, > 0. None if there is no Gaussian at x = 0.
    peak : float, units of the stress drop
        Value at x = 0. At 1 the block there is released at t = 0; below 1 nothing moves.
    steps : sequence of (position, level)
        From the position on, away from x = 0, the level of its side becomes this.
    bumps : sequence of (centre, amplitude, width)
        Gaussians added: a barrier (amplitude < 0), an asperity, or a second nucleation.
    points : sequence of (x, tau)
        Points of a background that is linear between them, from left to right. Its first and last
        values are ``left`` and ``right``. Two points at one x are a jump.

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
    bumps: tuple[tuple[float, float, float], ...] = ()
    points: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        for name, bounds in NUMBERS.items():
            if name == "width" and self.width is None:
                continue
            check_number(f"prestress.{name}", getattr(self, name), **bounds)
            object.__setattr__(self, name, float(getattr(self, name)))
        for name, parts in PARTS.items():
            rows = _number_tuples(f"prestress.{name}", getattr(self, name), parts)
            object.__setattr__(self, name, rows)
        object.__setattr__(self, "points", _points(self.points))
        positions = [position for position, _ in self.steps]
        different = 0.0 not in positions and len({*positions}) == len(positions)
        allowed = "different positions, none of them 0 (see left, right)"
        check_that(different, "prestress.steps", positions, allowed)
        without_peak = self.width is not None or self.peak == 1.0
        check_that(without_peak, "prestress.peak", self.peak, "nothing without a width")
        if self.points:
            self._check_points()

    def _check_points(self) -> None:
        check_that(not self.steps, "prestress.steps", self.steps, "none with points")
        x, tau = self._table
        _check_table(x)
        for name, row in (("left", 0), ("right", -1)):
            allowed = f"{float(tau[row])!r}, the outermost value of the points"
            level = getattr(self, name)
            check_that(level == tau[row], f"prestress.{name}", level, allowed)

    @classmethod
    def through(
        cls,
        x: Any,
        tau: Any,
        width: float | None = None,
        peak: float = 1.0,
        bumps: tuple[tuple[float, float, float], ...] = (),
    ) -> Self:
        """A pre-stress that is linear between points, and constant before and after them.

        Parameters
        ----------
        x : sequence of float, units of H
            Positions from left to right, at least two. The same position twice is a jump; at the
            jump itself the value farther from x = 0 holds, and at x = 0 the larger one.
        tau : sequence of float, units of the stress drop
            Value at each position. The first and the last are < 1.
        width, peak, bumps
            Gaussian at x = 0 and further Gaussians, as in `Prestress`. Without a width there is
            none at x = 0: the rupture starts wherever the table is 1 or more.

        Returns
        -------
        Prestress

        Raises
        ------
        ValueError
            In one line that names the row, the value and what is allowed.

        Examples
        --------
        >>> ramp = sp.Prestress.through([-10.0, 10.0], [0.2, 0.6], width=1.0)
        >>> float(ramp.level(0.0))
        0.4
        """
        positions, values = _column("x", x), _column("tau", tau)
        size = len(positions)
        check_that(size == len(values), "prestress.points", len(values), f"{size} values, as of x")
        points = tuple(zip(positions, values, strict=True))
        return cls(values[0], values[-1], width, peak, bumps=bumps, points=points)

    @classmethod
    def from_file(
        cls,
        path: str | Path,
        x: str | None = None,
        prestress: str | None = None,
        width: float | None = None,
        peak: float = 1.0,
        bumps: tuple[tuple[float, float, float], ...] = (),
    ) -> Self:
        """A pre-stress through the points of a CSV or netCDF file, as by `through`.

        Parameters
        ----------
        path : str or Path
            A CSV file has the names of its columns in the first row, and their units in the second
            if it gives any: H and S (the stress drop), or 1 or -. Rows that begin with # are
            comments.
        x, prestress : str, optional
            Names of the two columns, or variables; by default those named x, position or distance,
            and tau, prestress, shear_stress or stress.
        width, peak, bumps
            As in `through`.

        Returns
        -------
        Prestress

        Raises
        ------
        ValueError
            In one line that names the file, the row and what is allowed.

        Examples
        --------
        >>> profile = sp.Prestress.from_file("stress.csv", width=1.0)  # doctest: +SKIP
        """
        from .stress_file import read_dimensionless

        table = read_dimensionless(path, x, prestress)
        try:
            return cls.through(table.x, table.prestress, width, peak, bumps)
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
        bumps: tuple[tuple[float, float, float], ...] = (),
    ) -> Self:
        """A pre-stress through samples of a function, as by `through`.

        Parameters
        ----------
        function : callable
            Pre-stress (units of the stress drop) at a position (units of H).
        start, stop : float, units of H
            First and last position; the pre-stress is constant before and after them.
        tolerance : float, units of the stress drop
            Largest deviation of the lines between samples from the function. Features narrower than
            1/256 of the range may be missed.
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
        return cls.through(x, tau, width, peak, bumps)

    def __repr__(self) -> str:
        """The arguments that differ from the defaults; a long table by its size."""
        given = []
        for entry in fields(self):
            value = getattr(self, entry.name)
            if value != entry.default:
                text = f"<{len(value)}>" if entry.name == "points" and value[8:] else repr(value)
                given.append(f"{entry.name}={text}")
        return f"{type(self).__name__}({', '.join(given)})"

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
        """Distance from x = 0 within which bumps lie, and every position where a table is >= 1."""
        reach = max((abs(centre) + 4.0 * width for centre, _, width in self.bumps), default=0.0)
        # Bumps add to a table.
        least = 1.0 - sum(max(amplitude, 0.0) for _, amplitude, _ in self.bumps)
        return max([reach, *(abs(x) for x, tau in self.points if tau >= least)])

    @property
    def symmetric(self) -> bool:
        """True where tau(-x) = tau(x), so that half the lattice is enough."""
        parts = {*self.steps, *self.bumps}
        mirrored = {(-position, *rest) for position, *rest in parts}
        return self.left == self.right and parts == mirrored and self._symmetric_table

    @cached_property
    def _symmetric_table(self) -> bool:
        # Order counts: at a jump the two values change places.
        return self.points == tuple((-x, tau) for x, tau in reversed(self.points))

    @cached_property
    def _table(self) -> tuple[np.ndarray, np.ndarray]:
        """Positions and values of the points."""
        x, tau = np.array(self.points).T
        return np.ascontiguousarray(x), np.ascontiguousarray(tau)

    def level(self, x: np.ndarray | float) -> np.ndarray:
        """Background at positions x (units of H): levels with steps, or the linear table."""
        x = as_positions("x", x)
        if self.points:
            return self._linear(x)
        level = np.where(x < 0.0, self.left, self.right)
        for position, value in sorted(self.steps, key=lambda step: abs(step[0])):
            level = np.where(x * math.copysign(1.0, position) >= abs(position), value, level)
        return level

    def _linear(self, x: np.ndarray) -> np.ndarray:
        """The table at positions x, computed outwards so that it can be mirrored to the bit."""
        positions, values = self._table
        right = np.interp(np.maximum(x, 0.0), positions, values)
        left = np.interp(np.maximum(-x, 0.0), -positions[::-1], values[::-1])
        return np.where(x > 0.0, right, np.where(x < 0.0, left, np.maximum(left, right)))

    @cached_property
    def intervals(self) -> tuple[Interval, ...]:
        """Intervals of a linear background from left to right; the outermost are constant."""
        if self.points:
            knots = [(-math.inf, self.left), *self.points, (math.inf, self.right)]
            linear = (Interval(a, b, low, high) for (a, low), (b, high) in pairwise(knots))
            return tuple(interval for interval in linear if interval.left < interval.right)
        jumps = sorted({0.0}.union(position for position, _ in self.steps))
        middles = [0.5 * (left + right) for left, right in pairwise(jumps)]
        levels = self.level(np.array([jumps[0] - 1.0, *middles, jumps[-1] + 1.0])).tolist()
        ends = [-math.inf, *jumps, math.inf]
        constant = zip(ends[:-1], ends[1:], levels, levels, strict=True)
        return tuple(Interval(*ends_and_values) for ends_and_values in constant)

    @cached_property
    def interval_table(self) -> np.ndarray:
        """The intervals as rows of an array, which takes as long as the run on a long table."""
        return np.array(self.intervals)

    @cached_property
    def parts_as_json(self) -> str:
        """Steps, bumps and points, as a data file has them; 10,000 points take 10 ms."""
        parts = {"steps": self.steps, "bumps": self.bumps}
        return json.dumps(parts | {"points": self.points} if self.points else parts)

    def __call__(self, x: np.ndarray | float) -> np.ndarray:
        """Pre-stress at positions x (units of H), exactly ``peak`` at x = 0 without bumps."""
        x = as_positions("x", x)
        tau = self.level(x)
        if self.width is not None:
            # Written with 1 - exp, nothing cancels near x = 0, where the threshold is met.
            tau = self.peak + (tau - self.peak) * -np.expm1(-0.5 * (x / self.width) ** 2)
        if not self.bumps and not self.points:
            return tau
        # Bumps at equal distances are first added to each other, so that a mirrored profile is
        # mirrored to the last bit.
        bumps = sorted((abs(centre), *shape, centre) for centre, *shape in self.bumps)
        for (_, size, width), equal in groupby(bumps, key=itemgetter(0, 1, 2)):
            tau = tau + sum(size * np.exp(-0.5 * ((x - bump[3]) / width) ** 2) for bump in equal)
        # The tail of a distant bump leaves the peak within rounding of the threshold, which it is
        # meant to meet.
        rounding = ROUNDING_OF_TABLE if self.points else ROUNDING
        return np.where(np.abs(tau - 1.0) <= rounding, 1.0, tau)


def attributes_of(prestress: Prestress) -> dict[str, float | str]:
    """The attributes of a data file; the width is NaN if there is no Gaussian at x = 0."""
    width = math.nan if prestress.width is None else prestress.width
    numbers = {name: getattr(prestress, name) for name in NUMBERS} | {"width": width}
    return {**numbers, "steps_and_bumps": prestress.parts_as_json}


def prestress_from(attributes: Mapping) -> Prestress:
    """The pre-stress of a data file's attributes; KeyError if one is missing, or ValueError."""
    left, right, width, peak = (attributes[name] for name in NUMBERS)
    text = attributes["steps_and_bumps"]
    if isinstance(width, float) and math.isnan(width):
        width = None
    # Lists and the like, which are refused, are no keys of a cache.
    plain = all(isinstance(value, Hashable) for value in (text, left, right, width, peak))
    read = _cached_from_text if plain else _from_text
    return read(text, left, right, width, peak)


def _from_text(text: Any, left: Any, right: Any, width: Any, peak: Any) -> Prestress:
    try:
        given = {"points": ()} | json.loads(text)
        parts = {name: given[name] for name in (*PARTS, "points")}
    except (TypeError, ValueError, LookupError):
        allowed = "a JSON object of steps and bumps, and points of a table"
        raise ValueError(f"steps_and_bumps: {short_repr(text)}; allowed: {allowed}") from None
    digest = isinstance(parts["points"], str)
    allowed = "the points themselves, which the data file of the run has"
    check_that(not digest, "steps_and_bumps points", parts["points"], allowed)
    return Prestress(left, right, width, peak, **parts)


# The numbers of one run are measured one after the other, and each starts from the pre-stress.
_cached_from_text = lru_cache(maxsize=8, typed=True)(_from_text)


def _points(rows: Any) -> tuple[tuple[float, float], ...]:
    """Points of a table as numbers; no points are no table."""
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
    """One column of a table as numbers; ValueError names the first row that is not one."""
    key, listed = f"prestress.points {name}", values
    try:
        listed = np.asarray(values).tolist() if hasattr(values, "__array__") else [*values]
        size = len(listed)
    except TypeError:
        size = 0
    check_that(2 <= size <= MOST_POINTS, key, size, f"2 to {MOST_POINTS} numbers")
    if all(type(value) is float for value in listed) and np.all(np.isfinite(listed)):
        return listed
    for row, value in enumerate(listed, start=1):
        check_number(f"{key} in row {row}", value)
    return [*map(float, listed)]


def _check_table(x: np.ndarray) -> None:
    """Refuse positions that are not in order."""
    for row in (np.flatnonzero(np.diff(x) < 0.0) + 2)[:1].tolist():
        allowed = f">= {x[row - 2]:.10g}, the x of the row before"
        check_that(False, f"prestress.points x in row {row}", float(x[row - 1]), allowed)
    for row in (np.flatnonzero(x[2:] == x[:-2]) + 3)[:1].tolist():
        allowed = "one x in at most 2 rows, which are a jump"
        check_that(False, f"prestress.points x in row {row}", float(x[row - 1]), allowed)


def _number_tuples(key: str, rows: Any, parts: Mapping[str, Mapping]) -> tuple[tuple, ...]:
    allowed = f"a list of [{', '.join(parts)}]"
    try:
        named = [dict(zip(parts, row, strict=True)) for row in rows]
    except (TypeError, ValueError):
        raise ValueError(f"{key}: {short_repr(rows)}; allowed: {allowed}") from None
    for row in named:
        for part, value in row.items():
            check_number(f"{key} {part}", value, **parts[part])
    return tuple(tuple(map(float, row.values())) for row in named)
