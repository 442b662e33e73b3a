"""Balance of the pre-stress, which ends a rupture under a stress boundary."""

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from .checks import check_kind
from .prestress import Prestress


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
    gaussians = [(0.0, 1.0, prestress.width), *prestress.bumps]
    ends = [abs(centre) + 40.0 * width for centre, _, width in gaussians]
    distance = max(ends + [abs(position) + prestress.width for position, _ in prestress.steps])
    left, right = prestress.level(np.array([-distance, distance])).tolist()
    if right != 0.0:
        allowed = "0, or the balance integral is not finite"
        raise ValueError(f"prestress.right: {right!r}; allowed: {allowed}")
    if left >= 0.0:
        allowed = "< 0, or the pre-stress is never balanced"
        raise ValueError(f"prestress.left: {left!r}; allowed: {allowed}")
    lower, upper = -distance, 0.0
    while prestress.integral(lower, distance) > 0.0:
        lower *= 2.0
    if not prestress.integral(lower, distance) <= 0.0 <= prestress.integral(upper, distance):
        raise ArithmeticError("the pre-stress has no balance at x < 0 that can be computed")
    return root_to_last_bit(lambda x: prestress.integral(x, distance), lower, upper)


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
