"""Fronts that outrun the waves: their arrival time T(x) is the integral of 1/v(tau(x)).

No wave from behind reaches such a front, so that its speed v depends only on the pre-stress tau at
its position (`slowness`). `FastFront` integrates 1/v in panels that are divided until they
resolve it.
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
# Largest proper length sqrt(dx^2 - dT^2) of a panel, in units of 1/sqrt(gamma). The phase of the
# waves changes by as much along the panel.
MAX_PHASE = 2.0
# Largest length of a panel in x, in the same units. It resolves the static solution.
MAX_SCALED_LENGTH = 4.0
# Largest length of a panel in x without leaf springs.
MAX_LENGTH_WITHOUT_SPRINGS = 8.0
MAX_PANELS = 20_000
# Slow fronts into pre-stress below this are not followed.
MIN_PRESTRESS = -1e20
# The largest factor by which the numbers of panels, positions and times may be multiplied.
MAX_REFINEMENT = 10
# Gaussians are narrow if their width, in units of 1/sqrt(gamma), is below this.
NARROW_WIDTH = 0.1
# Features of a Gaussian are its centre, and positions at these distances from it, in widths. They
# divide the Gaussian into panels.
FEATURE_DISTANCES = np.array([-GAUSSIAN_EXTENT, -4.5, -2.0, 0.0, 2.0, 4.5, GAUSSIAN_EXTENT])


@dataclass
class FastFront:
    """The law of motion of a front that outruns the waves, and the panels of its path.

    alpha is the coefficient of the drag -alpha du/dt in the equation of motion. The integer
    refinement divides all lengths of panels.

    Attributes: pieces are intervals of smooth pre-stress of one sign, from left to right. features
    are positions where a panel begins or ends, and narrow_features are those of narrow Gaussians.
    kernel_rate is the rate at which waves change; it is sqrt(gamma) unless drag is strong.
    """

    prestress: Prestress
    gamma: float
    damping_ratio: float
    release: str
    refinement: int = 1
    alpha: float = 0.0

    def __post_init__(self) -> None:
        """Check all fields, and set the attributes that depend on them."""
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
        self._set_features()
        # Without Gaussians the pre-stress is linear in each interval, so that it is lowest at an
        # end. A Gaussian may lower it, most at one of the features (positions in the Gaussian).
        _, _, left_values, right_values = prestress.interval_table.T
        lowest_at_ends = np.min([left_values, right_values])
        lowest = float(np.min(prestress(self.features), initial=lowest_at_ends))
        check_number("lowest prestress", lowest, at_least=MIN_PRESTRESS)
        self.pieces = split_into_pieces(prestress)
        self._piece_ends = [piece.right for piece in self.pieces]

    def _set_features(self) -> None:
        """Set ``features`` and ``narrow_features``: positions in all and in narrow Gaussians.

        These positions are the centre of each Gaussian and positions at fixed distances from it, in
        widths. A panel begins at each of them. Otherwise a narrow Gaussian could lie unnoticed
        between two nodes of a panel.
        """
        centres, widths = np.array(self.prestress.gaussians).reshape(-1, 2).T
        # The axes are [Gaussian, feature].
        features = centres[:, None] + widths[:, None] * FEATURE_DISTANCES
        self.features = np.unique(features)
        # A Gaussian is narrow compared with the length over which waves change, 1/kernel_rate. This
        # length is infinite without leaf springs and drag.
        is_narrow = (widths * self.kernel_rate < NARROW_WIDTH) | (self.kernel_rate == 0.0)
        self.narrow_features = features[is_narrow].ravel()

    def mirrored(self) -> "FastFront":
        """Return the same front for the pre-stress reflected at x = 0."""
        profile = self.prestress
        steps = tuple((-position, level) for position, level in profile.steps)
        bumps = tuple((-centre, amplitude, width) for centre, amplitude, width in profile.bumps)
        points = tuple((-position, tau) for position, tau in profile.points[::-1])
        levels = {"left": profile.right, "right": profile.left}
        mirrored = replace(profile, **levels, steps=steps, bumps=bumps, points=points)
        return replace(self, prestress=mirrored)

    def slowness(self, tau: np.ndarray) -> np.ndarray:
        """Return 1/v, the inverse of the front speed, at each pre-stress."""
        return slowness(tau, self.damping_ratio, self.release)

    @property
    def marks(self) -> list[float]:
        """Positions from which waves come, because the motion of the front changes there.

        A piece is an interval on which the pre-stress is smooth, and either above or below 0. The
        marks are the positions where two pieces meet. Only the kinks of a table of points are left
        out: the pre-stress is continuous there, and has the same sign on both sides.
        """
        marks = []
        for piece, next_piece in pairwise(self.pieces):
            changes_sign = piece.is_above != next_piece.is_above
            jumps = piece.background.right_value != next_piece.background.left_value
            is_kink_of_table = bool(self.prestress.points) and not (changes_sign or jumps)
            if not is_kink_of_table:
                marks.append(piece.right)
        return marks

    def piece_right_of(self, x: float) -> Piece:
        """Return the piece that contains x, or that begins at x."""
        return self.pieces[bisect_right(self._piece_ends, x)]

    def max_panel_length(self, background: Interval) -> float:
        """Return the largest length of an unrefined panel on an interval of the linear background.

        The phase of the waves changes by at most MAX_PHASE along such a panel. The phase is
        kernel_rate (sqrt(gamma), or more if drag is strong) times the proper length along the
        front, the integral of sqrt(dx^2 - dT^2). The panel is also short enough to resolve the
        static solution, which changes over lengths of about 1/kernel_rate.
        """
        if self.kernel_rate == 0.0:
            return MAX_LENGTH_WITHOUT_SPRINGS
        # The phase changes fastest where the front is fastest, at the higher end of the interval.
        level = max(background.left_value, background.right_value)
        # If the background is not positive, a Gaussian of unknown height drives the front. Then the
        # largest possible proper length is assumed, which belongs to an infinite speed.
        proper_length_per_x = 1.0
        if level > 0.0:
            slowness = self.slowness(np.array(min(level, 1.0)))
            proper_length_per_x = float(np.sqrt(1.0 - slowness**2))
        # Lengths in units of 1/kernel_rate are called scaled. The first one resolves the static
        # solution.
        scaled_length = MAX_SCALED_LENGTH
        if scaled_length * proper_length_per_x > MAX_PHASE:
            scaled_length = MAX_PHASE / proper_length_per_x
        return scaled_length / self.kernel_rate

    def panels_to_right(self, start: Point, stop: float, until: float) -> tuple[list[Panel], Point]:
        """Return the panels of a front that runs right from a point, and the point where they end.

        The panels end where tau turns negative, at the position ``stop``, or after the time
        ``until``. In the last case they go on to the end of the piece of pre-stress that the front
        is in.
        """
        x, time = start
        panels: list[Panel] = []
        # Features are positions in the Gaussians. Beyond the last one all Gaussians are 0.
        last_feature = float(np.max(self.features, initial=-np.inf))
        while x < stop and time < until:
            piece = self.piece_right_of(x)
            # In negative pre-stress (not above 0) the front is slower than the waves.
            if not piece.is_above:
                break
            end = min(stop, piece.right)
            # The last piece has no end. It is divided where its pre-stress becomes uniform.
            if np.isinf(end) and x < last_feature:
                end = last_feature
            elif np.isinf(end):
                # Slightly beyond the position at the time until.
                slowness = float(self.slowness(np.array(piece.background.right_value)))
                end = x + (until - time) / slowness * (1.0 + 1e-9) + 1e-9
            panels += self.panels_between(piece.background, Point(x, time), end)
            x, time = end, panels[-1].time_ends[1]
        return panels, Point(x, time)

    def panels_between(self, background: Interval, start: Point, end: float) -> list[Panel]:
        """Return the panels of a front that runs right from a point to an end, within one piece.

        background is the linear part of the pre-stress in this piece, to which Gaussians are added.
        """
        edges = self._first_edges(background, start.x, end)
        # Panels on which 1/v or tau is not resolved are halved, until all are resolved.
        while True:
            half = 0.5 * np.diff(edges)[:, None]
            x = edges[:-1, None] + half * (1.0 + NODES)
            tau = continued_prestress(self.prestress, background, x)
            slowness = self.slowness(tau)
            # The last two Legendre coefficients of 1/v and of tau on each panel.
            last_coefficients = np.stack([slowness, tau]) @ NODES_TO_SERIES[-2:].T
            largest_coefficient = np.abs(last_coefficients).max(axis=(0, 2))
            length = 2.0 * half[:, 0]
            is_unresolved = largest_coefficient * length > SERIES_TOLERANCE
            is_halved = is_unresolved & (length > MIN_PANEL_LENGTH)
            if not is_halved.any():
                break
            if edges.size > MAX_PANELS:
                raise self._too_many_panels_error(background, end - start.x)
            middles = 0.5 * (edges[:-1] + edges[1:])
            edges = np.sort(np.concatenate([edges, middles[is_halved]]))
        # T is the integral of 1/v, where dx/ds is half of the length of a panel.
        durations = half[:, 0] * (slowness @ WEIGHTS)
        times = start.time + np.concatenate([[0.0], np.cumsum(durations)])
        node_times = times[:-1, None] + (half * slowness) @ NODES_TO_INTEGRALS.T
        # Each of these arrays or iterators has one row for each panel: the fields of `Panel`.
        rows_of_fields = x, node_times, tau * half, pairwise(edges), pairwise(times)
        return [Panel._make(fields) for fields in zip(*rows_of_fields, strict=True)]

    def _first_edges(self, background: Interval, start: float, end: float) -> np.ndarray:
        """Return edges of panels from a start to an end, within one piece.

        A panel begins at every feature (a position in a Gaussian). Panels are not longer than
        `max_panel_length`, divided by the refinement.
        """
        max_length = self.max_panel_length(background)
        if (end - start) * self.refinement > MAX_PANELS * max_length:
            raise self._too_many_panels_error(background, end - start)
        features = self.features[(self.features > start) & (self.features < end)]
        ends = np.concatenate([[start], features, [end]])
        panel_counts = self.refinement * np.ceil(np.diff(ends) / max_length).astype(int)
        edges_between = []
        for (left, right), panel_count in zip(pairwise(ends), panel_counts, strict=True):
            edges_between.append(np.linspace(left, right, panel_count + 1))
        # Each end of an interval is also the start of the next one, and is kept only once.
        return np.unique(np.concatenate(edges_between))

    def _too_many_panels_error(self, background: Interval, distance: float) -> ValueError:
        """Return the error for a front that needs too many panels over a distance."""
        longest = self.max_panel_length(background) / self.refinement
        return ValueError(
            f"prestress: level {background.right_value!r} over a distance of {distance:g};"
            f" allowed: a shorter distance, with at most {MAX_PANELS} integration panels. Each"
            f" panel is at most {longest:.3g} long at gamma = {self.gamma:g} and damping_ratio ="
            f" {self.damping_ratio:g}"
        )


def straight_panels(edges: np.ndarray, slowness: float, tau: float) -> list[Panel]:
    """Return the panels between given edges of a front at constant speed, T = slowness |x|.

    tau is the uniform pre-stress. No panel may contain x = 0 in its interior.
    """
    panels = []
    for left, right in pairwise(edges.tolist()):
        # The parameter s of a panel runs from -1 to 1. Hence dx/ds is half the length of the panel.
        dx_ds = 0.5 * (right - left)
        x = left + dx_ds * (1.0 + NODES)
        panels.append(
            Panel(
                x=x,
                time=slowness * np.abs(x),
                source=np.full(NODE_COUNT, tau * dx_ds),
                x_ends=(left, right),
                time_ends=(slowness * abs(left), slowness * abs(right)),
            )
        )
    return panels
