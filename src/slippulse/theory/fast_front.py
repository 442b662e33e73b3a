"""Fronts that outrun the waves: T(x) is the integral of 1/v(tau(x)).

Such a front feels nothing from behind, so that its speed depends only on the pre-stress at its
position (`slowness`). `FastFront` integrates 1/v in panels that are divided until they resolve it.
"""

from bisect import bisect_right
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ..model.checks import check_choice, check_kind, check_number
from ..model.prestress import Interval, Prestress
from ..model.release import RELEASES
from ..model.runaway import check_runaway
from .curve import NODE_COUNT, NODES, NODES_TO_INTEGRALS, NODES_TO_SERIES, WEIGHTS, Panel, Point
from .prestress_pieces import GAUSSIAN_EXTENT, Piece, continued_prestress, split_into_pieces
from .riemann import kernel_rate
from .slowness import LARGEST_RATIO, slowness

# A panel is resolved if the last two Legendre coefficients of 1/v and of tau, times its length, are
# below this.
SERIES_TOLERANCE = 1e-10
# Panels shorter than this are not divided.
MIN_PANEL_LENGTH = 1e-9
# Largest length of a panel in units of 1/sqrt(gamma): its proper length sqrt(dx^2 - dT^2), for the
# phase of the waves, and its length in x, for the static solution. The third number is a length in
# x without leaf springs.
MAX_PHASE = 2.0
MAX_SCALED_LENGTH = 4.0
MAX_LENGTH_WITHOUT_SPRINGS = 8.0
MAX_PANELS = 20_000
# Slow fronts into pre-stress below this are not followed.
MIN_PRESTRESS = -1e20
# The largest factor by which the numbers of panels, positions and times may be multiplied.
MAX_REFINEMENT = 10
# Gaussians are narrow if their width, in units of 1/sqrt(gamma), is below this.
NARROW_WIDTH = 0.1
# Features are these multiples of the width of a Gaussian from its centre. Panels begin and end at
# features.
FEATURE_MULTIPLES = np.array([-GAUSSIAN_EXTENT, -4.5, -2.0, 0.0, 2.0, 4.5, GAUSSIAN_EXTENT])


@dataclass
class FastFront:
    """The law of motion of a front that outruns the waves, and the panels of its path.

    alpha is the coefficient of the drag -alpha du/dt. pieces are the pieces of positive and of
    negative pre-stress. features are positions at which a panel begins or ends; narrow_features are
    those of narrow Gaussians. kernel_rate is the rate of the waves (`riemann.kernel_rate`).
    """

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
        check_number(
            "refinement", self.refinement, integer=True, at_least=1, at_most=MAX_REFINEMENT
        )
        check_number("rate_strengthening", self.alpha)
        check_runaway(self.gamma, self.alpha)
        self.gamma, self.alpha = float(self.gamma), float(self.alpha)
        self.kernel_rate = kernel_rate(self.gamma, self.alpha)
        # A panel begins at each feature, so that no feature lies unnoticed between two nodes. They
        # are indexed [Gaussian, feature].
        centres, widths = np.array(prestress.gaussians).reshape(-1, 2).T
        features = centres[:, None] + widths[:, None] * FEATURE_MULTIPLES
        self.features = np.unique(features)
        # Features of Gaussians that a front crosses in a small fraction of a wave period.
        is_narrow = (widths * self.kernel_rate < NARROW_WIDTH) | (self.kernel_rate == 0.0)
        self.narrow_features = features[is_narrow].ravel()
        _, _, left_values, right_values = prestress.interval_table.T
        lowest_level = np.min([left_values, right_values])
        lowest = float(np.min(prestress(self.features), initial=lowest_level))
        check_number("lowest prestress", lowest, at_least=MIN_PRESTRESS)
        self.pieces = split_into_pieces(prestress)
        self._piece_ends = [piece.right for piece in self.pieces]

    def mirrored(self) -> "FastFront":
        """Return the law for the pre-stress reflected at x = 0."""
        profile = self.prestress
        steps = tuple((-position, level) for position, level in profile.steps)
        bumps = tuple((-centre, amplitude, width) for centre, amplitude, width in profile.bumps)
        points = tuple((-position, tau) for position, tau in profile.points[::-1])
        sides = {"left": profile.right, "right": profile.left}
        turned = replace(profile, **sides, steps=steps, bumps=bumps, points=points)
        return replace(self, prestress=turned)

    def slowness(self, tau: np.ndarray) -> np.ndarray:
        """Return 1/v at each pre-stress."""
        return slowness(tau, self.damping_ratio, self.release)

    @property
    def marks(self) -> list[float]:
        """Positions where pieces meet, except kinks of a table of points.

        At such a kink the pre-stress is continuous, and the front is fast on both sides of it or
        slow on both sides.
        """
        marks = []
        for piece, after in pairwise(self.pieces):
            is_turn = piece.is_above != after.is_above
            is_jump = piece.background.right_value != after.background.left_value
            is_kink_of_table = bool(self.prestress.points) and not is_turn and not is_jump
            if not is_kink_of_table:
                marks.append(piece.right)
        return marks

    def piece_right_of(self, x: float) -> Piece:
        """Return the piece that contains x, or that begins at x."""
        return self.pieces[bisect_right(self._piece_ends, x)]

    def max_panel_length(self, background: Interval) -> float:
        """Return the length of the longest panel.

        The phase of the waves changes by at most MAX_PHASE along it.
        """
        level = max(background.left_value, background.right_value)
        if self.kernel_rate == 0.0:
            return MAX_LENGTH_WITHOUT_SPRINGS / self.refinement
        slowness = self.slowness(np.array(np.clip(level, 0.0, 1.0)))
        # sqrt(dx^2 - dT^2) per unit of x.
        proper_length = float(np.sqrt(1.0 - slowness**2)) if level > 0.0 else 1.0
        length = min(MAX_PHASE / max(proper_length, 1e-3), MAX_SCALED_LENGTH)
        return length / self.kernel_rate / self.refinement

    def panels_to_right(self, start: Point, stop: float, until: float) -> tuple[list[Panel], Point]:
        """Return panels from a point to the right, and the point where they end.

        They end where tau turns negative, at the position stop, or at the end of the piece in which
        the time until is reached.
        """
        x, time = start
        panels: list[Panel] = []
        last_feature = float(np.max(self.features, initial=-np.inf))
        while x < stop and time < until:
            piece = self.piece_right_of(x)
            if not piece.is_above:
                break
            end = min(stop, piece.right)
            if np.isinf(end) and x >= last_feature:
                # The pre-stress is uniform from here on.
                slowness = float(self.slowness(np.array(piece.background.right_value)))
                end = x + (until - time) / slowness * (1.0 + 1e-9) + 1e-9
            elif np.isinf(end):
                end = last_feature
            panels += self.panels_between(piece.background, Point(x, time), end)
            x, time = end, panels[-1].time_ends[1]
        return panels, Point(x, time)

    def panels_between(self, background: Interval, start: Point, end: float) -> list[Panel]:
        """Return panels of a front that runs right from a point, within one piece."""
        max_length = self.max_panel_length(background)
        if (end - start.x) * self.refinement > MAX_PANELS * max_length:
            raise self._too_many_panels_error(background, end - start.x)
        # Panels that are short enough for the waves, and begin at every feature.
        inner = self.features[(self.features > start.x) & (self.features < end)]
        stretches = np.concatenate([[start.x], inner, [end]])
        counts = self.refinement * np.ceil(np.diff(stretches) / max_length).astype(int)
        parts = []
        for (left, right), count in zip(pairwise(stretches), counts, strict=True):
            parts.append(np.linspace(left, right, count + 1))
        edges = np.unique(np.concatenate(parts))
        edges[0], edges[-1] = start.x, end
        # Panels on which 1/v or tau is not resolved are halved.
        while True:
            half = 0.5 * np.diff(edges)[:, None]
            x = edges[:-1, None] + half * (1.0 + NODES)
            tau = continued_prestress(self.prestress, background, x)
            slowness = self.slowness(tau)
            last_coefficients = np.stack([slowness, tau]) @ NODES_TO_SERIES[-2:].T
            largest_tail = np.abs(last_coefficients).max(axis=(0, 2))
            length = 2.0 * half[:, 0]
            is_split = (largest_tail * length > SERIES_TOLERANCE) & (length > MIN_PANEL_LENGTH)
            if not is_split.any():
                break
            if edges.size > MAX_PANELS:
                raise self._too_many_panels_error(background, end - start.x)
            middles = 0.5 * (edges[:-1] + edges[1:])
            edges = np.sort(np.concatenate([edges, middles[is_split]]))
        # T is the integral of 1/v; dx/ds is half of the length of a panel.
        durations = half[:, 0] * (slowness @ WEIGHTS)
        times = start.time + np.concatenate([[0.0], np.cumsum(durations)])
        node_times = times[:-1, None] + (half * slowness) @ NODES_TO_INTEGRALS.T
        columns = x, node_times, tau * half, pairwise(edges), pairwise(times)
        return [Panel._make(row) for row in zip(*columns, strict=True)]

    def _too_many_panels_error(self, background: Interval, distance: float) -> ValueError:
        """Return the error for a front that needs too many panels."""
        level, gamma = background.right_value, self.gamma
        return ValueError(
            f"prestress: level {level!r} over a distance of {distance:g} at gamma = {gamma:g},"
            f" damping_ratio = {self.damping_ratio:g}; allowed: fronts that stay within"
            f" {MAX_PANELS} panels, of {self.max_panel_length(background):.3g} at most"
        )


def straight_panels(edges: np.ndarray, slowness: float, tau: float) -> list[Panel]:
    """Return panels of T = slowness |x| in uniform pre-stress tau.

    x = 0 is one of the edges of the panels, or beyond them.
    """
    panels = []
    for left, right in pairwise(edges.tolist()):
        half = 0.5 * (right - left)
        slope = slowness if left + right > 0.0 else -slowness
        x = left + half * (1.0 + NODES)
        source = np.full(NODE_COUNT, tau * half)
        panels.append(
            Panel(
                x=x,
                time=slope * x,
                source=source,
                x_ends=(left, right),
                time_ends=(slope * left, slope * right),
            )
        )
    return panels
