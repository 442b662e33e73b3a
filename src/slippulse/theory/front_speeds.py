"""Front speeds: on the damped lattice, with and without leaf springs, and in the continuum at fixed damping.

All but the closed forms come from the Wiener-Hopf factor M_+ of `wiener_hopf`: the released stress is 1 when
M_+(0) = tau_0 (release "total": the stress includes the damping force) or M_+(0)/M_+(i/(b v)) = tau_0 ("elastic").
The slipping part is taken to reach far behind the front: sticking is felt at the front only where the pulse is hardly
wider than the layer of damped or lattice waves at its tip, a few blocks unless b is large.
"""

import numpy as np

from ..model.checks import check_choice, check_number, check_runaway
from ..model.roots import increasing_roots
from ..model.scene import RELEASES
from .domains import DOMAINS, broadcast_numbers, check_domains
from .pulse import SteadyPulse, front_speed_undamped, pulse_behind_front
from .wiener_hopf import log_prestress

LARGEST_RATIO = DOMAINS["damping_ratio"]["at_most"]
# So near 1, in 1 - tau_0, rounding of the quadrature is felt and the first terms in 1/v are better.
NEARLY_ONE = {"total": 1e-10, "elastic": 1e-13}
# With leaf springs, where no reference takes the rounding out of 1 - M_+(0), it is felt from here on.
NEARLY_ONE_WITH_SPRINGS = 1e-7
# ln(v - 1) where v is 1 to all digits, and beyond any speed in the domain.
SLOWEST, FASTEST = -80.0, 280.0
# How far, relative, above the speed at which slip runs away a front is.
SLOWEST_MARGIN = 1e-6
# Elements solved at once: bounds memory.
CHUNK = 128
# Where the pre-stress is looked at for its least, and how often the range is narrowed.
SCAN, NARROWINGS = 64, 6


def front_speed(tau0, damping_ratio, release: str = "total"):
    """Exact speed (wave speeds) of a steady front into pre-stress tau_0, leaf springs left out (gamma dx^2 << 1).

    Parameters
    ----------
    tau0, damping_ratio : floats or arrays, broadcast: pre-stress ahead, in (0, 1), and beta/dx, from 0 to 1e100
    release : "total" or "elastic", whether the stress that is compared with the threshold includes the damping force

    Raises ValueError: outside the domain.
    Source: Wiener-Hopf factorisation of the lattice equation (`wiener_hopf`); at damping_ratio = 0 the paper's
    1/sqrt(1 - tau_0^2) for any dx. Relative error below 1e-12 in tau_0.
    """
    check_choice("release", release, RELEASES)
    tau, ratio = broadcast_numbers(tau0=tau0, damping_ratio=damping_ratio)
    out = np.array(front_speed_undamped(tau))
    damped = ratio > 0.0
    near = damped & (1.0 - tau < NEARLY_ONE[release]) & ((release == "total") | (ratio < 1e3))
    out[near] = 1.0 / slowest(tau[near], ratio[near], release)
    rest = damped & ~near
    if np.any(rest):
        tau, ratio = tau[rest], ratio[rest]
        # Neighbours in the order of the speed share a contour.
        order = np.argsort(first_guess(tau, ratio, release))
        found = np.empty(tau.size)
        for part in np.split(order, range(CHUNK, order.size, CHUNK)):
            found[part] = 1.0 + np.exp(root(tau[part], ratio[part], 0.0, release))
        out[rest] = found
    return out if out.ndim else float(out)


def prestress_for_speed(speed, damping_ratio, release: str = "total"):
    """Pre-stress into which a steady front runs at ``speed``: the inverse of `front_speed`.

    Raises ValueError: for a speed (wave speeds) outside 1 to 1e100, or as `front_speed`.
    """
    check_choice("release", release, RELEASES)
    speeds, ratio = broadcast_numbers(speed=speed, damping_ratio=damping_ratio)
    excess = speeds - 1.0
    out = np.array(np.sqrt(excess * (1.0 + speeds)) / speeds)
    damped = ratio > 0.0
    if np.any(damped):
        out[damped] = np.exp(in_chunks(excess[damped], ratio[damped], release))
    return out if out.ndim else float(out)


def lattice_front_speed(
    tau0: float, gamma: float, dx: float, damping_ratio: float = 0.0, release: str = "total",
    rate_strengthening: float = 0.0,
) -> float:  # fmt: skip
    """Exact front speed at finite spacing with leaf springs, damping and friction that depends on slip rate.

    Parameters
    ----------
    tau0, gamma, dx : pre-stress, in (0, 1), elasticity ratio, > 0, and block spacing (units of H), > 0
    damping_ratio, release : beta/dx, from 0 to 1e100; "total" or "elastic"
    rate_strengthening : alpha, of a term -alpha du/dt; as dx -> 0 it no longer matters

    Raises ValueError: outside these ranges, or where tau_0 is not above the least pre-stress of any front faster than
    the waves (and than sqrt(4 + gamma dx^2)/pi; where friction weakens with slip rate, so fast that slip behind it
    does not run away). Where that least lies at a speed above 1 (rule "total", strong damping), two speeds belong to
    one tau_0: the faster is returned, which grows with tau_0.
    Source: the lattice symbol with leaf springs (`wiener_hopf`); without damping it has a closed form, and as gamma
    dx^2 -> 0 it tends to `front_speed`. Sticking behind the front is left out (module docstring). Relative error
    below 1e-6 next to tau_0 = 1 for gamma dx^2 (1 + beta/dx) up to 10.
    """
    check_domains(tau0=tau0, gamma=gamma, dx=dx, damping_ratio=damping_ratio)
    check_choice("release", release, RELEASES)
    check_number("rate_strengthening", rate_strengthening)
    check_runaway(float(gamma), float(rate_strengthening))
    springs, drag = float(gamma) * float(dx) * float(dx), float(rate_strengthening) * float(dx)
    # Outside these there is no difference to no springs, or no front for any tau_0 below 1.
    if springs < 1e-30 and abs(drag) < 1e-15:
        return float(front_speed(tau0, damping_ratio, release))
    if springs <= 1e30 and 1.0 - tau0 < NEARLY_ONE_WITH_SPRINGS and damping_ratio > 0.0:
        speed = front_speed(tau0, damping_ratio, release)
        if springs * (1.0 + damping_ratio) < 1e-5 * speed**2 and abs(drag) < 1e-5 * speed:
            # To first order in g/v^2, whose factor is 1/24 without damping and 1/6, by quadrature, for b v >> 1.
            strength = damping_ratio * speed if release == "total" else 0.0
            return speed * (
                1.0 - springs / speed**2 * (strength / 6.0 + 1.0 / 24.0) / (strength + 1.0)
            )
    ratio = np.array([float(damping_ratio)])
    low, least = 0.0, 1.0
    if springs <= 1e30:
        # Mostly the slowest front is that of the least pre-stress; and above that of the slowest there is one speed.
        slow = max(1.0, np.sqrt(4.0 + springs) / np.pi)
        if drag < 0.0:
            # Behind a slower one slip runs away.
            slow = max(slow, (1.0 + SLOWEST_MARGIN) / np.sqrt(1.0 - 0.25 * drag**2 / springs))
        low = float(np.log(slow - 1.0)) if slow > 1.0 else SLOWEST
        least = float(np.exp(log_prestress(np.exp([low]), ratio, springs, release, drag)[0]))
        if tau0 <= least:
            low, least = _least_prestress(low, ratio[0], springs, release, drag)
    if tau0 <= least:
        rate = f", rate_strengthening = {rate_strengthening:g}" if drag else ""
        raise ValueError(
            f"tau0: {tau0!r}; allowed: > {least:.6g}, values whose front outruns the waves at gamma = {gamma:g},"
            f" dx = {dx:g}, damping_ratio = {damping_ratio:g}{rate}"
        )
    if damping_ratio == drag == 0.0:
        argument = np.sqrt(springs * (1.0 - tau0**2)) / (2.0 * tau0)
        return float(np.sqrt(springs) / (2.0 * tau0 * np.arcsin(argument)))
    return float(1.0 + np.exp(root(np.array([float(tau0)]), ratio, springs, release, low, drag)[0]))


def continuum_front_speed(tau0: float, gamma: float, beta: float) -> float:
    """Front speed as dx -> 0 at fixed beta > 0, under the rule as printed ("elastic"), for 0 < tau0 < 1 and gamma >= 0.

    Raises ValueError: outside these ranges, or where the front would not outrun the waves.
    Source: v^2 = 1/{(1 - tau)[1 + gamma beta^2 (1 - tau)^2/tau^2]}. The symbol has one zero -i Y below the real axis,
    beta v Y^3 = (v^2 - 1) Y^2 + gamma, and the rule reads Y/(Y + 1/(beta v)) = tau.
    """
    check_domains(tau0=tau0)
    check_number("gamma", gamma, at_least=0.0)
    check_number("beta", beta, above=0.0)
    springs = (np.sqrt(float(gamma)) * beta * (1.0 - tau0) / tau0) ** 2
    # v > 1.
    if not springs < tau0 / (1.0 - tau0):
        raise ValueError(
            f"tau0: {tau0!r}; allowed: values whose front outruns the waves at gamma = {gamma:g}, beta = {beta:g}"
        )
    return float(1.0 / np.sqrt((1.0 - tau0) * (1.0 + springs)))


def steady_pulse(
    tau0: float, gamma: float, beta: float = 0.0, speed: float | None = None, *, damping_ratio: float | None = None,
    release: str = "total", rate_strengthening: float = 0.0,
) -> SteadyPulse:  # fmt: skip
    """Steady pulse in uniform pre-stress behind a front whose speed is given, or follows from the damping ratio.

    Parameters and source of `pulse_behind_front`; damping_ratio, release of `front_speed`, where speed is left out.

    Raises ValueError: outside the domain.
    """
    if (damping_ratio is None) == (speed is None):
        raise ValueError(f"speed, damping_ratio: {speed}, {damping_ratio}; allowed: one of the two")
    if speed is None:
        speed = float(front_speed(tau0, damping_ratio, release))
    return pulse_behind_front(tau0, gamma, beta, speed, rate_strengthening)


def _least_prestress(
    first: float, ratio: float, springs: float, release: str, drag: float
) -> tuple[float, float]:
    """ln(v - 1) and tau_0 where the pre-stress of fronts from the slowest on is least: there, or at a fold."""
    slowest = 1.0 + np.exp(first)
    last = np.log(slowest * (1.0 + ratio) * (1.0 + springs)) + 5.0
    inner = np.log(slowest - 1.0 + np.geomspace(1e-6, np.exp(last), SCAN - 1))
    x = np.concatenate([[first], inner])
    for _ in range(NARROWINGS + 1):
        levels = log_prestress(np.exp(x), np.full(x.size, ratio), springs, release, drag)
        at = int(np.argmin(levels))
        if x[at] == first:
            break
        found = float(x[at]), float(np.exp(levels[at]))
        x = np.linspace(x[max(at - 1, 0)], x[min(at + 1, x.size - 1)], SCAN // 4 + 1)
    else:
        return found
    return first, float(np.exp(levels[at]))


def slowest(tau: np.ndarray, ratio: np.ndarray | float, release: str) -> np.ndarray:
    """1/v of fronts with v >> b: -ln tau = b/v + 1/(2 v^2) ("total") or 1/(2 v^2) ("elastic"), up to 1/v^3."""
    level = -np.log(tau)
    damping = np.asarray(ratio) if release == "total" else 0.0
    return 2.0 * level / np.maximum(damping + np.sqrt(damping**2 + 2.0 * level), 1e-300)


def in_chunks(excess: np.ndarray, ratio: np.ndarray, release: str) -> np.ndarray:
    """`log_prestress` without leaf springs, in as much memory."""
    parts = (slice(i, i + CHUNK) for i in range(0, excess.size, CHUNK))
    return np.concatenate(
        [log_prestress(excess[part], ratio[part], 0.0, release) for part in parts]
    )


def first_guess(tau: np.ndarray, ratio: np.ndarray, release: str) -> np.ndarray:
    """ln(v - 1) from the limits b = 0, and b = 1 ("total") or b -> infinity ("elastic"), and from strong damping."""
    rest = 1.0 - tau
    undamped = np.log(tau) * 2.0 - np.log(rest * (1.0 + tau) + np.sqrt(rest * (1.0 + tau)))
    if release == "elastic":
        damped = np.log(tau) - np.log(rest + np.sqrt(rest))
        return np.where(ratio < 0.2, undamped + 0.5 * ratio, damped - 1.0 / (1.0 + 2.0 * ratio))
    weight = np.minimum(ratio, 1.0)
    return (1.0 - weight) * undamped + weight * (
        np.log(tau / rest) + np.log(np.maximum(ratio, 1.0))
    )


def root(
    tau: np.ndarray,
    ratio: np.ndarray,
    springs: float,
    release: str,
    slowest: float = SLOWEST,
    drag: float = 0.0,
) -> np.ndarray:
    """ln(v - 1), from the slowest on, where the pre-stress is tau, with ln(tau/(1 - tau)) compared.

    That is monotone and nearly linear in ln(v - 1).
    """
    target = np.log(tau) - np.log1p(-tau)

    def mismatch(x: np.ndarray, which: np.ndarray) -> np.ndarray:
        level = log_prestress(np.exp(x), ratio[which], springs, release, drag)
        # Beyond the floating range below 1 the stress is faster than any target.
        return level - np.log(np.maximum(-np.expm1(level), 1e-17)) - target[which]

    low, high = np.full(tau.size, slowest), np.full(tau.size, FASTEST)
    guess = np.clip(first_guess(tau, ratio, release), low + 0.1, high - 1.0)
    return increasing_roots(mismatch, guess, low, high)
