"""The paper's estimates of where and when a crack becomes a pulse."""

from __future__ import annotations

import numpy as np

from ..model.balance import prestress_balance_position
from ..model.checks import check_domains
from ..model.prestress import Prestress


def paper_transition_displacement(tau0: float, gamma: float) -> tuple[float, float]:
    """The paper's T_trans = pi/sqrt(gamma) and L_trans = 2 T_trans/sqrt(1 - tau_0^2), displacement boundary.

    Parameters
    ----------
    tau0 : pre-stress on both sides, in (0, 1)
    gamma : elasticity ratio, > 0

    Raises ValueError: outside the domain.
    Source: section III B of the paper. It neglects the elastic coupling and the Gaussian at nucleation.
    """
    check_domains(tau0=tau0, gamma=gamma)
    time = np.pi / np.sqrt(float(gamma))
    return float(time), float(2.0 * time / np.sqrt(1.0 - tau0**2))


def paper_transition_stress(prestress: Prestress) -> tuple[float, float]:
    """The paper's T_trans = |x_minus| and L_trans = 2 |x_minus|, stress boundary, front speeds taken as 1.

    Raises ValueError: as `prestress_balance_position`.
    Source: section III C of the paper.
    """
    distance = abs(prestress_balance_position(prestress))
    return distance, 2.0 * distance
