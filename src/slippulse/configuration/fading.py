"""Where no steady front is under leaf springs, and on what way one fades there: measured on the lattice, for costs."""

from __future__ import annotations

import math

import numpy as np

from ..model.scene import Scene

# Ways on which a front fades: where damping spreads it over the wave of the leaf springs, times
# (gamma^2 beta)^-1/3, and where the lattice does, times (gamma^3 dx^2)^-1/4.
DAMPED, LATTICE = 2.6, 13.0


def fading_rate(level: np.ndarray, scene: Scene) -> np.ndarray:
    """What share of a front fades on a unit of its way, by the pre-stress ahead; 0 where a steady front is.

    Parameters
    ----------
    level : pre-stress ahead
    scene : with leaf springs
    """
    # With long steps the textbook scheme drives a front on for ever (measured).
    driven = scene.scheme == "fixed_step" and scene.max_step > 0.5 + 2.5 * scene.damping_ratio
    if scene.scheme == "continuum" or driven:
        return np.zeros(level.size)
    way = LATTICE * (scene.gamma**3 * scene.dx**2) ** -0.25
    if scene.beta:
        way = min(way, DAMPED * (scene.gamma**2 * scene.beta) ** (-1.0 / 3.0))
    return np.where((level <= 0.0) | _held(level, scene), 1.0 / way, 0.0)


def _held(level: np.ndarray, scene: Scene) -> np.ndarray:
    """Where leaf springs hold the blocks of the lattice (measured).

    They hold none that a single released neighbour frees, with what it slips and, by "total", with its velocity.
    """
    tau, ratio, total = np.clip(level, 1e-16, 1.0 - 1e-16), scene.damping_ratio, scene.release == "total"
    stiffness = scene.dx * math.sqrt(scene.gamma)
    bound = 1.1 + 0.45 / (1.0 + ratio) + (ratio**1.16 * tau**1.48 if total else 0.0)
    bound = np.where(1.6 * ratio < tau, np.maximum(bound, 1.5 / np.sqrt(tau)), bound)
    own = stiffness**2 + 2.0
    freed = tau * (2.0 / own + (min(ratio / math.sqrt(own), 0.5) if total else 0.0)) >= 1.0 - tau
    return ~freed & (stiffness * np.sqrt((1.0 - tau) * (1.0 + tau)) > bound * tau)
