"""What float32 would do: the textbook scheme in plain numpy, in either precision. Not part of the solver."""

from __future__ import annotations

import numpy as np


def crack_velocity(
    gamma: float, level: float, dx: float, duration: float, step: float, dtype: type
) -> np.ndarray:
    """Slip velocity of a crack from a Gaussian of width 8 dx at the end, right half, without damping.

    Parameters
    ----------
    gamma, level, dx, duration : the scene: elasticity ratio, pre-stress, spacing, time
    step : in units of dx
    dtype : np.float32 or np.float64, of every array and constant

    Source: symplectic Euler on slip, the force from second differences of slip.
    """
    count = int(1.5 * duration / dx) + 32
    x = dx * np.arange(count)
    tau = (level + (1.0 - level) * np.exp(-0.5 * (x / (8.0 * dx)) ** 2)).astype(dtype)
    slip, velocity, sliding = np.zeros(count, dtype), np.zeros(count, dtype), tau >= 1.0
    per_dx2, leaf, h = dtype(1.0 / dx**2), dtype(gamma), dtype(step * dx)
    force = np.zeros(count, dtype)
    for _ in range(round(duration / (step * dx))):
        force[1:-1] = per_dx2 * (slip[2:] - dtype(2.0) * slip[1:-1] + slip[:-2])
        force[0] = dtype(2.0) * per_dx2 * (slip[1] - slip[0])
        force[:-1] += tau[:-1] - leaf * slip[:-1]
        sliding |= force >= dtype(1.0)
        velocity = np.where(sliding, np.maximum(velocity + h * force, dtype(0.0)), dtype(0.0))
        slip += h * velocity
    return velocity
