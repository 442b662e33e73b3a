"""The steady slip pulse, with damping."""

import math

from ..model.checks import check_number
from .closed_pulse import NoPulse, SteadyPulse, pulse_at_speed
from .domains import check_domains
from .front_speeds import front_speed


def steady_pulse(
    tau0: float,
    gamma: float,
    beta: float = 0.0,
    speed: float | None = None,
    *,
    damping_ratio: float | None = None,
    release: str = "total",
    rate_strengthening: float = 0.0,
) -> SteadyPulse:
    """Steady pulse in uniform pre-stress behind a front.

    Source: beta v U''' + (v^2 - 1) U'' - alpha v U' + gamma U = tau_0 with U(0) = U'(0) = 0 on the
    complex pair of roots. The real root, about -(v^2 - 1)/(beta v), grows away from the front and
    is dropped. alpha = beta = 0 gives appendix C of the paper before its last step, at any speed.
    Raises ValueError: outside these ranges, or where the pulse is too large or small.

    Parameters
    ----------
    tau0, gamma : floats, pre-stress, in (0, 1), and elasticity ratio, > 0
    beta : float, damping, >= 0; 0 is the limit dx -> 0 at any damping ratio
    speed : float, front speed (wave speeds), > 1, or None
    damping_ratio, release : where speed is None it is that of `front_speed`
    rate_strengthening : float, alpha of a term -alpha du/dt, at most `critical_rate_strengthening`
        in size

    Returns
    -------
    SteadyPulse

    Examples
    --------
    >>> round(steady_pulse(0.6, 0.65, speed=1.25).slip, 6)
    1.846154
    """
    if (damping_ratio is None) == (speed is None):
        raise ValueError(f"speed, damping_ratio: {speed}, {damping_ratio}; allowed: one of the two")
    if speed is None:
        speed = float(front_speed(tau0, damping_ratio, release))
    try:
        return pulse_at_speed(tau0, gamma, beta, speed, rate_strengthening)
    except NoPulse:
        critical = critical_rate_strengthening(gamma, speed)
        if abs(rate_strengthening) <= 0.5 * critical:
            raise
    raise ValueError(
        f"rate_strengthening: {rate_strengthening!r}; allowed: less than {critical:.6g} in size at"
        f" gamma = {gamma:.4g}, speed = {speed:.6g} without beta, or no pulse is steady"
    )


def critical_rate_strengthening(gamma: float, speed: float) -> float:
    """alpha_c = 2 sqrt(gamma) sqrt(1 - 1/v^2): no pulse is steady beyond +- alpha_c.

    Source: the wavenumber q of the steady pulse is 0 there (beta -> 0). Without damping of the
    front alpha_c is 2 tau_0 sqrt(gamma). Raises ValueError: outside the domain.

    Parameters
    ----------
    gamma, speed : floats, elasticity ratio, > 0, and front speed v (wave speeds), > 1

    Returns
    -------
    float : alpha_c

    Examples
    --------
    >>> critical_rate_strengthening(0.25, 1.25)
    0.6
    """
    check_domains(gamma=gamma)
    check_number("speed", speed, above=1.0)
    return 2.0 * math.sqrt(gamma) * math.sqrt((speed - 1.0) * (speed + 1.0)) / speed
