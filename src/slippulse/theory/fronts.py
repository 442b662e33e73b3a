"""Fronts that outrun the waves: T(x) is the integral of 1/v(tau(x)), in panels that resolve it.

The pre-stress is cut into pieces, smooth and of one sign on each, with the intervals that are released at t = 0.
"""

from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..model.checks import check_choice, check_kind, check_number, check_runaway
from ..model.prestress import Prestress
from ..model.roots import root_between
from ..model.scene import RELEASES
from .curve import COUNT, CUMULATIVE, NODES, TO_SERIES, WEIGHTS, Panel
from .slowness import LARGEST_RATIO, slowness

# Largest last Legendre coefficients of 1/v and tau on a panel, times its length.
RESOLVED = 1e-10
NARROWEST = 1e-9
# A panel is at most so long in units of 1/sqrt(gamma): in proper length, for waves, and in x, for the state at rest.
LONGEST = 2.0
LONGEST_AT_REST = 4.0
LONGEST_WITHOUT_SPRINGS = 8.0
MOST_PANELS = 20_000
# Slow fronts into less are not followed.
LOWEST = -1e20
# How many times as many panels, positions and times may be asked for.
FINEST = 10
# A Gaussian is its level to rounding beyond this many widths; edges of panels stand at these multiples of the width.
EXTENT = 9.0
FEATURES = np.array([-EXTENT, -4.5, -2.0, 0.0, 2.0, 4.5, EXTENT])
# Samples a width that find each sign change.
SAMPLES = 32
ROUNDING = 1e-15


class Piece(NamedTuple):
    """An interval on which the pre-stress is smooth and of one sign."""

    left: float
    right: float
    level: float  # of its side
    supersonic: bool  # tau >= 0, so that a front outruns the waves


def analytic(prestress: Prestress, level: float, x: np.ndarray) -> np.ndarray:
    """The pre-stress with one level everywhere: analytic, and the pre-stress itself where the level is that."""
    tau = prestress.peak + (level - prestress.peak) * -np.expm1(-0.5 * (x / prestress.width) ** 2)
    for centre, amplitude, width in prestress.bumps:
        tau = tau + amplitude * np.exp(-0.5 * ((x - centre) / width) ** 2)
    return tau


def pieces(prestress: Prestress) -> list[Piece]:
    """The pieces from left to right."""
    out = []
    for left, right, level in prestress.intervals:
        sign, marks = _crossings(prestress, left, right, level, 0.0)
        for a, b in pairwise([left, *marks, right]):
            if b > a:
                out.append(Piece(a, b, level, sign))
            sign = not sign
    return out


def nucleations(prestress: Prestress) -> list[tuple[float, float]]:
    """The intervals (points, where tau only touches 1) with tau >= 1, from left to right."""
    found: list[tuple[float, float]] = []
    for left, right, level in prestress.intervals:
        over, marks = _crossings(prestress, left, right, level, 1.0)
        marks = [left, *marks] if over else marks
        found += zip(marks[::2], [*marks[1::2], right], strict=False)
    merged: list[tuple[float, float]] = []
    for a, b in sorted(found):
        if merged and a <= merged[-1][1]:
            merged[-1] = (merged[-1][0], max(b, merged[-1][1]))
        else:
            merged.append((a, b))
    return merged


def _crossings(
    prestress, left: float, right: float, level: float, value: float
) -> tuple[bool, list[float]]:
    """Whether an interval begins with the pre-stress at a value or above, and where that changes; it touches twice."""
    # Positions that show each change of sign, and both ends; far outside everything a side has its last level.
    fine = np.linspace(-EXTENT, EXTENT, int(2 * EXTENT * SAMPLES) + 1)
    x = np.concatenate([centre + width * fine for centre, width in _gaussians(prestress)])
    first = left if np.isfinite(left) else min(float(x.min()), right) - 1.0
    last = right if np.isfinite(right) else max(float(x.max()), left) + 1.0
    x = np.unique(np.concatenate([x[(x > left) & (x < right)], [first, last]]))

    def excess(position: float) -> float:
        return float(analytic(prestress, level, np.asarray(position))) - value

    # What is at the value but for rounding, as under the far tail of a bump, is there.
    at = analytic(prestress, level, x) - value
    at[np.abs(at) <= ROUNDING] = 0.0
    above = at >= 0.0
    marks = []
    for k in np.flatnonzero(above[1:] != above[:-1]):
        touching = x[k : k + 2][at[k : k + 2] == 0.0]
        marks.append(
            float(touching[0])
            if touching.size
            else root_between(excess, x[k], x[k + 1], xtol=1e-14)
        )
    return bool(above[0]), marks


def _gaussians(prestress: Prestress) -> list[tuple[float, float]]:
    """Centre and width of the peak and of each bump."""
    return [(0.0, prestress.width), *((centre, width) for centre, _, width in prestress.bumps)]


class FrontLaw:
    """What makes panels where a front outruns the waves."""

    def __init__(
        self, prestress: Prestress, gamma: float, damping_ratio: float, release: str, refinement: int = 1,
        alpha: float = 0.0,
    ) -> None:  # fmt: skip
        check_kind("prestress", prestress, Prestress)
        check_number("gamma", gamma, at_least=0.0)
        check_number("damping_ratio", damping_ratio, at_least=0.0, at_most=LARGEST_RATIO)
        check_choice("release", release, RELEASES)
        check_number("refinement", refinement, integer=True, at_least=1, at_most=FINEST)
        check_number("rate_strengthening", alpha)
        check_runaway(gamma, alpha)
        self.prestress, self.gamma, self.alpha = prestress, float(gamma), float(alpha)
        # The fastest that a kernel changes.
        self.rate = max(float(np.sqrt(self.gamma)), 0.5 * abs(self.alpha))
        self.damping_ratio, self.release, self.refinement = (
            float(damping_ratio),
            release,
            int(refinement),
        )
        # Where an edge of a panel stands, so that no feature falls between two nodes.
        centres = [centre + width * FEATURES for centre, width in _gaussians(prestress)]
        self.features = np.unique(np.concatenate(centres))
        levels = (prestress.left, prestress.right, *(level for _, level in prestress.steps))
        lowest = float(np.min(prestress(self.features), initial=min(levels)))
        check_number("lowest prestress", lowest, at_least=LOWEST)
        self.pieces = pieces(prestress)

    def mirrored(self) -> "FrontLaw":
        """The same at -x."""
        profile = self.prestress
        steps = tuple((-position, level) for position, level in profile.steps)
        bumps = tuple((-centre, amplitude, width) for centre, amplitude, width in profile.bumps)
        turned = replace(profile, left=profile.right, right=profile.left, steps=steps, bumps=bumps)
        return FrontLaw(
            turned, self.gamma, self.damping_ratio, self.release, self.refinement, self.alpha
        )

    def slowness(self, tau: np.ndarray) -> np.ndarray:
        """1/v of each pre-stress."""
        return slowness(tau, self.damping_ratio, self.release)

    def piece_right_of(self, x: float) -> Piece:
        return next(piece for piece in self.pieces if piece.right > x)

    def longest(self, level: float) -> float:
        """The longest panel: the leaf springs' phase changes by LONGEST along it."""
        if self.rate == 0.0:
            return LONGEST_WITHOUT_SPRINGS / self.refinement
        rate = self.slowness(np.array(np.clip(level, 0.0, 1.0)))
        proper = float(np.sqrt(1.0 - rate**2)) if level > 0.0 else 1.0
        return min(LONGEST / max(proper, 1e-3), LONGEST_AT_REST) / self.rate / self.refinement

    def rightwards(
        self, start: float, time: float, stop: float, until: float
    ) -> tuple[list[Panel], float, float]:
        """Panels from start towards stop, while tau >= 0 and T < until; and where and when they end."""
        panels: list[Panel] = []
        while start < stop and time < until:
            piece = self.piece_right_of(start)
            if not piece.supersonic:
                break
            end = min(stop, piece.right)
            far = float(self.features[-1])
            if np.isinf(end) and start >= far:
                # Uniform from here on.
                rate = float(self.slowness(np.array(piece.level)))
                end = start + (until - time) / rate * (1.0 + 1e-9) + 1e-9
            elif np.isinf(end):
                end = max(far, np.nextafter(start, np.inf))
            panels += self.between(piece.level, start, end, time)
            start, time = end, panels[-1].time_ends[1]
        return panels, start, time

    def between(self, level: float, start: float, end: float, time: float) -> list[Panel]:
        """Panels of a front that goes right over part of one piece, from a time on."""
        inner = self.features[(self.features > start) & (self.features < end)]
        longest = self.longest(level)
        if (end - start) * self.refinement > MOST_PANELS * longest:
            raise self._too_many(level, start, end)
        rough = np.concatenate([[start], inner, [end]])
        count = self.refinement * np.ceil(np.diff(rough) / longest).astype(int)
        parts = [np.linspace(a, b, n + 1) for (a, b), n in zip(pairwise(rough), count, strict=True)]
        edges = np.unique(np.concatenate(parts))
        edges[0], edges[-1] = start, end
        while True:
            half = 0.5 * np.diff(edges)[:, None]
            x = edges[:-1, None] + half * (1.0 + NODES)
            tau = analytic(self.prestress, level, x)
            rate = self.slowness(tau)
            tails = np.abs(np.stack([rate, tau]) @ TO_SERIES[-2:].T).max(axis=(0, 2))
            size = 2.0 * half[:, 0]
            split = (tails * size > RESOLVED) & (size > NARROWEST)
            if not split.any():
                break
            if edges.size > MOST_PANELS:
                raise self._too_many(level, start, end)
            edges = np.sort(np.concatenate([edges, 0.5 * (edges[:-1] + edges[1:])[split]]))
        starts = time + np.concatenate([[0.0], np.cumsum(half[:, 0] * (rate @ WEIGHTS))])
        within = (half * rate) @ CUMULATIVE.T
        columns = x, starts[:-1, None] + within, tau * half, pairwise(edges), pairwise(starts)
        return [Panel(*row) for row in zip(*columns, strict=True)]

    def _too_many(self, level: float, start: float, end: float) -> ValueError:
        scene = f"over a distance of {end - start:g} at gamma = {self.gamma:g}, damping_ratio = {self.damping_ratio:g}"
        allowed = (
            f"fronts that stay within {MOST_PANELS} panels, of {self.longest(level):.3g} at most"
        )
        return ValueError(f"prestress: level {level!r} {scene}; allowed: {allowed}")


def straight_panel(left: float, right: float, slope: float, tau: float) -> Panel:
    """A panel of a front at constant speed in uniform pre-stress, T = slope x."""
    half = 0.5 * (right - left)
    x = left + half * (1.0 + NODES)
    return Panel(
        x, slope * x, np.full(COUNT, tau * half), (left, right), (slope * left, slope * right)
    )
