"""Integral of the pre-stress, and the position at which the pre-stress is balanced.

Under a stress boundary, a rupture that runs into negative pre-stress stops where the integral of
the pre-stress over the rupture vanishes. The integral is computed in closed form, interval by
interval. The balance position is found by bisection; in a table of points, `_balance_of_table`
first walks from the nucleation to the left until the integral changes sign.
"""

import math
from collections.abc import Callable, Iterator
from functools import lru_cache, partial
from typing import NamedTuple

import numpy as np

from .checks import check_kind, check_that
from .prestress import Interval, Prestress


def integral(prestress: Prestress, lower: float, upper: float) -> float:
    """Return the integral of the pre-stress from ``lower`` to ``upper``, in closed form."""
    low, high = min(lower, upper), max(lower, upper)
    total = 0.0
    for interval in prestress.intervals:
        # The part of the interval within the limits, if there is one.
        a, b = max(interval.left, low), min(interval.right, high)
        if a < b:
            total += _linear_integral(prestress, interval, a, b)
    for centre, amplitude, width in prestress.bumps:
        total += amplitude * _gaussian_area(low, high, centre, width)
    return total if upper >= lower else -total


def _linear_integral(prestress: Prestress, interval: Interval, a: float, b: float) -> float:
    """Return the integral of background and peak from a to b, which lie within one interval."""
    width = prestress.width
    if interval.left_value == interval.right_value:
        level = interval.left_value
        total = level * (b - a)
        if width is not None:
            total += (prestress.peak - level) * _gaussian_area(a, b, 0.0, width)
        return total
    rise = interval.right_value - interval.left_value
    slope = rise / (interval.right - interval.left)
    middle_value = interval.left_value + slope * (0.5 * (a + b) - interval.left)
    total = middle_value * (b - a)
    if width is not None:
        # The Gaussian is multiplied by peak - level(x), and level(x) = level_at_zero + slope x.
        level_at_zero = interval.left_value - slope * interval.left
        total += (prestress.peak - level_at_zero) * _gaussian_area(a, b, 0.0, width)
        first_moment = math.exp(-0.5 * (a / width) ** 2) - math.exp(-0.5 * (b / width) ** 2)
        total -= slope * width**2 * first_moment
    return total


def _gaussian_area(lower: float, upper: float, centre: float, width: float) -> float:
    """Return the integral of exp(-(x - centre)^2 / 2 width^2) from ``lower`` to ``upper``."""
    a, b = ((end - centre) / (math.sqrt(2.0) * width) for end in (lower, upper))
    if b < 0.0:
        a, b = -b, -a
    # In the tail erf is close to 1, so that a difference of two values would lose digits; erfc does
    # not.
    area = math.erfc(a) - math.erfc(b) if a > 0.0 else math.erf(b) - math.erf(a)
    return width * math.sqrt(0.5 * math.pi) * area


def prestress_balance_position(prestress: Prestress) -> float:
    """Return the position x_minus < 0 from which the pre-stress integrated to infinity is 0.

    Parameters
    ----------
    prestress : Prestress
        Its level must be 0 far on the right and negative far on the left.

    Returns
    -------
    float, units of H

    Raises
    ------
    ValueError
        If the levels far away are different from these.
    ArithmeticError
        If no such position exists, or rounding prevents its computation.

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
    """Compute `prestress_balance_position`; results are cached."""
    # Beyond this distance the profile equals its side levels to machine precision. On the right the
    # level is 0, so that integrals to infinity end there.
    ends = [abs(centre) + 40.0 * width for centre, width in prestress.gaussians]
    ends += [abs(position) + (prestress.width or 1.0) for position, _ in prestress.steps]
    ends += [abs(position) + 1.0 for position, _ in prestress.points]
    distance = max(ends, default=1.0)
    left, right = prestress.level(np.array([-distance, distance])).tolist()
    allowed = "0, since otherwise the balance integral is not finite"
    check_that(right == 0.0, "prestress.right", right, allowed)
    allowed = "< 0, since otherwise the pre-stress is never balanced"
    check_that(left < 0.0, "prestress.left", left, allowed)
    if prestress.points:
        return _balance_of_table(prestress, distance)
    lower, upper = -distance, 0.0
    while integral(prestress, lower, distance) > 0.0:
        lower *= 2.0
    if not integral(prestress, lower, distance) <= 0.0 <= integral(prestress, upper, distance):
        raise ArithmeticError("the pre-stress has no balance at x < 0 that can be computed")
    return root_to_last_bit(lambda x: integral(prestress, x, distance), lower, upper)


def _balance_of_table(prestress: Prestress, distance: float) -> float:
    """Return the balance position that is nearest to the nucleation, on its left.

    The integral from a position to infinity is followed from the nucleation to the left. Within
    each part of an interval the background keeps its sign, so that the integral cannot change sign
    twice. The balance lies in the first part at whose left end the integral is negative.

    distance : distance from x = 0 beyond which the pre-stress is its level on either side. On the
        right the level is 0, so that an integral to infinity ends there.
    """
    x, tau = prestress.point_arrays
    # A table without a Gaussian at x = 0 is released wherever it reaches 1.
    released = x[tau >= min(1.0, float(tau.max()))]
    start = 0.0 if prestress.width is not None else float(released[0])
    integral_from_right = integral(prestress, start, distance)
    if not integral_from_right >= 0.0:
        raise ArithmeticError("the pre-stress has no balance at x < 0 that can be computed")
    for part in _parts_leftwards(prestress, start):
        integral_from = partial(_integral_from, prestress, part, integral_from_right)
        left = part.left
        if left == -math.inf:
            # The outermost part is infinite. Its length is doubled until the integral is negative.
            left = part.right - 1.0
            while integral_from(left) >= 0.0:
                left = part.right - 2.0 * (part.right - left)
        integral_from_right = integral_from(left)
        if integral_from_right < 0.0:
            break
    return root_to_last_bit(integral_from, left, part.right)


class _Part(NamedTuple):
    """Part of an interval, from ``left`` to ``right``, on which the background keeps its sign."""

    interval: Interval
    left: float
    right: float


def _integral_from(
    prestress: Prestress, part: _Part, integral_from_right: float, position: float
) -> float:
    """Return the integral from a position within a part to infinity.

    integral_from_right : the integral from the right end of the part to infinity
    """
    area = _linear_integral(prestress, part.interval, position, part.right)
    for centre, amplitude, width in prestress.bumps:
        area += amplitude * _gaussian_area(position, part.right, centre, width)
    return integral_from_right + area


def _parts_leftwards(prestress: Prestress, start: float) -> Iterator[_Part]:
    """Yield the parts of the intervals to the left of ``start``, from right to left."""
    for interval in reversed(prestress.intervals):
        left, right, left_value, right_value = interval
        # Where the background changes its sign; the right end if it does not.
        zero = right
        if left_value * right_value < 0.0:
            zero = left - left_value * (right - left) / (right_value - left_value)
        for lower, upper in ((zero, right), (left, zero)):
            if lower < min(upper, start):
                yield _Part(interval, lower, min(upper, start))


def root_to_last_bit(function: Callable[[float], float], lower: float, upper: float) -> float:
    """Return the position at which a function turns from negative to non-negative, by bisection.

    The result is the larger one of the two neighbouring numbers between which the sign changes.
    Unlike `root_between`, this needs no scipy, which is slow to load.
    """
    middle = 0.5 * (lower + upper)
    while lower < middle < upper:
        if function(middle) < 0.0:
            lower = middle
        else:
            upper = middle
        middle = 0.5 * (lower + upper)
    return upper
