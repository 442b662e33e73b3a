"""The rupture front as a curve t = T(x), in panels on which x, T and tau are Legendre series of a parameter.

Behind the curve each field is an integral along it, between the two points where the characteristics through
(y, t) meet it. With xi = t - y and eta = t + y these are where T - x rises to xi, going left from y, and where T + x
rises to eta, going right.
"""

from collections.abc import Iterable
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

# Times and positions that differ by less than this, relative, are the same: a hundred times the error of a stick time.
SAME = 1e-9
COUNT = 12
NODES, WEIGHTS = legendre.leggauss(COUNT)
TO_SERIES = np.linalg.inv(legendre.legvander(NODES, COUNT - 1))
# From values at the nodes to the Legendre series of the integral from the left end, and of the derivative.
INTEGRATE = legendre.legint(TO_SERIES, lbnd=-1.0)
DERIVE = legendre.legder(TO_SERIES)
# From values at the nodes to the integral from the left end, and to the derivative, at the nodes.
CUMULATIVE = legendre.legvander(NODES, COUNT) @ INTEGRATE
SLOPE = legendre.legvander(NODES, COUNT - 2) @ DERIVE
AT_ENDS = legendre.legvander(np.array([-1.0, 1.0]), COUNT - 1) @ TO_SERIES
# What has a value and a slope on each panel, all but the source monotonic.
FIELDS = ("x", "time", "late", "early", "source")


def power_basis(count: int) -> np.ndarray:
    """From a Legendre series to coefficients by powers, which are quicker to evaluate."""
    units = enumerate(np.eye(count))
    return np.array([np.pad(legendre.leg2poly(unit), (0, count - 1 - k)) for k, unit in units]).T


def with_slopes(powers: np.ndarray) -> np.ndarray:
    """Coefficients [power, column] and those of the derivative, for `value_and_slope`."""
    slopes = np.append(
        powers[1:] * np.arange(1.0, len(powers))[:, None], np.zeros_like(powers[:1]), axis=0
    )
    return np.stack([powers, slopes], axis=1).reshape(-1, 8, powers.shape[1])


TO_POWERS = with_slopes(power_basis(COUNT) @ TO_SERIES)
# From powers of a parameter to weights at the nodes of the integral from the left end to it.
PARTIAL = power_basis(COUNT + 1) @ INTEGRATE


class Panel(NamedTuple):
    """One panel: x, T and tau dx/ds at the nodes s, and x and T at both ends, with x rising."""

    x: np.ndarray
    time: np.ndarray
    source: np.ndarray
    x_ends: tuple[float, float]
    time_ends: tuple[float, float]

    def mirrored(self) -> "Panel":
        """The same at -x."""
        ends = (-self.x_ends[1], -self.x_ends[0]), self.time_ends[::-1]
        return Panel(-self.x[::-1], self.time[::-1], self.source[::-1], *ends)

    def until(self, s: float, x_end: float) -> "Panel":
        """The part from the left end to the parameter s, where x is x_end."""
        half = 0.5 * (s + 1.0)
        resample = (
            legendre.legvander(np.append(half * (1.0 + NODES) - 1.0, s), COUNT - 1) @ TO_SERIES
        )
        x, time, source = resample @ self.x, resample @ self.time, half * (resample @ self.source)
        ends = (self.x_ends[0], x_end), (self.time_ends[0], float(time[-1]))
        return Panel(x[:-1], time[:-1], source[:-1], *ends)


def seen(panels: list[Panel], side: float) -> list[Panel]:
    """Panels as they are on one side (+1), or at -x (-1)."""
    return panels if side > 0.0 else [panel.mirrored() for panel in panels[::-1]]


class Crossing(NamedTuple):
    """Where characteristics meet the curve: panels and the parameter on them; known says whether they do."""

    panel: np.ndarray
    s: np.ndarray
    known: np.ndarray


class Curve:
    """Panels side by side, from left to right without gaps; and where a front on each side outran the waves again."""

    def __init__(
        self,
        panels: list[Panel],
        restarts_left: Iterable[float] = (),
        restarts_right: Iterable[float] = (),
    ) -> None:
        self.panels = panels
        self.x = np.array([panel.x for panel in panels])
        self.time = np.array([panel.time for panel in panels])
        self.source = np.array([panel.source for panel in panels])
        x_ends = np.array([panel.x_ends for panel in panels])
        time_ends = np.array([panel.time_ends for panel in panels])
        self.edges = np.append(x_ends[:, 0], x_ends[-1, 1])
        self.edge_times = np.append(time_ends[:, 0], time_ends[-1, 1])
        self.late, self.early = self.time + self.x, self.time - self.x
        # Values at both ends of each panel, of FIELDS but the source one after another: [end, panel].
        self.ends = np.concatenate([x_ends, time_ends, time_ends + x_ends, time_ends - x_ends]).T
        self.restarts_left, self.restarts_right = tuple(restarts_left), tuple(restarts_right)

    @cached_property
    def powers(self) -> np.ndarray:
        """Of FIELDS one after another, for `value_and_slope`."""
        return TO_POWERS @ np.concatenate([self.x, self.time, self.late, self.early, self.source]).T

    def row(self, name: str, panel: np.ndarray) -> np.ndarray:
        """Where a field on panels is in `ends` and `powers`."""
        return panel + len(self.panels) * FIELDS.index(name)

    def mirrored(self) -> "Curve":
        """The same at -x."""
        restarts = ([-x for x in side] for side in (self.restarts_right, self.restarts_left))
        return Curve(seen(self.panels, -1.0), *restarts)

    def at(self, name: str, panel: np.ndarray, s: np.ndarray, order: int = 0) -> np.ndarray:
        """One of FIELDS at a parameter on panels, or its derivative by the parameter (order 1)."""
        return value_and_slope(self.powers.take(self.row(name, panel), axis=-1), s)[order]

    def covers(self, x: np.ndarray) -> np.ndarray:
        """Whether positions lie on the curve."""
        slack = SAME * (self.edges[-1] - self.edges[0])
        return (x >= self.edges[0] - slack) & (x <= self.edges[-1] + slack)

    def arrival(self, x: np.ndarray | float) -> np.ndarray:
        """T(x); NaN outside the panels."""
        x = np.asarray(x, dtype=float)
        time = self.at("time", *self.locate(x.ravel())).reshape(x.shape)
        return np.where(self.covers(x), time, np.nan)

    def locate(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Panel and parameter on it of each position."""
        panel = np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, len(self.panels) - 1)
        return panel, self._solve(self.row("x", panel), x)

    def crossings(
        self, y: np.ndarray, xi: np.ndarray, eta: np.ndarray
    ) -> tuple[Crossing, Crossing]:
        """Where T - x rises to xi, going left from y, and where T + x rises to eta, going right."""
        right, known_right = _first_rise(self.edges, self._exits[0], y, eta)
        # The same at -x.
        left, known_left = _first_rise(-self.edges[::-1], self._exits[1], -y, xi)
        left = len(self.panels) - 1 - left
        rows = np.concatenate([self.row("early", left), self.row("late", right)])
        s = self._solve(rows, np.concatenate([xi, eta]))
        s_left, s_right = (
            np.where(known_left, s[: y.size], -1.0),
            np.where(known_right, s[y.size :], 1.0),
        )
        return Crossing(left, s_left, known_left), Crossing(right, s_right, known_right)

    @cached_property
    def _exits(self) -> list[list[np.ndarray]]:
        """Going right, and going left: T + x where each panel is left, the least of it and those beyond, by regions.

        What leaves a region across a slow front sees no source beyond.
        """
        out = []
        _, _, late, early = np.split(self.ends, 4, axis=1)
        right, left = late[1], early[0, ::-1]
        for exits, edges, restarts in (
            (right, self.edges, self.restarts_left),
            (left, self.edges[::-1], self.restarts_right),
        ):
            regions = np.split(exits, sorted(int(np.argmin(np.abs(edges - x))) for x in restarts))
            out.append([np.minimum.accumulate(region[::-1])[::-1] for region in regions])
        return out

    def front_at(self, time: float, x: float, side: float) -> float:
        """Where the front going to one side from around x is at a time: the nearest position released then."""
        beyond = np.flatnonzero((side * self.edges > side * x) & (self.edge_times > time))
        if not beyond.size:
            return float(self.edges[-1 if side > 0.0 else 0])
        panel = beyond[:1] - 1 if side > 0.0 else beyond[-1:]
        found = float(
            self.at("x", panel, self._solve(self.row("time", panel), np.array([time])))[0]
        )
        return side * max(side * found, side * x)

    def _solve(self, row: np.ndarray, level: np.ndarray) -> np.ndarray:
        """The parameter where a field that is monotonic on its panel has a value."""
        at_left, at_right = self.ends[:, row]
        span = at_right - at_left
        flat = np.abs(span) < 1e-13
        out = (2.0 * (level - at_left) / np.where(flat, 1.0, span) - 1.0).clip(-1.0, 1.0)
        # Where a slow front has stopped its end is a double root, to which Newton's steps halve the way, or go astray.
        off = np.minimum(np.abs(level - at_left), np.abs(level - at_right))
        todo = np.flatnonzero(off > 1e-15 * np.abs(level))
        least = np.where(flat, 1.0, 1e-8 * np.abs(span) + 1e-300)
        s, level, rising, least = np.array([out, level, np.sign(span), least])[:, todo]
        coefficients = self.powers.take(row[todo], axis=-1)
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


def _first_rise(
    edges: np.ndarray, exits: list[np.ndarray], y: np.ndarray, level: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Panels, walking from y towards higher ones, on which a field rises to a level for the last time (what lies
    nearer falls from above it to the front); and whether there are any."""
    count = edges.size - 1
    start = np.minimum(np.searchsorted(edges, y, side="right") - 1, count - 1)
    panel, first = np.full(y.shape, count), 0
    for lowest in exits:
        last = first + lowest.size
        found = first + np.searchsorted(lowest, level, side="left")
        panel = np.where((start < last) & (panel == count) & (found < last), found, panel)
        first = last
    return np.minimum(panel, count - 1), panel < count


def value_and_slope(coefficients: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Polynomials and their derivatives at a parameter each, for every fourth power at once.

    The coefficients are [n, 2 m + derivative, point] of the power 4 n + m.
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
