"""The crack-pulse transition under leaf springs, in scenes that stick first at x = 0."""

import numpy as np

from ..model.checks import check_kind
from ..model.prestress import Prestress
from .curve import Curve
from .domains import check_domains
from .fast_front import straight_panels
from .front_speeds import front_speed
from .part import Part
from .two_fronts import ExactTransition, fast_fronts

# Largest distance, in wave lengths, up to which a uniform front is computed that is hardly faster
# than the waves.
MAX_REACH = 10_000


def exact_transition_displacement(
    prestress: Prestress, gamma: float, damping_ratio: float = 0.0, release: str = "total"
) -> ExactTransition:
    """Return T_trans and L_trans of a symmetric scene under a displacement boundary, as dx -> 0.

    Raises ValueError: outside these ranges; if the profile also nucleates elsewhere; or if a front
    needs more than 20000 panels: gamma times the square of the width from 1e-17 to 1e6 is safe.
    Source: the first zero of du/dt at x = 0, where symmetric scenes stick first. For other scenes,
    `Rupture.transition` examines all positions.

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
    # Half of the period of the leaf springs, after which uniform slip would stick.
    half_period = float(np.pi / np.sqrt(gamma))
    # Only points of the fronts with |x| + T(x) <= t influence the motion at x = 0 up to the time t.
    # They have |x| < t. The stick is searched for up to t = 2 half-periods, so that this reach is
    # long enough.
    fronts = fast_fronts(
        prestress,
        damping_ratio=damping_ratio,
        release=release,
        reach=2.5 * half_period,
        gamma=gamma,
    )
    part = Part(fronts, gamma, until=2.0 * half_period)
    stick = float(part.find_stick_times(np.zeros(1))[0])
    if not stick < fronts.edge_times[-1]:
        # The fronts are faster than the waves. At the time of the stick they may be farther away
        # than was needed to find it, so they are computed again over a longer distance.
        speed = float(front_speed(level, damping_ratio, release))
        reach = speed * stick + _distance_to_uniform(prestress)
        fronts = fast_fronts(
            prestress, damping_ratio=damping_ratio, release=release, reach=reach, gamma=gamma
        )
    return ExactTransition(stick, 2.0 * fronts.front_at(stick, x=0.0, side=1.0))


def _distance_to_uniform(prestress: Prestress) -> float:
    """Return the distance beyond which the pre-stress is uniform."""
    width = prestress.width or 0.0
    return max([20.0 * width, *(x for x, _ in prestress.points)])


def uniform_transition_time(
    tau0: float, gamma: float, damping_ratio: float = 0.0, release: str = "total"
) -> float:
    """Return T_trans in uniform pre-stress with a point-like nucleation.

    Raises ValueError: outside the domain.
    Source: the first zero of du/dt at x = 0 behind the fronts ``T(x) = |x|/v``. With w = 1/v and
    q = sqrt(gamma) t/(1 + w), du/dt is proportional to Int_0^q J0( sqrt((w q + q - w s)^2 - s^2) )
    ds, whose zero depends on v alone.

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
    # The zero of du/dt does not depend on the size of tau, but a tiny tau would lose digits.
    tau = max(tau0, 1e-9)
    # The front of a slow rupture is needed only as far as waves from it reach the centre in time.
    reach = 12.0 / max(1.0 - slowness**2, 12.0 / MAX_REACH)
    edges = np.linspace(-reach, reach, 2 * int(np.ceil(reach)) + 1)
    curve = Curve(straight_panels(edges, slowness, tau))
    # The time is computed at gamma = 1.
    (stick,) = Part(curve, gamma=1.0, until=10.0).find_stick_times(np.zeros(1))
    return float(stick / np.sqrt(float(gamma)))
