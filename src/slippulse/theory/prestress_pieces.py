"""Divide a pre-stress into smooth pieces, and find the intervals that are released at t = 0.

The pre-stress is a piecewise linear background with Gaussians on it. `split_into_pieces` cuts it
where the background changes its slope or jumps, and where the pre-stress crosses a value.
This value is 0, where fronts change between fast and slow, or 1, where the rupture nucleates.
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
# A difference between the pre-stress and a value that is smaller than this is a rounding error.
ROUNDING_ERROR = 1e-15


class Piece(NamedTuple):
    """An interval on which the pre-stress is smooth and lies on one side of a value.

    left and right are its ends. background is the interval of the linear background that contains
    it. is_above is True if the pre-stress is at least the value. If the value is 0, a front is
    faster than the waves there.
    """

    left: float
    right: float
    background: Interval
    is_above: bool


def uniform_background(level: float) -> Interval:
    """Return the background (a pre-stress without its Gaussians) that has one level everywhere."""
    return Interval(left=-np.inf, right=np.inf, left_value=level, right_value=level)


def continued_prestress(prestress: Prestress, background: Interval, x: np.ndarray) -> np.ndarray:
    """Return the pre-stress at positions, with the background of one interval continued everywhere.

    So it is the exact pre-stress in this interval, and a smooth function beyond its ends.
    """
    left, right, left_value, right_value = background
    level: np.ndarray | float = left_value
    if left_value != right_value:
        # This form is exact at both ends.
        fraction = (x - left) / (right - left)
        level = (1.0 - fraction) * left_value + fraction * right_value
    tau = np.broadcast_to(level, x.shape)
    if prestress.width is not None:
        # The Gaussian at x = 0, which leads from the peak to the level.
        one_minus_gaussian = -np.expm1(-0.5 * (x / prestress.width) ** 2)
        tau = prestress.peak + (level - prestress.peak) * one_minus_gaussian
    for centre, amplitude, width in prestress.bumps:
        tau = tau + amplitude * np.exp(-0.5 * ((x - centre) / width) ** 2)
    return tau


def split_into_pieces(prestress: Prestress, value: float = 0.0) -> list[Piece]:
    """Return intervals on which the pre-stress is smooth and on one side of a value, in order.

    The intervals are cut where the background changes its slope or jumps, and where the pre-stress
    crosses the value. A piece has no length where the pre-stress only touches the value.
    """
    # Sample positions, which are dense enough to show every sign change in a Gaussian. Between the
    # Gaussians the pre-stress is linear.
    sample_count = int(2 * GAUSSIAN_EXTENT * SAMPLES_PER_WIDTH) + 1
    distances_in_widths = np.linspace(-GAUSSIAN_EXTENT, GAUSSIAN_EXTENT, sample_count)
    samples_of_gaussians = [
        centre + width * distances_in_widths for centre, width in prestress.gaussians
    ]
    samples = np.unique(np.concatenate([[], *samples_of_gaussians]))
    pieces = []
    for background in prestress.intervals:
        # is_above is that of the first piece. From one piece to the next the pre-stress changes to
        # the other side of the value.
        is_above, crossings = _crossings_of_value(
            prestress, background=background, samples=samples, value=value
        )
        for start, end in pairwise([background.left, *crossings, background.right]):
            pieces.append(Piece(left=start, right=end, background=background, is_above=is_above))
            is_above = not is_above
    return pieces


def nucleation_intervals(prestress: Prestress) -> list[tuple[float, float]]:
    """Return the left and right end of each interval with tau >= 1, from left to right.

    Where tau only touches 1, both ends are the same position.
    """
    intervals: list[tuple[float, float]] = []
    for piece in split_into_pieces(prestress, 1.0):
        if not piece.is_above:
            continue
        if intervals and piece.left <= intervals[-1][1]:
            # The piece continues the interval before.
            left, _ = intervals.pop()
            intervals.append((left, piece.right))
        else:
            intervals.append((piece.left, piece.right))
    return intervals


def _crossings_of_value(
    prestress: Prestress, background: Interval, samples: np.ndarray, value: float
) -> tuple[bool, list[float]]:
    """Return a flag and the positions where tau crosses a value, in an interval of the background.

    The flag is True if tau >= value at the left end of the interval. samples are sorted positions,
    so dense that tau crosses the value at most once between two of them. Where tau only touches the
    value from below, it rises to the value and falls again, so that the position appears twice.
    """
    left, right = background.left, background.right
    inner_samples = samples[(samples > left) & (samples < right)]
    # An outermost interval is infinite. Beyond all Gaussians, and thus beyond all samples, it is
    # uniform, so that one more sample there is sufficient. Without Gaussians there are no samples.
    first = left if np.isfinite(left) else min([*samples[:1], right]) - 1.0
    last = right if np.isfinite(right) else max([*samples[-1:], left]) + 1.0
    x = np.concatenate([[first], inner_samples, [last]])

    def difference(position: float) -> float:
        """Return tau - value at a position."""
        return float(continued_prestress(prestress, background, np.asarray(position))) - value

    differences = continued_prestress(prestress, background, x) - value
    # The far tail of a Gaussian leaves differences as small as rounding errors. Those of a table of
    # points are larger, because positions between its points are rounded as well.
    rounding_error = TABLE_THRESHOLD_TOLERANCE if prestress.points else ROUNDING_ERROR
    differences[np.abs(differences) <= rounding_error] = 0.0
    is_above = differences >= 0.0
    crossings = []
    # tau crosses the value between sample k and sample k + 1, or at one of them.
    for k in np.flatnonzero(is_above[1:] != is_above[:-1]):
        if differences[k] == 0.0:
            crossings.append(float(x[k]))
        elif differences[k + 1] == 0.0:
            crossings.append(float(x[k + 1]))
        else:
            crossings.append(root_between(difference, x[k], x[k + 1], xtol=1e-14))
    return bool(is_above[0]), crossings
