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
# The most steps of Newton's method for a parameter on a panel.
MAX_NEWTON_STEPS = 40
# Quantities of which each panel has a polynomial: x, T, T + x, T - x and tau dx/ds. All of them
# except the last are monotonic on a panel.
PANEL_FIELDS = ("x", "time", "t_plus_x", "t_minus_x", "source")


def power_basis(count: int) -> np.ndarray:
    """Return the matrix from coefficients of a Legendre series to coefficients of powers.

    Row m belongs to the power m, and column k to the Legendre polynomial of degree k.
    """
    columns = []
    for degree, unit in enumerate(np.eye(count)):
        powers = legendre.leg2poly(unit)
        columns.append(np.pad(powers, (0, count - 1 - degree)))
    return np.array(columns).T


def with_slopes(powers: np.ndarray) -> np.ndarray:
    """Return coefficients of polynomials and of their derivatives, in groups of four powers.

    powers has the shape [power, polynomial], and its number of powers is a multiple of 4. The
    result has the shape [group, row, polynomial], as `value_and_slope` takes it. The 8 rows of a
    group are the coefficients of the polynomial and of its derivative for the lowest power, then
    both for the next power, and so on.
    """
    exponents = np.arange(1.0, len(powers))
    slopes = powers[1:] * exponents[:, None]
    # The highest power of the derivatives is added with the coefficient 0.
    slopes = np.append(slopes, np.zeros_like(powers[:1]), axis=0)
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
        left, right = self.x_ends
        return Panel(
            x=-self.x[::-1],
            time=self.time[::-1],
            source=self.source[::-1],
            x_ends=(-right, -left),
            time_ends=self.time_ends[::-1],
        )

    def until(self, s: float, x_end: float) -> "Panel":
        """Return the part of the panel from its left end to the parameter s, where x is x_end."""
        fraction = 0.5 * (s + 1.0)
        nodes_and_end = np.append(fraction * (1.0 + NODES) - 1.0, s)
        resample = legendre.legvander(nodes_and_end, NODE_COUNT - 1) @ NODES_TO_SERIES
        x = resample @ self.x
        time = resample @ self.time
        # The source is tau dx/ds, and dx/ds of the shorter panel is smaller by the fraction.
        source = fraction * (resample @ self.source)
        return Panel(
            x=x[:-1],
            time=time[:-1],
            source=source[:-1],
            x_ends=(self.x_ends[0], x_end),
            time_ends=(self.time_ends[0], float(time[-1])),
        )


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
    than the waves again. They divide the curve into regions for `crossings`. edges and edge_times
    are the positions and times of the ends of the panels, where neighbouring panels share one.
    """

    def __init__(
        self, panels: list[Panel], restarts: tuple[Sequence[float], Sequence[float]] = ((), ())
    ) -> None:
        self.panels, self.restarts = panels, restarts
        # The fields of all panels as arrays, [panel, node] and [panel, left or right end].
        columns = map(np.array, zip(*panels, strict=True))
        self.x, self.time, self.source, self.x_ends, self.time_ends = columns
        self.edges = np.append(self.x_ends[:, 0], self.x_ends[-1, 1])
        self.edge_times = np.append(self.time_ends[:, 0], self.time_ends[-1, 1])
        self.t_plus_x, self.t_minus_x = self.time + self.x, self.time - self.x

    def joined(self, other: "Curve") -> "Curve":
        """Return this curve followed by another that begins at its right end, without restarts."""
        # The arrays of both curves are joined, which is faster than building them from the panels.
        whole = Curve.__new__(Curve)
        whole.panels, whole.restarts = self.panels + other.panels, ((), ())
        for name in ("x", "time", "source", "t_plus_x", "t_minus_x", "x_ends", "time_ends"):
            setattr(whole, name, np.concatenate([getattr(self, name), getattr(other, name)]))
        whole.edges = np.append(self.edges[:-1], other.edges)
        whole.edge_times = np.append(self.edge_times[:-1], other.edge_times)
        return whole

    def restarted(self, restarts: tuple[Sequence[float], Sequence[float]]) -> "Curve":
        """Return this curve with the given restarts."""
        changed = copy(self)
        # This cached property depends on the restarts. The other ones remain valid.
        changed.__dict__.pop("_lowest_exits", None)
        changed.restarts = restarts
        return changed

    @cached_property
    def end_values(self) -> np.ndarray:
        """Values of x, T, T + x and T - x at both ends of the panels, [end, column]."""
        x, time = self.x_ends, self.time_ends
        return np.concatenate([x, time, time + x, time - x]).T

    def coefficients(self, columns: np.ndarray) -> np.ndarray:
        """Return the given columns of `powers`, the coefficients of one polynomial each.

        On a long curve only the polynomials of these columns are computed (see MAX_EAGER_PANELS).
        """
        count = len(self.panels)
        are_all_computed = "powers" in self.__dict__
        is_short = count <= MAX_EAGER_PANELS
        if is_short or are_all_computed or columns.size > MAX_SEPARATE_COLUMNS:
            return self.powers.take(columns, axis=-1)
        fields = [getattr(self, name) for name in PANEL_FIELDS]
        # A column is the number of the panel, plus `count` for each field before (see `columns`).
        values = [fields[k // count][k % count] for k in columns]
        return NODES_TO_POWERS @ np.reshape(values, (-1, NODE_COUNT)).T

    @cached_property
    def powers(self) -> np.ndarray:
        """Coefficients of the polynomials of PANEL_FIELDS, one field after another."""
        values = np.concatenate([getattr(self, name) for name in PANEL_FIELDS])
        return NODES_TO_POWERS @ values.T

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
        exits_to_right, exits_to_left = self._lowest_exits
        right, meets_right = _panels_of_crossings(
            self.edges, regions=exits_to_right, y=y, level=eta
        )
        # The left side is searched as the right side of the mirrored curve.
        mirrored, meets_left = _panels_of_crossings(
            -self.edges[::-1], regions=exits_to_left, y=-y, level=xi
        )
        left = len(self.panels) - 1 - mirrored
        columns = np.concatenate([self.columns("t_minus_x", left), self.columns("t_plus_x", right)])
        s = self._solve(columns, np.concatenate([xi, eta]))
        s_left = np.where(meets_left, s[: y.size], -1.0)
        s_right = np.where(meets_right, s[y.size :], 1.0)
        return Crossing(left, s_left, meets_left), Crossing(right, s_right, meets_right)

    @cached_property
    def _lowest_exits(self) -> tuple[list[np.ndarray], list[np.ndarray]]:
        """Lowest exit values (`_lowest_exit_beyond`) for characteristics to the right and the left.

        A characteristic to the right leaves a panel at its right end, and the exit value is T + x
        there. To the left it is T - x at the left end. Regions end only at the restarts that a
        characteristic can reach from outside: those of the left side if it goes to the right.
        """
        _, _, t_plus_x, t_minus_x = np.split(self.end_values, 4, axis=1)
        exits_at_right_ends, exits_at_left_ends = t_plus_x[1], t_minus_x[0]
        left_restarts, right_restarts = self.restarts
        to_right = _lowest_exit_beyond(exits_at_right_ends, self.edges, left_restarts)
        # To the left the order of panels and edges is reversed.
        to_left = _lowest_exit_beyond(exits_at_left_ends[::-1], self.edges[::-1], right_restarts)
        return to_right, to_left

    def front_at(self, time: float, x: float, side: float) -> float:
        """Return the position at a time of the front that runs to one side from x.

        It is the end of the released interval around x; the end of the curve if the front has left
        it.
        """
        later = np.flatnonzero((side * self.edges > side * x) & (self.edge_times > time))
        if not later.size:
            return float(self.edges[-1] if side > 0.0 else self.edges[0])
        # The panel between the nearest edge that is reached later and the edge before it.
        panel = np.array([later[0] - 1 if side > 0.0 else later[-1]])
        s = self._solve(self.columns("time", panel), np.array([time]))
        front = float(self.evaluate("x", panel, s)[0])
        return side * max(side * front, side * x)

    def _solve(self, columns: np.ndarray, level: np.ndarray) -> np.ndarray:
        """Return the parameters at which fields have given levels, one for each column.

        A column stands for one monotonic field on one panel (see `columns`).

        Newton's method starts from linear interpolation between the ends of the panel. Its steps do
        not leave the panel.
        """
        at_left, at_right = self.end_values[:, columns]
        span = at_right - at_left
        is_flat = np.abs(span) < 1e-13
        fraction = (level - at_left) / np.where(is_flat, 1.0, span)
        parameters = (2.0 * fraction - 1.0).clip(-1.0, 1.0)
        # Where a slow front has stopped, the end of the panel is a double root. Newton's steps only
        # halve the distance to it, or leave the panel, so a level at an end is not iterated.
        distance = np.minimum(np.abs(level - at_left), np.abs(level - at_right))
        todo = np.flatnonzero(distance > 1e-15 * np.abs(level))
        # The sign of the slope is known, since the field is monotonic, and a lower bound of its
        # size limits the step.
        min_slope = np.where(is_flat, 1.0, 1e-8 * np.abs(span) + 1e-300)
        s, level, sign, min_slope = np.array([parameters, level, np.sign(span), min_slope])[:, todo]
        coefficients = self.coefficients(columns[todo])
        for _ in range(MAX_NEWTON_STEPS):
            if not todo.size:
                break
            value, slope = value_and_slope(coefficients, s)
            step = sign * (level - value) / np.maximum(sign * slope, min_slope)
            next_s = (s + step).clip(-1.0, 1.0)
            parameters[todo] = next_s
            going = np.abs(next_s - s) >= 1e-9
            todo, coefficients = todo[going], coefficients.compress(going, axis=-1)
            s, level, sign, min_slope = np.array([next_s, level, sign, min_slope])[:, going]
        return parameters


def _lowest_exit_beyond(
    exits: np.ndarray, edges: np.ndarray, restarts: Sequence[float]
) -> list[np.ndarray]:
    """Return, for each panel, the lowest exit value of this panel and of those beyond it.

    Only panels of the same region count, and the result has one array for each region. A region
    ends at a restart, because a characteristic that leaves its region across a slow front meets no
    source farther on.
    """
    cuts = sorted(int(np.argmin(np.abs(edges - x))) for x in restarts)
    lowest = []
    for region in np.split(exits, cuts):
        from_far_end = np.minimum.accumulate(region[::-1])
        lowest.append(from_far_end[::-1])
    return lowest


def _panels_of_crossings(
    edges: np.ndarray, regions: list[np.ndarray], y: np.ndarray, level: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return, for each point, the panel on which a field rises to a level for the last time.

    Also return a mask that is False for points without such a panel. The field is T + x, and the
    search goes to the right, through the region of the point and those beyond it.

    edges : ends of the panels
    regions : lowest exit values of the panels in each region (`_lowest_exit_beyond`)
    y, level : position of each point, and its value of the field
    """
    count = edges.size - 1
    start = np.minimum(np.searchsorted(edges, y, side="right") - 1, count - 1)
    panel, first_of_region = np.full(y.shape, count), 0
    for lowest_exits in regions:
        end_of_region = first_of_region + lowest_exits.size
        # The field reaches the level on this panel, and beyond it stays above the level up to the
        # end of the region. The lowest exit values are in ascending order.
        candidate = first_of_region + np.searchsorted(lowest_exits, level, side="left")
        is_in_region = (start < end_of_region) & (candidate < end_of_region)
        is_missing = panel == count
        panel = np.where(is_in_region & is_missing, candidate, panel)
        first_of_region = end_of_region
    return np.minimum(panel, count - 1), panel < count


def value_and_slope(coefficients: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Return polynomials p and their derivatives at one parameter each, [p or p', point].

    By Estrin's scheme p(s) is the sum of s^m q_m(s^4) over m < 4. The coefficients are indexed [n,
    2 m + derivative, point] for the power 4 n + m, and the number of powers is a multiple of 4.
    """
    square = s * s
    fourth = square * square
    # Horner's rule in s^4 for the four polynomials q_m and for those of the derivative.
    sums = coefficients[-1] * fourth
    for row in coefficients[-2:0:-1]:
        sums += row
        sums *= fourth
    sums += coefficients[0]
    # q_0 + s^2 q_2 and q_1 + s^2 q_3, and then the sum of the first and s times the second.
    sums = sums[:4] + square * sums[4:]
    return sums[:2] + s * sums[2:]
