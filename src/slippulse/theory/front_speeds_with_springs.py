"""Front speeds with leaf springs, on the damped lattice and in the continuum.

On the lattice they follow from the Wiener-Hopf factor, as in `front_speeds`.
"""

import numpy as np

from ..model.checks import check_choice, check_number
from ..model.release import RELEASES
from ..model.runaway import check_runaway
from .domains import check_domains
from .front_speeds import MIN_LOG_EXCESS, FrontLaw, front_speed, speeds_into

# If 1 - tau_0 is below this, rounding affects the quadrature. (Without leaf springs the limit is
# lower, because only the difference from a closed form is integrated.)
NEARLY_ONE_DISTANCE = 1e-7
# Leaf springs (gamma dx^2) and drag (alpha dx) below these values make no difference.
MIN_GAMMA_DX2, MIN_ALPHA_DX = 1e-30, 1e-15
# With stronger leaf springs than this no front outruns the waves.
MAX_GAMMA_DX2 = 1e30
# Next to tau_0 = 1, leaf springs are a small correction if gamma dx^2 (1 + beta/dx) is below this
# fraction of v^2, where v is the front speed. Drag is one if alpha dx is below this fraction of v.
SMALL_CORRECTION = 1e-5
# Factor by which a front is at least faster than the speed at which slip runs away.
SPEED_MARGIN = 1.0 + 1e-6
# The least pre-stress is first searched at this number of speeds.
SCAN_SPEEDS = 64
# Then the search is repeated between the neighbours of the best speed, this number of times ...
NARROW_SCANS = 6
# ... and each time at this number of speeds.
NARROW_SCAN_SPEEDS = 17


def lattice_front_speed(
    tau0: float,
    gamma: float,
    dx: float,
    damping_ratio: float = 0.0,
    release: str = "total",
    rate_strengthening: float = 0.0,
) -> float:
    """Return the exact front speed with leaf springs, damping and drag -alpha du/dt.

    There is a least pre-stress, below which no front outruns the waves. (The shortest waves have
    the phase velocity sqrt(4 + gamma dx^2)/pi. Fronts behind which slip runs away do not count;
    slip may run away if friction weakens with slip velocity.) With strong damping and rule "total",
    two speeds belong to a pre-stress slightly above it. The higher one is returned, which grows
    with the pre-stress.
    Source: Wiener-Hopf factorisation of the lattice equation with leaf springs (`wiener_hopf`). It
    has a closed form without damping, and tends to `front_speed` as gamma dx^2 -> 0. Blocks that
    stick behind the front are neglected. The relative error is below 1e-6 next to tau_0 = 1 for
    gamma dx^2 (1 + beta/dx) up to 10.
    Raises ValueError: outside the ranges below, or if tau0 is not above the least pre-stress.

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
    gamma_dx2 = float(gamma) * float(dx) * float(dx)
    alpha_dx = float(rate_strengthening) * float(dx)
    if gamma_dx2 < MIN_GAMMA_DX2 and abs(alpha_dx) < MIN_ALPHA_DX:
        return float(front_speed(tau0, damping_ratio, release))
    front_law = FrontLaw(
        damping_ratios=np.array([float(damping_ratio)]),
        release=release,
        gamma_dx2=gamma_dx2,
        alpha_dx=alpha_dx,
    )
    speed = _speed_if_prestress_nearly_one(tau0, front_law)
    if speed is not None:
        return speed
    min_log_excess, least_prestress = _least_prestress(tau0, front_law)
    if tau0 <= least_prestress:
        rate = f", rate_strengthening = {rate_strengthening:g}" if alpha_dx else ""
        raise ValueError(
            f"tau0: {tau0!r}; allowed: > {least_prestress:.6g}, so that the front is faster than"
            f" the waves at gamma = {gamma:g}, dx = {dx:g}, damping_ratio = {damping_ratio:g}{rate}"
        )
    if damping_ratio == alpha_dx == 0.0:
        # The closed form sin(sqrt(g)/(2 tau v)) = sqrt(g (1 - tau^2))/(2 tau), g = gamma dx^2,
        # solved for v.
        sine = np.sqrt(gamma_dx2 * (1.0 - tau0**2)) / (2.0 * tau0)
        return float(np.sqrt(gamma_dx2) / (2.0 * tau0 * np.arcsin(sine)))
    return float(speeds_into(np.array([float(tau0)]), front_law, min_log_excess)[0])


def _speed_if_prestress_nearly_one(tau0: float, front_law: FrontLaw) -> float | None:
    """Return the front speed into pre-stress next to 1, to first order in the leaf springs.

    The result is None if tau0 is not so near to 1, or if leaf springs or drag are not small.
    """
    gamma_dx2, release = front_law.gamma_dx2, front_law.release
    damping_ratio = float(front_law.damping_ratios[0])
    is_near = 1.0 - tau0 < NEARLY_ONE_DISTANCE
    # Without damping the caller has a closed form.
    if not (is_near and damping_ratio > 0.0 and gamma_dx2 <= MAX_GAMMA_DX2):
        return None
    speed = front_speed(tau0, damping_ratio, release)
    has_weak_springs = gamma_dx2 * (1.0 + damping_ratio) < SMALL_CORRECTION * speed**2
    has_weak_drag = abs(front_law.alpha_dx) < SMALL_CORRECTION * speed
    if not (has_weak_springs and has_weak_drag):
        return None
    # The relative decrease of the speed is gamma dx^2/v^2 times (b v/6 + 1/24)/(b v + 1), where
    # b = beta/dx. Without damping this factor is 1/24, as the closed form gives. Under rule "total"
    # it agrees with the quadrature farther from tau_0 = 1, at small and at large b v. Under rule
    # "elastic" damping has no influence next to tau_0 = 1, and b v is set to 0.
    b_v = damping_ratio * speed if release == "total" else 0.0
    coefficient = b_v / 6.0 + 1.0 / 24.0
    relative_decrease = gamma_dx2 / speed**2 * coefficient / (b_v + 1.0)
    return speed * (1.0 - relative_decrease)


def continuum_front_speed(tau0: float, gamma: float, beta: float) -> float:
    """Return the front speed as dx -> 0 at fixed beta, under the printed release rule ("elastic").

    Source: v^2 = 1/{(1 - tau)[1 + gamma beta^2 (1 - tau)^2/tau^2]}, where tau is tau0. It follows
    by the method of Wiener and Hopf, as on the lattice (`wiener_hopf`).
    Raises ValueError: outside the ranges below, or where the front would not outrun the waves.

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
    # gamma beta^2 (1 - tau)^2/tau^2, by which leaf springs slow the front.
    slowing = (np.sqrt(float(gamma)) * beta * (1.0 - tau0) / tau0) ** 2
    # This condition is v > 1: the front must outrun the waves.
    if not slowing < tau0 / (1.0 - tau0):
        raise ValueError(
            f"tau0: {tau0!r}; allowed: a higher pre-stress, at which the front is faster than"
            f" the waves, for gamma = {gamma:g} and beta = {beta:g}"
        )
    return float(1.0 / np.sqrt((1.0 - tau0) * (1.0 + slowing)))


def _least_prestress(tau0: float, front_law: FrontLaw) -> tuple[float, float]:
    """Return ln(v - 1) of the front with the least pre-stress, and this pre-stress.

    Usually it is the slowest front. With strong damping a faster front can have less pre-stress.
    Such a front matters only if tau0 is not above the pre-stress of the slowest front. If tau0 is
    above it, the values of the slowest front are returned without a search.
    """
    if front_law.gamma_dx2 > MAX_GAMMA_DX2:
        # No front outruns the waves, as if the least pre-stress were 1. ln(v - 1) is not used then.
        return 0.0, 1.0
    # ln(v - 1) and the pre-stress of the slowest front.
    slowest = _slowest_log_excess(front_law)
    (log_tau,) = front_law.log_prestress(np.array([slowest]), front_law.damping_ratios)
    prestress_of_slowest = float(np.exp(log_tau))
    if tau0 > prestress_of_slowest:
        return slowest, prestress_of_slowest
    return _search_least_prestress(front_law, slowest)


def _slowest_log_excess(front_law: FrontLaw) -> float:
    """Return ln(v - 1) of the slowest front that outruns all waves and behind which slip is stable.

    More exactly, v is the lower limit of the speeds of such fronts. If this is the wave speed 1,
    the result is MIN_LOG_EXCESS in place of ln 0.
    """
    # The phase velocity of the shortest waves on the lattice.
    short_wave_speed = np.sqrt(4.0 + front_law.gamma_dx2) / np.pi
    slowest_speed = max(1.0, short_wave_speed)
    if front_law.alpha_dx < 0.0:
        # Far behind a steady front, the slip U obeys (v^2 - 1) U'' - alpha v U' + gamma U = tau_0.
        # If alpha^2 v^2 < 4 gamma (v^2 - 1), U oscillates, so that blocks stick. Otherwise slip
        # runs away. The two sides are equal at this inverse speed.
        runaway_slowness = np.sqrt(1.0 - 0.25 * front_law.alpha_dx**2 / front_law.gamma_dx2)
        slowest_speed = max(slowest_speed, SPEED_MARGIN / runaway_slowness)
    return float(np.log(slowest_speed - 1.0)) if slowest_speed > 1.0 else MIN_LOG_EXCESS


def _search_least_prestress(front_law: FrontLaw, slowest: float) -> tuple[float, float]:
    """Return ln(v - 1) of the front with the least pre-stress, and this pre-stress.

    slowest is ln(v - 1) of the slowest front. The pre-stress is computed on a grid of speeds. The
    grid is then repeatedly narrowed to the neighbours of the speed with the least pre-stress.
    """
    (damping_ratio,) = front_law.damping_ratios
    slowest_speed = 1.0 + np.exp(slowest)
    # The first grid extends far beyond the speeds that damping and leaf springs influence.
    scale_of_speeds = slowest_speed * (1.0 + damping_ratio) * (1.0 + front_law.gamma_dx2)
    largest_increase = np.exp(5.0) * scale_of_speeds
    speed_increase = np.geomspace(1e-6, largest_increase, SCAN_SPEEDS - 1)
    log_excess = np.append(slowest, np.log(slowest_speed - 1.0 + speed_increase))
    for _ in range(NARROW_SCANS + 1):
        log_tau = front_law.log_prestress(log_excess, np.full(log_excess.size, damping_ratio))
        lowest = int(np.argmin(log_tau))
        log_excess_of_lowest = float(log_excess[lowest])
        least_prestress = float(np.exp(log_tau[lowest]))
        if log_excess_of_lowest == slowest:
            # No faster front has less pre-stress.
            break
        below = log_excess[max(lowest - 1, 0)]
        above = log_excess[min(lowest + 1, log_excess.size - 1)]
        log_excess = np.linspace(below, above, NARROW_SCAN_SPEEDS)
    return log_excess_of_lowest, least_prestress
