"""References for the speed of kernels: a stencil without branches, and a scheme in NumPy."""

import numpy as np

from slippulse.solver.jit import kernel_entry, kernel_function


@kernel_function()
def second_difference(out, lower, upper, per_dx2, leaf, damping):
    """Compute a time derivative of slip from the two before it, in an array with fixed ends."""
    for i in range(out.shape[0]):
        out[i] = (
            per_dx2 * (lower[i + 2] - 2.0 * lower[i + 1] + lower[i])
            - leaf * lower[i + 1]
            + damping * (upper[i + 2] - 2.0 * upper[i + 1] + upper[i])
        )


@kernel_function()
def advance_polynomials(slip, velocity, a, b, c, d, h):
    """Advance slip and velocity by their Taylor polynomials."""
    for i in range(slip.shape[0]):
        slip[i] += h * (
            velocity[i] + h / 2.0 * (a[i] + h / 3.0 * (b[i] + h / 4.0 * (c[i] + h / 5.0 * d[i])))
        )
        velocity[i] += h * (a[i] + h / 2.0 * (b[i] + h / 3.0 * (c[i] + h / 4.0 * d[i])))


@kernel_entry
def taylor_steps(w, tau, steps, h, per_dx2, leaf, damping):
    """Take steps of order 4 without events; rows 0 and 1 of w (6 rows) are slip and velocity."""
    n = tau.shape[0]
    for _ in range(steps):
        second_difference(w[2, 1 : n - 1], w[0], w[1], per_dx2, leaf, damping)
        for i in range(n):
            w[2, i] += tau[i]
        for k in range(3, 6):
            second_difference(w[k, 1 : n - 1], w[k - 2], w[k - 1], per_dx2, leaf, damping)
        advance_polynomials(w[0], w[1], w[2], w[3], w[4], w[5], h)


def numpy_steps(
    tau: np.ndarray, steps: int, h: float, dx: float, leaf: float, beta: float
) -> np.ndarray:
    """Return the slip of each block between fixed ends by the textbook scheme."""
    (slip, velocity, force), sliding = np.zeros((3, tau.size)), tau >= 1.0
    for _ in range(steps):
        force[1:-1] = np.diff(slip + beta * velocity, 2) / dx**2 - leaf * slip[1:-1] + tau[1:-1]
        sliding |= force >= 1.0
        velocity = np.where(sliding, velocity + h * force, 0.0)
        sliding &= velocity > 0.0
        velocity = np.maximum(velocity, 0.0)
        slip += h * velocity
    return slip
