"""Where the pre-stress is balanced: x_minus."""

import numpy as np

from .checks import check_kind
from .prestress import Prestress
from .roots import root_between


def prestress_balance_position(prestress: Prestress) -> float:
    """x_minus < 0, where the integral of the pre-stress from x_minus to infinity vanishes.

    Parameters
    ----------
    prestress : a profile whose level is 0 far to the right and negative far to the left

    Raises ValueError: if it is none such; ArithmeticError: if numbers are too large to compute with.
    Source: equation (11) of the paper, section III C.
    """
    check_kind("prestress", prestress, Prestress)
    far = _far(prestress)
    right, left = float(prestress.level(np.asarray(far))), float(prestress.level(np.asarray(-far)))
    if right != 0.0:
        raise ValueError(f"prestress.right: {right!r}; allowed: 0, or the balance integral is not finite")
    if left >= 0.0:
        raise ValueError(f"prestress.left: {left!r}; allowed: < 0, or the pre-stress is never balanced")
    reach = far
    while prestress.integral(-reach, far) > 0.0:
        reach *= 2.0
    try:
        return float(root_between(lambda x: prestress.integral(x, far), -reach, 0.0, xtol=1e-12 * reach))
    except ValueError as error:
        raise ArithmeticError(f"the balance of the pre-stress cannot be computed: {error}") from None


def _far(prestress: Prestress) -> float:
    """A distance beyond which the profile is its side levels to rounding."""
    reach = [40.0 * prestress.width]
    reach += [abs(centre) + 40.0 * width for centre, _, width in prestress.bumps]
    reach += [abs(position) + prestress.width for position, _ in prestress.steps]
    return max(reach)
