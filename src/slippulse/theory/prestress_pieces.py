"""A pre-stress in smooth pieces of one sign, and the intervals that are released at t = 0."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..model.prestress import TABLE_THRESHOLD_TOLERANCE, Interval, Prestress
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
    background: Interval
    above: bool  # tau >= the value; for 0, a front outruns the waves


def uniform(level: float) -> Interval:
    """The background of one level everywhere."""
    return Interval(-np.inf, np.inf, level, level)


def analytic(prestress: Prestress, background: Interval, x: np.ndarray) -> np.ndarray:
    """Pre-stress with one linear background everywhere: analytic, and exact in its interval."""
    left, right, first, last = background
    level: np.ndarray | float = first
    if first != last:
        # Exact at both ends.
        fraction = (x - left) / (right - left)
        level = (1.0 - fraction) * first + fraction * last
    tau = np.broadcast_to(level, x.shape)
    if prestress.width is not None:
        rise = -np.expm1(-0.5 * (x / prestress.width) ** 2)
        tau = prestress.peak + (level - prestress.peak) * rise
    for centre, amplitude, width in prestress.bumps:
        tau = tau + amplitude * np.exp(-0.5 * ((x - centre) / width) ** 2)
    return tau


def pieces(prestress: Prestress, value: float = 0.0) -> list[Piece]:
    """The pieces from left to right; one where tau only touches the value has no length."""
    # Positions that show each change of a Gaussian; between them the pre-stress is linear.
    fine = np.linspace(-EXTENT, EXTENT, int(2 * EXTENT * SAMPLES) + 1)
    rows = [centre + width * fine for centre, width in prestress.gaussians]
    samples = np.unique(np.concatenate([[], *rows]))
    out = []
    for background in prestress.intervals:
        above, changes = _changes(prestress, background, samples, value)
        for start, end in pairwise([background.left, *changes, background.right]):
            out.append(Piece(start, end, background, above))
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
    prestress: Prestress, background: Interval, samples: np.ndarray, value: float
) -> tuple[bool, list[float]]:
    """Tell whether tau >= value at the left end, and where that changes: twice at a contact."""
    left, right, *_ = background
    inner = samples[np.searchsorted(samples, left, "right") : np.searchsorted(samples, right)]
    # Beyond every Gaussian the outermost intervals are uniform.
    first = left if np.isfinite(left) else min([*samples[:1], right]) - 1.0
    last = right if np.isfinite(right) else max([*samples[-1:], left]) + 1.0
    x = np.concatenate([[first], inner, [last]])

    def excess(position: float) -> float:
        return float(analytic(prestress, background, np.asarray(position))) - value

    differences = analytic(prestress, background, x) - value
    # The far tail of a bump leaves a difference of rounding where there is none.
    rounding = TABLE_THRESHOLD_TOLERANCE if prestress.points else ROUNDING
    differences[np.abs(differences) <= rounding] = 0.0
    above = differences >= 0.0
    changes = []
    for k in np.flatnonzero(above[1:] != above[:-1]):
        zeros = x[k : k + 2][differences[k : k + 2] == 0.0]
        if zeros.size:
            changes.append(float(zeros[0]))
        else:
            changes.append(root_between(excess, x[k], x[k + 1], xtol=1e-14))
    return bool(above[0]), changes
