"""Largest time steps that are stable and accurate on a sliding lattice.

In a lattice of sliding blocks with leaf springs and damping, each wave (mode) evolves by itself. A
step is stable if it amplifies no mode. For symplectic Euler this condition has a closed form. For a
Taylor step, `_taylor_bound` computes the amplification of each mode from the step's polynomial and
searches for the shortest step that amplifies one: it scans steps from short to long, and then
divides the interval that contains the bound into smaller and smaller parts.
"""

import math
from functools import lru_cache

import numpy as np

# A step may amplify a mode by at most 1 plus one of these numbers. The first allows for rounding.
# The second is for the orders 5 and 6, whose Taylor polynomials amplify an undamped mode slightly
# at every step size.
ROUNDING_GROWTH = 1e-12
WEAK_GROWTH = 1e-4
WEAKLY_UNSTABLE_ORDERS = (5, 6)
# A step is chosen to be at most this fraction of the stability bound. Simulations agree with the
# bound to one per cent.
STABILITY_MARGIN = 0.9
# The error of a Taylor step may be this fraction of the amplitude of the fastest mode. The error of
# front speeds is then below 1e-3 (for levels of 0.2 to 0.8 and beta/dx up to 100). The step that it
# allows is shorter than the stable step only if damping is strong.
MAX_STEP_ERROR = 1e-2
# The search for the bound divides the remaining interval into this many parts in each round.
SEARCH_ROUNDS, PARTS_PER_ROUND = 5, 32


def largest_step(
    scheme: str, order: int, damping_ratio: float, gamma_dx2: float, alpha_dx: float = 0.0
) -> float:
    """Return the largest stable time step, in units of dx.

    In these units a mode of the lattice has stiffness s + gamma dx^2 and damping rate
    b s + alpha dx, where b = beta/dx and s lies in [0, 4]. Symplectic Euler ("fixed_step") is
    stable for dt <= sqrt(dt_c^2 + c^2) - c, where dt_c = 2/sqrt(4 + gamma dx^2) and
    c = b + alpha dx/4. A Taylor step ("localised") expands velocity to ``order`` and slip to one
    order more; it is stable if it amplifies no mode. The bound is infinite for "continuum", which
    has no steps, and 0 if the polynomials overflow.
    """
    if scheme == "continuum":
        return math.inf
    # Where alpha < 0 slip grows physically, and the step need not prevent that.
    drag = max(alpha_dx, 0.0)
    if scheme == "fixed_step":
        critical = 2.0 / math.sqrt(4.0 + gamma_dx2)
        # The form sqrt(dt_c^2 + c^2) - c loses digits at large damping; this equal form does not.
        damping = damping_ratio + 0.25 * drag
        return critical**2 / (math.sqrt(critical**2 + damping**2) + damping)
    rounded = [float(f"{value:.6g}") for value in (damping_ratio, gamma_dx2, drag)]
    return _taylor_bound(order, *rounded)


def accurate_step(
    error: float, order: int, damping_ratio: float, gamma_dx2: float, alpha_dx: float = 0.0
) -> float:
    """Return the largest Taylor step, in units of dx, with at most a given relative error.

    The error is estimated by the first omitted term of the Taylor series of a mode,
    (r dt)^(order + 1)/(order + 1)!. Here r is the largest rate at which a mode changes. For a mode
    of stiffness k and damping rate 2c it is sqrt(k), or c + sqrt(c^2 - k) if the mode is
    overdamped (c^2 > k).
    """
    frequency = math.sqrt(4.0 + gamma_dx2)
    half_damping = 2.0 * damping_ratio + 0.5 * max(alpha_dx, 0.0)
    # This is sqrt(c^2 - k), written so that the squares do not overflow.
    root = math.sqrt(max(half_damping - frequency, 0.0)) * math.sqrt(half_damping + frequency)
    largest_rate = max(half_damping, frequency) + root
    return (error * math.factorial(order + 1)) ** (1.0 / (order + 1)) / largest_rate


def choose_step(scheme: str, order: int, *ratios: float) -> float:
    """Return the longest step, in units of dx, that is accurate, and stable with a margin.

    The ratios are beta/dx, gamma dx^2 and, optionally, alpha dx.
    """
    stable = STABILITY_MARGIN * largest_step(scheme, order, *ratios)
    if scheme != "localised":
        return stable
    return min(stable, accurate_step(MAX_STEP_ERROR, order, *ratios))


@lru_cache(maxsize=4096)
@np.errstate(over="ignore", invalid="ignore")
def _taylor_bound(order: int, damping_ratio: float, gamma_dx2: float, drag: float) -> float:
    """Return the largest stable Taylor step, in units of dx; 0 if the polynomials overflow."""
    modes = np.linspace(0.0, 4.0, 101)
    stiffness, damping = modes + gamma_dx2, damping_ratio * modes + drag
    # Each time derivative of a mode's slip is a linear combination of the slip and the velocity at
    # the start of the step. An array of shape (2, modes) holds the two coefficients.
    derivatives = [np.outer(start, np.ones_like(modes)) for start in np.eye(2)]
    for _ in range(order):
        derivatives.append(-stiffness * derivatives[-2] - damping * derivatives[-1])
    allowed = 1.0 + (WEAK_GROWTH if order in WEAKLY_UNSTABLE_ORDERS else ROUNDING_GROWTH)

    def are_unstable(steps: np.ndarray) -> np.ndarray:
        """Return a mask of the steps that amplify a mode by more than is allowed."""
        largest = np.max(_amplifications(steps, np.array(derivatives)), axis=-1)
        # Written with ~ so that an amplification of NaN counts as unstable.
        return ~(largest <= allowed)

    # The shortest step that is tried. If it is unstable, the bound lies between 0 and this step.
    smallest = 0.01 / (1.0 + damping_ratio + drag) / max(1.0, 0.01 * math.sqrt(gamma_dx2))
    if smallest == 0.0:
        return 0.0
    # The longest of these steps is unstable at every order.
    steps = np.append(0.0, np.geomspace(smallest, 8.0, 160))
    for _ in range(SEARCH_ROUNDS):
        # The last step is known to be unstable from the round before. It is not tested again, since
        # rounding may make it look stable.
        last_stable = int(np.argmax(np.append(are_unstable(steps[1:-1]), True)))
        steps = np.linspace(steps[last_stable], steps[last_stable + 1], PARTS_PER_ROUND + 1)
    return float(steps[0])


def _amplifications(steps: np.ndarray, derivatives: np.ndarray) -> np.ndarray:
    """Return the factor by which each step amplifies each mode, in an array (steps, modes).

    A step maps the slip and the velocity of a mode to new ones by a matrix of 2 x 2 numbers. Its
    larger eigenvalue, in absolute value, is the amplification.

    derivatives : array of shape (orders, 2, modes), see `_taylor_bound`
    """
    degrees = np.arange(len(derivatives))
    factorials = [math.factorial(k) for k in degrees]
    # The terms dt^k/k! of the Taylor series, for each step.
    powers = np.asarray(steps, dtype=float)[:, None] ** degrees / factorials
    slip = np.tensordot(powers, derivatives, 1)
    velocity = np.tensordot(powers[:, :-1], derivatives[1:], 1)
    half_trace = 0.5 * (slip[:, 0] + velocity[:, 1])
    determinant = slip[:, 0] * velocity[:, 1] - slip[:, 1] * velocity[:, 0]
    # The discriminant equals half_trace^2 - determinant. That form would lose digits for a mode
    # that feels drag but no springs.
    discriminant = (0.5 * (slip[:, 0] - velocity[:, 1])) ** 2 + slip[:, 1] * velocity[:, 0]
    # If it is negative, the two eigenvalues are complex and have equal absolute values.
    real = np.abs(half_trace) + np.sqrt(np.maximum(discriminant, 0.0))
    complex_pair = np.sqrt(np.maximum(determinant, 0.0))
    return np.where(discriminant >= 0.0, real, complex_pair)
