"""Front speeds: on the damped lattice, with and without leaf springs, and in the continuum.

All but the closed forms come from the Wiener-Hopf factor M_+ of `wiener_hopf`: the released stress
is 1 when M_+(0) = tau_0 (release "total": the stress includes the damping force) or
M_+(0)/M_+(i/(b v)) = tau_0 ("elastic"). The slipping part is taken to be infinitely long: sticking
is felt at the front only where the pulse is hardly wider than the layer of damped or lattice waves
at its tip, which is a few blocks unless b is large.
"""

from typing import NamedTuple

import numpy as np

from ..model.checks import as_numbers, check_choice, check_number
from ..model.release import RELEASES
from ..model.runaway import check_runaway
from .domains import DOMAINS, broadcast_numbers, check_domains
from .vector_roots import increasing_roots
from .wiener_hopf import log_prestress

LARGEST_RATIO = DOMAINS["damping_ratio"]["at_most"]
# So near 1, in 1 - tau_0, rounding of the quadrature is felt and the first terms in 1/v are better.
NEARLY_ONE = {"total": 1e-10, "elastic": 1e-13}
# With leaf springs, where no reference takes the rounding out of 1 - M_+(0), it is felt from here.
NEARLY_ONE_WITH_SPRINGS = 1e-7
# Leaf springs, gamma dx^2, and drag, alpha dx, below these make no difference; above the largest
# leaf springs no front outruns the waves.
LEAST_SPRINGS, LARGEST_SPRINGS, LEAST_DRAG = 1e-30, 1e30, 1e-15
# Values of ln(v - 1) where v is 1 to all digits, and beyond any speed in the domain.
SLOWEST, FASTEST = -80.0, 280.0
# A front is at least this much, relative, above the speed at which slip runs away.
SLOWEST_MARGIN = 1e-6
# This number of elements is solved at once, which bounds the memory.
CHUNK = 128
# The least pre-stress is searched at SCAN speeds, then NARROWINGS times at NARROWER_SCAN more
# around the lowest.
SCAN, NARROWER_SCAN, NARROWINGS = 64, 17, 6


class Lattice(NamedTuple):
    """A lattice: damping ratios of its fronts, leaf springs gamma dx^2, drag alpha dx."""

    ratio: np.ndarray
    release: str
    springs: float = 0.0
    drag: float = 0.0

    def log_prestress(self, x: np.ndarray, ratio: np.ndarray) -> np.ndarray:
        """ln tau_0 of fronts at x = ln(v - 1)."""
        return log_prestress(np.exp(x), ratio, self.springs, self.release, self.drag)


def front_speed_undamped(tau0: float | np.ndarray) -> float | np.ndarray:
    """Front speed (wave speeds) without damping, 1/sqrt(1 - tau_0^2).

    Source: section III A of the paper. Raises ValueError: outside the domain.

    Parameters
    ----------
    tau0 : float or array in [0, 1), pre-stress ahead of the front

    Returns
    -------
    float or array : front speed (wave speeds)

    Examples
    --------
    >>> round(float(front_speed_undamped(0.6)), 6)
    1.25
    """
    return 1.0 / np.sqrt(1.0 - as_numbers("tau0", tau0, at_least=0.0, below=1.0) ** 2)


def front_speed(tau0, damping_ratio, release: str = "total"):
    """Exact speed (wave speeds) of a steady front, leaf springs left out (gamma dx^2 << 1).

    Source: Wiener-Hopf factorisation of the lattice equation (`wiener_hopf`); at damping_ratio = 0
    the paper's 1/sqrt(1 - tau_0^2) for any dx. Its relative error is below 1e-12 in tau_0.
    Raises ValueError: outside the domain.

    Parameters
    ----------
    tau0, damping_ratio : floats or arrays, broadcast: pre-stress ahead, in (0, 1), and beta/dx,
        from 0 to 1e100
    release : "total" or "elastic", whether the stress that is compared with the threshold includes
        the damping force

    Returns
    -------
    float or array : front speed (wave speeds)

    Examples
    --------
    >>> round(front_speed(0.6, 1.0), 6)
    2.5
    """
    check_choice("release", release, RELEASES)
    tau, ratio = broadcast_numbers(tau0=tau0, damping_ratio=damping_ratio)
    out = np.array(front_speed_undamped(tau))
    damped = ratio > 0.0
    near = damped & (1.0 - tau < NEARLY_ONE[release]) & ((release == "total") | (ratio < 1e3))
    out[near] = 1.0 / slowness_nearly_one(tau[near], ratio[near], release)
    rest = damped & ~near
    if np.any(rest):
        tau, ratio = tau[rest], ratio[rest]
        # Neighbours in the order of the speed share a contour.
        order = np.argsort(first_guess(tau, ratio, release))
        speed = np.empty(tau.size)
        for part in np.split(order, range(CHUNK, order.size, CHUNK)):
            speed[part] = _speed(tau[part], Lattice(ratio[part], release))
        out[rest] = speed
    return out if out.ndim else float(out)


def prestress_for_speed(speed, damping_ratio, release: str = "total"):
    """Pre-stress into which a steady front runs at a speed: the inverse of `front_speed`.

    Raises ValueError: outside the domain.

    Parameters
    ----------
    speed, damping_ratio : floats or arrays, broadcast: wave speeds, from 1 to 1e100, and beta/dx
    release : "total" or "elastic", as in `front_speed`

    Returns
    -------
    float or array : pre-stress tau_0

    Examples
    --------
    >>> round(prestress_for_speed(2.5, 1.0), 6)
    0.6
    """
    check_choice("release", release, RELEASES)
    speeds, ratio = broadcast_numbers(speed=speed, damping_ratio=damping_ratio)
    excess = speeds - 1.0
    out = np.array(np.sqrt(excess * (1.0 + speeds)) / speeds)
    damped = ratio > 0.0
    if np.any(damped):
        out[damped] = np.exp(log_prestress_in_chunks(excess[damped], ratio[damped], release))
    return out if out.ndim else float(out)


def lattice_front_speed(
    tau0: float,
    gamma: float,
    dx: float,
    damping_ratio: float = 0.0,
    release: str = "total",
    rate_strengthening: float = 0.0,
) -> float:
    """Exact front speed (wave speeds) with leaf springs, damping and drag -alpha du/dt.

    Where the least pre-stress of all fronts lies at a speed above 1 (rule "total", strong damping),
    two speeds belong to one tau_0: the faster one is returned, which grows with tau_0.
    Source: the lattice symbol with leaf springs (`wiener_hopf`), which has a closed form without
    damping and tends to `front_speed` as gamma dx^2 -> 0. Sticking behind the front is left out.
    The relative error is below 1e-6 next to tau_0 = 1 for gamma dx^2 (1 + beta/dx) up to 10.
    Raises ValueError: outside these ranges, or where tau_0 is not above the least pre-stress of any
    front faster than the waves and than sqrt(4 + gamma dx^2)/pi (where friction weakens with slip
    velocity, so fast that slip behind it does not run away).

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
    if springs < LEAST_SPRINGS and abs(drag) < LEAST_DRAG:
        return float(front_speed(tau0, damping_ratio, release))
    lattice = Lattice(np.array([float(damping_ratio)]), release, springs, drag)
    nearly_one = 1.0 - tau0 < NEARLY_ONE_WITH_SPRINGS
    if nearly_one and damping_ratio > 0.0 and springs <= LARGEST_SPRINGS:
        speed = front_speed(tau0, damping_ratio, release)
        if springs * (1.0 + damping_ratio) < 1e-5 * speed**2 and abs(drag) < 1e-5 * speed:
            # The factor of g/v^2 is 1/24 without damping and, by quadrature, 1/6 for b v >> 1.
            strength = damping_ratio * speed if release == "total" else 0.0
            slowed = springs / speed**2 * (strength / 6.0 + 1.0 / 24.0) / (strength + 1.0)
            return speed * (1.0 - slowed)
    slowest, least = _least_prestress(tau0, lattice)
    if tau0 <= least:
        rate = f", rate_strengthening = {rate_strengthening:g}" if drag else ""
        raise ValueError(
            f"tau0: {tau0!r}; allowed: > {least:.6g}, values whose front outruns the waves at"
            f" gamma = {gamma:g}, dx = {dx:g}, damping_ratio = {damping_ratio:g}{rate}"
        )
    if damping_ratio == drag == 0.0:
        argument = np.sqrt(springs * (1.0 - tau0**2)) / (2.0 * tau0)
        return float(np.sqrt(springs) / (2.0 * tau0 * np.arcsin(argument)))
    return float(_speed(np.array([float(tau0)]), lattice, slowest)[0])


def continuum_front_speed(tau0: float, gamma: float, beta: float) -> float:
    """Front speed (wave speeds) as dx -> 0 at fixed beta, under the rule as printed ("elastic").

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
    # This is v > 1.
    if not springs < tau0 / (1.0 - tau0):
        raise ValueError(
            f"tau0: {tau0!r}; allowed: values whose front outruns the waves at gamma = {gamma:g},"
            f" beta = {beta:g}"
        )
    return float(1.0 / np.sqrt((1.0 - tau0) * (1.0 + springs)))


def _least_prestress(tau0: float, lattice: Lattice) -> tuple[float, float]:
    """ln(v - 1) of a front, and the least pre-stress of fronts, which that front has."""
    springs, ratio = lattice.springs, lattice.ratio
    if springs > LARGEST_SPRINGS:
        return 0.0, 1.0
    slow = max(1.0, np.sqrt(4.0 + springs) / np.pi)
    if lattice.drag < 0.0:
        # Behind a slower front slip runs away.
        margin = 1.0 + SLOWEST_MARGIN
        slow = max(slow, margin / np.sqrt(1.0 - 0.25 * lattice.drag**2 / springs))
    first = float(np.log(slow - 1.0)) if slow > 1.0 else SLOWEST
    least = float(np.exp(lattice.log_prestress(np.array([first]), ratio)[0]))
    # The slowest front mostly has the least pre-stress; above it there is one speed.
    if tau0 > least:
        return first, least
    slowest = 1.0 + np.exp(first)
    last = np.log(slowest * (1.0 + ratio[0]) * (1.0 + springs)) + 5.0
    inner = np.log(slowest - 1.0 + np.geomspace(1e-6, np.exp(last), SCAN - 1))
    x = np.concatenate([[first], inner])
    for _ in range(NARROWINGS + 1):
        log_tau = lattice.log_prestress(x, np.full(x.size, ratio[0]))
        lowest = int(np.argmin(log_tau))
        slow, least = float(x[lowest]), float(np.exp(log_tau[lowest]))
        if slow == first:
            break
        x = np.linspace(x[max(lowest - 1, 0)], x[min(lowest + 1, x.size - 1)], NARROWER_SCAN)
    return slow, least


def slowness_nearly_one(tau: np.ndarray, ratio: np.ndarray | float, release: str) -> np.ndarray:
    """1/v of fronts with v >> b, up to terms in 1/v^3.

    -ln tau = b/v + 1/(2 v^2) under rule "total", and 1/(2 v^2) under rule "elastic".
    """
    fall = -np.log(tau)
    damping = np.asarray(ratio) if release == "total" else 0.0
    return 2.0 * fall / np.maximum(damping + np.sqrt(damping**2 + 2.0 * fall), 1e-300)


def log_prestress_in_chunks(excess: np.ndarray, ratio: np.ndarray, release: str) -> np.ndarray:
    """`log_prestress` without leaf springs, in bounded memory."""
    parts = (slice(i, i + CHUNK) for i in range(0, excess.size, CHUNK))
    values = [log_prestress(excess[part], ratio[part], 0.0, release) for part in parts]
    return np.concatenate(values)


def first_guess(tau: np.ndarray, ratio: np.ndarray, release: str) -> np.ndarray:
    """ln(v - 1) from the limits of no and of strong damping, and from b = 1 ("total")."""
    rest = 1.0 - tau
    undamped = np.log(tau) * 2.0 - np.log(rest * (1.0 + tau) + np.sqrt(rest * (1.0 + tau)))
    if release == "elastic":
        damped = np.log(tau) - np.log(rest + np.sqrt(rest))
        return np.where(ratio < 0.2, undamped + 0.5 * ratio, damped - 1.0 / (1.0 + 2.0 * ratio))
    weight = np.minimum(ratio, 1.0)
    damped = np.log(tau / rest) + np.log(np.maximum(ratio, 1.0))
    return (1.0 - weight) * undamped + weight * damped


def _speed(tau: np.ndarray, lattice: Lattice, slowest: float = SLOWEST) -> np.ndarray:
    """Speeds v at which the pre-stress is tau, with ln(v - 1) from the slowest on."""
    target = np.log(tau) - np.log1p(-tau)

    def mismatch(x: np.ndarray, which: np.ndarray) -> np.ndarray:
        """Difference in ln(tau/(1 - tau)), which is nearly linear in ln(v - 1)."""
        log_tau = lattice.log_prestress(x, lattice.ratio[which])
        # Where the stress is 1 to rounding, the front is faster than any target.
        return log_tau - np.log(np.maximum(-np.expm1(log_tau), 1e-17)) - target[which]

    low, high = np.full(tau.size, slowest), np.full(tau.size, FASTEST)
    guess = np.clip(first_guess(tau, lattice.ratio, lattice.release), low + 0.1, high - 1.0)
    return 1.0 + np.exp(increasing_roots(mismatch, guess, low, high))
