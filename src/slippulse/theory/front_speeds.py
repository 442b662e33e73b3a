"""Front speeds on the damped lattice, without leaf springs.

The speeds follow from a relation between front speed and pre-stress (`wiener_hopf`). This relation
assumes that the sliding part behind the front is infinitely long. A pulse is finite, but this
changes its front speed only if it is hardly wider than a layer of damped waves and lattice waves at
the front. This layer is a few blocks wide, unless the damping ratio is large.
"""

from typing import NamedTuple

import numpy as np

from ..model.checks import as_numbers, check_choice
from ..model.release import RELEASES
from .domains import DOMAINS, broadcast_numbers
from .vector_roots import increasing_roots
from .wiener_hopf import log_prestress

LARGEST_RATIO = DOMAINS["damping_ratio"]["at_most"]
# If 1 - tau_0 is below this, rounding affects the quadrature. The first terms of an expansion in
# 1/v are then more accurate.
NEARLY_ONE_DISTANCE = {"total": 1e-10, "elastic": 1e-13}
# The smallest ln(v - 1), for which v is 1 to all digits, and the largest one, which is beyond any
# speed in the domain.
MIN_LOG_EXCESS, MAX_LOG_EXCESS = -80.0, 280.0
# Number of fronts that are solved at once, which limits the memory.
FRONTS_PER_CHUNK = 128


class FrontLaw(NamedTuple):
    """The relation between pre-stress and speed of fronts on a lattice.

    There is one damping ratio beta/dx for each front. gamma_dx2 is gamma dx^2 (leaf springs), and
    alpha_dx is alpha dx (drag).
    """

    damping_ratios: np.ndarray
    release: str
    gamma_dx2: float = 0.0
    alpha_dx: float = 0.0

    def log_prestress(self, log_excess: np.ndarray, damping_ratio: np.ndarray) -> np.ndarray:
        """Return ln tau_0 of fronts of speed v, given log_excess = ln(v - 1) and beta/dx."""
        return log_prestress(
            np.exp(log_excess), damping_ratio, self.gamma_dx2, self.release, self.alpha_dx
        )


def front_speed_undamped(tau0: float | np.ndarray) -> float | np.ndarray:
    """Return the front speed (wave speeds) without damping, 1/sqrt(1 - tau_0^2).

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
    """Return the exact speed of a steady front without leaf springs (gamma dx^2 << 1).

    Without damping it is the paper's 1/sqrt(1 - tau_0^2), for any dx.
    Source: Wiener-Hopf factorisation of the lattice equation (`wiener_hopf`). The pre-stress that
    belongs to the returned speed differs from tau0 by a relative error below 1e-12.
    Raises ValueError: outside the domain.

    Parameters
    ----------
    tau0, damping_ratio : floats or arrays, broadcast: pre-stress ahead, in (0, 1), and beta/dx,
        from 0 to 1e100
    release : "total" or "elastic". A block is released when the stress on it reaches 1; "total"
        means that this stress includes the damping force

    Returns
    -------
    float or array : front speed (wave speeds)

    Examples
    --------
    >>> round(front_speed(0.6, 1.0), 6)
    2.5
    """
    check_choice("release", release, RELEASES)
    tau, damping_ratio = broadcast_numbers(tau0=tau0, damping_ratio=damping_ratio)
    speeds = np.array(front_speed_undamped(tau))
    is_damped = damping_ratio > 0.0
    # Next to tau_0 = 1 fronts are so fast that an expansion of ln tau_0 in 1/v gives the speed v.
    # Under rule "elastic" this holds only if v is much larger than the damping ratio. Next to
    # tau_0 = 1, v = 1/sqrt(2 (1 - tau_0)) is above 2e6, so that a ratio below 1e3 is small.
    may_be_expanded = (release == "total") | (damping_ratio < 1e3)
    is_expanded = is_damped & (1.0 - tau < NEARLY_ONE_DISTANCE[release]) & may_be_expanded
    speeds[is_expanded] = 1.0 / slowness_nearly_one(
        tau[is_expanded], damping_ratio[is_expanded], release
    )
    is_solved = is_damped & ~is_expanded
    if np.any(is_solved):
        speeds[is_solved] = _solved_speeds(tau[is_solved], damping_ratio[is_solved], release)
    return speeds if speeds.ndim else float(speeds)


def _solved_speeds(tau: np.ndarray, damping_ratio: np.ndarray, release: str) -> np.ndarray:
    """Return the speeds of fronts into pre-stresses tau, by numerical solution, chunk by chunk."""
    # Fronts of similar speeds are in one chunk, because they share a contour of integration.
    order = np.argsort(first_guess(tau, damping_ratio, release))
    speeds = np.empty(tau.size)
    for chunk in np.split(order, range(FRONTS_PER_CHUNK, order.size, FRONTS_PER_CHUNK)):
        speeds[chunk] = speeds_into(tau[chunk], FrontLaw(damping_ratio[chunk], release))
    return speeds


def prestress_for_speed(speed, damping_ratio, release: str = "total"):
    """Return the pre-stress of a steady front of given speed, the inverse of `front_speed`.

    Raises ValueError: outside the domain.

    Parameters
    ----------
    speed, damping_ratio : floats or arrays, broadcast: front speed (wave speeds), from 1 to 1e100,
        and beta/dx
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
    speeds, damping_ratio = broadcast_numbers(speed=speed, damping_ratio=damping_ratio)
    excess_speed = speeds - 1.0
    # Without damping the pre-stress is sqrt(v^2 - 1)/v.
    prestress = np.array(np.sqrt(excess_speed * (1.0 + speeds)) / speeds)
    is_damped = damping_ratio > 0.0
    if np.any(is_damped):
        log_tau = log_prestress_in_chunks(
            excess_speed[is_damped], damping_ratio[is_damped], release
        )
        prestress[is_damped] = np.exp(log_tau)
    return prestress if prestress.ndim else float(prestress)


def slowness_nearly_one(
    tau: np.ndarray, damping_ratio: np.ndarray | float, release: str
) -> np.ndarray:
    """Return 1/v of fronts into pre-stress tau next to 1, which are very fast.

    With b = beta/dx, 1/v solves -ln tau = b/v + 1/(2 v^2) under rule "total", and
    -ln tau = 1/(2 v^2) under rule "elastic". Terms in 1/v^3 are neglected.
    """
    minus_log_tau = -np.log(tau)
    b = np.asarray(damping_ratio) if release == "total" else 0.0
    # This form of the root of a quadratic equation loses no digits. 1e-300 avoids 0/0 at tau = 1.
    return 2.0 * minus_log_tau / np.maximum(b + np.sqrt(b**2 + 2.0 * minus_log_tau), 1e-300)


def log_prestress_in_chunks(
    excess_speed: np.ndarray, damping_ratio: np.ndarray, release: str
) -> np.ndarray:
    """Return `log_prestress` of many fronts without leaf springs, in chunks to limit the memory."""
    values = []
    for start in range(0, excess_speed.size, FRONTS_PER_CHUNK):
        chunk = slice(start, start + FRONTS_PER_CHUNK)
        values.append(log_prestress(excess_speed[chunk], damping_ratio[chunk], release=release))
    return np.concatenate(values)


def first_guess(tau: np.ndarray, damping_ratio: np.ndarray, release: str) -> np.ndarray:
    """Return an estimate of ln(v - 1), with which the search for the front speed v starts.

    Without damping and with strong damping, the speed has a simple formula. In between, the
    estimate is interpolated under rule "total". Under rule "elastic", it is one of these formulas
    with a fitted correction, depending on the damping ratio.
    """
    b, distance_to_1 = damping_ratio, 1.0 - tau
    # Without damping v = 1/sqrt(1 - tau^2), so that v - 1 = tau^2/(1 - tau^2 + sqrt(1 - tau^2)).
    one_minus_square = distance_to_1 * (1.0 + tau)
    undamped = np.log(tau) * 2.0 - np.log(one_minus_square + np.sqrt(one_minus_square))
    if release == "elastic":
        # With strong damping v = 1/sqrt(1 - tau). The terms with b are fitted corrections.
        strongly_damped = np.log(tau) - np.log(distance_to_1 + np.sqrt(distance_to_1))
        with_weak_damping = undamped + 0.5 * b
        with_strong_damping = strongly_damped - 1.0 / (1.0 + 2.0 * b)
        return np.where(b < 0.2, with_weak_damping, with_strong_damping)
    # Under rule "total", v - 1 = tau/(1 - tau) at b = 1. Beyond, it grows in proportion to b.
    damped = np.log(tau / distance_to_1) + np.log(np.maximum(b, 1.0))
    weight = np.minimum(b, 1.0)
    return (1.0 - weight) * undamped + weight * damped


def speeds_into(
    tau: np.ndarray, front_law: FrontLaw, min_log_excess: float = MIN_LOG_EXCESS
) -> np.ndarray:
    """Return the speeds v of fronts into the pre-stresses tau.

    The unknown is ln(v - 1), which is at least min_log_excess. It is found from the value of
    ln(tau/(1 - tau)), which is nearly linear in the unknown.
    """
    required_values = np.log(tau) - np.log1p(-tau)

    def excess_over_required(log_excess: np.ndarray, fronts: np.ndarray) -> np.ndarray:
        """Return ln(tau/(1 - tau)) at ln(v - 1) = log_excess, minus the required value.

        The search calls this function with only those fronts whose speed is not found yet.

        fronts : indices of these fronts, one for each element of log_excess
        """
        log_tau = front_law.log_prestress(log_excess, front_law.damping_ratios[fronts])
        # 1 - tau may be rounded to 0. It is then replaced by a number that is smaller than any
        # required 1 - tau.
        log_one_minus_tau = np.log(np.maximum(-np.expm1(log_tau), 1e-17))
        return log_tau - log_one_minus_tau - required_values[fronts]

    low, high = np.full(tau.size, min_log_excess), np.full(tau.size, MAX_LOG_EXCESS)
    guess = first_guess(tau, front_law.damping_ratios, front_law.release)
    # The search starts inside of its bracket.
    guess = np.clip(guess, low + 0.1, high - 1.0)
    return 1.0 + np.exp(increasing_roots(excess_over_required, guess=guess, lower=low, upper=high))
