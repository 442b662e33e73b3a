"""Integral of the pre-stress, and the position at which the pre-stress is balanced.

Under a stress boundary, a rupture that runs into negative pre-stress stops where the integral of
the pre-stress over the rupture vanishes. The integral is computed in closed form, interval by
interval. The balance position is found by bisection. A pre-stress with steps, bumps or points may
be balanced at several positions. The rupture stops at the nearest one, so `_nearest_balance` first
walks from the nucleation to the left until the integral changes sign.
"""

import math
from collections.abc import Callable, Iterator
from functools import lru_cache, partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from .checks import check_kind, check_that
from .prestress import Interval, Prestress

# Distances from the centre of a Gaussian, in units of its width, at which the walk of
# `_nearest_balance` stops. Between two of them the pre-stress changes its sign at most once, unless
# it hardly crosses 0.
OFFSETS_FROM_GAUSSIANS = np.linspace(-5.0, 5.0, 41)


def integral(prestress: Prestress, lower: float, upper: float) -> float:
    """Return the integral of the pre-stress from ``lower`` to ``upper``, in closed form."""
    left_limit, right_limit = min(lower, upper), max(lower, upper)
    total = 0.0
    for interval in prestress.intervals:
        # The overlap of the interval with the range of integration, if they overlap.
        start, end = max(interval.left, left_limit), min(interval.right, right_limit)
        if start < end:
            # The background, and the Gaussian at x = 0.
            total += _integral_in_interval(prestress, interval, start, end)
    for centre, amplitude, width in prestress.bumps:
        total += amplitude * _gaussian_area(left_limit, right_limit, centre, width)
    return total if upper >= lower else -total


def _integral_in_interval(
    prestress: Prestress, interval: Interval, start: float, end: float
) -> float:
    """Return the integral of background and peak from start to end, within one interval.

    There the background is level_at_zero + slope x. The peak at x = 0 adds to it
    (peak - background) exp(-x^2 / 2 width^2).
    """
    peak, width = prestress.peak, prestress.width
    # The background is constant on an infinite interval, for which the formulas below would fail.
    if interval.left_value == interval.right_value:
        level = interval.left_value
        total = level * (end - start)
        if width is not None:
            total += (peak - level) * _gaussian_area(start, end, 0.0, width)
        return total
    rise = interval.right_value - interval.left_value
    slope = rise / (interval.right - interval.left)
    # The integral of the background is its value in the middle times the length.
    middle = 0.5 * (start + end)
    value_in_middle = interval.left_value + slope * (middle - interval.left)
    total = value_in_middle * (end - start)
    if width is not None:
        level_at_zero = interval.left_value - slope * interval.left
        total += (peak - level_at_zero) * _gaussian_area(start, end, 0.0, width)
        # The integral of x exp(-x^2 / 2 width^2) is width^2 times this difference.
        difference = math.exp(-0.5 * (start / width) ** 2) - math.exp(-0.5 * (end / width) ** 2)
        total -= slope * width**2 * difference
    return total


def _gaussian_area(lower: float, upper: float, centre: float, width: float) -> float:
    """Return the integral of exp(-(x - centre)^2 / 2 width^2) from ``lower`` to ``upper``."""
    # The limits in the variable of the error function.
    unit = math.sqrt(2.0) * width
    start, end = (lower - centre) / unit, (upper - centre) / unit
    if end < 0.0:
        # The mirrored range has the same area.
        start, end = -end, -start
    factor = width * math.sqrt(0.5 * math.pi)
    if start > 0.0:
        # In the tail both values of erf are close to 1, so their difference would lose digits.
        return factor * (math.erfc(start) - math.erfc(end))
    return factor * (math.erf(end) - math.erf(start))


def prestress_balance_position(prestress: Prestress) -> float:
    """Return the position x_minus < 0 from which the integral of the pre-stress to infinity is 0.

    Parameters
    ----------
    prestress : Prestress
        Its level must be 0 far on the right. If no part of the profile balances the nucleation, the
        level must be negative far on the left.

    Returns
    -------
    float, units of H

    Raises
    ------
    ValueError
        If the level far on the right is not 0, or if there is no balance because the level far on
        the left is not negative.
    ArithmeticError
        If no such position exists for another reason, or rounding prevents its computation.

    Notes
    -----
    Source: equation (11) of the paper, section III C.

    Examples
    --------
    >>> round(sp.theory.prestress_balance_position(sp.Prestress(left=-0.5, right=0.0)), 3)
    -6.267
    """
    check_kind("prestress", prestress, Prestress)
    return _balance_position(prestress)


@lru_cache(maxsize=1024)
def _balance_position(prestress: Prestress) -> float:
    """Return the position x_minus < 0 from which the integral of the pre-stress to infinity is 0.

    `prestress_balance_position` names the conditions and errors. Results are cached.
    """
    # Beyond this distance the pre-stress is constant. The pre-stress must be 0 on the right, so
    # that integrals to infinity end there.
    distance = _distance_of_constant_levels(prestress)
    right = float(prestress.level(distance))
    allowed = "0, since otherwise the integral of the pre-stress up to infinity is not finite"
    check_that(right == 0.0, "prestress.right", right, allowed)
    if prestress.points or prestress.steps or prestress.bumps:
        return _nearest_balance(prestress, distance)
    _check_far_left_level(prestress.left)
    # The balance lies between these positions. The lower one is moved to the left until the
    # integral from there is not positive.
    lower, upper = -distance, 0.0
    while integral(prestress, lower, distance) > 0.0:
        lower *= 2.0
    if not integral(prestress, lower, distance) <= 0.0 <= integral(prestress, upper, distance):
        raise ArithmeticError("no balance position at x < 0 can be computed for this pre-stress")
    return root_to_last_bit(lambda x: integral(prestress, x, distance), lower, upper)


def _check_far_left_level(level: float) -> None:
    """Raise ValueError unless the level far on the left can still balance the pre-stress."""
    allowed = "< 0, since otherwise the pre-stress is never balanced"
    check_that(level < 0.0, "prestress.left", level, allowed)


def _distance_of_constant_levels(prestress: Prestress) -> float:
    """Return a distance from x = 0 beyond which the profile equals its level on either side.

    The values are equal to machine precision, because at 40 widths a Gaussian has no digits left.
    Beyond a step or a point any margin is enough.
    """
    distances = [abs(centre) + 40.0 * width for centre, width in prestress.gaussians]
    distances += [abs(position) + (prestress.width or 1.0) for position, _ in prestress.steps]
    distances += [abs(position) + 1.0 for position, _ in prestress.points]
    return max(distances, default=1.0)


def _nearest_balance(prestress: Prestress, distance: float) -> float:
    """Return the balance position that is nearest to the nucleation, on its left.

    The integral from a position to infinity is followed from the nucleation to the left, part by
    part. The parts are so short that the pre-stress changes its sign at most once within each. The
    balance lies in the first part at whose left end the integral is negative.

    distance : distance from x = 0 beyond which the pre-stress equals its level on either side. On
        the right the level is 0, so that an integral to infinity ends there.
    """
    nucleation = _leftmost_nucleation(prestress)
    integral_from_right_end = integral(prestress, nucleation, distance)
    if not integral_from_right_end >= 0.0:
        raise ArithmeticError("no balance position at x < 0 can be computed for this pre-stress")
    for part in _parts_leftwards(prestress, nucleation):
        # A function of the position within this part.
        integral_from = partial(_integral_from, prestress, part, integral_from_right_end)
        left_end = part.left
        if left_end == -math.inf:
            # Nothing has balanced the pre-stress so far, so that only this last part, which is
            # infinite, can. A finite length of it is enough, which is doubled until the integral is
            # negative.
            _check_far_left_level(part.interval.left_value)
            left_end = part.right - 1.0
            while integral_from(left_end) >= 0.0:
                left_end = part.right - 2.0 * (part.right - left_end)
        integral_from_left_end = integral_from(left_end)
        if integral_from_left_end < 0.0:
            break
        # The left end of this part is the right end of the next one.
        integral_from_right_end = integral_from_left_end
    return root_to_last_bit(integral_from, left_end, part.right)


def _leftmost_nucleation(prestress: Prestress) -> float:
    """Return the leftmost position at which the rupture starts.

    If a Gaussian at x = 0 has the peak 1 or more, the rupture starts there. Otherwise it starts at
    the points and at the centres of bumps and of this Gaussian where the pre-stress reaches 1 or,
    if it reaches 1 nowhere, where it is largest. Without points and bumps, 0 is returned.
    """
    has_gaussian_nucleation = prestress.width is not None and prestress.peak >= 1.0
    if has_gaussian_nucleation or not (prestress.points or prestress.bumps):
        return 0.0
    positions = np.array([centre for centre, _ in prestress.gaussians])
    values = prestress(positions)
    if prestress.points:
        # At a jump the table has two values, so that the bumps are added to each of them.
        x, tau = prestress.point_arrays
        sum_of_bumps = prestress(x) - prestress.level(x)
        positions, values = np.append(positions, x), np.append(values, tau + sum_of_bumps)
    return float(positions[values >= min(1.0, values.max())].min())


class _Part(NamedTuple):
    """Part of an interval, from ``left`` to ``right``."""

    interval: Interval
    left: float
    right: float


def _integral_from(
    prestress: Prestress, part: _Part, integral_from_right_end: float, position: float
) -> float:
    """Return the integral of the pre-stress from a position within a part to infinity.

    integral_from_right_end : the integral from the right end of the part to infinity
    """
    # The background and the Gaussian at x = 0, and then the other Gaussians.
    within_part = _integral_in_interval(prestress, part.interval, position, part.right)
    for centre, amplitude, width in prestress.bumps:
        within_part += amplitude * _gaussian_area(position, part.right, centre, width)
    return integral_from_right_end + within_part


def _parts_leftwards(prestress: Prestress, start: float) -> Iterator[_Part]:
    """Yield short parts of the profile to the left of ``start``, from right to left.

    The intervals on which the background is linear are divided where it changes its sign, and into
    short parts near Gaussians. The pre-stress then changes its sign at most once within each part.
    """
    positions: list[float] = []
    for centre, width in prestress.gaussians:
        positions += (centre + width * OFFSETS_FROM_GAUSSIANS).tolist()
    for left, right, left_value, right_value in prestress.intervals:
        if left_value * right_value < 0.0:
            # The zero of the straight line between the two values.
            positions.append(left - left_value * (right - left) / (right_value - left_value))
    divisions = np.sort(positions)
    for interval in reversed(prestress.intervals):
        left_end, right_end = interval.left, min(interval.right, start)
        is_inside = (divisions > left_end) & (divisions < right_end)
        part_ends = [left_end, *divisions[is_inside].tolist(), right_end]
        for left, right in reversed(list(pairwise(part_ends))):
            if left < right:
                yield _Part(interval, left, right)


def root_to_last_bit(function: Callable[[float], float], lower: float, upper: float) -> float:
    """Return the position at which a function turns from negative to non-negative, by bisection.

    Bisection ends at two neighbouring floating-point numbers, and the larger one is returned.
    Unlike `root_between`, this function needs no scipy, which is slow to load.
    """
    middle = 0.5 * (lower + upper)
    while lower < middle < upper:
        if function(middle) < 0.0:
            lower = middle
        else:
            upper = middle
        middle = 0.5 * (lower + upper)
    return upper
