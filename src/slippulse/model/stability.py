"""Largest time steps that are stable and accurate on a sliding lattice.

In a lattice of sliding blocks with leaf springs and damping, each wave (mode) evolves by itself. A
step is stable if it amplifies no mode. For symplectic Euler this condition has a closed form. For a
Taylor step, `_taylor_bound` searches for the shortest step that amplifies a mode. It scans steps
from short to long, and then divides the interval that contains the bound into smaller and smaller
parts.
"""

import math
from functools import lru_cache

import numpy as np

# A step may amplify a mode by a factor of at most 1 plus one of these numbers. The first number
# allows for rounding. The second is for the orders 5 and 6, whose Taylor polynomials amplify an
# undamped mode slightly at every step size.
ROUNDING_GROWTH = 1e-12
WEAK_GROWTH = 1e-4
WEAKLY_UNSTABLE_ORDERS = (5, 6)
# A step is chosen to be at most this fraction of the stability bound. Simulations agree with the
# bound to one per cent.
STABILITY_MARGIN = 0.9
# The error of a Taylor step may be this fraction of the amplitude of the fastest mode. The error of
# front speeds is then below 1e-3, for levels of 0.2 to 0.8 and beta/dx up to 100. This condition is
# stricter than stability only if damping is strong.
MAX_STEP_ERROR = 1e-2
# The search for the bound divides the remaining interval into this many parts in each round.
SEARCH_ROUNDS, PARTS_PER_ROUND = 5, 32


def largest_step(
    scheme: str, order: int, damping_ratio: float, gamma_dx2: float, alpha_dx: float = 0.0
) -> float:
    """Return the largest stable time step, in units of dx.

    In these units, a mode of the lattice has stiffness s + gamma dx^2 and damping rate
    b s + alpha dx. Here b = beta/dx, and s is between 0 for the longest mode and 4 for the
    shortest. The bound depends on the scheme:

    - "fixed_step" (symplectic Euler): dt <= sqrt(dt_c^2 + c^2) - c, where
      dt_c = 2/sqrt(4 + gamma dx^2) and c = b + alpha dx/4;
    - "localised" (Taylor step of ``order`` in velocity and ``order`` + 1 in slip): the step may
      amplify no mode; 0 if the polynomials overflow;
    - "continuum": infinite, since there are no steps.

    damping_ratio : b = beta/dx
    gamma_dx2 : gamma dx^2
    alpha_dx : alpha dx, where alpha is the largest derivative of friction by slip velocity
    """
    if scheme == "continuum":
        return math.inf
    # If alpha is negative, slip grows physically, and the step need not prevent that.
    drag = max(alpha_dx, 0.0)
    if scheme == "fixed_step":
        # Here critical is dt_c, and damping is c. The form sqrt(dt_c^2 + c^2) - c loses digits at
        # large damping; the equal form below does not.
        critical = 2.0 / math.sqrt(4.0 + gamma_dx2)
        damping = damping_ratio + 0.25 * drag
        return critical**2 / (math.hypot(critical, damping) + damping)
    # The results of `_taylor_bound` are cached, and rounded arguments find one more often.
    rounded = [float(f"{value:.6g}") for value in (damping_ratio, gamma_dx2, drag)]
    return _taylor_bound(order, *rounded)


def accurate_step(
    error: float, order: int, damping_ratio: float, gamma_dx2: float, alpha_dx: float = 0.0
) -> float:
    """Return the largest Taylor step, in units of dx, with at most a given relative error.

    The error is estimated by the first omitted term of the Taylor series of the fastest mode. This
    term is (r dt)^(order + 1)/(order + 1)!, where r is the rate at which the mode changes. For a
    mode of stiffness k and damping rate 2c, this rate is sqrt(k). If the mode is overdamped
    (c^2 > k), it is c + sqrt(c^2 - k).

    damping_ratio, gamma_dx2, alpha_dx : beta/dx, gamma dx^2 and alpha dx, as in `largest_step`
    """
    # The shortest mode is the fastest. In units of dx, this mode has k = 4 + gamma dx^2 and
    # 2c = 4 beta/dx + alpha dx. Here frequency is sqrt(k), and half_damping is c.
    frequency = math.sqrt(4.0 + gamma_dx2)
    half_damping = 2.0 * damping_ratio + 0.5 * max(alpha_dx, 0.0)
    # This is sqrt(c^2 - k), or 0 if it is imaginary, written so that the squares do not overflow.
    root = math.sqrt(max(half_damping - frequency, 0.0)) * math.sqrt(half_damping + frequency)
    largest_rate = max(half_damping, frequency) + root
    return (error * math.factorial(order + 1)) ** (1.0 / (order + 1)) / largest_rate


def choose_step(scheme: str, order: int, *ratios: float) -> float:
    """Return the longest step, in units of dx, that is accurate, and stable with a margin.

    order : order of a Taylor step; other schemes do not use it
    ratios : beta/dx, gamma dx^2 and, optionally, alpha dx (see `largest_step`)
    """
    stable = STABILITY_MARGIN * largest_step(scheme, order, *ratios)
    # The localised scheme takes Taylor steps. The others have no condition for accuracy.
    if scheme != "localised":
        return stable
    return min(stable, accurate_step(MAX_STEP_ERROR, order, *ratios))


@lru_cache(maxsize=4096)
@np.errstate(over="ignore", invalid="ignore")
def _taylor_bound(order: int, damping_ratio: float, gamma_dx2: float, drag: float) -> float:
    """Return the largest stable Taylor step, in units of dx; 0 if the polynomials overflow.

    Steps are tried from short to long. The bound lies between the first unstable step and the step
    before it, and this interval is divided further in the same way.

    drag : alpha dx, not negative
    """
    # In units of dx, each mode has a number s, stiffness s + gamma dx^2 and damping rate
    # (beta/dx) s + alpha dx. From the longest mode to the shortest one, s grows from 0 to 4.
    s = np.linspace(0.0, 4.0, 101)
    derivatives = _mode_derivatives(
        order, stiffness=s + gamma_dx2, damping=damping_ratio * s + drag
    )
    # Some orders amplify undamped modes slightly at every step size. This weak growth is allowed.
    max_amplification = 1.0 + (WEAK_GROWTH if order in WEAKLY_UNSTABLE_ORDERS else ROUNDING_GROWTH)
    # The shortest step that is tried is so small that it is usually stable, also with strong
    # damping or stiff leaf springs: it is not longer than 1/damping_ratio, 1/drag and
    # 1/sqrt(gamma_dx2), the times in which the fastest mode changes. If it is unstable, the bound
    # lies between 0 and it.
    shortest = 0.01 / (1.0 + damping_ratio + drag) / max(1.0, 0.01 * math.sqrt(gamma_dx2))
    if shortest == 0.0:
        return 0.0
    # The longest of these steps is unstable at every order.
    steps = np.append(0.0, np.geomspace(shortest, 8.0, 160))
    for _ in range(SEARCH_ROUNDS):
        # The first step is stable and the last one is unstable. They are not tested again, since
        # rounding may make the last one look stable.
        largest_of_modes = np.max(_amplifications(steps[1:-1], derivatives), axis=1)
        # Written with ~ so that an amplification of NaN counts as unstable.
        is_unstable = [False, *~(largest_of_modes <= max_amplification), True]
        first_unstable = is_unstable.index(True)
        steps = np.linspace(steps[first_unstable - 1], steps[first_unstable], PARTS_PER_ROUND + 1)
    return float(steps[0])


def _mode_derivatives(order: int, stiffness: np.ndarray, damping: np.ndarray) -> np.ndarray:
    """Return the time derivatives of the slip of each mode, in an array (order + 2, 2, modes).

    Each derivative is a linear combination of the slip and the velocity at the start of a step. The
    second axis of the array holds the two coefficients.

    stiffness, damping : stiffness and damping rate of each mode
    """
    ones, zeros = np.ones_like(stiffness), np.zeros_like(stiffness)
    slip, velocity = np.array([ones, zeros]), np.array([zeros, ones])
    derivatives = [slip, velocity]
    # A mode obeys d2u/dt2 = -stiffness u - damping du/dt. Each derivative of this equation gives
    # the next derivative of u from the two before it.
    for _ in range(order):
        derivatives.append(-stiffness * derivatives[-2] - damping * derivatives[-1])
    return np.array(derivatives)


def _amplifications(steps: np.ndarray, derivatives: np.ndarray) -> np.ndarray:
    """Return the factor by which each step amplifies each mode, in an array (steps, modes).

    A step maps the slip and the velocity of a mode to new ones by a matrix of 2 x 2 numbers. Its
    larger eigenvalue, in absolute value, is the amplification.

    derivatives : derivative k of the slip of each mode, as the two coefficients of the slip and the
        velocity at the start of the step; array of shape (derivatives, 2, modes)
    """
    degrees = np.arange(len(derivatives))
    factorials = [math.factorial(k) for k in degrees]
    # The factors dt^k/k! of the Taylor series, for each step.
    factors = np.asarray(steps, dtype=float)[:, None] ** degrees / factorials
    # The sum over k of dt^k/k! times derivative k gives the new slip, and the same sum over the
    # next derivatives gives the new velocity. Both are arrays of shape (steps, 2, modes).
    slip = np.tensordot(factors, derivatives, 1)
    velocity = np.tensordot(factors[:, :-1], derivatives[1:], 1)
    # The matrix is ((a, b), (c, d)).
    a, b = slip[:, 0], slip[:, 1]
    c, d = velocity[:, 0], velocity[:, 1]
    half_trace = 0.5 * (a + d)
    determinant = a * d - b * c
    # The discriminant equals half_trace^2 - determinant. That form would lose digits for a mode
    # that feels drag but no springs.
    discriminant = (0.5 * (a - d)) ** 2 + b * c
    larger_real_eigenvalue = np.abs(half_trace) + np.sqrt(np.maximum(discriminant, 0.0))
    # Two complex eigenvalues have the same absolute value.
    complex_eigenvalue = np.sqrt(np.maximum(determinant, 0.0))
    return np.where(discriminant >= 0.0, larger_real_eigenvalue, complex_eigenvalue)
