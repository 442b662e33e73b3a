"""Largest stable step of each scheme on the sliding lattice, with leaf springs and damping."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

# An amplification of at most this much above 1 a step counts as stable: rounding in the polynomial.
ROUNDING = 1e-12
# Orders whose Taylor polynomial grows slightly on the imaginary axis (5, 6) are held to this growth a step.
WEAK_GROWTH = 1e-4


def largest_step(scheme: str, order: int, damping_ratio: float, gamma_dx2: float) -> float:
    """Largest stable time step in units of dx.

    Parameters
    ----------
    scheme : "localised" or "fixed_step"
    order : order of the Taylor step (not used by "fixed_step")
    damping_ratio : beta/dx, >= 0
    gamma_dx2 : gamma dx^2, >= 0 (0 under a stress boundary)

    A mode of the lattice has stiffness s in [0, 4] + gamma dx^2 and damping rate b s', s' in [0, 4], in units of dx.
    "fixed_step" (symplectic Euler): dt <= sqrt(dt_c^2 + b^2) - b with dt_c = 2/sqrt(4 + gamma dx^2). "localised":
    the largest h for which the Taylor polynomial of the exponential is at most 1 for every mode.
    """
    if scheme == "fixed_step":
        critical = 2.0 / math.sqrt(4.0 + gamma_dx2)
        # The difference of nearly equal numbers at large damping, rewritten.
        return critical**2 / (math.sqrt(critical**2 + damping_ratio**2) + damping_ratio)
    return _taylor_bound(order, float(f"{damping_ratio:.6g}"), float(f"{gamma_dx2:.6g}"))


@lru_cache(maxsize=4096)
def _taylor_bound(order: int, damping_ratio: float, gamma_dx2: float) -> float:
    stiffness = np.linspace(0.0, 4.0, 101)
    half_damping = 0.5 * damping_ratio * stiffness
    root = np.sqrt((half_damping**2 - stiffness - gamma_dx2).astype(complex))
    eigenvalues = np.concatenate([-half_damping + root, -half_damping - root])
    allowed = 1.0 + (WEAK_GROWTH if order in (5, 6) else ROUNDING)

    def stable(step: float) -> bool:
        z = step * eigenvalues
        term = np.ones_like(z)
        total = np.ones_like(z)
        for k in range(1, order + 1):
            term = term * z / k
            total = total + term
        return bool(np.all(np.abs(total) <= allowed))

    steps = np.geomspace(0.01 / (1.0 + damping_ratio), 8.0, 160)
    good = 0.0
    for step in steps:
        if not stable(step):
            break
        good = step
    lower, upper = good, float(step)
    for _ in range(40):
        middle = 0.5 * (lower + upper)
        lower, upper = (middle, upper) if stable(middle) else (lower, middle)
    return lower
