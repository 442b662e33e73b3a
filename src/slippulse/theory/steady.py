"""The steady pulse behind a front whose speed is that of the front law: apart, since measuring needs no front law."""

from __future__ import annotations

from ..model.checks import check_domains, check_number
from .front_law import front_speed
from .pulse import SteadyPulse, pulse_behind_front


def steady_pulse(
    tau0: float, gamma: float, beta: float = 0.0, speed: float | None = None, *, damping_ratio: float | None = None,
    release: str = "total", rate_strengthening: float = 0.0,
) -> SteadyPulse:  # fmt: skip
    """Steady pulse in uniform pre-stress behind a front whose speed is given, or follows from the damping ratio.

    Parameters
    ----------
    tau0 : pre-stress, in (0, 1)
    gamma : elasticity ratio, > 0
    beta : damping, >= 0; 0 is the limit dx -> 0 at any damping ratio
    speed : front speed, > 1, or
    damping_ratio, release : of `front_speed`, where the speed is left out
    rate_strengthening : alpha, of a term -alpha du/dt, between -alpha_c and alpha_c (`critical_rate_strengthening`)

    Raises ValueError: outside the domain.
    Source: `pulse_behind_front`.
    """
    check_domains(tau0=tau0, gamma=gamma)
    check_number("beta", beta, at_least=0.0)
    if damping_ratio is None and speed is not None:
        return pulse_behind_front(tau0, gamma, beta, speed, rate_strengthening)
    if damping_ratio is None or speed is not None:
        raise ValueError(f"speed, damping_ratio: {speed}, {damping_ratio}; allowed: one of the two")
    found = float(front_speed(tau0, damping_ratio, release))
    return pulse_behind_front(tau0, gamma, beta, found, rate_strengthening)
