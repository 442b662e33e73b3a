"""Divide a pre-stress into smooth pieces, and find the intervals that are released at t = 0.

A profile is piecewise linear (the background) plus Gaussians. `split_into_pieces` cuts it where the
background changes and where the profile crosses a value: 0, where fronts change between fast and
slow, or 1, where the rupture nucleates.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..model.prestress import TABLE_THRESHOLD_TOLERANCE, Interval, Prestress
from ..model.roots import root_between

# Beyond this many widths a Gaussian is 0 to rounding.
GAUSSIAN_EXTENT = 9.0
# Samples for each width of a Gaussian, which are dense enough to show every sign change.
SAMPLES_PER_WIDTH = 32
# Smaller differences from a value are rounding errors.
ROUNDING_ERROR = 1e-15


class Piece(NamedTuple):
    """An interval on which the pre-stress is smooth and lies on one side of a value.

    is_above is True if tau >= the value. For the value 0 a front is faster than the waves there.
    """

    left: float
    right: float
    background: Interval
    is_above: bool


def uniform_background(level: float) -> Interval:
    """Return the background of one level everywhere."""
    return Interval(left=-np.inf, right=np.inf, left_value=level, right_value=level)


def continued_prestress(prestress: Prestress, background: Interval, x: np.ndarray) -> np.ndarray:
    """Return the pre-stress with the linear background of one interval continued everywhere.

    It is analytic, and exact in the interval.
    """
    left, right, first, last = background
    level: np.ndarray | float = first
    if first != last:
        # This form is exact at both ends.
        fraction = (x - left) / (right - left)
        level = (1.0 - fraction) * first + fraction * last
    tau = np.broadcast_to(level, x.shape)
    if prestress.width is not None:
        rise = -np.expm1(-0.5 * (x / prestress.width) ** 2)
        tau = prestress.peak + (level - prestress.peak) * rise
    for centre, amplitude, width in prestress.bumps:
        tau = tau + amplitude * np.exp(-0.5 * ((x - centre) / width) ** 2)
    return tau


def split_into_pieces(prestress: Prestress, value: float = 0.0) -> list[Piece]:
    """Return the pieces from left to right.

    A piece has no length where the pre-stress only touches the value.
    """
    # Positions dense enough to show every change of a Gaussian. Between the Gaussians the
    # pre-stress is linear.
    sample_count = int(2 * GAUSSIAN_EXTENT * SAMPLES_PER_WIDTH) + 1
    in_widths = np.linspace(-GAUSSIAN_EXTENT, GAUSSIAN_EXTENT, sample_count)
    of_gaussians = [centre + width * in_widths for centre, width in prestress.gaussians]
    samples = np.unique(np.concatenate([[], *of_gaussians]))
    pieces = []
    for background in prestress.intervals:
        is_above, changes = _sign_changes(
            prestress, background=background, samples=samples, value=value
        )
        for start, end in pairwise([background.left, *changes, background.right]):
            pieces.append(Piece(left=start, right=end, background=background, is_above=is_above))
            is_above = not is_above
    return pieces


def nucleation_intervals(prestress: Prestress) -> list[tuple[float, float]]:
    """Return the left and right end of each interval with tau >= 1, from left to right.

    An interval is a point where tau only touches 1. Neighbouring pieces are one interval.
    """
    lefts: list[float] = []
    rights: list[float] = []
    for piece in split_into_pieces(prestress, 1.0):
        if not piece.is_above:
            continue
        if rights and piece.left <= rights[-1]:
            rights[-1] = piece.right
        else:
            lefts.append(piece.left)
            rights.append(piece.right)
    return list(zip(lefts, rights, strict=True))


def _sign_changes(
    prestress: Prestress, background: Interval, samples: np.ndarray, value: float
) -> tuple[bool, list[float]]:
    """Return a flag, and the positions at which it changes from left to right.

    The flag is True if tau >= value at the left end of the interval. A position appears twice where
    tau only touches the value.
    """
    left, right = background.left, background.right
    inner = samples[(samples > left) & (samples < right)]
    # The outermost intervals are infinite, but uniform beyond every Gaussian.
    first = left if np.isfinite(left) else min([*samples[:1], right]) - 1.0
    last = right if np.isfinite(right) else max([*samples[-1:], left]) + 1.0
    x = np.concatenate([[first], inner, [last]])

    def difference(position: float) -> float:
        """Return tau - value at a position."""
        return float(continued_prestress(prestress, background, np.asarray(position))) - value

    differences = continued_prestress(prestress, background, x) - value
    # The far tail of a Gaussian leaves differences as small as rounding errors.
    rounding = TABLE_THRESHOLD_TOLERANCE if prestress.points else ROUNDING_ERROR
    differences[np.abs(differences) <= rounding] = 0.0
    is_above = differences >= 0.0
    changes = []
    for k in np.flatnonzero(is_above[1:] != is_above[:-1]):
        # The change is at a sample if tau equals the value there, otherwise between two samples.
        if differences[k] == 0.0:
            changes.append(float(x[k]))
        elif differences[k + 1] == 0.0:
            changes.append(float(x[k + 1]))
        else:
            changes.append(root_between(difference, x[k], x[k + 1], xtol=1e-14))
    return bool(is_above[0]), changes
