"""The rupture front as a curve t = T(x), in panels on which x, T and tau are Legendre series of a parameter.

Behind the curve each field is an integral along it, between the two points where the characteristics through
(y, t) meet it. With xi = t - y and eta = t + y these are where T - x rises to xi, going left from y, and where T + x
rises to eta, going right.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from ..model.roots import root_between

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
# From values at the nodes to coefficients by powers, which are quicker to evaluate.
TO_POWERS = np.array(
    [np.pad(legendre.leg2poly([0.0] * k + [1.0]), (0, COUNT - 1 - k)) for k in range(COUNT)]
).T
TO_POWERS = TO_POWERS @ TO_SERIES


class Panel(NamedTuple):
    """One panel: x, T and tau dx/ds at the nodes s, and x and T at both ends, with x rising."""

    x: np.ndarray
    time: np.ndarray
    source: np.ndarray
    x_ends: tuple[float, float]
    time_ends: tuple[float, float]

    def mirrored(self) -> Panel:
        """The same at -x."""
        ends = (-self.x_ends[1], -self.x_ends[0]), self.time_ends[::-1]
        return Panel(-self.x[::-1], self.time[::-1], self.source[::-1], *ends)

    def until(self, s: float, x_end: float) -> Panel:
        """The part from the left end to the parameter s, where x is x_end."""
        half = 0.5 * (s + 1.0)
        resample = legendre.legvander(np.append(half * (1.0 + NODES) - 1.0, s), COUNT - 1) @ TO_SERIES
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
        self, panels: list[Panel], restarts_left: Iterable[float] = (), restarts_right: Iterable[float] = ()
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
        self.late_ends, self.early_ends = time_ends + x_ends, time_ends - x_ends
        self.restarts_left, self.restarts_right = tuple(restarts_left), tuple(restarts_right)

    @cached_property
    def powers(self) -> dict[str, np.ndarray]:
        """Coefficients, by powers of the parameter, of values and their derivatives: [power, 2, panel]."""
        out = {}
        for name in ("x", "time", "late", "early", "source"):
            values = (getattr(self, name) @ TO_POWERS.T).T
            slopes = np.zeros_like(values)
            slopes[:-1] = values[1:] * np.arange(1.0, COUNT)[:, None]
            out[name] = np.stack([values, slopes], axis=1)
        return out

    def mirrored(self) -> Curve:
        """The same at -x."""
        restarts = ([-x for x in side] for side in (self.restarts_right, self.restarts_left))
        return Curve(seen(self.panels, -1.0), *restarts)

    def at(self, name: str, panel: np.ndarray, s: np.ndarray, order: int = 0) -> np.ndarray:
        """One of `powers` at a parameter on panels, or its derivative by the parameter (order 1)."""
        return horner(self.powers[name][:, order, panel], s)

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
        return panel, self._solve("x", panel, x, self.edges[panel], self.edges[panel + 1])

    def right(self, y: np.ndarray, eta: np.ndarray) -> Crossing:
        """Where T + x rises to eta, going right from y."""
        regions = self._regions(self.restarts_left)
        panel, known = _first_rise(self.edges, self.late_ends[:, 1], regions, y, eta)
        s = self._solve("late", panel, eta, *self.late_ends[panel].T)
        return Crossing(panel, np.where(known, s, 1.0), known)

    def left(self, y: np.ndarray, xi: np.ndarray) -> Crossing:
        """Where T - x rises to xi, going left from y."""
        # The same at -x.
        count = len(self.panels)
        regions = [count - r for r in reversed(self._regions(self.restarts_right))]
        panel, known = _first_rise(-self.edges[::-1], self.early_ends[::-1, 0], regions, -y, xi)
        panel = count - 1 - panel
        s = self._solve("early", panel, xi, *self.early_ends[panel].T)
        return Crossing(panel, np.where(known, s, -1.0), known)

    def _regions(self, restarts: tuple[float, ...]) -> list[int]:
        """Panels where regions begin, and their number: what leaves one across a slow front sees no source beyond."""
        return [0, *sorted(int(np.argmin(np.abs(self.edges - x))) for x in restarts), len(self.panels)]

    def front_at(self, time: float, x: float, side: float) -> float:
        """Where the front going to one side from around x is at a time: the nearest position released then."""
        edges, times = self.edges, self.edge_times
        beyond = np.flatnonzero((side * edges > side * x) & (times > time))
        if not beyond.size:
            return float(edges[-1 if side > 0.0 else 0])
        k = beyond[0] if side > 0.0 else beyond[-1]
        inner = side * max(side * edges[k - int(side)], side * x)

        def late(position: float) -> float:
            return float(self.arrival(position)) - time

        return inner if late(inner) >= 0.0 else root_between(late, inner, float(edges[k]), xtol=1e-13)

    def _solve(self, name, panel, level, at_left, at_right) -> np.ndarray:
        """The parameter where a field, monotonic on its panel with these values at the ends, has a value."""
        span = at_right - at_left
        flat = np.abs(span) < 1e-13
        s = np.clip(2.0 * (level - at_left) / np.where(flat, 1.0, span) - 1.0, -1.0, 1.0)
        rising, least = np.sign(span), 1e-8 * np.abs(span) + 1e-300
        # Where a slow front has stopped its end is a double root, to which Newton's steps halve the way, or go astray.
        todo = np.flatnonzero(
            np.minimum(np.abs(level - at_left), np.abs(level - at_right)) > 1e-15 * np.abs(level)
        )
        for _ in range(40):
            value, slope = horner(self.powers[name][:, :, panel[todo]], s[todo])
            slope = rising[todo] * np.maximum(rising[todo] * slope, least[todo]) + flat[todo]
            new = np.clip(s[todo] + (level[todo] - value) / slope, -1.0, 1.0)
            going = np.abs(new - s[todo]) >= 1e-9
            s[todo] = new
            todo = todo[going]
            if not todo.size:
                break
        return s


def _first_rise(edges, exits, regions, y, level) -> tuple[np.ndarray, np.ndarray]:
    """Panels, walking from y towards higher ones, on which a field with these values at their far ends rises to a level
    for the last time (what lies nearer falls from above it to the front); and whether there are any."""
    count = exits.size
    region = np.searchsorted(
        regions, np.clip(np.searchsorted(edges, y, side="right") - 1, 0, count - 1), side="right"
    )
    panel = np.full(y.shape, count)
    for r, (first, last) in enumerate(pairwise(regions), start=1):
        lowest = np.minimum.accumulate(exits[first:last][::-1])[::-1]
        found = first + np.searchsorted(lowest, level, side="left")
        panel = np.where((region <= r) & (panel == count) & (found < last), found, panel)
    return np.minimum(panel, count - 1), panel < count


def horner(powers: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Polynomials with coefficients [power, ...] at a parameter each."""
    out = powers[-1].copy()
    for power in powers[-2::-1]:
        out *= s
        out += power
    return out
