"""Front speed on the damped lattice, exactly, by the Wiener-Hopf method.

A front that runs at constant speed v > 1 (in wave speeds) over a lattice with damping ratio b = beta/dx has, in
lattice units, the symbol

    M(k) = 1 - 4 sin^2(k/2) (1 + i b v k) / (v k)^2 = M_+(k) M_-(k),    M_+ analytic in the upper half plane,

and the released stress equals 1 when M_+(0) = tau_0 (release "total": the stress includes the damping force) or
M_+(0) / M_+(i/(b v)) = tau_0 ("elastic"). Leaf springs are left out: gamma dx^2 << 1.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ..model.checks import check_choice, check_number
from ..model.roots import root_between

RELEASES = ("total", "elastic")
# Quadrature: Gauss-Legendre nodes on each panel of half a period, and how many periods beyond the last scale.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(16)
PERIODS = 48
# The nodes of up to so many periods are kept for the next quadrature: 1 MB.
MOST_KEPT = 1000
# Beyond this damping ratio the quadrature takes long, and the pulse is as wide as the damped layer.
STRONGEST_DAMPING = 10.0
# Two quadratures that differ by more than this (relative, in tau) are refused.
QUADRATURE_TOLERANCE = 1e-11


def front_speed_undamped(tau0: float | np.ndarray) -> float | np.ndarray:
    """Front speed without damping, 1/sqrt(1 - tau_0^2) (section III A of the paper)."""
    return 1.0 / np.sqrt(1.0 - np.asarray(tau0, dtype=float) ** 2)


def front_speed(tau0, damping_ratio, release: str = "total"):
    """Exact speed of a steady front into pre-stress tau_0.

    Parameters
    ----------
    tau0 : float or array
        Pre-stress ahead of the front, in (0, 1).
    damping_ratio : float or array, broadcast with tau0
        beta/dx, >= 0.
    release : "total" or "elastic"
        Whether the stress that is compared with the threshold includes the damping force.

    Returns
    -------
    float or array
        Speed in units of the wave speed, > 1.

    Raises
    ------
    ValueError
        Outside the domain, naming the value and the range.

    Source: Wiener-Hopf factorisation of the lattice equation (module docstring); at damping_ratio = 0 the paper's
    1/sqrt(1 - tau_0^2) for any dx.
    """
    check_choice("release", release, RELEASES)
    tau, ratio = np.broadcast_arrays(np.asarray(tau0, dtype=float), np.asarray(damping_ratio, dtype=float))
    out = np.empty(tau.shape)
    for index in np.ndindex(tau.shape):
        check_number("tau0", float(tau[index]), above=0.0, below=1.0)
        check_number("damping_ratio", float(ratio[index]), at_least=0.0)
        out[index] = _speed(float(tau[index]), float(ratio[index]), release)
    return out if out.ndim else float(out)


def prestress_for_speed(speed, damping_ratio, release: str = "total"):
    """Pre-stress into which a steady front runs at ``speed``: the inverse of `front_speed`.

    Parameters
    ----------
    speed : float or array, > 1 (wave speeds)
    damping_ratio : float or array, broadcast with speed, >= 0
    release : "total" or "elastic"

    Raises
    ------
    ValueError
        Outside the domain, naming the value and the range.
    """
    check_choice("release", release, RELEASES)
    speeds, ratio = np.broadcast_arrays(
        np.asarray(speed, dtype=float), np.asarray(damping_ratio, dtype=float)
    )
    out = np.empty(speeds.shape)
    for index in np.ndindex(speeds.shape):
        check_number("speed", float(speeds[index]), above=1.0)
        check_number("damping_ratio", float(ratio[index]), at_least=0.0)
        out[index] = np.exp(_log_prestress(float(speeds[index]) - 1.0, float(ratio[index]), release))
    return out if out.ndim else float(out)


def lattice_front_speed(tau0: float, gamma: float, dx: float) -> float:
    """Exact front speed at finite spacing with leaf springs and no damping.

    Parameters
    ----------
    tau0 : pre-stress, in (0, 1)
    gamma : elasticity ratio, > 0
    dx : block spacing (units of H), > 0

    Raises
    ------
    ValueError
        Where no front outruns the waves: sqrt(gamma (1 - tau_0^2)) dx > 2 tau_0, or a speed not above 1.

    Source: the undamped lattice symbol with leaf springs; tends to 1/sqrt(1 - tau_0^2) as gamma dx^2 -> 0.
    """
    check_number("tau0", tau0, above=0.0, below=1.0)
    check_number("gamma", gamma, above=0.0)
    check_number("dx", dx, above=0.0)
    argument = np.sqrt(gamma * (1.0 - tau0**2)) * dx / (2.0 * tau0)
    speed = np.sqrt(gamma) * dx / (2.0 * tau0 * np.arcsin(argument)) if argument <= 1.0 else 0.0
    if speed <= 1.0:
        raise ValueError(
            f"tau0: {tau0!r}; allowed: values whose front outruns the waves at gamma = {gamma:g}, dx = {dx:g}"
        )
    return float(speed)


def _speed(tau: float, ratio: float, release: str) -> float:
    target = np.log(tau)

    def mismatch(log_excess: float) -> float:
        return _log_prestress(float(np.exp(log_excess)), ratio, release, check=False) - target

    lower = np.log(0.25 * tau**2 / (1.0 + ratio) ** 2) - 2.0
    upper = np.log(front_speed_undamped(tau) - 1.0) + 2.0
    while mismatch(lower) > 0.0:
        lower -= 2.0
    while mismatch(upper) < 0.0:
        upper += 2.0
        if upper > 60.0:
            raise ValueError(
                f"tau0: {tau!r}; allowed: values with a finite speed at damping_ratio = {ratio:g}"
            )
    excess = float(np.exp(root_between(mismatch, lower, upper, xtol=1e-13, rtol=1e-13)))
    # The error control is for the root alone: its bracket may be anything.
    _log_prestress(excess, ratio, release)
    return 1.0 + excess


def _log_prestress(excess: float, ratio: float, release: str, check: bool = True) -> float:
    """ln tau_0 at speed 1 + excess; to check, the quadrature is done twice and the two must agree."""
    speed = 1.0 + excess
    log_static = 0.5 * np.log(excess * (2.0 + excess) / speed**2)
    if ratio == 0.0:
        return log_static
    if not check:
        return log_static + _quadrature(excess, ratio, release, PERIODS)
    values = [log_static + _quadrature(excess, ratio, release, periods) for periods in (PERIODS, 2 * PERIODS)]
    if abs(values[1] - values[0]) > QUADRATURE_TOLERANCE * max(1.0, abs(values[1])):
        raise ArithmeticError(
            f"the front-speed quadrature did not converge at speed {speed!r}, damping_ratio {ratio!r}:"
            f" {values[0]!r} against {values[1]!r}"
        )
    return values[1]


def _quadrature(excess: float, ratio: float, release: str, periods: int) -> float:
    """ln M_+(0) - ln sqrt(1 - 1/v^2), less ln M_+(i/(b v)) for the elastic rule.

    Panels shrink geometrically towards 0, where M varies on the scale of sqrt(v - 1) and (v - 1)/b, and have half
    a period each beyond. What is left beyond the last panel, Z, a whole number of periods, is the period average
    of the expansion in 1/Z, integrated in closed form.
    """
    v, b = 1.0 + excess, ratio
    whole = periods * int(np.ceil(1.0 + 2.0 * b / v / np.pi))
    z, weight, bend, lag, end = (_kept_panels if whole <= MOST_KEPT else _panels)(whole)
    q = b * bend / (v * z)
    real = (excess * (2.0 + excess) + lag) / v**2
    argument = np.arctan2(-q, real)
    # q = b bend/(v z) decays slowly: its integral over all z is pi b / v, and only the rest is left to the panels.
    total = np.sum(weight * (argument + q) / z) - np.pi * b / v
    # Averages over a period: bend -> 2, bend^2 -> 6, bend^3 -> 20.
    total += (-6.0 * b / v**3 + 20.0 * b**3 / (3.0 * v**3)) / (3.0 * end**3)
    if release == "elastic":
        y = 1.0 / (b * v)
        kernel = 1.0 / (z**2 + y**2)
        size = 0.5 * np.log(real**2 + q**2)
        shifted = np.sum(weight * kernel * (y * size + z * (argument + q)))
        # Int (2 - 2 cos z)/(z^2 + y^2) dz over all z = (pi/y)(1 - e^{-y}).
        shifted -= (b / v) * (np.pi / y) * -np.expm1(-y)
        # ln|M| -> -p + q^2/2 - p^2/2 + p q^2 - q^4/4 and arg M + q -> -p q + q^3/3, averaged.
        second = (-2.0 + 3.0 * b**2) / v**2
        fourth = (-3.0 + 20.0 * b**2 - 70.0 * b**4 / 4.0) / v**4
        odd = (-6.0 * b + 20.0 * b**3 / 3.0) / v**3
        tails = _tail_moments(end, y)
        shifted += y * (second * tails[0] + fourth * tails[1]) + odd * tails[0]
        total -= shifted
    return float(total / np.pi)


def _panels(whole: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, float]:
    """Nodes z up to so many whole periods, their weights, and what of the integrand they alone tell.

    Re M = 1 - p, p = bend/(v z)^2, without cancellation at small z, where p -> 1/v^2 and v may be close to 1, takes
    lag = 1 - bend/z^2.
    """
    edges = np.concatenate([[0.0], np.pi * 2.0 ** np.arange(-60.0, 0.0), np.pi * np.arange(1, 2 * whole + 1)])
    half = 0.5 * np.diff(edges)[:, None]
    z = (0.5 * (edges[1:] + edges[:-1])[:, None] + half * NODES).ravel()
    weight = (half * WEIGHTS).ravel()
    bend = np.where(z < 1e-4, z**2 * (1.0 - z**2 / 12.0), 2.0 * (1.0 - np.cos(z)))
    lag = np.where(z < 1e-2, z**2 / 12.0 * (1.0 - z**2 / 30.0 * (1.0 - z**2 / 56.0)), 1.0 - bend / z**2)
    return z, weight, bend, lag, float(edges[-1])


_kept_panels = lru_cache(maxsize=16)(_panels)


def _tail_moments(end: float, y: float) -> tuple[float, float]:
    """Int_end^inf dz / (z^n (z^2 + y^2)) for n = 2 and 4."""
    ratio = y / end
    if ratio < 0.05:
        r2 = ratio**2
        second = (1 / 3 - r2 / 5 + r2**2 / 7 - r2**3 / 9 + r2**4 / 11) / end**3
        fourth = (1 / 5 - r2 / 7 + r2**2 / 9 - r2**3 / 11 + r2**4 / 13) / end**5
        return second, fourth
    first = np.arctan(ratio) / y
    second = (1.0 / end - first) / y**2
    fourth = (1.0 / (3.0 * end**3) - second) / y**2
    return float(second), float(fourth)
