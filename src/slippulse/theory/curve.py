"""The rupture front as a curve t = T(x), divided into panels.

A panel is an interval of x with a parameter s from -1 to 1. On it x, T and tau dx/ds are stored at
the NODE_COUNT nodes of Gauss and Legendre, as in a spectral element method, so that integrals and
derivatives along the front are products with the constant matrices of this module.

Every field behind the front at a point (y, t) is an integral along the part of the curve in the
past of the point. That part lies between the two points where the characteristics through (y, t)
meet the curve (`Curve.crossings`):

              (y, t)
                /\
        `.     /  \\     .'
          `.  /    \\  .'      t = T(x)
            `/      \'
         x_l  `.  .'  x_r
                `'

At x_l, T - x rises to xi = t - y, going left from y. At x_r, T + x rises to eta = t + y, going
right.
"""

from collections.abc import Sequence
from copy import copy
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

# Times and positions are equal if their relative difference is below this, which is a hundred times
# the error of a stick time.
EQUALITY_TOLERANCE = 1e-9
NODE_COUNT = 12
NODES, WEIGHTS = legendre.leggauss(NODE_COUNT)
NODES_TO_SERIES = np.linalg.inv(legendre.legvander(NODES, NODE_COUNT - 1))
# Matrices that map values at the nodes of a panel: to the Legendre series of the function; to the
# series of its integral from the left end; to the values at the nodes of that integral and of the
# derivative with respect to s; and to the values at both ends.
NODES_TO_INTEGRAL_SERIES = legendre.legint(NODES_TO_SERIES, lbnd=-1.0)
NODES_TO_INTEGRALS = legendre.legvander(NODES, NODE_COUNT) @ NODES_TO_INTEGRAL_SERIES
NODES_TO_DERIVATIVES = legendre.legvander(NODES, NODE_COUNT - 2) @ legendre.legder(NODES_TO_SERIES)
NODES_TO_ENDS = legendre.legvander(np.array([-1.0, 1.0]), NODE_COUNT - 1) @ NODES_TO_SERIES
# A curve of at most MAX_EAGER_PANELS panels computes the polynomials of all its panels at once. A
# longer curve computes only the requested ones, unless more than MAX_SEPARATE_COLUMNS are requested
# at a time: a slow front needs a few of them at each of its steps.
MAX_EAGER_PANELS, MAX_SEPARATE_COLUMNS = 500, 32
# Quantities of which each panel has a polynomial: x, T, T + x, T - x and tau dx/ds. All of them
# except the last are monotonic on a panel.
PANEL_FIELDS = ("x", "time", "t_plus_x", "t_minus_x", "source")


def power_basis(count: int) -> np.ndarray:
    """Return the matrix from Legendre coefficients to coefficients of powers."""
    units = enumerate(np.eye(count))
    return np.array([np.pad(legendre.leg2poly(unit), (0, count - 1 - k)) for k, unit in units]).T


def with_slopes(powers: np.ndarray) -> np.ndarray:
    """Return coefficients of polynomials and of their derivatives, for `value_and_slope`.

    powers has the shape [power, polynomial], and its number of powers is a multiple of 4.
    """
    inner = powers[1:] * np.arange(1.0, len(powers))[:, None]
    slopes = np.append(inner, np.zeros_like(powers[:1]), axis=0)
    return np.stack([powers, slopes], axis=1).reshape(-1, 8, powers.shape[1])


NODES_TO_POWERS = with_slopes(power_basis(NODE_COUNT) @ NODES_TO_SERIES)
# Matrix that maps powers of a parameter to the weights at the nodes that integrate from the left
# end of the panel to that parameter.
POWERS_TO_WEIGHTS = power_basis(NODE_COUNT + 1) @ NODES_TO_INTEGRAL_SERIES


class Point(NamedTuple):
    """A position and a time."""

    x: float
    time: float


class Panel(NamedTuple):
    """One panel of a front, with x increasing: x, T and tau dx/ds at the nodes, and both ends."""

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
        """Return the panel reflected at x = 0."""
        ends = (-self.x_ends[1], -self.x_ends[0]), self.time_ends[::-1]
        return Panel(-self.x[::-1], self.time[::-1], self.source[::-1], *ends)

    def until(self, s: float, x_end: float) -> "Panel":
        """Return the part of the panel from its left end to the parameter s, where x is x_end."""
        half = 0.5 * (s + 1.0)
        parameters = np.append(half * (1.0 + NODES) - 1.0, s)
        resample = legendre.legvander(parameters, NODE_COUNT - 1) @ NODES_TO_SERIES
        x = resample @ self.x
        time = resample @ self.time
        source = half * (resample @ self.source)
        ends = (self.x_ends[0], x_end), (self.time_ends[0], float(time[-1]))
        return Panel(x[:-1], time[:-1], source[:-1], *ends)


def turned_to_right(side: float, panels: list[Panel]) -> list[Panel]:
    """Return panels with a side, -1 (left) or +1 (right), turned to the right.

    For the left side they are mirrored; a second call gives the original panels.
    """
    return panels if side > 0.0 else [panel.mirrored() for panel in panels[::-1]]


class Crossing(NamedTuple):
    """Panels, and parameters on them, where characteristics meet the curve.

    meets_curve is False for a characteristic that passes the curve by; its parameter is then that
    of the nearest end.
    """

    panel: np.ndarray
    s: np.ndarray
    meets_curve: np.ndarray


class Curve:
    """Panels from left to right without gaps.

    restarts are the positions, on the left and on the right side, where a slow front became faster
    than the waves again. They divide the curve into regions for `crossings`.
    """

    def __init__(
        self, panels: list[Panel], restarts: tuple[Sequence[float], Sequence[float]] = ((), ())
    ) -> None:
        self.panels, self.restarts = panels, restarts
        columns = map(np.array, zip(*panels, strict=True))
        self.x, self.time, self.source, x_ends, time_ends = columns
        self.edges = np.append(x_ends[:, 0], x_ends[-1, 1])
        self.edge_times = np.append(time_ends[:, 0], time_ends[-1, 1])
        self.t_plus_x, self.t_minus_x = self.time + self.x, self.time - self.x
        self.x_ends, self.time_ends = x_ends, time_ends

    def joined(self, other: "Curve") -> "Curve":
        """Return this curve followed by another that begins at its right end, without restarts."""
        out = Curve.__new__(Curve)
        out.panels, out.restarts = self.panels + other.panels, ((), ())
        for name in ("x", "time", "source", "t_plus_x", "t_minus_x", "x_ends", "time_ends"):
            setattr(out, name, np.concatenate([getattr(self, name), getattr(other, name)]))
        out.edges = np.append(self.edges[:-1], other.edges)
        out.edge_times = np.append(self.edge_times[:-1], other.edge_times)
        return out

    def restarted(self, restarts: tuple[Sequence[float], Sequence[float]]) -> "Curve":
        """Return this curve with the given restarts."""
        out = copy(self)
        out.__dict__.pop("_lowest_exits", None)
        out.restarts = restarts
        return out

    @cached_property
    def end_values(self) -> np.ndarray:
        """Values of x, T, T + x and T - x at both ends of the panels, [end, column]."""
        x, time = self.x_ends, self.time_ends
        return np.concatenate([x, time, time + x, time - x]).T

    def coefficients(self, columns: np.ndarray) -> np.ndarray:
        """Return the given columns of `powers`, computed on demand if the curve is long."""
        count = len(self.panels)
        if (
            count <= MAX_EAGER_PANELS
            or columns.size > MAX_SEPARATE_COLUMNS
            or "powers" in self.__dict__
        ):
            return self.powers.take(columns, axis=-1)
        fields = (self.x, self.time, self.t_plus_x, self.t_minus_x, self.source)
        values = [fields[k // count][k % count] for k in columns]
        return NODES_TO_POWERS @ np.reshape(values, (-1, NODE_COUNT)).T

    @cached_property
    def powers(self) -> np.ndarray:
        """Coefficients of the polynomials of PANEL_FIELDS, one field after another."""
        return (
            NODES_TO_POWERS
            @ np.concatenate([self.x, self.time, self.t_plus_x, self.t_minus_x, self.source]).T
        )

    def columns(self, name: str, panel: np.ndarray) -> np.ndarray:
        """Return the columns of a field on some panels, in `end_values` and `powers`."""
        return panel + len(self.panels) * PANEL_FIELDS.index(name)

    def evaluate(self, name: str, panel: np.ndarray, s: np.ndarray, order: int = 0) -> np.ndarray:
        """Return one of PANEL_FIELDS, or its derivative (order 1), at a parameter on each panel."""
        return value_and_slope(self.coefficients(self.columns(name, panel)), s)[order]

    def covers(self, x: np.ndarray) -> np.ndarray:
        """Return a mask of the positions that lie on the curve."""
        slack = EQUALITY_TOLERANCE * (self.edges[-1] - self.edges[0])
        return (x >= self.edges[0] - slack) & (x <= self.edges[-1] + slack)

    def arrival(self, x: np.ndarray | float) -> np.ndarray:
        """Return the arrival time T(x) of the front; NaN outside of the curve."""
        x = np.asarray(x, dtype=float)
        time = self.evaluate("time", *self.locate(x.ravel())).reshape(x.shape)
        return np.where(self.covers(x), time, np.nan)

    def locate(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the panel of each position, and the parameter on it."""
        panel = np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, len(self.panels) - 1)
        return panel, self._solve(self.columns("x", panel), x)

    def crossings(
        self, y: np.ndarray, xi: np.ndarray, eta: np.ndarray
    ) -> tuple[Crossing, Crossing]:
        """Return where the characteristics through points (y, t) meet the curve: left and right.

        On the left T - x rises to xi = t - y, going left from y; on the right T + x rises to eta =
        t + y, going right.
        """
        right, meets_right = _panels_of_crossings(
            self.edges, regions=self._lowest_exits[0], y=y, level=eta
        )
        mirrored, meets_left = _panels_of_crossings(
            -self.edges[::-1], regions=self._lowest_exits[1], y=-y, level=xi
        )
        left = len(self.panels) - 1 - mirrored
        columns = np.concatenate([self.columns("t_minus_x", left), self.columns("t_plus_x", right)])
        s = self._solve(columns, np.concatenate([xi, eta]))
        s_left = np.where(meets_left, s[: y.size], -1.0)
        s_right = np.where(meets_right, s[y.size :], 1.0)
        return Crossing(left, s_left, meets_left), Crossing(right, s_right, meets_right)

    @cached_property
    def _lowest_exits(self) -> tuple[list[np.ndarray], list[np.ndarray]]:
        """Lowest exits (`_lowest_exit_beyond`) of T + x going right, and of T - x going left.

        The exit of a panel is the value at the end where the characteristic leaves it.
        """
        _, _, t_plus_x, t_minus_x = np.split(self.end_values, 4, axis=1)
        right = _lowest_exit_beyond(t_plus_x[1], self.edges, self.restarts[0])
        return right, _lowest_exit_beyond(t_minus_x[0, ::-1], self.edges[::-1], self.restarts[1])

    def front_at(self, time: float, x: float, side: float) -> float:
        """Return the position at a time of the front that runs to one side from x.

        It is the end of the released interval around x; the end of the curve if the front has left
        it.
        """
        later = np.flatnonzero((side * self.edges > side * x) & (self.edge_times > time))
        if not later.size:
            return float(self.edges[-1 if side > 0.0 else 0])
        panel = later[:1] - 1 if side > 0.0 else later[-1:]
        s = self._solve(self.columns("time", panel), np.array([time]))
        front = float(self.evaluate("x", panel, s)[0])
        return side * max(side * front, side * x)

    def _solve(self, columns: np.ndarray, level: np.ndarray) -> np.ndarray:
        """Return the parameters where monotonic fields (by column) have given levels."""
        at_left, at_right = self.end_values[:, columns]
        span = at_right - at_left
        flat = np.abs(span) < 1e-13
        out = (2.0 * (level - at_left) / np.where(flat, 1.0, span) - 1.0).clip(-1.0, 1.0)
        # Where a slow front has stopped, the end of the panel is a double root. Newton's steps only
        # halve the distance to it, or leave the panel, so a level at an end is not iterated.
        distance = np.minimum(np.abs(level - at_left), np.abs(level - at_right))
        todo = np.flatnonzero(distance > 1e-15 * np.abs(level))
        min_slope = np.where(flat, 1.0, 1e-8 * np.abs(span) + 1e-300)
        s, level, rising, min_slope = np.array([out, level, np.sign(span), min_slope])[:, todo]
        coefficients = self.coefficients(columns[todo])
        for _ in range(40):
            if not todo.size:
                break
            value, slope = value_and_slope(coefficients, s)
            new = (s + rising * (level - value) / np.maximum(rising * slope, min_slope)).clip(
                -1.0, 1.0
            )
            out[todo] = new
            going = np.abs(new - s) >= 1e-9
            todo, coefficients = todo[going], coefficients.compress(going, axis=-1)
            s, level, rising, min_slope = np.array([new, level, rising, min_slope])[:, going]
        return out


def _lowest_exit_beyond(
    exits: np.ndarray, edges: np.ndarray, restarts: Sequence[float]
) -> list[np.ndarray]:
    """Return the lowest exit value of each panel and the later ones in its region.

    A region ends at a restart; there is one array for each region.
    """
    # A characteristic that leaves its region across a slow front meets no source farther on.
    cuts = sorted(int(np.argmin(np.abs(edges - x))) for x in restarts)
    return [np.minimum.accumulate(region[::-1])[::-1] for region in np.split(exits, cuts)]


def _panels_of_crossings(
    edges: np.ndarray, regions: list[np.ndarray], y: np.ndarray, level: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the panels, from y on, on which a field rises to a level for the last time.

    The mask that is returned with them is False where there is no such panel.
    """
    # On the way from y the field first falls, from above the level, down to the front.
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
    """Return polynomials p and their derivatives at one parameter each, [p or p', point].

    By Estrin's scheme p(s) is the sum of s^m q_m(s^4) over m < 4. The coefficients are indexed [n,
    2 m + derivative, point] for the power 4 n + m, and the number of powers is a multiple of 4.
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
