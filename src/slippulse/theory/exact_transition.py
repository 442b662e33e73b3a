"""The crack-pulse transition under leaf springs, in scenes that stick first at x = 0."""

from functools import partial

import numpy as np

from ..model.checks import check_kind
from ..model.prestress import Prestress
from .curve import Curve
from .domains import check_domains
from .fast_front import FastFront, straight_panels
from .front_speeds import front_speed
from .part import Part
from .prestress_pieces import split_into_pieces
from .two_fronts import ExactTransition, fast_fronts


def exact_transition_displacement(
    prestress: Prestress, gamma: float, damping_ratio: float = 0.0, release: str = "total"
) -> ExactTransition:
    """Return T_trans and L_trans of a symmetric scene under a displacement boundary, as dx -> 0.

    Raises ValueError: outside the ranges below; if the rupture also nucleates away from x = 0; or
    if a front needs more than 20000 panels. This does not happen if gamma times the square of the
    Gaussian width is between 1e-17 and 1e6.
    Source: the first zero of du/dt at x = 0. With a Gaussian as the only change of the pre-stress,
    x = 0 sticks first. With steps, bumps or points, another position may stick before;
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
    # The level far away, beyond all steps.
    level = float(prestress.level(np.asarray(1e300)))
    is_nowhere_negative = all(piece.is_above for piece in split_into_pieces(prestress))
    if not (prestress.symmetric and is_nowhere_negative and level > 0.0):
        allowed = "equal values > 0 on both sides"
        raise ValueError(f"prestress: not symmetric, or not positive; allowed: {allowed}")
    gamma = float(gamma)
    fronts_up_to = partial(
        fast_fronts, prestress, damping_ratio=damping_ratio, release=release, gamma=gamma
    )
    # Positions from which waves come that change du/dt within less than a step of the search.
    law = FastFront(prestress=prestress, gamma=gamma, damping_ratio=damping_ratio, release=release)
    marks = [*law.marks, *(law.narrow_features if prestress.bumps else ())]
    # Half of the period of the leaf springs, after which uniform slip would stick. The stick is
    # searched for until twice this time, and longer only if it is not found.
    half_period = float(np.pi / np.sqrt(gamma))
    until, stick = half_period, np.nan
    while np.isnan(stick):
        until *= 2.0
        # Until this time only fronts at a smaller distance influence x = 0, because waves have the
        # speed 1. The fronts are computed a little farther.
        fronts = fronts_up_to(reach=1.25 * until)
        part = Part(fronts, gamma, until=until, marks=marks)
        stick = float(part.find_stick_times(np.zeros(1))[0])
    time_at_end_of_curve = fronts.edge_times[-1]
    if stick >= time_at_end_of_curve:
        # When x = 0 sticks, the fronts are already beyond the distance up to which they have been
        # computed, since they are faster than the waves. They are computed again, up to a distance
        # that they have certainly not reached at that time.
        speed = float(front_speed(level, damping_ratio, release))
        fronts = fronts_up_to(reach=speed * stick + _distance_to_uniform(prestress))
    right_front = fronts.front_at(stick, x=0.0, side=1.0)
    return ExactTransition(stick, 2.0 * right_front)


def _distance_to_uniform(prestress: Prestress) -> float:
    """Return the distance from x = 0 beyond which the pre-stress is uniform.

    At 20 widths from its centre, a Gaussian is smaller than any rounding error.
    """
    ends_of_gaussians = [abs(centre) + 20.0 * width for centre, width in prestress.gaussians]
    steps_and_points = [abs(x) for x, _ in (*prestress.steps, *prestress.points)]
    return max([0.0, *ends_of_gaussians, *steps_and_points])


def uniform_transition_time(
    tau0: float, gamma: float, damping_ratio: float = 0.0, release: str = "total"
) -> float:
    """Return T_trans in uniform pre-stress, if the rupture starts at a single point.

    Raises ValueError: outside the domain.
    Source: the first zero of du/dt at x = 0, behind two fronts of constant speed v that start there
    at t = 0. This time is proportional to 1/sqrt(gamma), with a factor that depends on v alone.

    Parameters
    ----------
    tau0, gamma : floats, pre-stress, in (0, 1), and elasticity ratio, > 0
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
    # At a given front speed, du/dt is proportional to tau, so that its zero does not depend on tau.
    # A tiny tau would lose digits.
    tau = max(tau0, 1e-9)
    # The time is computed at gamma = 1, where it is below 10. Until then only the fronts at a
    # distance below 10 influence x = 0. Their curve extends to 12, in panels of length 1.
    edges_of_panels = np.linspace(-12.0, 12.0, 25)
    curve = Curve(straight_panels(edges_of_panels, slowness, tau))
    (stick,) = Part(curve, gamma=1.0, until=10.0).find_stick_times(np.zeros(1))
    return float(stick / np.sqrt(float(gamma)))
