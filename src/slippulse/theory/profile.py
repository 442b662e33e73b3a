"""A pre-stress in pieces: smooth and of one sign on each, with the intervals that are released at t = 0."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..model.prestress import Prestress
from ..model.roots import root_between

# A Gaussian is its level to rounding beyond this many widths; edges of panels stand at these multiples of the width.
EXTENT = 9.0
FEATURES = np.array([-EXTENT, -4.5, -2.0, 0.0, 2.0, 4.5, EXTENT])
# Samples a width that find each sign change.
SAMPLES = 32
ROUNDING = 1e-15


class Piece(NamedTuple):
    """An interval on which the pre-stress is smooth and does not change its sign."""

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


def mirrored(prestress: Prestress) -> Prestress:
    """The pre-stress at -x."""
    return Prestress(
        left=prestress.right,
        right=prestress.left,
        width=prestress.width,
        peak=prestress.peak,
        steps=tuple((-position, level) for position, level in prestress.steps),
        bumps=tuple((-centre, amplitude, width) for centre, amplitude, width in prestress.bumps),
    )


def edges_of_features(prestress: Prestress) -> np.ndarray:
    """Positions that an edge of a panel stands at, so that no feature falls between two nodes."""
    return np.unique(np.concatenate([centre + width * FEATURES for centre, width in _gaussians(prestress)]))


def pieces(prestress: Prestress) -> list[Piece]:
    """The pieces from left to right."""
    out = []
    for left, right, level in _between_jumps(prestress):
        sign, marks = _crossings(prestress, left, right, level, 0.0)
        for a, b in pairwise([left, *marks, right]):
            if b > a:
                out.append(Piece(a, b, level, sign))
            sign = not sign
    return out


def nucleations(prestress: Prestress) -> list[tuple[float, float]]:
    """The intervals (points, where tau only touches 1) with tau >= 1, from left to right."""
    found: list[tuple[float, float]] = []
    for left, right, level in _between_jumps(prestress):
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


def _crossings(prestress, left: float, right: float, level: float, value: float) -> tuple[bool, list[float]]:
    """Whether an interval begins with the pre-stress at a value or above, and where that changes; it touches twice."""
    x = _samples(prestress, left, right)

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
            float(touching[0]) if touching.size else root_between(excess, x[k], x[k + 1], xtol=1e-14)
        )
    return bool(above[0]), marks


def _gaussians(prestress: Prestress) -> list[tuple[float, float]]:
    """Centre and width of the peak and of each bump."""
    return [(0.0, prestress.width), *((centre, width) for centre, _, width in prestress.bumps)]


def _between_jumps(prestress: Prestress) -> list[tuple[float, float, float]]:
    """Intervals of one side level: left, right, level."""
    jumps = sorted({0.0, *(position for position, _ in prestress.steps)})
    inside = [jumps[0] - 1.0, *(0.5 * (a + b) for a, b in pairwise(jumps)), jumps[-1] + 1.0]
    levels = prestress.level(np.array(inside)).tolist()
    ends = [-np.inf, *jumps, np.inf]
    return list(zip(ends[:-1], ends[1:], levels, strict=True))


def _samples(prestress: Prestress, left: float, right: float) -> np.ndarray:
    """Positions that show each change of sign within an interval, its finite ends among them."""
    fine = np.linspace(-EXTENT, EXTENT, int(2 * EXTENT * SAMPLES) + 1)
    x = np.concatenate([centre + width * fine for centre, width in _gaussians(prestress)])
    # Far outside everything a side has its last level.
    far = [float(x.min()) - 1.0, float(x.max()) + 1.0]
    ends = [left, right]
    ends[0] = left if np.isfinite(left) else min(far[0], right - 1.0)
    ends[1] = right if np.isfinite(right) else max(far[1], left + 1.0)
    return np.unique(np.concatenate([x[(x > left) & (x < right)], ends]))
