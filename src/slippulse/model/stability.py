"""Largest stable and accurate steps on the sliding lattice, with leaf springs and damping."""

import math
from functools import lru_cache

import numpy as np

# An amplification by at most this much above 1 a step is the polynomial's rounding, not a growth.
ROUNDING = 1e-12
# Orders whose Taylor polynomial grows slightly on the imaginary axis are held to this a step.
WEAK_GROWTH = 1e-4
WEAK_ORDERS = (5, 6)
# A step is at most this fraction of the bound. Simulations confirm the bound to a hundredth.
MARGIN = 0.9
# A Taylor step may err by this fraction of the mode that changes fastest. Front speeds then err by
# less than 1e-3 (levels 0.2 to 0.8, beta/dx up to 100), and strong damping is what asks for it.
STEP_ERROR = 1e-2
# The bound is sought in rounds; each divides the interval that is left into this many parts.
ROUNDS, PARTS = 5, 32


def largest_step(
    scheme: str, order: int, damping_ratio: float, gamma_dx2: float, alpha_dx: float = 0.0
) -> float:
    """Largest stable time step in units of dx, by b = beta/dx, gamma dx^2 and alpha dx.

    A mode of the lattice has stiffness s + gamma dx^2 and damping rate b s + alpha dx, where s is
    in [0, 4], in units of dx. Symplectic Euler is stable for dt <= sqrt(dt_c^2 + c^2) - c, where
    dt_c = 2/sqrt(4 + gamma dx^2) and c = b + alpha dx/4. A Taylor step is stable where it amplifies
    no mode; it expands slip to one order more than velocity. The bound is 0 where the polynomials
    cannot be computed.
    """
    if scheme == "continuum":
        return math.inf
    # Slip that grows physically may grow.
    drag = max(alpha_dx, 0.0)
    if scheme == "fixed_step":
        critical = 2.0 / math.sqrt(4.0 + gamma_dx2)
        # sqrt(dt_c^2 + c^2) - c cancels at large damping; this form of it does not.
        damping = damping_ratio + 0.25 * drag
        return critical**2 / (math.sqrt(critical**2 + damping**2) + damping)
    rounded = [float(f"{value:.6g}") for value in (damping_ratio, gamma_dx2, drag)]
    return _taylor_bound(order, *rounded)


def accurate_step(
    error: float, order: int, damping_ratio: float, gamma_dx2: float, alpha_dx: float = 0.0
) -> float:
    """Largest Taylor step, in units of dx, that errs by a fraction of any mode at most.

    The error is the remainder (r dt)^(order + 1)/(order + 1)!, where r is the largest rate of a
    mode: sqrt(k), or c + sqrt(c^2 - k) where damping c^2 > k, with its stiffness k and c of half
    its damping rate.
    """
    stiffness = math.sqrt(4.0 + gamma_dx2)
    half = 2.0 * damping_ratio + 0.5 * max(alpha_dx, 0.0)
    over = math.sqrt(max(half - stiffness, 0.0)) * math.sqrt(half + stiffness)
    rate = max(half, stiffness) + over
    return (error * math.factorial(order + 1)) ** (1.0 / (order + 1)) / rate


def chosen_step(scheme: str, order: int, *ratios: float) -> float:
    """Longest step, in units of dx, that is stable by a margin and accurate."""
    step = MARGIN * largest_step(scheme, order, *ratios)
    return min(step, accurate_step(STEP_ERROR, order, *ratios)) if scheme == "localised" else step


@lru_cache(maxsize=4096)
@np.errstate(over="ignore", invalid="ignore")
def _taylor_bound(order: int, damping_ratio: float, gamma_dx2: float, drag: float) -> float:
    modes = np.linspace(0.0, 4.0, 101)
    stiffness, damping = modes + gamma_dx2, damping_ratio * modes + drag
    # Each time derivative of the slip of a mode combines the slip and the velocity at the start.
    derivatives = [np.outer(start, np.ones_like(modes)) for start in np.eye(2)]
    for _ in range(order):
        derivatives.append(-stiffness * derivatives[-2] - damping * derivatives[-1])
    allowed = 1.0 + (WEAK_GROWTH if order in WEAK_ORDERS else ROUNDING)

    def unstable(steps: np.ndarray) -> np.ndarray:
        # An amplification of NaN is not stable.
        return ~(np.max(_amplifications(steps, np.array(derivatives)), axis=-1) <= allowed)

    smallest = 0.01 / (1.0 + damping_ratio + drag) / max(1.0, 0.01 * math.sqrt(gamma_dx2))
    if smallest == 0.0:
        return 0.0
    # No order is stable at the last step.
    steps = np.append(0.0, np.geomspace(smallest, 8.0, 160))
    for _ in range(ROUNDS):
        # The last step is known to be unstable, even where rounding hides it now.
        first = int(np.argmax(np.append(unstable(steps[1:-1]), True)))
        steps = np.linspace(steps[first], steps[first + 1], PARTS + 1)
    return float(steps[0])


def _amplifications(steps: np.ndarray, derivatives: np.ndarray) -> np.ndarray:
    """Amplification of each mode by each step, shape (steps, modes)."""
    degrees = np.arange(len(derivatives))
    factorials = [math.factorial(k) for k in degrees]
    powers = np.asarray(steps, dtype=float)[:, None] ** degrees / factorials
    slip = np.tensordot(powers, derivatives, 1)
    velocity = np.tensordot(powers[:, :-1], derivatives[1:], 1)
    half_trace = 0.5 * (slip[:, 0] + velocity[:, 1])
    product = slip[:, 0] * velocity[:, 1] - slip[:, 1] * velocity[:, 0]
    # This is half_trace^2 - product, which would cancel for a mode that drag alone slows down.
    difference = (0.5 * (slip[:, 0] - velocity[:, 1])) ** 2 + slip[:, 1] * velocity[:, 0]
    # The two eigenvalues are real, or complex with equal absolute values.
    real = np.abs(half_trace) + np.sqrt(np.maximum(difference, 0.0))
    return np.where(difference >= 0.0, real, np.sqrt(np.maximum(product, 0.0)))
