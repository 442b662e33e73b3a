"""Fronts that outrun the waves: T(x) is the integral of 1/v(tau(x)), in panels that resolve it."""

from bisect import bisect_right
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ..model.checks import check_choice, check_kind, check_number
from ..model.prestress import Interval, Prestress
from ..model.release import RELEASES
from ..model.runaway import check_runaway
from .curve import COUNT, CUMULATIVE, NODES, TO_SERIES, WEIGHTS, Panel, Point
from .prestress_pieces import EXTENT, Piece, analytic, pieces
from .riemann import kernel_rate
from .slowness import LARGEST_RATIO, slowness

# Largest last Legendre coefficients of 1/v and tau on a panel, times its length.
RESOLVED = 1e-10
NARROWEST = 1e-9
# A panel is at most this long in units of 1/sqrt(gamma): in proper length, for the waves, and in x,
# for the state at rest.
LONGEST = 2.0
LONGEST_AT_REST = 4.0
LONGEST_WITHOUT_SPRINGS = 8.0
MOST_PANELS = 20_000
# Slow fronts into lower pre-stress are not followed.
LOWEST = -1e20
# The largest factor for the numbers of panels, positions and times.
FINEST = 10
# Gaussians are narrow below this width, in units of 1/sqrt(gamma).
NARROW = 0.1
# Edges of panels stand at these multiples of the width of a Gaussian.
FEATURES = np.array([-EXTENT, -4.5, -2.0, 0.0, 2.0, 4.5, EXTENT])


@dataclass
class FastFront:
    """The law of motion of a front that outruns the waves; it makes the panels of its path."""

    prestress: Prestress
    gamma: float
    damping_ratio: float
    release: str
    refinement: int = 1
    alpha: float = 0.0

    def __post_init__(self) -> None:
        prestress = self.prestress
        check_kind("prestress", prestress, Prestress)
        check_number("gamma", self.gamma, at_least=0.0)
        check_number("damping_ratio", self.damping_ratio, at_least=0.0, at_most=LARGEST_RATIO)
        check_choice("release", self.release, RELEASES)
        check_number("refinement", self.refinement, integer=True, at_least=1, at_most=FINEST)
        check_number("rate_strengthening", self.alpha)
        check_runaway(self.gamma, self.alpha)
        self.gamma, self.alpha = float(self.gamma), float(self.alpha)
        self.kernel_rate = kernel_rate(self.gamma, self.alpha)
        # An edge of a panel stands at each feature, so that none falls between two nodes.
        centre, width = np.array(prestress.gaussians).reshape(-1, 2).T[..., None]
        features = centre + width * FEATURES
        self.features = np.unique(features)
        # Those of the Gaussians that a front crosses within a fraction of a period of the waves.
        narrow = (width[:, 0] * self.kernel_rate < NARROW) | (self.kernel_rate == 0.0)
        self.narrow_features = features[narrow].ravel()
        levels = np.array(prestress.intervals)[:, 2:]
        lowest = float(np.min(prestress(self.features), initial=np.min(levels)))
        check_number("lowest prestress", lowest, at_least=LOWEST)
        self.pieces = pieces(prestress)
        self._piece_ends = [piece.right for piece in self.pieces]

    def mirrored(self) -> "FastFront":
        """The law at -x."""
        profile = self.prestress
        steps = tuple((-position, level) for position, level in profile.steps)
        bumps = tuple((-centre, amplitude, width) for centre, amplitude, width in profile.bumps)
        points = tuple((-position, tau) for position, tau in profile.points[::-1])
        sides = {"left": profile.right, "right": profile.left}
        turned = replace(profile, **sides, steps=steps, bumps=bumps, points=points)
        return replace(self, prestress=turned)

    def slowness(self, tau: np.ndarray) -> np.ndarray:
        """1/v at each pre-stress."""
        return slowness(tau, self.damping_ratio, self.release)

    @property
    def marks(self) -> list[float]:
        """Positions where the background jumps, or the front changes between fast and slow."""
        return [
            piece.right
            for piece, after in pairwise(self.pieces)
            if piece.above != after.above
            or piece.background.right_value != after.background.left_value
            or not self.prestress.points
        ]

    def piece_right_of(self, x: float) -> Piece:
        """The piece that begins at x, or holds it."""
        return self.pieces[bisect_right(self._piece_ends, x)]

    def longest(self, background: Interval) -> float:
        """Length of the longest panel, along which the phase of the springs changes by LONGEST."""
        level = max(background.left_value, background.right_value)
        if self.kernel_rate == 0.0:
            return LONGEST_WITHOUT_SPRINGS / self.refinement
        slowness = self.slowness(np.array(np.clip(level, 0.0, 1.0)))
        proper = float(np.sqrt(1.0 - slowness**2)) if level > 0.0 else 1.0
        longest = min(LONGEST / max(proper, 1e-3), LONGEST_AT_REST)
        return longest / self.kernel_rate / self.refinement

    def rightwards(self, start: Point, stop: float, until: float) -> tuple[list[Panel], Point]:
        """Panels from a point towards stop, as long as tau >= 0 and T < until, and their end."""
        x, time = start
        panels: list[Panel] = []
        last_feature = float(np.max(self.features, initial=-np.inf))
        while x < stop and time < until:
            piece = self.piece_right_of(x)
            if not piece.above:
                break
            end = min(stop, piece.right)
            if np.isinf(end) and x >= last_feature:
                # The pre-stress is uniform from here on.
                slowness = float(self.slowness(np.array(piece.background.right_value)))
                end = x + (until - time) / slowness * (1.0 + 1e-9) + 1e-9
            elif np.isinf(end):
                end = last_feature
            panels += self.between(piece.background, Point(x, time), end)
            x, time = end, panels[-1].time_ends[1]
        return panels, Point(x, time)

    def between(self, background: Interval, start: Point, end: float) -> list[Panel]:
        """Panels of a front that goes right from a point over a part of one piece."""
        longest = self.longest(background)
        if (end - start.x) * self.refinement > MOST_PANELS * longest:
            raise self._too_many(background, end - start.x)
        # Edges of panels that are short enough for the waves, with one at each feature.
        inner = self.features[(self.features > start.x) & (self.features < end)]
        rough = np.concatenate([[start.x], inner, [end]])
        count = self.refinement * np.ceil(np.diff(rough) / longest).astype(int)
        parts = [np.linspace(a, b, n + 1) for (a, b), n in zip(pairwise(rough), count, strict=True)]
        edges = np.unique(np.concatenate(parts))
        edges[0], edges[-1] = start.x, end
        while True:
            half = 0.5 * np.diff(edges)[:, None]
            x = edges[:-1, None] + half * (1.0 + NODES)
            tau = analytic(self.prestress, background, x)
            slowness = self.slowness(tau)
            tails = np.abs(np.stack([slowness, tau]) @ TO_SERIES[-2:].T).max(axis=(0, 2))
            size = 2.0 * half[:, 0]
            split = (tails * size > RESOLVED) & (size > NARROWEST)
            if not split.any():
                break
            if edges.size > MOST_PANELS:
                raise self._too_many(background, end - start.x)
            edges = np.sort(np.concatenate([edges, 0.5 * (edges[:-1] + edges[1:])[split]]))
        times = start.time + np.concatenate([[0.0], np.cumsum(half[:, 0] * (slowness @ WEIGHTS))])
        within = times[:-1, None] + (half * slowness) @ CUMULATIVE.T
        columns = x, within, tau * half, pairwise(edges), pairwise(times)
        return [Panel(*row) for row in zip(*columns, strict=True)]

    def _too_many(self, background: Interval, distance: float) -> ValueError:
        level, gamma = background.right_value, self.gamma
        return ValueError(
            f"prestress: level {level!r} over a distance of {distance:g} at gamma = {gamma:g},"
            f" damping_ratio = {self.damping_ratio:g}; allowed: fronts that stay within"
            f" {MOST_PANELS} panels, of {self.longest(background):.3g} at most"
        )


def straight_panels(edges: np.ndarray, slowness: float, tau: float) -> list[Panel]:
    """Panels of T = slowness |x| in uniform pre-stress, none of them across x = 0."""
    panels = []
    for left, right in pairwise(edges.tolist()):
        half, slope = 0.5 * (right - left), slowness if left + right > 0.0 else -slowness
        x = left + half * (1.0 + NODES)
        source = np.full(COUNT, tau * half)
        panels.append(Panel(x, slope * x, source, (left, right), (slope * left, slope * right)))
    return panels
