"""The rupture front as a curve t = T(x), in panels on which x, T and tau are Legendre series.

Each field behind the curve is an integral along it, between the two points where the
characteristics through (y, t) meet it. With xi = t - y and eta = t + y these are the points where
T - x rises to xi, going left from y, and where T + x rises to eta, going right.
"""

from collections.abc import Sequence
from copy import copy
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

# Times and positions that differ by less than this, relative, are equal: a hundred times the error
# of a stick time.
SAME = 1e-9
COUNT = 12
NODES, WEIGHTS = legendre.leggauss(COUNT)
TO_SERIES = np.linalg.inv(legendre.legvander(NODES, COUNT - 1))
# Maps from values at the nodes: to the series of the integral from the left end; to its values at
# the nodes, to those of the derivative, and to the values at both ends.
INTEGRATE = legendre.legint(TO_SERIES, lbnd=-1.0)
CUMULATIVE = legendre.legvander(NODES, COUNT) @ INTEGRATE
SLOPE = legendre.legvander(NODES, COUNT - 2) @ legendre.legder(TO_SERIES)
AT_ENDS = legendre.legvander(np.array([-1.0, 1.0]), COUNT - 1) @ TO_SERIES
# A curve of more panels computes polynomials of these only, for at most this number of rows at a
# time, until they are asked for all together: a slow front asks for a few at each of its panels.
MANY_PANELS, FEW_ROWS = 500, 32
# Fields on a panel: x, T, T + x, T - x and tau dx/ds; all but the last are monotonic.
FIELDS = ("x", "time", "late", "early", "source")


def power_basis(count: int) -> np.ndarray:
    """Map from a Legendre series to coefficients of powers, which are quicker to evaluate."""
    units = enumerate(np.eye(count))
    return np.array([np.pad(legendre.leg2poly(unit), (0, count - 1 - k)) for k, unit in units]).T


def with_slopes(powers: np.ndarray) -> np.ndarray:
    """Coefficients [power, column] and those of the derivative, for `value_and_slope`."""
    inner = powers[1:] * np.arange(1.0, len(powers))[:, None]
    slopes = np.append(inner, np.zeros_like(powers[:1]), axis=0)
    return np.stack([powers, slopes], axis=1).reshape(-1, 8, powers.shape[1])


TO_POWERS = with_slopes(power_basis(COUNT) @ TO_SERIES)
# Map from powers of a parameter to weights at the nodes of the integral from the left end to it.
PARTIAL = power_basis(COUNT + 1) @ INTEGRATE


class Point(NamedTuple):
    """A position and a time."""

    x: float
    time: float


class Panel(NamedTuple):
    """One panel: x, T and tau dx/ds at the nodes s, and x and T at both ends, with x rising."""

    x: np.ndarray
    time: np.ndarray
    source: np.ndarray
    x_ends: tuple[float, float]
    time_ends: tuple[float, float]

    @property
    def end(self) -> Point:
        """The point at the right end."""
        return Point(self.x_ends[1], self.time_ends[1])

    def mirrored(self) -> "Panel":
        """The panel at -x."""
        ends = (-self.x_ends[1], -self.x_ends[0]), self.time_ends[::-1]
        return Panel(-self.x[::-1], self.time[::-1], self.source[::-1], *ends)

    def until(self, s: float, x_end: float) -> "Panel":
        """The part from the left end to the parameter s, where x is x_end."""
        half = 0.5 * (s + 1.0)
        parameters = np.append(half * (1.0 + NODES) - 1.0, s)
        resample = legendre.legvander(parameters, COUNT - 1) @ TO_SERIES
        x = resample @ self.x
        time = resample @ self.time
        source = half * (resample @ self.source)
        ends = (self.x_ends[0], x_end), (self.time_ends[0], float(time[-1]))
        return Panel(x[:-1], time[:-1], source[:-1], *ends)


def seen_from(side: float, panels: list[Panel]) -> list[Panel]:
    """Panels with the side, -1 (left) or +1 (right), turned to the right; twice gives them back."""
    return panels if side > 0.0 else [panel.mirrored() for panel in panels[::-1]]


class Crossing(NamedTuple):
    """Panels, and parameters on them, where characteristics meet the curve; known: they do."""

    panel: np.ndarray
    s: np.ndarray
    known: np.ndarray


class Curve:
    """Panels from left to right without gaps.

    A restart, on the left or the right side, is where a slow front outran the waves again.
    """

    def __init__(
        self, panels: list[Panel], restarts: tuple[Sequence[float], Sequence[float]] = ((), ())
    ) -> None:
        self.panels, self.restarts = panels, restarts
        columns = map(np.array, zip(*panels, strict=True))
        self.x, self.time, self.source, x_ends, time_ends = columns
        self.edges = np.append(x_ends[:, 0], x_ends[-1, 1])
        self.edge_times = np.append(time_ends[:, 0], time_ends[-1, 1])
        self.late, self.early = self.time + self.x, self.time - self.x
        self.x_ends, self.time_ends = x_ends, time_ends

    def joined(self, other: "Curve") -> "Curve":
        """This curve with another one that begins at its right end, without restarts."""
        out = Curve.__new__(Curve)
        out.panels, out.restarts = self.panels + other.panels, ((), ())
        for name in ("x", "time", "source", "late", "early", "x_ends", "time_ends"):
            setattr(out, name, np.concatenate([getattr(self, name), getattr(other, name)]))
        out.edges = np.append(self.edges[:-1], other.edges)
        out.edge_times = np.append(self.edge_times[:-1], other.edge_times)
        return out

    def restarted(self, restarts: tuple[Sequence[float], Sequence[float]]) -> "Curve":
        """This curve with some restarts."""
        out = copy(self)
        out.__dict__.pop("_exits", None)
        out.restarts = restarts
        return out

    @cached_property
    def ends(self) -> np.ndarray:
        """Values of FIELDS but the last, one after another, at both ends of panels: [end, row]."""
        x, time = self.x_ends, self.time_ends
        return np.concatenate([x, time, time + x, time - x]).T

    def coefficients(self, row: np.ndarray) -> np.ndarray:
        """Columns of `powers`."""
        count = len(self.panels)
        if count <= MANY_PANELS or row.size > FEW_ROWS or "powers" in self.__dict__:
            return self.powers.take(row, axis=-1)
        fields = (self.x, self.time, self.late, self.early, self.source)
        values = [fields[k // count][k % count] for k in row]
        return TO_POWERS @ np.reshape(values, (-1, COUNT)).T

    @cached_property
    def powers(self) -> np.ndarray:
        """Coefficients of FIELDS, one after another, for `value_and_slope`."""
        return TO_POWERS @ np.concatenate([self.x, self.time, self.late, self.early, self.source]).T

    def row(self, name: str, panel: np.ndarray) -> np.ndarray:
        """Columns of a field on panels in `ends` and `powers`."""
        return panel + len(self.panels) * FIELDS.index(name)

    def evaluate(self, name: str, panel: np.ndarray, s: np.ndarray, order: int = 0) -> np.ndarray:
        """One of FIELDS at a parameter on panels, or its derivative by the parameter (order 1)."""
        return value_and_slope(self.coefficients(self.row(name, panel)), s)[order]

    def covers(self, x: np.ndarray) -> np.ndarray:
        """Mask of the positions that lie on the curve."""
        slack = SAME * (self.edges[-1] - self.edges[0])
        return (x >= self.edges[0] - slack) & (x <= self.edges[-1] + slack)

    def arrival(self, x: np.ndarray | float) -> np.ndarray:
        """T(x); NaN outside the panels."""
        x = np.asarray(x, dtype=float)
        time = self.evaluate("time", *self.locate(x.ravel())).reshape(x.shape)
        return np.where(self.covers(x), time, np.nan)

    def locate(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Panel and parameter on it of each position."""
        panel = np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, len(self.panels) - 1)
        return panel, self._solve(self.row("x", panel), x)

    def crossings(
        self, y: np.ndarray, xi: np.ndarray, eta: np.ndarray
    ) -> tuple[Crossing, Crossing]:
        """The points where T - x rises to xi, going left from y, and T + x to eta, going right."""
        right, known_right = _first_rise(self.edges, self._exits[0], y, eta)
        mirrored, known_left = _first_rise(-self.edges[::-1], self._exits[1], -y, xi)
        left = len(self.panels) - 1 - mirrored
        rows = np.concatenate([self.row("early", left), self.row("late", right)])
        s = self._solve(rows, np.concatenate([xi, eta]))
        s_left = np.where(known_left, s[: y.size], -1.0)
        s_right = np.where(known_right, s[y.size :], 1.0)
        return Crossing(left, s_left, known_left), Crossing(right, s_right, known_right)

    @cached_property
    def _exits(self) -> tuple[list[np.ndarray], list[np.ndarray]]:
        """`_least_beyond` of T + x going right, and of T - x going left, where panels are left."""
        _, _, late, early = np.split(self.ends, 4, axis=1)
        right = _least_beyond(late[1], self.edges, self.restarts[0])
        return right, _least_beyond(early[0, ::-1], self.edges[::-1], self.restarts[1])

    def front_at(self, time: float, x: float, side: float) -> float:
        """Position of the front that goes to one side from x: the nearest that is released then."""
        later = np.flatnonzero((side * self.edges > side * x) & (self.edge_times > time))
        if not later.size:
            return float(self.edges[-1 if side > 0.0 else 0])
        panel = later[:1] - 1 if side > 0.0 else later[-1:]
        s = self._solve(self.row("time", panel), np.array([time]))
        front = float(self.evaluate("x", panel, s)[0])
        return side * max(side * front, side * x)

    def _solve(self, row: np.ndarray, level: np.ndarray) -> np.ndarray:
        """The parameter where a field that is monotonic on its panel has a value."""
        at_left, at_right = self.ends[:, row]
        span = at_right - at_left
        flat = np.abs(span) < 1e-13
        out = (2.0 * (level - at_left) / np.where(flat, 1.0, span) - 1.0).clip(-1.0, 1.0)
        # The end where a slow front has stopped is a double root, to which Newton's steps halve the
        # way, or go astray.
        distance = np.minimum(np.abs(level - at_left), np.abs(level - at_right))
        todo = np.flatnonzero(distance > 1e-15 * np.abs(level))
        least = np.where(flat, 1.0, 1e-8 * np.abs(span) + 1e-300)
        s, level, rising, least = np.array([out, level, np.sign(span), least])[:, todo]
        coefficients = self.coefficients(row[todo])
        for _ in range(40):
            if not todo.size:
                break
            value, slope = value_and_slope(coefficients, s)
            new = (s + rising * (level - value) / np.maximum(rising * slope, least)).clip(-1.0, 1.0)
            out[todo] = new
            going = np.abs(new - s) >= 1e-9
            todo, coefficients = todo[going], coefficients.compress(going, axis=-1)
            s, level, rising, least = np.array([new, level, rising, least])[:, going]
        return out


def _least_beyond(
    exits: np.ndarray, edges: np.ndarray, restarts: Sequence[float]
) -> list[np.ndarray]:
    """The least exit of each panel and those after it in its region, which ends at a restart."""
    # A characteristic that leaves its region across a slow front meets no source beyond.
    cuts = sorted(int(np.argmin(np.abs(edges - x))) for x in restarts)
    return [np.minimum.accumulate(region[::-1])[::-1] for region in np.split(exits, cuts)]


def _first_rise(
    edges: np.ndarray, regions: list[np.ndarray], y: np.ndarray, level: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Panels, from y on, on which a field rises to a level for the last time; a mask of those."""
    # The field falls to the front from above the level on nearer panels.
    count = edges.size - 1
    start = np.minimum(np.searchsorted(edges, y, side="right") - 1, count - 1)
    panel, first = np.full(y.shape, count), 0
    for lowest in regions:
        last = first + lowest.size
        candidate = first + np.searchsorted(lowest, level, side="left")
        inside = (start < last) & (candidate < last)
        panel = np.where(inside & (panel == count), candidate, panel)
        first = last
    return np.minimum(panel, count - 1), panel < count


def value_and_slope(coefficients: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Polynomials p and their derivatives at one parameter each, by Estrin's scheme.

    p(s) is the sum of s^m q_m(s^4) over m < 4. The coefficients are [n, 2 m + derivative, point] of
    the power 4 n + m; the number of powers is a multiple of 4.
    """
    square = s * s
    fourth = square * square
    out = coefficients[-1] * fourth
    for row in coefficients[-2:0:-1]:
        out += row
        out *= fourth
    out += coefficients[0]
    out = out[:4] + square * out[4:]
    return out[:2] + s * out[2:]
