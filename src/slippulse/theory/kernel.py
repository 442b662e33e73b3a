"""Riemann's function J0(sqrt z) and its derivatives, entire in z: z > 0 inside the cone, z < 0 just outside it."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.polynomial import Polynomial, chebyshev

# Beyond this the polynomial would cancel.
LARGEST = 256.0


def riemann(z: np.ndarray, bounds: tuple[float, float]) -> np.ndarray:
    """J0(sqrt z) for z within bounds (clipped there), with J0(i y) = I0(y); error below 1e-11."""
    return _value(z, bounds, 0)


def riemann_slope(z: np.ndarray, bounds: tuple[float, float]) -> np.ndarray:
    """The derivative of J0(sqrt z) by z, -J1(sqrt z)/(2 sqrt z)."""
    return _value(z, bounds, 1)


def riemann_bend(z: np.ndarray, bounds: tuple[float, float]) -> np.ndarray:
    """The second derivative of J0(sqrt z) by z, J2(sqrt z)/(4 z)."""
    return _value(z, bounds, 2)


def _value(z: np.ndarray, bounds: tuple[float, float], order: int) -> np.ndarray:
    lower, upper = min(bounds[0], 0.0), max(bounds[1], 0.0)
    if lower == upper == 0.0:
        return np.full(z.shape, (1.0, -0.25, 1.0 / 32.0)[order])
    if max(-lower, upper) > LARGEST:
        return _bessel(np.clip(z, lower, upper), order)
    # Few polynomials serve all ranges.
    lower, upper = (
        math.copysign(2.0 ** max(0, math.ceil(math.log2(max(abs(e), 1.0)))), e) for e in (lower, upper)
    )
    if lower > 0.0:
        lower = 0.0
    centre, half = 0.5 * (lower + upper), 0.5 * (upper - lower)
    scaled = (z - centre) * (1.0 / half)
    np.clip(scaled, -1.0, 1.0, out=scaled)
    coefficients = _polynomial(lower, upper, order)
    out = np.full_like(scaled, coefficients[-1])
    for coefficient in coefficients[-2::-1]:
        out *= scaled
        out += coefficient
    return out


@lru_cache(maxsize=256)
def _polynomial(lower: float, upper: float, order: int) -> tuple[float, ...]:
    """Coefficients by powers of the scaled variable, which runs from -1 to 1 between the bounds."""
    series = chebyshev.chebinterpolate(
        lambda s: _bessel(0.5 * (lower + upper) + 0.5 * (upper - lower) * s, order), 40
    )
    size = np.max(np.abs(series))
    last = int(np.flatnonzero(np.abs(series) > 1e-14 * size)[-1])
    return tuple(Polynomial(chebyshev.cheb2poly(series[: last + 1])).coef.tolist())


def _bessel(z: np.ndarray, order: int) -> np.ndarray:
    # Slow to load, and not needed under a stress boundary.
    from scipy.special import i0, i1, j0, j1

    root = np.sqrt(np.abs(z))
    outside = np.where(z < 0.0, root, 0.0)
    even = np.where(z >= 0.0, j0(root), i0(outside))
    if order == 0:
        return even
    safe = np.maximum(root, 1e-9)
    slope = np.where(z >= 0.0, -j1(safe), -i1(np.maximum(outside, 1e-9))) / (2.0 * safe)
    if order == 1:
        return slope
    # Bessel's equation, z f'' + f' + f/4 = 0, and its series where that cancels.
    small = np.abs(z) < 0.1
    series = (1.0 - z / 12.0 * (1.0 - z / 32.0 * (1.0 - z / 60.0 * (1.0 - z / 96.0)))) / 32.0
    return np.where(small, series, -(slope + 0.25 * even) / np.where(small, 1.0, z))
