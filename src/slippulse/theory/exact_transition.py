"""The crack-pulse transition under leaf springs, in scenes that first stick at x = 0."""

import numpy as np

from ..model.checks import check_kind
from ..model.prestress import Prestress
from .curve import Curve
from .domains import check_domains
from .fast_front import straight_panels
from .front_speeds import front_speed
from .part import Part
from .two_fronts import ExactTransition, fast_fronts

# Largest distance, in wave lengths, that is kept of a uniform front that hardly outruns the waves.
FARTHEST = 10_000


def exact_transition_displacement(
    prestress: Prestress, gamma: float, damping_ratio: float = 0.0, release: str = "total"
) -> ExactTransition:
    """T_trans and L_trans of a symmetric scene under a displacement boundary, as dx -> 0.

    Raises ValueError: outside these ranges; if the profile nucleates elsewhere too; or if a front
    needs more than 20000 panels: gamma times the square of the width from 1e-17 to 1e6 is safe.
    Source: the first zero of du/dt at x = 0, where symmetric scenes stick first. For other scenes,
    `Rupture.transition` looks at all positions.

    Parameters
    ----------
    prestress : Prestress, symmetric, with tau(0) = 1, positive everywhere
    gamma : float, elasticity ratio, > 0
    damping_ratio, release : beta/dx, from 0 to 1e6; "total" or "elastic"

    Returns
    -------
    ExactTransition

    Examples
    --------
    >>> round(exact_transition_displacement(Prestress(0.5, 0.5), 0.65).time, 2)
    3.83
    """
    check_kind("prestress", prestress, Prestress)
    check_domains(gamma=gamma)
    level = float(prestress.level(np.asarray(1e300)))
    if not prestress.symmetric or level <= 0.0:
        allowed = "equal levels > 0 on both sides"
        raise ValueError(f"prestress: not symmetric and positive; allowed: {allowed}")
    gamma = float(gamma)
    period = float(np.pi / np.sqrt(gamma))
    # The past of (0, t) begins at x + T(x) = t, so x < t.
    fronts = fast_fronts(prestress, damping_ratio, release, 2.5 * period, gamma)
    stick = float(Part(fronts, gamma, 2.0 * period).search(np.zeros(1))[0])
    if not stick < fronts.edge_times[-1]:
        reach = float(front_speed(level, damping_ratio, release)) * stick + _extent(prestress)
        fronts = fast_fronts(prestress, damping_ratio, release, reach, gamma)
    return ExactTransition(stick, 2.0 * fronts.front_at(stick, 0.0, 1.0))


def _extent(prestress: Prestress) -> float:
    """Distance beyond which the pre-stress is uniform."""
    return max([20.0 * (prestress.width or 0.0), *(x for x, _ in prestress.points)])


def uniform_transition_time(
    tau0: float, gamma: float, damping_ratio: float = 0.0, release: str = "total"
) -> float:
    """T_trans, like 1/sqrt(gamma), in uniform pre-stress that is nucleated at one point.

    Raises ValueError: outside the domain.
    Source: the first zero of du/dt at x = 0 behind the fronts T(x) = |x|/v. With w = 1/v and
    q = sqrt(gamma) t/(1 + w) it is that of Int_0^q J0( sqrt((w q + q - w s)^2 - s^2) ) ds, which
    depends on v alone.

    Parameters
    ----------
    tau0, gamma : float, pre-stress, in (0, 1), and elasticity ratio, > 0
    damping_ratio, release : beta/dx, from 0 to 1e100; "total" or "elastic"

    Returns
    -------
    float, proportional to 1/sqrt(gamma)

    Examples
    --------
    >>> round(uniform_transition_time(0.4, 1.0), 3)
    3.787
    """
    check_domains(tau0=tau0, gamma=gamma, damping_ratio=damping_ratio)
    slowness = 1.0 / float(front_speed(tau0, damping_ratio, release))
    # A factor of the velocity does not move its zero; a tiny one would lose digits.
    tau = max(tau0, 1e-9)
    # The fronts of a slow rupture need not be known beyond where the waves of the centre come from.
    reach = 12.0 / max(1.0 - slowness**2, 12.0 / FARTHEST)
    edges = np.linspace(-reach, reach, 2 * int(np.ceil(reach)) + 1)
    curve = Curve(straight_panels(edges, slowness, tau))
    return float(Part(curve, 1.0, 10.0).search(np.zeros(1))[0] / np.sqrt(float(gamma)))
