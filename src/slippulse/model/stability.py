"""Largest stable step of each scheme on the sliding lattice, with leaf springs and damping."""

import math
from functools import lru_cache

import numpy as np

# An amplification of at most this much above 1 a step counts as stable: rounding in the polynomial.
ROUNDING = 1e-12
# Orders whose Taylor polynomial grows slightly on the imaginary axis (5, 6) are held to this growth a step.
WEAK_GROWTH = 1e-4
WEAK_ORDERS = (5, 6)
# Steps are chosen at most this fraction of the bound: measured boundaries meet it within a hundredth.
MARGIN = 0.9
# The bound is found in rounds, each looking at this number of parts of the interval that is left.
ROUNDS, PARTS = 4, 32


def largest_step(
    scheme: str, order: int, damping_ratio: float, gamma_dx2: float, alpha_dx: float = 0.0,
    enough: float = math.inf,
) -> float:  # fmt: skip
    """Largest stable time step in units of dx: "continuum" takes none.

    order : of the Taylor step, used by "localised" alone
    damping_ratio, gamma_dx2 : beta/dx and gamma dx^2 (0 under a stress boundary), >= 0
    alpha_dx : alpha dx, the rate strengthening of friction; below 0 as 0, since slip that grows by itself may grow
    enough : of a larger bound some number from this up to it is returned, in less than half the time

    A mode of the lattice has stiffness s + gamma dx^2 and damping rate b s + alpha dx, s in [0, 4], in units of dx.
    "fixed_step" (symplectic Euler): dt <= sqrt(dt_c^2 + c^2) - c with dt_c = 2/sqrt(4 + gamma dx^2) and
    c = b + alpha dx/4. "localised": the largest h at which one step, slip to one order more than velocity, amplifies
    no mode; 0 where the polynomials cannot be computed.
    """
    if scheme == "continuum":
        return math.inf
    drag = max(alpha_dx, 0.0)
    if scheme == "fixed_step":
        critical = 2.0 / math.sqrt(4.0 + gamma_dx2)
        # The difference of nearly equal numbers at large damping, rewritten.
        damping = damping_ratio + 0.25 * drag
        return critical**2 / (math.sqrt(critical**2 + damping**2) + damping)
    if not (math.isfinite(damping_ratio) and math.isfinite(gamma_dx2) and math.isfinite(drag)):
        return 0.0
    rounded = [float(f"{value:.6g}") for value in (damping_ratio, gamma_dx2, drag)]
    return _taylor_bound(order, *rounded, enough)


@lru_cache(maxsize=4096)
@np.errstate(over="ignore", invalid="ignore")
def _taylor_bound(
    order: int, damping_ratio: float, gamma_dx2: float, drag: float, enough: float
) -> float:
    modes = np.linspace(0.0, 4.0, 101)
    stiffness, damping = modes + gamma_dx2, damping_ratio * modes + drag
    # Time derivatives of slip of each mode, each a combination of slip and velocity at the start.
    derivatives = [np.outer(start, np.ones_like(modes)) for start in np.eye(2)]
    for _ in range(order):
        derivatives.append(-stiffness * derivatives[-2] - damping * derivatives[-1])
    allowed = 1.0 + (WEAK_GROWTH if order in WEAK_ORDERS else ROUNDING)

    def unstable(steps: np.ndarray) -> np.ndarray:
        # Not a number is not stable.
        return ~(np.max(_amplifications(steps, np.array(derivatives)), axis=-1) <= allowed)

    # From small steps on, a few at a time: the first that is unstable is what counts.
    smallest = 0.01 / (1.0 + damping_ratio + drag) / max(1.0, 0.01 * math.sqrt(gamma_dx2))
    if smallest == 0.0:
        return 0.0
    steps = np.geomspace(smallest, 8.0, 160)
    for start in range(0, steps.size, PARTS):
        found = np.flatnonzero(unstable(steps[start : start + PARTS]))
        if found.size:
            break
        if not (reached := float(steps[start + PARTS - 1])) < min(enough, steps[-1]):
            return reached
    first = start + int(found[0])
    lower, upper = steps[first - 1] if first else 0.0, steps[first]
    for _ in range(ROUNDS):
        parts = np.linspace(lower, upper, PARTS + 1)
        # The last is unstable, whatever rounding makes of it now.
        first = int(np.argmax(np.append(unstable(parts[1:-1]), True)))
        lower, upper = parts[first], parts[first + 1]
    return float(lower)


def _amplifications(steps: np.ndarray, derivatives: np.ndarray) -> np.ndarray:
    """Amplification of each mode by each step, shape (steps, modes)."""
    degrees = np.arange(len(derivatives))
    powers = np.asarray(steps, dtype=float)[:, None] ** degrees / [
        math.factorial(k) for k in degrees
    ]
    slip = np.tensordot(powers, derivatives, 1)
    velocity = np.tensordot(powers[:, :-1], derivatives[1:], 1)
    half_trace = 0.5 * (slip[:, 0] + velocity[:, 1])
    product = slip[:, 0] * velocity[:, 1] - slip[:, 1] * velocity[:, 0]
    # As half_trace^2 - product, which would cancel for a mode that drag alone slows down.
    difference = (0.5 * (slip[:, 0] - velocity[:, 1])) ** 2 + slip[:, 1] * velocity[:, 0]
    # Two real eigenvalues, or two complex ones of one size.
    real = np.abs(half_trace) + np.sqrt(np.maximum(difference, 0.0))
    return np.where(difference >= 0.0, real, np.sqrt(np.maximum(product, 0.0)))
