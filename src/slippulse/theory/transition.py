"""The paper's estimates of where and when a crack becomes a pulse."""

from __future__ import annotations

import numpy as np

from ..checks import check_number
from ..prestress import Prestress
from ..roots import root_between


def paper_transition_displacement(tau0: float, gamma: float) -> tuple[float, float]:
    """The paper's T_trans = pi/sqrt(gamma) and L_trans = 2 T_trans/sqrt(1 - tau_0^2), displacement boundary.

    Parameters
    ----------
    tau0 : pre-stress on both sides, in (0, 1)
    gamma : elasticity ratio, > 0

    Source: section III B of the paper. It neglects the elastic coupling and the Gaussian at nucleation.
    """
    check_number("tau0", tau0, above=0.0, below=1.0)
    check_number("gamma", gamma, above=0.0)
    time = np.pi / np.sqrt(gamma)
    return float(time), float(2.0 * time / np.sqrt(1.0 - tau0**2))


def prestress_balance_position(prestress: Prestress) -> float:
    """x_minus < 0, where the integral of the pre-stress from x_minus to infinity vanishes.

    Parameters
    ----------
    prestress : a profile whose level is 0 far to the right and negative far to the left

    Raises
    ------
    ValueError
        If the levels are otherwise: the integral then has no finite value, or never returns to 0.

    Source: equation (11) of the paper, section III C.
    """
    far = _far(prestress)
    right, left = float(prestress.level(np.asarray(far))), float(prestress.level(np.asarray(-far)))
    if right != 0.0:
        raise ValueError(f"prestress.right: {right!r}; allowed: 0, or the balance integral is not finite")
    if left >= 0.0:
        raise ValueError(f"prestress.left: {left!r}; allowed: < 0, or the pre-stress is never balanced")
    reach = far
    while prestress.integral(-reach, far) > 0.0:
        reach *= 2.0
    return float(root_between(lambda x: prestress.integral(x, far), -reach, 0.0, xtol=1e-12 * reach))


def paper_transition_stress(prestress: Prestress) -> tuple[float, float]:
    """The paper's T_trans = |x_minus| and L_trans = 2 |x_minus|, stress boundary, front speeds taken as 1.

    Source: section III C of the paper.
    """
    distance = abs(prestress_balance_position(prestress))
    return distance, 2.0 * distance


def _far(prestress: Prestress) -> float:
    """A distance beyond which the profile is its side levels to rounding."""
    reach = [40.0 * prestress.width]
    reach += [abs(centre) + 40.0 * width for centre, _, width in prestress.bumps]
    reach += [abs(position) + prestress.width for position, _ in prestress.steps]
    return max(reach)
