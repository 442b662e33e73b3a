"""Front speeds with leaf springs, on the damped lattice and in the continuum.

On the lattice they follow from the Wiener-Hopf factor, as in `front_speeds`.
"""

import numpy as np

from ..model.checks import check_choice, check_number
from ..model.release import RELEASES
from ..model.runaway import check_runaway
from .domains import check_domains
from .front_speeds import MIN_LOG_EXCESS, Lattice, front_speed, speeds_into

# If 1 - tau_0 is below this, rounding affects the quadrature, since with leaf springs no reference
# with the same rounding is subtracted.
NEARLY_ONE_DISTANCE = 1e-7
# Leaf springs (gamma dx^2) and drag (alpha dx) below the minimum make no difference. With stronger
# leaf springs than the maximum no front outruns the waves.
MIN_SPRINGS, MAX_SPRINGS = 1e-30, 1e30
MIN_DRAG = 1e-15
# Next to tau_0 = 1, leaf springs (times 1 + beta/dx) below this fraction of v^2, and drag below
# this fraction of v, are included as small corrections.
SMALL_CORRECTION = 1e-5
# Factor by which a front is at least faster than the speed at which slip runs away.
SPEED_MARGIN = 1.0 + 1e-6
# The least pre-stress is first searched at this number of speeds.
SCAN_SPEEDS = 64
# Around the lowest one it is then searched at this number of speeds ...
NARROW_SCAN_SPEEDS = 17
# ... this number of times.
NARROW_SCANS = 6


def lattice_front_speed(
    tau0: float,
    gamma: float,
    dx: float,
    damping_ratio: float = 0.0,
    release: str = "total",
    rate_strengthening: float = 0.0,
) -> float:
    """Return the exact front speed with leaf springs, damping and drag -alpha du/dt.

    With strong damping and rule "total", the front with the least pre-stress is faster than the
    waves. Then two speeds belong to one tau_0; the higher one, which grows with tau_0, is returned.
    Source: the lattice symbol with leaf springs (`wiener_hopf`), which has a closed form without
    damping and tends to `front_speed` as gamma dx^2 -> 0. Sticking behind the front is left out.
    The relative error is below 1e-6 next to tau_0 = 1 for gamma dx^2 (1 + beta/dx) up to 10.
    Raises ValueError: outside these ranges, or where tau_0 is not above the least pre-stress of any
    front faster than the waves and than sqrt(4 + gamma dx^2)/pi. (If friction weakens with
    slip velocity, the front must also be so fast that slip behind it does not run away.)

    Parameters
    ----------
    tau0, gamma, dx : floats, pre-stress, in (0, 1), elasticity ratio, > 0, and spacing (H), > 0
    damping_ratio, release : beta/dx, from 0 to 1e100; "total" or "elastic"
    rate_strengthening : float, alpha of a term -alpha du/dt; as dx -> 0 it no longer matters

    Returns
    -------
    float : front speed (wave speeds)

    Examples
    --------
    >>> round(lattice_front_speed(0.6, 0.65, 0.01), 4)
    1.25
    """
    check_domains(tau0=tau0, gamma=gamma, dx=dx, damping_ratio=damping_ratio)
    check_choice("release", release, RELEASES)
    check_number("rate_strengthening", rate_strengthening)
    check_runaway(float(gamma), float(rate_strengthening))
    springs = float(gamma) * float(dx) * float(dx)
    drag = float(rate_strengthening) * float(dx)
    if springs < MIN_SPRINGS and abs(drag) < MIN_DRAG:
        return float(front_speed(tau0, damping_ratio, release))
    lattice = Lattice(
        ratio=np.array([float(damping_ratio)]), release=release, springs=springs, drag=drag
    )
    speed = _speed_nearly_one(tau0, lattice)
    if speed is not None:
        return speed
    slowest, least_prestress = _least_prestress(tau0, lattice)
    if tau0 <= least_prestress:
        rate = f", rate_strengthening = {rate_strengthening:g}" if drag else ""
        raise ValueError(
            f"tau0: {tau0!r}; allowed: > {least_prestress:.6g}, values whose front outruns the"
            f" waves at gamma = {gamma:g}, dx = {dx:g}, damping_ratio = {damping_ratio:g}{rate}"
        )
    if damping_ratio == drag == 0.0:
        # The closed form, solved for v.
        argument = np.sqrt(springs * (1.0 - tau0**2)) / (2.0 * tau0)
        return float(np.sqrt(springs) / (2.0 * tau0 * np.arcsin(argument)))
    return float(speeds_into(np.array([float(tau0)]), lattice, slowest)[0])


def _speed_nearly_one(tau0: float, lattice: Lattice) -> float | None:
    """Return the speed of a front next to tau_0 = 1, to first order in the leaf springs.

    The result is None if tau_0 is not so near to 1, or if leaf springs or drag are not small.
    """
    springs, release = lattice.springs, lattice.release
    damping_ratio = float(lattice.ratio[0])
    is_near = 1.0 - tau0 < NEARLY_ONE_DISTANCE
    if not (is_near and damping_ratio > 0.0 and springs <= MAX_SPRINGS):
        return None
    speed = front_speed(tau0, damping_ratio, release)
    has_weak_springs = springs * (1.0 + damping_ratio) < SMALL_CORRECTION * speed**2
    has_weak_drag = abs(lattice.drag) < SMALL_CORRECTION * speed
    if not (has_weak_springs and has_weak_drag):
        return None
    # The relative decrease of the speed is proportional to g/v^2. The coefficient is 1/24 without
    # damping and, by quadrature, 1/6 for b v >> 1.
    strength = damping_ratio * speed if release == "total" else 0.0
    coefficient = strength / 6.0 + 1.0 / 24.0
    slowed = springs / speed**2 * coefficient / (strength + 1.0)
    return speed * (1.0 - slowed)


def continuum_front_speed(tau0: float, gamma: float, beta: float) -> float:
    """Return the front speed as dx -> 0 at fixed beta, under the printed rule ("elastic").

    Source: v^2 = 1/{(1 - tau)[1 + gamma beta^2 (1 - tau)^2/tau^2]}. The symbol has one zero -i Y
    below the real axis, beta v Y^3 = (v^2 - 1) Y^2 + gamma; the rule is Y/(Y + 1/(beta v)) = tau.
    Raises ValueError: outside these ranges, or where the front would not outrun the waves.

    Parameters
    ----------
    tau0, gamma, beta : floats, pre-stress, in (0, 1), elasticity ratio, >= 0, and damping, > 0

    Returns
    -------
    float : front speed (wave speeds)

    Examples
    --------
    >>> continuum_front_speed(0.75, 0.0, 0.1)
    2.0
    """
    check_domains(tau0=tau0)
    check_number("gamma", gamma, at_least=0.0)
    check_number("beta", beta, above=0.0)
    springs = (np.sqrt(float(gamma)) * beta * (1.0 - tau0) / tau0) ** 2
    # This condition is v > 1.
    if not springs < tau0 / (1.0 - tau0):
        raise ValueError(
            f"tau0: {tau0!r}; allowed: values whose front outruns the waves at gamma = {gamma:g},"
            f" beta = {beta:g}"
        )
    return float(1.0 / np.sqrt((1.0 - tau0) * (1.0 + springs)))


def _least_prestress(tau0: float, lattice: Lattice) -> tuple[float, float]:
    """Return ln(v - 1) of the front with the least pre-stress, and this pre-stress.

    If tau_0 is above the pre-stress of the slowest front, these are the values of that front.
    """
    springs, ratio = lattice.springs, lattice.ratio
    if springs > MAX_SPRINGS:
        return 0.0, 1.0
    slowest_speed = max(1.0, np.sqrt(4.0 + springs) / np.pi)
    if lattice.drag < 0.0:
        # Slip runs away behind a slower front.
        inverse_runaway_speed = np.sqrt(1.0 - 0.25 * lattice.drag**2 / springs)
        slowest_speed = max(slowest_speed, SPEED_MARGIN / inverse_runaway_speed)
    log_excess = float(np.log(slowest_speed - 1.0)) if slowest_speed > 1.0 else MIN_LOG_EXCESS
    least = float(np.exp(lattice.log_prestress(np.array([log_excess]), ratio)[0]))
    # Usually the slowest front has the least pre-stress, and each higher pre-stress has one speed.
    if tau0 > least:
        return log_excess, least
    slowest_speed = 1.0 + np.exp(log_excess)
    log_range = np.log(slowest_speed * (1.0 + ratio[0]) * (1.0 + springs)) + 5.0
    faster = np.geomspace(1e-6, np.exp(log_range), SCAN_SPEEDS - 1)
    log_excesses = np.append(log_excess, np.log(slowest_speed - 1.0 + faster))
    for _ in range(NARROW_SCANS + 1):
        log_tau = lattice.log_prestress(log_excesses, np.full(log_excesses.size, ratio[0]))
        lowest = int(np.argmin(log_tau))
        log_excess_of_least = float(log_excesses[lowest])
        least = float(np.exp(log_tau[lowest]))
        if log_excess_of_least == log_excess:
            break
        below = log_excesses[max(lowest - 1, 0)]
        above = log_excesses[min(lowest + 1, log_excesses.size - 1)]
        log_excesses = np.linspace(below, above, NARROW_SCAN_SPEEDS)
    return log_excess_of_least, least
