"""Front speeds on the damped lattice, without leaf springs.

They follow from the Wiener-Hopf factor M_+ of `wiener_hopf`. With the release rule "total" (the
stress includes the damping force) the stress at the release is 1 if M_+(0) = tau_0; with "elastic"
(it does not) if M_+(0)/M_+(i/(b v)) = tau_0. The sliding part is taken to be infinitely long. The
front feels that blocks stick behind it only if the pulse is hardly wider than the layer of damped
or lattice waves at its tip, which is a few blocks unless b is large.
"""

from typing import NamedTuple

import numpy as np

from ..model.checks import as_numbers, check_choice
from ..model.release import RELEASES
from .domains import DOMAINS, broadcast_numbers
from .vector_roots import increasing_roots
from .wiener_hopf import log_prestress

LARGEST_RATIO = DOMAINS["damping_ratio"]["at_most"]
# If 1 - tau_0 is below this, rounding affects the quadrature, and the first terms in 1/v are more
# accurate.
NEARLY_ONE_DISTANCE = {"total": 1e-10, "elastic": 1e-13}
# The smallest ln(v - 1), for which v is 1 to all digits, and one beyond any speed in the domain.
MIN_LOG_EXCESS, MAX_LOG_EXCESS = -80.0, 280.0
# Number of elements that are solved at once, which limits the memory.
ELEMENTS_PER_CHUNK = 128


class Lattice(NamedTuple):
    """A lattice: its damping ratios, release rule, leaf springs gamma dx^2 and drag alpha dx."""

    ratio: np.ndarray
    release: str
    springs: float = 0.0
    drag: float = 0.0

    def log_prestress(self, x: np.ndarray, ratio: np.ndarray) -> np.ndarray:
        """Return ln tau_0 of fronts at x = ln(v - 1)."""
        return log_prestress(np.exp(x), ratio, self.springs, self.release, self.drag)


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
    speeds = np.array(front_speed_undamped(tau))
    damped = ratio > 0.0
    # Under rule "elastic" the expansion holds only for fronts that are much faster than the ratio.
    may_be_expanded = (release == "total") | (ratio < 1e3)
    is_nearly_one = damped & (1.0 - tau < NEARLY_ONE_DISTANCE[release]) & may_be_expanded
    speeds[is_nearly_one] = 1.0 / slowness_nearly_one(
        tau[is_nearly_one], ratio[is_nearly_one], release
    )
    is_solved = damped & ~is_nearly_one
    if np.any(is_solved):
        tau, ratio = tau[is_solved], ratio[is_solved]
        # Elements with similar speeds share a contour.
        order = np.argsort(first_guess(tau, ratio, release))
        solved_speeds = np.empty(tau.size)
        for part in np.split(order, range(ELEMENTS_PER_CHUNK, order.size, ELEMENTS_PER_CHUNK)):
            solved_speeds[part] = speeds_into(tau[part], Lattice(ratio[part], release))
        speeds[is_solved] = solved_speeds
    return speeds if speeds.ndim else float(speeds)


def prestress_for_speed(speed, damping_ratio, release: str = "total"):
    """Return the pre-stress of a steady front of given speed, the inverse of `front_speed`.

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
    # Without damping the pre-stress is sqrt(v^2 - 1)/v.
    prestress = np.array(np.sqrt(excess * (1.0 + speeds)) / speeds)
    damped = ratio > 0.0
    if np.any(damped):
        prestress[damped] = np.exp(log_prestress_in_chunks(excess[damped], ratio[damped], release))
    return prestress if prestress.ndim else float(prestress)


def slowness_nearly_one(tau: np.ndarray, ratio: np.ndarray | float, release: str) -> np.ndarray:
    """Return 1/v of fronts that are much faster than b, up to terms in 1/v^3.

    It solves -ln tau = b/v + 1/(2 v^2) under rule "total", and -ln tau = 1/(2 v^2) under "elastic".
    """
    fall = -np.log(tau)
    damping = np.asarray(ratio) if release == "total" else 0.0
    return 2.0 * fall / np.maximum(damping + np.sqrt(damping**2 + 2.0 * fall), 1e-300)


def log_prestress_in_chunks(excess: np.ndarray, ratio: np.ndarray, release: str) -> np.ndarray:
    """Return `log_prestress` without leaf springs, with limited memory."""
    parts = (slice(i, i + ELEMENTS_PER_CHUNK) for i in range(0, excess.size, ELEMENTS_PER_CHUNK))
    values = [log_prestress(excess[part], ratio[part], 0.0, release) for part in parts]
    return np.concatenate(values)


def first_guess(tau: np.ndarray, ratio: np.ndarray, release: str) -> np.ndarray:
    """Return an estimate of ln(v - 1), with which the search for the speed starts.

    It follows from the limits of weak and strong damping and, under rule "total", from b = 1.
    """
    distance_to_1 = 1.0 - tau
    # Without damping v = 1/sqrt(1 - tau^2), so that v - 1 = tau^2/(1 - tau^2 + sqrt(1 - tau^2)).
    one_minus_square = distance_to_1 * (1.0 + tau)
    undamped = np.log(tau) * 2.0 - np.log(one_minus_square + np.sqrt(one_minus_square))
    if release == "elastic":
        # With strong damping v = 1/sqrt(1 - tau).
        damped = np.log(tau) - np.log(distance_to_1 + np.sqrt(distance_to_1))
        return np.where(ratio < 0.2, undamped + 0.5 * ratio, damped - 1.0 / (1.0 + 2.0 * ratio))
    # At b = 1, v - 1 = tau/(1 - tau). It grows in proportion to b beyond.
    weight = np.minimum(ratio, 1.0)
    damped = np.log(tau / distance_to_1) + np.log(np.maximum(ratio, 1.0))
    return (1.0 - weight) * undamped + weight * damped


def speeds_into(tau: np.ndarray, lattice: Lattice, slowest: float = MIN_LOG_EXCESS) -> np.ndarray:
    """Return the speeds v at which the pre-stress is tau.

    They are searched from ln(v - 1) = slowest on.
    """
    target = np.log(tau) - np.log1p(-tau)

    def mismatch(x: np.ndarray, which: np.ndarray) -> np.ndarray:
        """Return the error of ln(tau/(1 - tau)), which is nearly linear in ln(v - 1)."""
        log_tau = lattice.log_prestress(x, lattice.ratio[which])
        # If the stress is 1 to rounding, the front is faster than any target.
        return log_tau - np.log(np.maximum(-np.expm1(log_tau), 1e-17)) - target[which]

    low, high = np.full(tau.size, slowest), np.full(tau.size, MAX_LOG_EXCESS)
    guess = np.clip(first_guess(tau, lattice.ratio, lattice.release), low + 0.1, high - 1.0)
    return 1.0 + np.exp(increasing_roots(mismatch, guess=guess, lower=low, upper=high))
