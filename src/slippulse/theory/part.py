"""One connected part of a rupture: its curve, its trailing edge and its fields."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np

from ..model.roots import root_between
from .fronts import FrontLaw
from .riemann import Cones
from .spreading import Stretch
from .stationary import Stationary
from .trailing import TrailingEdge


class Part:
    """A connected part of the rupture with what is computed from its curve.

    Parameters
    ----------
    law : pre-stress, front law and gamma
    stretch : how it spreads
    until : time up to which it is wanted
    """

    def __init__(self, law: FrontLaw, stretch: Stretch, until: float) -> None:
        self.law, self.stretch, self.until = law, stretch, until
        self.curve = stretch.curve()

    @cached_property
    def rest(self) -> Stationary:
        """A state at rest, for slip and strain."""
        return Stationary(self.curve, self.law.gamma)

    @cached_property
    def edge(self) -> TrailingEdge:
        """Its trailing edge."""
        ends = [piece.right for piece in self.law.pieces if np.isfinite(piece.right)]
        marks = np.array([0.0, *ends, *self.stretch.joins])
        one_side = self.law.prestress.symmetric
        return TrailingEdge(self.curve, self.law.gamma, self.until, marks, self.law.refinement, one_side)

    def inside(self, x: np.ndarray) -> np.ndarray:
        """Which positions belong to it."""
        return (x >= self.curve.edges[0]) & (x <= self.curve.edges[-1])

    def field(self, name: str, y: np.ndarray, time: np.ndarray) -> np.ndarray:
        """A field at points that slide."""
        cones = Cones(self.curve, self.law.gamma, y, time)
        return cones.slip_velocity() if name == "slip_velocity" else getattr(cones, name)(self.rest)

    def front_at(self, time: float, x: float, side: float) -> float:
        """Where the front going to one side from around x is at a time: the nearest place released then."""
        edges, times = self.curve.edges, self.curve.edge_times
        beyond = np.flatnonzero((side * edges > side * x) & (times > time))
        if not beyond.size:
            return float(edges[-1 if side > 0.0 else 0])
        k = beyond[0] if side > 0.0 else beyond[-1]
        inner = edges[k - 1] if side > 0.0 else edges[k + 1]
        inner = max(inner, x) if side > 0.0 else min(inner, x)

        def late(place: float) -> float:
            return float(self.curve.arrival(np.array(place))) - time

        return root_between(late, float(inner), float(edges[k]), xtol=1e-13)

    def first_stick(self) -> tuple[float, float] | None:
        """Time and position of the first sticking."""
        edge = self.edge
        if not np.isfinite(edge.stick).any():
            return None
        # Where several are first, the one nearest to x = 0.
        first = np.flatnonzero(edge.stick <= np.nanmin(edge.stick) + 1e-10)
        k = int(first[np.argmin(np.abs(edge.x[first]))])
        centre, time = float(edge.x[k]), float(edge.stick[k])
        reach = max(edge.x[min(k + 1, edge.x.size - 1)] - centre, centre - edge.x[max(k - 1, 0)])
        for _ in range(8):
            x = centre + reach * np.linspace(-1.0, 1.0, 9)
            x = x[(x >= edge.x[0]) & (x <= edge.x[-1])]
            stick = edge.stick_time(x)
            if not np.isfinite(stick).any():
                break
            best = int(np.nanargmin(stick))
            if stick[best] < time - 1e-12:
                centre, time = float(x[best]), float(stick[best])
            reach *= 0.25
        return time, centre

    def largest_velocity(self, horizon: Callable[[np.ndarray], np.ndarray]) -> float:
        """Largest slip velocity before a horizon, from a grid refined around the largest value on it."""
        edge = self.edge
        x = edge.x
        release = self.curve.arrival(x)
        stick = np.where(np.isfinite(edge.stick), edge.stick, self.until)
        stick = np.minimum(stick, horizon(x))
        best, centre, share = 0.0, None, 0.5
        shares = np.linspace(0.0, 1.0, 33)
        grid_x, grid_share = np.meshgrid(x, shares, indexing="ij")
        reach_x, reach_share = np.max(np.diff(x), initial=1e-3), shares[1]
        for _ in range(6):
            low = np.interp(grid_x, x, release)
            time = low + (np.interp(grid_x, x, stick) - low) * grid_share
            keep = np.flatnonzero(time.ravel() > self.curve.arrival(grid_x.ravel()))
            values = self.field("slip_velocity", grid_x.ravel()[keep], time.ravel()[keep])
            n = int(np.argmax(values))
            if values[n] > best:
                best, centre, share = float(values[n]), grid_x.ravel()[keep][n], grid_share.ravel()[keep][n]
            near_x = np.clip(centre + reach_x * np.linspace(-1.0, 1.0, 7), x[0], x[-1])
            near_share = np.clip(share + reach_share * np.linspace(-1.0, 1.0, 7), 0.0, 1.0)
            grid_x, grid_share = np.meshgrid(near_x, near_share, indexing="ij")
            reach_x, reach_share = 0.4 * reach_x, 0.4 * reach_share
        return best
