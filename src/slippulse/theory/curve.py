"""The rupture front as a curve t = T(x), divided into panels.

T(x) is the time at which the front arrives at x. A panel is an interval of x with a parameter s
from -1 to 1. On it x, T and tau dx/ds are stored at NODE_COUNT Gauss-Legendre nodes, as in a
spectral element method. Integrals and derivatives along the front are then products with the
constant matrices of this module.

Slip velocity, slip and strain at a point (y, t) behind the front are integrals along the part of
the curve in the past of the point. That part lies between the two points where the characteristics
through (y, t) meet the curve (`Curve.crossings`):

              (y, t)
                /\
        `.     /  \\     .'
          `.  /    \\  .'      t = T(x)
            `/      \'
         x_l  `.  .'  x_r
                `'

At x_l, T - x rises to xi = t - y, going left from y. At x_r, T + x rises to eta = t + y, going
right.

A restart is a position where a slow front became faster than the waves again, or where a slow front
met another front. T + x has a maximum at each restart of a left front, and T - x at each restart of
a right front. So a characteristic may have several crossings with the curve, of which only the one
nearest to its point counts.
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
# Nodes and weights of each panel, in its parameter s.
NODE_COUNT = 12
NODES, WEIGHTS = legendre.leggauss(NODE_COUNT)
# The following matrices are multiplied by the values of a function at the nodes of a panel.
# They give its Legendre series, and the series of its integral from the left end.
NODES_TO_SERIES = np.linalg.inv(legendre.legvander(NODES, NODE_COUNT - 1))
NODES_TO_INTEGRAL_SERIES = legendre.legint(NODES_TO_SERIES, lbnd=-1.0)
# These matrices give this integral, and the derivative by s, at the nodes.
NODES_TO_INTEGRALS = legendre.legvander(NODES, NODE_COUNT) @ NODES_TO_INTEGRAL_SERIES
NODES_TO_DERIVATIVES = legendre.legvander(NODES, NODE_COUNT - 2) @ legendre.legder(NODES_TO_SERIES)
# These rows give the value of the function at s = -1, and at s = 1.
NODES_TO_START, NODES_TO_END = (
    legendre.legvander(np.array([-1.0, 1.0]), NODE_COUNT - 1) @ NODES_TO_SERIES
)
# A curve of at most MAX_EAGER_PANELS panels computes the polynomials of all its panels at once. A
# longer curve computes only the requested polynomials, because a slow front needs only a few at
# each of its steps. If more than MAX_SEPARATE_POLYNOMIALS are requested at once, it computes all.
MAX_EAGER_PANELS, MAX_SEPARATE_POLYNOMIALS = 500, 32
# The most steps of Newton's method for a parameter on a panel.
MAX_NEWTON_STEPS = 40
# Quantities of which each panel has a polynomial: x, T, T + x, T - x and tau dx/ds. All of them
# except the last are monotonic on a panel.
PANEL_FIELDS = ("x", "time", "t_plus_x", "t_minus_x", "source")


def power_basis(count: int) -> np.ndarray:
    """Return the matrix from coefficients of a Legendre series to coefficients of powers.

    The series and the powers have ``count`` coefficients each. Row m belongs to the power m, and
    column k to the Legendre polynomial of degree k.
    """
    columns = []
    for degree, unit in enumerate(np.eye(count)):
        powers = legendre.leg2poly(unit)
        # The coefficients of the powers above the degree are 0.
        columns.append(np.pad(powers, (0, count - 1 - degree)))
    return np.array(columns).T


def with_slopes(powers: np.ndarray) -> np.ndarray:
    """Return coefficients of polynomials and of their derivatives, as `value_and_slope` needs them.

    powers has one row for each power and one column for each polynomial. The number of rows is a
    multiple of 4. The result has the shape [group, row, polynomial], where each group has four
    powers. The rows of the first group are p_0, d_0, p_1, d_1, p_2, d_2, p_3 and d_3, where p_m is
    the coefficient of the power m in the polynomial, and d_m that in its derivative.
    """
    exponents = np.arange(1.0, len(powers))
    slopes = powers[1:] * exponents[:, None]
    # The derivatives have one power less. A row of zeros makes both arrays equally long.
    slopes = np.append(slopes, np.zeros_like(powers[:1]), axis=0)
    # The axes are [power, polynomial or derivative, number of the polynomial].
    in_pairs = np.stack([powers, slopes], axis=1)
    group_count, polynomial_count = len(powers) // 4, powers.shape[1]
    return in_pairs.reshape(group_count, 8, polynomial_count)


NODES_TO_POWERS = with_slopes(power_basis(NODE_COUNT) @ NODES_TO_SERIES)
# Matrix that gives weights of the nodes from the powers of a parameter. With these weights a
# function is integrated from the left end of its panel to that parameter.
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

    def left_part(self, s: float, x_end: float) -> "Panel":
        """Return the part of the panel from its left end to the parameter s, where x is x_end."""
        # The nodes of the new panel, in the parameter of this one.
        fraction = 0.5 * (s + 1.0)
        new_nodes = fraction * (1.0 + NODES) - 1.0
        nodes_and_end = np.append(new_nodes, s)
        # The matrix that interpolates from the old nodes to the new nodes and the new end.
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
    """Return panels such that one of their sides, -1 (left) or +1 (right), points to the right.

    For the left side the panels are mirrored at x = 0 and reversed. A second call undoes this.
    """
    return panels if side > 0.0 else [panel.mirrored() for panel in panels[::-1]]


class Crossing(NamedTuple):
    """Panels, and parameters s on them, where characteristics meet the curve.

    meets_curve is False for a characteristic that does not meet it. The parameter is then that of
    the nearest end of the curve.
    """

    panel: np.ndarray
    s: np.ndarray
    meets_curve: np.ndarray


class Curve:
    """The fronts of a connected part of a rupture: panels from left to right without gaps.

    restarts are the positions where a slow front became faster than the waves again: those of left
    fronts, and those of right fronts. They divide the curve into regions for `crossings`. edges and
    edge_times are the positions and times of the ends of the panels. Neighbouring panels share one.
    """

    def __init__(
        self, panels: list[Panel], restarts: tuple[Sequence[float], Sequence[float]] = ((), ())
    ) -> None:
        """Store panels and restarts (where left fronts, and right fronts, became fast again)."""
        self.panels, self.restarts = panels, restarts
        # The axes are [panel, node].
        self.x = np.array([panel.x for panel in panels])
        self.time = np.array([panel.time for panel in panels])
        self.source = np.array([panel.source for panel in panels])
        # The axes are [panel, left or right end].
        self.x_ends = np.array([panel.x_ends for panel in panels])
        self.time_ends = np.array([panel.time_ends for panel in panels])
        self.edges = np.append(self.x_ends[:, 0], self.x_ends[-1, 1])
        self.edge_times = np.append(self.time_ends[:, 0], self.time_ends[-1, 1])
        self.t_plus_x, self.t_minus_x = self.time + self.x, self.time - self.x

    def joined(self, other: "Curve") -> "Curve":
        """Return this curve followed by another that begins at its right end, without restarts."""
        # The arrays of both curves are joined, which is faster than building them from the panels.
        joined = Curve.__new__(Curve)
        joined.panels, joined.restarts = self.panels + other.panels, ((), ())
        for name in ("x", "time", "source", "t_plus_x", "t_minus_x", "x_ends", "time_ends"):
            setattr(joined, name, np.concatenate([getattr(self, name), getattr(other, name)]))
        # Both curves have the edge where they meet. Of the two, that of the other curve is kept.
        joined.edges = np.append(self.edges[:-1], other.edges)
        joined.edge_times = np.append(self.edge_times[:-1], other.edge_times)
        return joined

    def with_restarts(self, restarts: tuple[Sequence[float], Sequence[float]]) -> "Curve":
        """Return this curve with other restarts: those of left fronts, and those of right fronts.

        Restarts are the positions where a slow front became faster than the waves again.
        """
        curve = copy(self)
        # The cached property _lowest_levels depends on the restarts. All other ones remain valid.
        curve.__dict__.pop("_lowest_levels", None)
        curve.restarts = restarts
        return curve

    @cached_property
    def end_values(self) -> np.ndarray:
        """Values of x, T, T + x and T - x at the left ends (row 0) and right ends of the panels.

        The columns are the numbers of `polynomial_numbers`: first x on all panels, then T, and so
        on.
        """
        x, time = self.x_ends, self.time_ends
        return np.concatenate([x, time, time + x, time - x]).T

    def coefficients(self, numbers: np.ndarray) -> np.ndarray:
        """Return the coefficients of polynomials, each of which is one field on one panel.

        `polynomial_numbers` gives their numbers. A long curve computes only the requested ones,
        unless they are many (see MAX_EAGER_PANELS).
        """
        panel_count = len(self.panels)
        is_short = panel_count <= MAX_EAGER_PANELS
        # A cached property is in this dictionary once it was computed.
        are_all_computed = "all_coefficients" in self.__dict__
        if is_short or are_all_computed or numbers.size > MAX_SEPARATE_POLYNOMIALS:
            return self.all_coefficients.take(numbers, axis=-1)
        node_values = []
        for number in numbers.tolist():
            # Find the field and the panel: the inverse of `polynomial_numbers`.
            field, panel = divmod(number, panel_count)
            node_values.append(getattr(self, PANEL_FIELDS[field])[panel])
        return NODES_TO_POWERS @ np.reshape(node_values, (-1, NODE_COUNT)).T

    @cached_property
    def all_coefficients(self) -> np.ndarray:
        """Coefficients of the polynomials of all fields on all panels, as `with_slopes` gives them.

        The last axis has the numbers of `polynomial_numbers`.
        """
        node_values = np.concatenate([getattr(self, name) for name in PANEL_FIELDS])
        return NODES_TO_POWERS @ node_values.T

    def polynomial_numbers(self, name: str, panel: np.ndarray) -> np.ndarray:
        """Return the numbers of the polynomials of a field (one of PANEL_FIELDS) on some panels.

        The polynomials of the first field on all panels come first, then those of the second field,
        and so on.
        """
        return panel + len(self.panels) * PANEL_FIELDS.index(name)

    def evaluate(self, name: str, panel: np.ndarray, s: np.ndarray, order: int = 0) -> np.ndarray:
        """Return a field (one of PANEL_FIELDS) at a parameter s on each of the panels.

        With order 1 it is the derivative of the field by s.
        """
        coefficients = self.coefficients(self.polynomial_numbers(name, panel))
        return value_and_slope(coefficients, s)[order]

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
        return panel, self._find_parameters(self.polynomial_numbers("x", panel), x)

    def crossings(
        self, y: np.ndarray, xi: np.ndarray, eta: np.ndarray
    ) -> tuple[Crossing, Crossing]:
        """Return where the characteristics through points (y, t) meet the curve: left and right.

        The left one is traced back in time from the point to the left, to where T - x = xi = t - y.
        The right one is traced back to the right, to where T + x = eta = t + y. First the panels
        are found, and then the parameters s on them.
        """
        # The lowest values of T + x and T - x beyond each panel, which are searched by bisection.
        levels_to_right, levels_to_left = self._lowest_levels
        right, meets_right = _panels_of_crossings(
            self.edges, lowest_levels=levels_to_right, y=y, level=eta
        )
        # The left side is searched as the right side of the mirrored curve, in which the order of
        # the panels is reversed.
        left_of_mirrored, meets_left = _panels_of_crossings(
            -self.edges[::-1], lowest_levels=levels_to_left, y=-y, level=xi
        )
        left = len(self.panels) - 1 - left_of_mirrored
        # Both sides are solved together: the polynomials of T - x on the left panels, and then
        # those of T + x on the right panels.
        numbers_left = self.polynomial_numbers("t_minus_x", left)
        numbers_right = self.polynomial_numbers("t_plus_x", right)
        numbers = np.concatenate([numbers_left, numbers_right])
        s = self._find_parameters(numbers, np.concatenate([xi, eta]))
        # A characteristic that does not meet the curve has the parameter of the nearest end.
        s_left = np.where(meets_left, s[: y.size], -1.0)
        s_right = np.where(meets_right, s[y.size :], 1.0)
        return Crossing(left, s_left, meets_left), Crossing(right, s_right, meets_right)

    @cached_property
    def _lowest_levels(self) -> tuple[list[np.ndarray], list[np.ndarray]]:
        """Levels from which `crossings` finds the panel on which a characteristic meets the curve.

        A characteristic that is traced to the right meets the curve where T + x rises to its value
        eta for the last time in its region. From there to the end of the region T + x is not below
        eta. So the crossing is on the first
        panel for which T + x is at least eta at the right ends of this panel and of all panels
        beyond it. To find this panel, the lowest T + x at these ends is computed for each panel.
        These levels are in ascending order, and can be searched by bisection. For a characteristic
        to the left the same is done with T - x at the left ends.

        The first result is for the right, and the second one for the left. Each has one array for
        each region between restarts (`_lowest_level_beyond`).
        """
        left_end, right_end = 0, 1
        t_plus_x = self.time_ends[:, right_end] + self.x_ends[:, right_end]
        t_minus_x = self.time_ends[:, left_end] - self.x_ends[:, left_end]
        # T + x has a maximum at the restarts of left fronts, and T - x at those of right fronts.
        left_restarts, right_restarts = self.restarts
        to_right = _lowest_level_beyond(t_plus_x, self.edges, left_restarts)
        # To the left the order of panels and edges is reversed.
        to_left = _lowest_level_beyond(t_minus_x[::-1], self.edges[::-1], right_restarts)
        return to_right, to_left

    def front_at(self, time: float, x: float, side: float) -> float:
        """Return where the front that runs from x to one side is at a time.

        side is -1 (left) or +1 (right). Everything between x and the front has been released. If
        the front has run beyond the end of the curve, this end is returned.
        """
        is_on_side = side * self.edges > side * x
        released_later = np.flatnonzero(is_on_side & (self.edge_times > time))
        if not released_later.size:
            return float(self.edges[-1] if side > 0.0 else self.edges[0])
        # The front is on the panel that leads to the nearest of these edges. Panel k lies between
        # the edges k and k + 1.
        panel = np.array([released_later[0] - 1 if side > 0.0 else released_later[-1]])
        # The parameter on this panel at which T is the time.
        s = self._find_parameters(self.polynomial_numbers("time", panel), np.array([time]))
        front = float(self.evaluate("x", panel, s)[0])
        # If x itself is on this panel, the result is not behind it.
        return side * max(side * front, side * x)

    def _find_parameters(self, numbers: np.ndarray, level: np.ndarray) -> np.ndarray:
        """Return the parameters s at which fields have the given levels, each on its panel.

        Each field (such as T + x) is a polynomial of s on its panel, where it is monotonic. numbers
        says which field and which panel (see `polynomial_numbers`). Newton's method starts from
        linear interpolation between the ends of the panel. The steps do not leave the panel.
        """
        at_left, at_right = self.end_values[:, numbers]
        rise = at_right - at_left
        is_flat = np.abs(rise) < 1e-13
        fraction = (level - at_left) / np.where(is_flat, 1.0, rise)
        s = (2.0 * fraction - 1.0).clip(-1.0, 1.0)
        # A level at an end of the panel needs no step. It is left out because this end is a double
        # root where a slow front has stopped, so that Newton's steps would only halve the distance.
        distance_to_end = np.minimum(np.abs(level - at_left), np.abs(level - at_right))
        unsolved = np.flatnonzero(distance_to_end > 1e-15 * np.abs(level))
        # A smallest slope limits the steps.
        min_slope = np.where(is_flat, 1.0, 1e-8 * np.abs(rise))
        s[unsolved] = _solve_by_newton(
            self.coefficients(numbers[unsolved]),
            s=s[unsolved],
            level=level[unsolved],
            sign=np.sign(rise[unsolved]),
            min_slope=min_slope[unsolved],
        )
        return s


def _solve_by_newton(
    coefficients: np.ndarray,
    s: np.ndarray,
    level: np.ndarray,
    sign: np.ndarray,
    min_slope: np.ndarray,
) -> np.ndarray:
    """Return the parameters at which monotonic polynomials have given levels, by Newton's method.

    s is where the search starts, between -1 and 1. sign is the sign of the slope of each
    polynomial. Smaller slopes than min_slope are replaced by it, so that steps are not too long.
    coefficients have the polynomials on their last axis, and are given to `value_and_slope`.
    """
    parameters = s.copy()
    # From here on, all arrays are kept only for the polynomials that are not solved yet.
    unsolved = np.arange(s.size)
    for _ in range(MAX_NEWTON_STEPS):
        if not unsolved.size:
            break
        value, slope = value_and_slope(coefficients, s)
        step = sign * (level - value) / np.maximum(sign * slope, min_slope)
        next_s = (s + step).clip(-1.0, 1.0)
        parameters[unsolved] = next_s
        still_changes = np.abs(next_s - s) >= 1e-9
        unsolved, s = unsolved[still_changes], next_s[still_changes]
        level, sign = level[still_changes], sign[still_changes]
        min_slope = min_slope[still_changes]
        coefficients = coefficients.compress(still_changes, axis=-1)
    return parameters


def _lowest_level_beyond(
    levels: np.ndarray, edges: np.ndarray, restarts: Sequence[float]
) -> list[np.ndarray]:
    """Return, for each panel, the lowest level of this panel and of later ones in its region.

    The result has one array for each region. A region ends at a restart, where a slow front became
    faster than the waves again, so that levels have a maximum there. A characteristic that meets
    the curve before this maximum is not followed beyond it, so that later regions do not count.

    levels : T + x at the right ends of the panels, from left to right, for characteristics that run
        to the right; T - x at the left ends, from right to left, for those that run to the left
    edges : ends of the panels, in the same order
    restarts : positions where the regions end
    """
    # The number of the first panel after each restart, which is at an edge of panels.
    region_ends = sorted(int(np.argmin(np.abs(edges - x))) for x in restarts)
    lowest = []
    for levels_of_region in np.split(levels, region_ends):
        from_far_end = np.minimum.accumulate(levels_of_region[::-1])
        lowest.append(from_far_end[::-1])
    return lowest


def _panels_of_crossings(
    edges: np.ndarray, lowest_levels: list[np.ndarray], y: np.ndarray, level: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return, for each point, the panel on which its characteristic to the right meets the curve.

    T + x rises to the level t + y of the point there. The curve is divided into regions at the
    restarts of its left fronts, where T + x has a maximum (see the top of this module). In each
    region T + x first falls, where the left front is slow, and then rises. The first region in
    which it rises to the level counts, but none on the left of the point. At the beginning of this
    region T + x may also be above the level, but then it falls below it. So the panel is the one on
    which T + x rises to the level for the last time.

    Also return a mask that is False for points without a panel; for these the last panel is
    returned.

    edges : ends of the panels
    lowest_levels : for each region and each of its panels, the lowest T + x at the right ends of
        this panel and of later panels in the region
    y, level : position of each point, and t + y there
    """
    panel_count = edges.size - 1
    panel_of_point = np.minimum(np.searchsorted(edges, y, side="right") - 1, panel_count - 1)
    # As long as no panel is found, the number of panels stands for it.
    panel = np.full(y.shape, panel_count)
    region_start = 0
    for lowest_levels_of_region in lowest_levels:
        region_end = region_start + lowest_levels_of_region.size
        # The first panel from whose right end to the end of the region T + x is not below the
        # level. The lowest levels are in ascending order.
        candidate = region_start + np.searchsorted(lowest_levels_of_region, level, side="left")
        # Regions that end on the left of a point do not count.
        has_crossing = (panel_of_point < region_end) & (candidate < region_end)
        is_not_found = panel == panel_count
        panel = np.where(has_crossing & is_not_found, candidate, panel)
        region_start = region_end
    return np.minimum(panel, panel_count - 1), panel < panel_count


def value_and_slope(coefficients: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Return the values of polynomials (row 0) and their derivatives (row 1) at parameters s.

    There is one parameter for each polynomial. For speed, each polynomial p and its derivative are
    split into four polynomials q of the fourth power of s (Estrin's scheme):

        p(s) = q_0(s^4) + s q_1(s^4) + s^2 q_2(s^4) + s^3 q_3(s^4).

    coefficients come from `with_slopes`, with the axes [group, row, polynomial]. Each group belongs
    to one power of s^4, and has eight rows: the coefficients of q_0 to q_3, each first for the
    polynomial and then for its derivative.
    """
    square = s * s
    fourth = square * square
    # Horner's rule in s^4, for all eight rows at once.
    q = coefficients[-1] * fourth
    for group in coefficients[-2:0:-1]:
        q += group
        q *= fourth
    q += coefficients[0]
    # The first four rows are q_0 and q_1 (value and derivative of each), the others q_2 and q_3. So
    # the sums are q_0 + s^2 q_2 in the first two rows, and q_1 + s^2 q_3 in the last two.
    sums = q[:4] + square * q[4:]
    return sums[:2] + s * sums[2:]
