"""Steady pulses under friction that depends on slip rate, in the limit dx -> 0 at fixed beta/dx.

Such a law is 0 at rest, so a front does not feel it. Behind a front of speed v, U(xi) obeys

    (v^2 - 1) U'' + gamma U = tau_0 - f(V),   V = -v U',   U(0) = U'(0) = 0.
"""

import math
from dataclasses import dataclass

import numpy as np

from ..model.checks import short_repr
from ..model.friction_laws.law import Friction
from .domains import check_domains
from .front_speeds import front_speed
from .weakening import SteadyRupture

# Half-periods of leaf springs behind the front in which slip must stop, or it creeps.
FARTHEST = 12.0
# Accuracy of the integration.
RELATIVE, ABSOLUTE = 1e-10, 1e-12
# Steps in each half-period, so that no stop is missed.
STEPS = 100


@dataclass(frozen=True)
class RatePulse(SteadyRupture):
    """Steady rupture under friction that depends on slip rate: its largest slip velocity, too."""

    peak_velocity: float


def rate_pulse(tau0: float, gamma: float, damping_ratio: float, friction: Friction) -> RatePulse:
    """Steady pulse in uniform pre-stress under friction that depends on slip rate alone.

    Source: derived in the supplement, section on friction that depends on slip rate.
    Raises ValueError: outside the domain.

    Parameters
    ----------
    tau0, gamma, damping_ratio : floats, pre-stress, in (0, 1), gamma > 0, and beta/dx, >= 0
    friction : Friction, a law that is 0 at rest and does not depend on slip

    Returns
    -------
    RatePulse : of infinite width and slip tau_0/gamma where slip creeps on

    Examples
    --------
    >>> law = sp.friction("bounded_rate", limit=0.3, v_0=1.0)
    >>> round(rate_pulse(0.5, 2 / 3, 0.1, law).slip, 4)
    1.1605
    """
    # Slow to load.
    from scipy.integrate import solve_ivp

    check_domains(tau0=tau0, gamma=gamma)
    constants = friction.constants
    if friction.friction(0.0, 0.0, *constants) != 0.0:
        allowed = "laws that depend on slip rate alone"
        raise ValueError(f"friction.law: {short_repr(friction.law)}; allowed: {allowed}")
    v = float(front_speed(tau0, damping_ratio))
    inertia = (v - 1.0) * (v + 1.0)
    half_period = math.pi * math.sqrt(inertia / gamma)

    def slopes(distance: float, state: np.ndarray) -> list[float]:
        slip, strain = state
        resistance = friction.friction(slip, v * strain, *constants)
        return [strain, (tau0 - resistance - gamma * slip) / inertia]

    def strain(distance: float, state: np.ndarray) -> float:
        return state[1]

    def curvature(distance: float, state: np.ndarray) -> float:
        return slopes(distance, state)[1]

    strain.terminal, strain.direction = True, -1.0  # type: ignore[attr-defined]
    accuracy = {"rtol": RELATIVE, "atol": ABSOLUTE, "max_step": half_period / STEPS}
    span = (0.0, FARTHEST * half_period)
    path = solve_ivp(slopes, span, [0.0, 0.0], events=[strain, curvature], **accuracy)
    peak = v * max(float(state[1]) for state in path.y_events[1])
    if path.status != 1:
        return RatePulse(v, math.inf, tau0 / gamma, peak)
    return RatePulse(v, float(path.t[-1]), float(path.y[0, -1]), peak)
