"""The steady slip pulse, with damping, behind a front of a given speed or damping ratio."""

from .closed_pulse import SteadyPulse, pulse_at_speed
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
    """Return the steady pulse in uniform pre-stress behind a front.

    Source: slip is a function U(xi) of the distance xi = x - v t from the front. It obeys
    beta v U''' + (v^2 - 1) U'' - alpha v U' + gamma U = tau_0, with U(0) = U'(0) = 0. In the
    solution, an exponential that grows with the distance from the front is left out. With
    alpha = beta = 0 it is the pulse of appendix C of the paper, but for any front speed v.
    Raises ValueError: outside the ranges below, or where the numbers of the pulse are too large or
    small for a float.

    Parameters
    ----------
    tau0, gamma : floats, pre-stress, in (0, 1), and elasticity ratio, > 0
    beta : float, damping, >= 0; 0 gives the limit dx -> 0 at any damping ratio
    speed : float, front speed (wave speeds), > 1, or None
    damping_ratio, release : if speed is None, the speed is `front_speed` of these arguments
    rate_strengthening : float, alpha of a term -alpha du/dt, of a size below
        `critical_rate_strengthening`

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
        check_domains(tau0=tau0, damping_ratio=damping_ratio)
        speed = float(front_speed(tau0, damping_ratio, release))
    return pulse_at_speed(
        tau0, gamma=gamma, beta=beta, speed=speed, rate_strengthening=rate_strengthening
    )
