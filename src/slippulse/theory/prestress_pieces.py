"""A pre-stress in smooth pieces of one sign, and the intervals that are released at t = 0."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..model.prestress import Prestress
from ..model.roots import root_between

# A Gaussian is its level to rounding beyond this many widths.
EXTENT = 9.0
# Samples a width that show each sign change.
SAMPLES = 32
ROUNDING = 1e-15


class Piece(NamedTuple):
    """An interval on which the pre-stress is smooth, and on one side of a value."""

    left: float
    right: float
    level: float  # of its side
    above: bool  # tau >= the value; for 0, a front outruns the waves


def analytic(prestress: Prestress, level: float, x: np.ndarray) -> np.ndarray:
    """Pre-stress with one side level everywhere: analytic, and exact where the level is that."""
    tau = prestress.peak + (level - prestress.peak) * -np.expm1(-0.5 * (x / prestress.width) ** 2)
    for centre, amplitude, width in prestress.bumps:
        tau = tau + amplitude * np.exp(-0.5 * ((x - centre) / width) ** 2)
    return tau


def gaussians(prestress: Prestress) -> list[tuple[float, float]]:
    """Centre and width of the peak and of each bump."""
    return [(0.0, prestress.width), *((centre, width) for centre, _, width in prestress.bumps)]


def pieces(prestress: Prestress, value: float = 0.0) -> list[Piece]:
    """The pieces from left to right; one where tau only touches the value has no length."""
    out = []
    for left, right, level, _ in prestress.intervals:
        above, changes = _changes(prestress, (left, right, level), value)
        for start, end in pairwise([left, *changes, right]):
            out.append(Piece(start, end, level, above))
            above = not above
    return out


def nucleations(prestress: Prestress) -> list[tuple[float, float]]:
    """Intervals with tau >= 1 (points, where tau only touches 1), from left to right."""
    merged: list[tuple[float, float]] = []
    for left, right, _, above in pieces(prestress, 1.0):
        if above and merged and left <= merged[-1][1]:
            merged[-1] = (merged[-1][0], right)
        elif above:
            merged.append((left, right))
    return merged


def _changes(
    prestress: Prestress, interval: tuple[float, float, float], value: float
) -> tuple[bool, list[float]]:
    """Tell whether tau >= value at the left end, and where that changes: twice at a contact."""
    left, right, level = interval
    fine = np.linspace(-EXTENT, EXTENT, int(2 * EXTENT * SAMPLES) + 1)
    x = np.concatenate([centre + width * fine for centre, width in gaussians(prestress)])
    # Beyond every Gaussian a side has its last level.
    first = left if np.isfinite(left) else min(float(x.min()), right) - 1.0
    last = right if np.isfinite(right) else max(float(x.max()), left) + 1.0
    x = np.unique(np.concatenate([x[(x > left) & (x < right)], [first, last]]))

    def excess(position: float) -> float:
        return float(analytic(prestress, level, np.asarray(position))) - value

    differences = analytic(prestress, level, x) - value
    # The far tail of a bump leaves a difference of rounding where there is none.
    differences[np.abs(differences) <= ROUNDING] = 0.0
    above = differences >= 0.0
    changes = []
    for k in np.flatnonzero(above[1:] != above[:-1]):
        zeros = x[k : k + 2][differences[k : k + 2] == 0.0]
        if zeros.size:
            changes.append(float(zeros[0]))
        else:
            changes.append(root_between(excess, x[k], x[k + 1], xtol=1e-14))
    return bool(above[0]), changes
