"""A pre-stress in pieces: smooth and of one sign on each, with the intervals that are released at t = 0."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..prestress import Prestress
from ..roots import root_between

# A Gaussian is its level to rounding beyond so many widths; edges of panels stand at these multiples of the width.
EXTENT = 9.0
FEATURES = np.array([-EXTENT, -4.5, -2.0, 0.0, 2.0, 4.5, EXTENT])
# Samples a width that find each sign change.
SAMPLES = 32
ROUNDING = 1e-15


@dataclass(frozen=True)
class Piece:
    """An interval on which the pre-stress is smooth and does not change its sign.

    Attributes
    ----------
    left, right : its ends; infinite for the outermost
    level : side level on it
    supersonic : whether tau >= 0, so that a front outruns the waves
    """

    left: float
    right: float
    level: float
    supersonic: bool


def smooth(prestress: Prestress, level: float, x: np.ndarray) -> np.ndarray:
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
    features = [(0.0, prestress.width), *((centre, width) for centre, _, width in prestress.bumps)]
    return np.unique(np.concatenate([centre + width * FEATURES for centre, width in features]))


def pieces(prestress: Prestress) -> list[Piece]:
    """The pieces from left to right."""
    features = [(0.0, prestress.width), *((centre, width) for centre, _, width in prestress.bumps)]
    fine = np.linspace(-EXTENT, EXTENT, int(2 * EXTENT * SAMPLES) + 1)
    grid = np.unique(np.concatenate([centre + width * fine for centre, width in features]))
    jumps = sorted({0.0, *(position for position, _ in prestress.steps)})
    out = []
    for left, right in pairwise([-np.inf, *jumps, np.inf]):
        # Far outside everything a side has its last level.
        inside = grid[(grid > left) & (grid < right)]
        ends = [e for e in (left, right) if np.isfinite(e)]
        x = np.unique(np.concatenate([inside, ends, [e + s for e, s in ((left, 1.0), (right, -1.0)) if np.isfinite(e) and not inside.size and left < e + s < right]]))
        probe = 0.5 * (left + right) if np.isfinite(left) and np.isfinite(right) else (left + 1e-9 * max(1.0, abs(left)) if np.isfinite(left) else right - 1e-9 * max(1.0, abs(right)))
        level = float(prestress.level(np.asarray(probe)))
        tau = smooth(prestress, level, x)
        positive = tau > -ROUNDING
        marks = [
            float(root_between(lambda z, lv=level: float(smooth(prestress, lv, np.asarray(z))), x[k], x[k + 1], xtol=1e-14))
            if tau[k] * tau[k + 1] < 0.0
            else float(x[k] if not positive[k] else x[k + 1])
            for k in np.flatnonzero(positive[1:] != positive[:-1])
        ]
        sign = bool(positive[0])
        for a, b in pairwise([left, *marks, right]):
            if b > a:
                out.append(Piece(a, b, level, sign))
            sign = not sign
    return out


def nucleations(prestress: Prestress) -> list[tuple[float, float]]:
    """The intervals (points, where they are tangent) with tau >= 1, from left to right."""
    found = []
    for piece in pieces(prestress):
        if not piece.supersonic:
            continue

        def excess(x, level=piece.level):
            return smooth(prestress, level, np.asarray(x)) - 1.0

        features = [(0.0, prestress.width), *((centre, width) for centre, _, width in prestress.bumps)]
        fine = np.linspace(-EXTENT, EXTENT, int(2 * EXTENT * SAMPLES) + 1)
        grid = np.concatenate([centre + width * fine for centre, width in features])
        ends = [e for e in (piece.left, piece.right) if np.isfinite(e)]
        x = np.unique(np.concatenate([grid[(grid > piece.left) & (grid < piece.right)], ends]))
        if not x.size:
            continue
        over = excess(x) >= 0.0
        changes = np.flatnonzero(over[1:] != over[:-1])
        marks = [x[0]] if over[0] else []
        for k in changes:
            at_zero = x[k] if excess(x[k]) == 0.0 else x[k + 1] if excess(x[k + 1]) == 0.0 else None
            marks.append(
                float(at_zero) if at_zero is not None
                else float(root_between(lambda z: float(excess(z)), x[k], x[k + 1], xtol=1e-14))
            )
        if over[-1]:
            marks.append(x[-1])
        found += list(zip(marks[::2], marks[1::2], strict=True))
    found.sort()
    merged: list[tuple[float, float]] = []
    for a, b in found:
        if merged and a <= merged[-1][1]:
            merged[-1] = (merged[-1][0], max(b, merged[-1][1]))
        else:
            merged.append((float(a), float(b)))
    return merged
