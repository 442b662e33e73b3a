"""The rupture front as a curve t = T(x), in panels on which x, T and tau are Legendre series of a parameter.

Behind the curve each field is an integral along it, between the two points where the characteristics through
(y, t) meet it. With xi = t - y and eta = t + y these are where T - x rises to xi, going left from y, and where T + x
rises to eta, going right.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import legendre

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
TO_POWERS = np.stack(
    [legendre.leg2poly(np.eye(COUNT)[k]).tolist() + [0.0] * (COUNT - 1 - k) for k in range(COUNT)]
).T
TO_POWERS = TO_POWERS @ TO_SERIES


@dataclass(frozen=True)
class Panel:
    """One panel: x, T and tau dx/ds at the nodes s, and x and T at both ends, with x rising."""

    x: np.ndarray
    time: np.ndarray
    source: np.ndarray
    x_ends: tuple[float, float]
    time_ends: tuple[float, float]

    def mirrored(self) -> Panel:
        """The same at -x."""
        return Panel(
            -self.x[::-1],
            self.time[::-1],
            self.source[::-1],
            (-self.x_ends[1], -self.x_ends[0]),
            self.time_ends[::-1],
        )

    def part(self, left: float, right: float) -> Panel:
        """The part between two places, -1 <= left < right <= 1."""
        half = 0.5 * (right - left)
        place = np.concatenate([left + half * (1.0 + NODES), [left, right]])
        resample = legendre.legvander(place, COUNT - 1) @ TO_SERIES
        x, time = resample @ self.x, resample @ self.time
        ends = [(self.x_ends, x), (self.time_ends, time)]
        ends = [(e[0] if left == -1.0 else f[-2], e[1] if right == 1.0 else f[-1]) for e, f in ends]
        return Panel(
            x[:-2], time[:-2], half * (resample @ self.source)[:-2], *(tuple(map(float, e)) for e in ends)
        )


@dataclass(frozen=True)
class Crossing:
    """Where characteristics meet the curve: panels and the parameter on them; known says whether they do."""

    panel: np.ndarray
    place: np.ndarray
    known: np.ndarray


class Curve:
    """Panels side by side, from left to right.

    Parameters
    ----------
    panels : in order of x, without gaps
    restarts_left, restarts_right : positions where a front, slower than the waves before, outran them again
    """

    def __init__(self, panels: list[Panel], restarts_left=(), restarts_right=()) -> None:
        self.panels = panels
        self.x = np.array([panel.x for panel in panels])
        self.time = np.array([panel.time for panel in panels])
        self.source = np.array([panel.source for panel in panels])
        x_ends = np.array([panel.x_ends for panel in panels])
        time_ends = np.array([panel.time_ends for panel in panels])
        self.edges = np.append(x_ends[:, 0], x_ends[-1, 1])
        self.edge_times = np.append(time_ends[:, 0], time_ends[-1, 1])
        self.late, self.early = self.time + self.x, self.time - self.x
        self.weight = self.source * WEIGHTS
        self._late_ends = time_ends + x_ends
        self._early_ends = time_ends - x_ends
        self.restarts_left, self.restarts_right = tuple(restarts_left), tuple(restarts_right)
        # A characteristic that leaves the rupture across a front that was slower than the waves sees no source beyond.
        self._regions_left = [0, *np.searchsorted(self.edges, sorted(restarts_left)).tolist(), len(panels)]
        self._regions_right = [0, *np.searchsorted(self.edges, sorted(restarts_right)).tolist(), len(panels)]

    @cached_property
    def powers(self) -> dict[str, np.ndarray]:
        """Coefficients by powers of the parameter: [power, panel]."""
        fields = {
            "x": self.x,
            "time": self.time,
            "late": self.late,
            "early": self.early,
            "source": self.source,
        }
        return {name: np.ascontiguousarray((values @ TO_POWERS.T).T) for name, values in fields.items()}

    @cached_property
    def slopes(self) -> dict[str, np.ndarray]:
        """Derivatives of `powers` by the parameter."""
        return {name: p[1:] * np.arange(1, len(p))[:, None] for name, p in self.powers.items()}

    def mirrored(self) -> Curve:
        """The same at -x."""
        return Curve(
            [panel.mirrored() for panel in self.panels[::-1]],
            [-x for x in self.restarts_right],
            [-x for x in self.restarts_left],
        )

    def at(self, name: str, panel: np.ndarray, place: np.ndarray) -> np.ndarray:
        """One of `powers` at places on panels."""
        return horner(self.powers[name], panel, place)

    def slope(self, name: str, panel: np.ndarray, place: np.ndarray) -> np.ndarray:
        """Its derivative by the parameter."""
        return horner(self.slopes[name], panel, place)

    def arrival(self, x) -> np.ndarray:
        """T(x); NaN outside the panels."""
        x = np.asarray(x, dtype=float)
        flat = x.ravel()
        panel, place = self.place(flat)
        out = self.at("time", panel, place)
        out[~((flat >= self.edges[0]) & (flat <= self.edges[-1]))] = np.nan
        return out.reshape(x.shape)

    def place(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Panel and place on it of each position."""
        panel = np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, len(self.panels) - 1)
        return panel, self._solve("x", panel, x, np.stack([self.edges[panel], self.edges[panel + 1]]))

    def right(self, y: np.ndarray, eta: np.ndarray) -> Crossing:
        """Where T + x rises to eta, going right from y."""
        return self._crossing("late", self._late_ends[:, 1], self._late_ends, self._regions_left, y, eta)

    def left(self, y: np.ndarray, xi: np.ndarray) -> Crossing:
        """Where T - x rises to xi, going left from y."""
        # The same at -x, panel by panel.
        count = len(self.panels)
        regions = [count - r for r in reversed(self._regions_right)]
        ends = self._early_ends[::-1, ::-1]
        mirror = self._crossing("early", ends[:, 1], ends, regions, -y, xi, flip=True)
        return Crossing(count - 1 - mirror.panel, -mirror.place, mirror.known)

    def _crossing(self, name, exits, ends, regions, y, level, flip=False) -> Crossing:
        """Walk towards higher panels (lower ones, numbered from the right, to flip) until the field rises to level."""
        edges = -self.edges[::-1] if flip else self.edges
        count = len(self.panels)
        start = np.clip(np.searchsorted(edges, y, side="right") - 1, 0, count - 1)
        region = np.searchsorted(regions, start, side="right") - 1
        panel = np.full(y.shape, count)
        for r in range(len(regions) - 1):
            first, last = regions[r], regions[r + 1]
            open_ = (region <= r) & (panel == count)
            # The last place where the field rises to the level: what lies nearer falls from above it to the front.
            lowest = np.minimum.accumulate(exits[first:last][::-1])[::-1]
            found = first + np.searchsorted(lowest, level[open_], side="left")
            panel[open_] = np.where(found < last, found, count)
        known = panel < count
        panel = np.minimum(panel, count - 1)
        near, far = ends[panel].T
        raw = count - 1 - panel if flip else panel
        bounds = np.stack([far, near]) if flip else np.stack([near, far])
        place = self._solve(name, raw, level, bounds)
        place = np.where(known, place, -1.0 if flip else 1.0)
        return Crossing(panel, -place if flip else place, known)

    def _solve(self, name, panel, level, ends) -> np.ndarray:
        """The parameter where a field, monotonic on its panel, has a value; ends are its values at -1 and 1."""
        span = ends[1] - ends[0]
        flat = np.abs(span) < 1e-13
        s = np.clip(2.0 * (level - ends[0]) / np.where(flat, 1.0, span) - 1.0, -1.0, 1.0)
        powers = self.powers[name]
        rising = np.sign(span)
        for _ in range(30):
            slope = np.zeros_like(s)
            value = powers[-1][panel]
            for power in powers[-2::-1]:
                slope *= s
                slope += value
                value *= s
                value += power[panel]
            least = 1e-3 * np.abs(span) + 1e-300
            step = (level - value) / (rising * np.maximum(rising * slope, least) + flat)
            new = np.clip(s + step, -1.0, 1.0)
            change = np.max(np.abs(new - s), initial=0.0)
            s = new
            if change < 1e-9:
                break
        return s


def horner(powers: np.ndarray, panel: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Polynomials with coefficients [power, panel] at places on panels."""
    out = powers[-1][panel]
    for power in powers[-2::-1]:
        out *= place
        out += power[panel]
    return out
