"""Integral of the pre-stress, and its balance, which ends a rupture under a stress boundary."""

import math
from collections.abc import Callable, Iterator
from functools import lru_cache

import numpy as np

from .checks import check_kind, check_that
from .prestress import Interval, Prestress


def integral(prestress: Prestress, lower: float, upper: float) -> float:
    """Integral of tau from ``lower`` to ``upper``, in closed form between the steps."""
    low, high = min(lower, upper), max(lower, upper)
    total = 0.0
    for interval in prestress.intervals:
        a, b = max(interval.left, low), min(interval.right, high)
        if a < b:
            total += _linear_integral(prestress, interval, a, b)
    for centre, amplitude, width in prestress.bumps:
        total += amplitude * _gaussian_area(low, high, centre, width)
    return total if upper >= lower else -total


def _linear_integral(prestress: Prestress, interval: Interval, a: float, b: float) -> float:
    """Integral of the background and the peak from a to b, within one interval."""
    width, (left, right, level, last) = prestress.width, interval
    if level == last:
        total = level * (b - a)
        if width is not None:
            total += (prestress.peak - level) * _gaussian_area(a, b, 0.0, width)
        return total
    slope = (last - level) / (right - left)
    total = (level + slope * (0.5 * (a + b) - left)) * (b - a)
    if width is not None:
        at_zero = level - slope * left
        total += (prestress.peak - at_zero) * _gaussian_area(a, b, 0.0, width)
        ends = math.exp(-0.5 * (a / width) ** 2) - math.exp(-0.5 * (b / width) ** 2)
        total -= slope * width**2 * ends
    return total


def _gaussian_area(lower: float, upper: float, centre: float, width: float) -> float:
    a, b = ((end - centre) / (math.sqrt(2.0) * width) for end in (lower, upper))
    if b < 0.0:
        a, b = -b, -a
    # On one side of the centre the areas of the tails do not cancel.
    area = math.erfc(a) - math.erfc(b) if a > 0.0 else math.erf(b) - math.erf(a)
    return width * math.sqrt(0.5 * math.pi) * area


def prestress_balance_position(prestress: Prestress) -> float:
    """Position x_minus < 0 from which the integral of the pre-stress to infinity vanishes.

    Parameters
    ----------
    prestress : Prestress
        Its level is 0 far on the right and negative far on the left.

    Returns
    -------
    float, units of H

    Raises
    ------
    ValueError
        If the levels are others.
    ArithmeticError
        If there is no such position that can be computed.

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
    # Beyond this distance the profile is its side levels to rounding.
    ends = [abs(centre) + 40.0 * width for centre, width in prestress.gaussians]
    ends += [abs(position) + (prestress.width or 1.0) for position, _ in prestress.steps]
    distance = max(ends + [abs(position) + 1.0 for position, _ in prestress.points], default=1.0)
    left, right = prestress.level(np.array([-distance, distance])).tolist()
    check_that(right == 0.0, "prestress.right", right, "0, or the balance integral is not finite")
    check_that(left < 0.0, "prestress.left", left, "< 0, or the pre-stress is never balanced")
    if prestress.points:
        return _balance_of_table(prestress, distance)
    lower, upper = -distance, 0.0
    while integral(prestress, lower, distance) > 0.0:
        lower *= 2.0
    if not integral(prestress, lower, distance) <= 0.0 <= integral(prestress, upper, distance):
        raise ArithmeticError("the pre-stress has no balance at x < 0 that can be computed")
    return root_to_last_bit(lambda x: integral(prestress, x, distance), lower, upper)


def _balance_of_table(prestress: Prestress, distance: float) -> float:
    """The first balance to the left of the nucleation, found from one interval to the next."""
    x, tau = np.array(prestress.points).T
    # A table without a Gaussian is released wherever it reaches 1.
    released = x[tau >= min(1.0, float(tau.max()))]
    start = 0.0 if prestress.width is not None else float(released[0])
    rest = integral(prestress, start, distance)
    if not rest >= 0.0:
        raise ArithmeticError("the pre-stress has no balance at x < 0 that can be computed")
    for interval, left, right in _parts_leftwards(prestress, start):

        def balance(position: float, part: tuple = (interval, right, rest)) -> float:
            interval, right, rest = part
            area = _linear_integral(prestress, interval, position, right)
            for centre, amplitude, width in prestress.bumps:
                area += amplitude * _gaussian_area(position, right, centre, width)
            return rest + area

        if left == -math.inf:
            left = right - 1.0
            while balance(left) >= 0.0:
                left = right - 2.0 * (right - left)
        rest = balance(left)
        if rest < 0.0:
            break
    return root_to_last_bit(balance, left, right)


def _parts_leftwards(prestress: Prestress, start: float) -> Iterator[tuple[Interval, float, float]]:
    """Parts of the intervals to the left of ``start``, on which the background keeps its sign."""
    for interval in reversed(prestress.intervals):
        left, right, low, high = interval
        zero = left - low * (right - left) / (high - low) if low * high < 0.0 else right
        for lower, upper in ((zero, right), (left, zero)):
            if lower < min(upper, start):
                yield interval, lower, min(upper, start)


def root_to_last_bit(function: Callable[[float], float], lower: float, upper: float) -> float:
    """Upper end of the last bit in which a function turns from negative to not; without scipy."""
    middle = 0.5 * (lower + upper)
    while lower < middle < upper:
        if function(middle) < 0.0:
            lower = middle
        else:
            upper = middle
        middle = 0.5 * (lower + upper)
    return upper
