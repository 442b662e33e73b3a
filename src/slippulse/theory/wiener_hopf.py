"""The Wiener-Hopf factor of a front on the lattice, with leaf springs and damping.

In the frame of a front of speed v, the equation of motion has two unknowns: the slip behind the
front, and the stress ahead of it. Its Fourier transform is one equation for both. The method of
Wiener and Hopf solves it by splitting the symbol M(k) of the equation into two factors. One has
neither zeros nor poles in the upper half plane of k, and the other one has none in the lower half
plane. (See Slepyan, Models and Phenomena in Fracture Mechanics, for fronts on lattices.) The value
of the first factor at k = 0 gives the pre-stress of the front.

The unit of length is the block spacing. Let w = v k and S(k) = 4 sin^2(k/2). b = beta/dx is the
damping ratio. Leaf springs enter by g = gamma dx^2 (`gamma_dx2` in the functions below), and drag
by a = alpha dx (`alpha_dx`). The symbol is

    M(k) = 1 - [S(k) (1 + i b w) + g + i a w]/w^2 = M_+(k) M_-(k),

where M_+ is analytic and without zeros for Im k > 0. M is an exact product of an algebraic function
and two factors that decay on opposite sides of the real axis,

    M = -((r + q)/w)^2 (1 - rho e^{ik}) (1 - rho e^{-ik}),   rho = (r - q)/(r + q),
    r = sqrt(1 + i b w - (w^2 - g - i a w)/4),   q = (i/2) sqrt(w^2 - g - i a w).

An integration contour C passes below the branch points of r and q, and below the zeros of M that
belong to waves radiated behind the front. (At a = 0 the branch points of q are w = +-sqrt(g). By
causality C passes below the waves, since damping moves them up. For a < 0 waves grow behind the
front, and C leaves 0 more steeply.) Then every factor except 1 - rho e^{ik} is analytic and without
zeros below C. Closing C downwards leaves

    ln M_+(k) = 1/(2 pi i) Int_C ln(1 - rho(z) e^{iz}) dz/(z - k).

The right half of C (the left half is its mirror image):

    Im z |                     / leg: upwards at 60 degrees,
         |                    /  where e^{iz} decays
    -----0-------------------/---- Re z
         | ` - .            /
         |       ` - .     /
         |             ` -/  ray: at CONTOUR_ANGLE below the axis,
         |                   up to the distance CONTOUR_REACH

Since nothing oscillates on the legs, no tail of the integral is left, whatever b is. At b = 1 and
g = 0 the root r is 1 + i w/2, and the factor has a closed form,

    M_+(k) = (1 + i v k - e^{ik})/(i v k),   hence   M_+(0) = 1 - 1/v.

For g = 0 only the ratio to this closed form is integrated.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

# Gauss-Legendre nodes and weights of each panel.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(14)
# The contour leaves 0 at this angle below the real axis, away from branch points and waves above
# it. Its ray ends beyond the farthest of them, |k| <= pi, and before the zeros of M below the axis,
# Re k > pi.
CONTOUR_ANGLE = 0.5
CONTOUR_REACH = 3.5
# Edges of the panels on its leg, which rises at 60 degrees to where e^{-Im z} is 1e-14.
LEG_EDGES = np.array([0.0, 1.2, 3.0, 7.0, 14.0, 24.0, 38.0])
LEG_DIRECTION = np.exp(1j * np.pi / 3.0)
# Length of the panels along the ray, in ln |z|.
LOG_PANEL_LENGTH = 0.9
# Arguments below which differences of nearly equal numbers are computed from their series.
SERIES_LIMIT = 0.5
ARTANH_SERIES_LIMIT = 0.1


class Contour(NamedTuple):
    """The right half of the contour: nodes z, weights dz, e^{iz} - 1, and e^{iz} - 1 - i z."""

    z: np.ndarray
    weight: np.ndarray
    exp_minus_1: np.ndarray
    exp_minus_2_terms: np.ndarray


class Roots(NamedTuple):
    """The functions q and r of the module docstring at the nodes, [front, node]."""

    q: np.ndarray
    r: np.ndarray


def log_prestress(
    excess_speed: np.ndarray,
    damping_ratio: np.ndarray,
    gamma_dx2: float = 0.0,
    release: str = "total",
    alpha_dx: float = 0.0,
) -> np.ndarray:
    """Return ln tau_0 of steady fronts of speeds v.

    The arrays excess_speed, v - 1, and damping_ratio, b = beta/dx, have one element for each front.
    gamma_dx2 is g = gamma dx^2 (leaf springs), and alpha_dx is alpha dx (drag). Speeds are above 1,
    or at least 1 with leaf springs, and at least sqrt(4 + g)/pi, the speed of the shortest waves.
    Drag requires leaf springs, and is above -2 sqrt(g (1 - 1/v^2)), below which slip runs away.

    Under the release rule "total" the pre-stress is tau_0 = M_+(0), and under "elastic" it is
    M_+(0)/M_+(i/(b v)), where M_+ is the Wiener-Hopf factor of the front. Both formulas hold with
    leaf springs as without: a block ahead of the front has not slipped, so that its leaf spring is
    relaxed.
    """
    contour, angle = _choose_contour(
        excess_speed, damping_ratio=damping_ratio, gamma_dx2=gamma_dx2, alpha_dx=alpha_dx
    )
    log_values = log_factor(
        contour,
        excess_speed=excess_speed[:, None],
        damping_ratio=damping_ratio[:, None],
        gamma_dx2=gamma_dx2,
        alpha_dx=alpha_dx,
    )
    # ln M_+(0) is the integral of ln(1 - rho e^{iz})/z divided by 2 pi i. If the right half of the
    # contour contributes I to the integral, its mirror image on the left contributes minus the
    # complex conjugate of I. The sum is 2 i Im I, and Im I/pi after the division.
    log_tau = (log_values @ (contour.weight / contour.z)).imag / np.pi
    if gamma_dx2 > 0.0:
        # The integrand has a pole at z = 0, where the two halves of the contour meet. A small arc
        # below 0 joins them. Its angle is pi - 2 angle, so the pole adds this fraction of 2 pi
        # times its residue, ln(1 - rho) at q = sqrt(g)/2 and r = sqrt(1 + g/4).
        q_at_0 = 0.5 * np.sqrt(gamma_dx2)
        log_at_0 = np.log(2.0 * q_at_0 / (np.sqrt(1.0 + q_at_0**2) + q_at_0))
        log_tau = (0.5 - angle / np.pi) * log_at_0 + log_tau
    else:
        # Without leaf springs `log_factor` leaves out the logarithm at b = 1. For it, the exact
        # M_+(0) = 1 - 1/v = (v - 1)/v is added.
        log_tau += np.log(excess_speed / (1.0 + excess_speed))
    if release == "elastic" and np.any(damping_ratio > 0.0):
        log_at_iy = _log_m_plus_at_iy(
            contour,
            log_values=log_values,
            excess_speed=excess_speed,
            damping_ratio=damping_ratio,
            gamma_dx2=gamma_dx2,
        )
        # Without damping ln M_+(i/(b v)) is 0, so that both rules are the same.
        log_tau -= np.where(damping_ratio > 0.0, log_at_iy, 0.0)
    return log_tau


def _log_m_plus_at_iy(
    contour: Contour,
    log_values: np.ndarray,
    excess_speed: np.ndarray,
    damping_ratio: np.ndarray,
    gamma_dx2: float,
) -> np.ndarray:
    """Return ln M_+(i y) of each front, where y = 1/(b v) and b is the damping ratio.

    The result is the integral of ln(1 - rho e^{iz})/(z - i y) along the contour, divided by 2 pi i.
    log_values, the result of `log_factor`, are the values of this logarithm at the nodes.
    excess_speed is v - 1.
    """
    # Without damping, y is infinite. The caller does not use the result then, and the smallest
    # divisor only avoids an error.
    y = 1.0 / np.maximum(damping_ratio * (1.0 + excess_speed), 1e-300)
    z_minus_iy = contour.z - 1j * y[:, None]
    log_at_iy = np.sum(log_values * (contour.weight / z_minus_iy), axis=1).imag / np.pi
    if gamma_dx2 == 0.0:
        # Without leaf springs log_values leave out the logarithm at b = 1. For it, the exact
        # M_+(i y) = 1 - (1 - e^{-y})/(v y) is added.
        numerator = excess_speed * y + _exp_minus_two_terms(-y).real
        log_at_iy += np.log(numerator / ((1.0 + excess_speed) * y))
    return log_at_iy


def _choose_contour(
    excess_speed: np.ndarray, damping_ratio: np.ndarray, gamma_dx2: float, alpha_dx: float
) -> tuple[Contour, float]:
    """Return a contour that serves all fronts, and the angle of its ray below the real axis.

    The panel next to 0 is at most half as long as the smallest distance |z| from 0 at which a zero
    or a branch point of the symbol can lie. From there to CONTOUR_REACH, panels have equal lengths
    in ln |z|. excess_speed is v - 1.
    """
    # A lower bound of (1 + b) |w| at these points. It is 1 for the branch points of r. With leaf
    # springs, branch points of q may be nearer to 0: sqrt(g) or, with drag, g/|a|. Without leaf
    # springs, a zero of the symbol may be nearer to 0: v - 1.
    bound = np.minimum(np.sqrt(gamma_dx2) if gamma_dx2 > 0.0 else excess_speed, 1.0)
    if alpha_dx:
        bound = min(bound, gamma_dx2 / abs(alpha_dx))
    # The same bound for |z|, because w is v z.
    smallest_z = np.min(bound / ((1.0 + damping_ratio) * (1.0 + excess_speed)))
    panel_count = int(np.ceil(np.log(2.0 * CONTOUR_REACH / smallest_z) / LOG_PANEL_LENGTH))
    angle = _contour_angle(excess_speed, gamma_dx2, alpha_dx)
    return make_contour(panel_count, angle), angle


def _contour_angle(excess_speed: np.ndarray, gamma_dx2: float, alpha_dx: float) -> float:
    """Return the angle below the real axis at which the contour leaves 0.

    If alpha_dx < 0, friction falls with slip velocity, and waves grow behind the front. The contour
    must then pass below the zeros of the symbol that belong to these waves. It leaves 0 halfway
    between the zeros of the slowest front and the imaginary axis, but at least at CONTOUR_ANGLE.
    """
    if alpha_dx >= 0.0:
        return CONTOUR_ANGLE
    slowest = float(np.min(excess_speed))
    # The sine of the angle of these zeros below the real axis, -a v/(2 sqrt(g (v^2 - 1))), where
    # v^2 - 1 is written in terms of v - 1.
    sine = -0.5 * alpha_dx * (1.0 + slowest) / np.sqrt(gamma_dx2 * slowest * (2.0 + slowest))
    halfway = 0.5 * (np.arcsin(min(sine, 1.0)) + 0.5 * np.pi)
    return max(CONTOUR_ANGLE, halfway)


def log_factor(
    contour: Contour,
    excess_speed: np.ndarray,
    damping_ratio: np.ndarray,
    gamma_dx2: float,
    alpha_dx: float,
) -> np.ndarray:
    """Return the logarithm of 1 - rho e^{iz}, a factor of the symbol, at the nodes: [front, node].

    Without leaf springs it is the difference from the logarithm at the damping ratio b = 1, where
    the factor has a closed form. excess_speed, v - 1, and damping_ratio are columns with one row
    for each front. The symbols z, q, r, w, rho and b are those of the module docstring.
    """
    z = contour.z
    iw = 1j * z * (1.0 + excess_speed)
    q, r = q_and_r(iw, damping_ratio=damping_ratio, gamma_dx2=gamma_dx2, alpha_dx=alpha_dx)
    # 1 - rho e^{iz} = (1 - rho) - rho (e^{iz} - 1), where 1 - rho = 2 q/(r + q) and
    # rho = (1 + i b w)/(r + q)^2.
    r_plus_q = r + q
    rho = (1.0 + damping_ratio * iw) / r_plus_q**2
    factor = 2.0 * q / r_plus_q - rho * contour.exp_minus_1
    # Near z = 0 the two terms cancel as v -> 1. There 1 - e^{i z + ln rho} is computed instead.
    is_small = (np.abs(q / r) < SERIES_LIMIT) & (np.abs(z) < SERIES_LIMIT)
    is_close = is_small & (excess_speed < 1.0)
    if np.any(is_close):
        # The first nodes are the nearest to 0. Those after the last close one are left out.
        close_count = int(np.flatnonzero(is_close.any(axis=0))[-1]) + 1
        first_nodes = np.s_[:, :close_count]
        exponent = _exponent_near_zero(
            z[:close_count],
            iw=iw[first_nodes],
            roots=Roots(q[first_nodes], r[first_nodes]),
            is_close=is_close[first_nodes],
            excess_speed=excess_speed,
            damping_ratio=damping_ratio,
            gamma_dx2=gamma_dx2,
            alpha_dx=alpha_dx,
        )
        factor[first_nodes] = np.where(
            is_close[first_nodes], -np.expm1(exponent), factor[first_nodes]
        )
    if gamma_dx2 > 0.0:
        return fast_log(factor)
    # At b = 1 the factor is [i z (v - 1) - (e^{iz} - 1 - i z)]/(1 + i w).
    factor_at_b_1 = (1j * excess_speed * z - contour.exp_minus_2_terms) / (1.0 + iw)
    return fast_log(factor / factor_at_b_1)


def _exponent_near_zero(
    z: np.ndarray,
    iw: np.ndarray,
    roots: Roots,
    is_close: np.ndarray,
    excess_speed: np.ndarray,
    damping_ratio: np.ndarray,
    gamma_dx2: float,
    alpha_dx: float,
) -> np.ndarray:
    """Return i z + ln rho at nodes z near 0, computed without cancellation, and 0 at other nodes.

    is_close is True at the nodes near 0. With h = q/r, ln rho is -2 artanh h. So the result is
    (i z - 2 h) - 2 (artanh h - h). With w = v z (iw is i w), g = gamma_dx2, a = alpha_dx, and
    W = sqrt(w^2 - g - i a w) = -2 i q, the first bracket is i times

        lag = z - W/r = (z - w) + (w - W) + W (r - 1)/r.
    """
    q, r = roots
    w_reduced = -2j * q
    # r - 1 = (r^2 - 1)/(r + 1), and r^2 = 1 + i b w - W^2/4.
    r_minus_1 = (damping_ratio * iw - 0.25 * w_reduced**2) / (r + 1.0)
    lag = -excess_speed * z + w_reduced * r_minus_1 / r
    if gamma_dx2 > 0.0:
        # w - W = (w^2 - W^2)/(w + W).
        lag = lag + (gamma_dx2 + alpha_dx * iw) / (-1j * iw + w_reduced)
    h = np.where(is_close, q / r, 0.0)
    # artanh h - h is computed from its series if h is small.
    square, is_large = h * h, np.abs(h) >= ARTANH_SERIES_LIMIT
    artanh_minus_h = h * square * _ARTANH_SERIES(square)
    artanh_minus_h[is_large] = np.arctanh(h[is_large]) - h[is_large]
    return np.where(is_close, 1j * lag - 2.0 * artanh_minus_h, 0.0)


def fast_log(z: np.ndarray) -> np.ndarray:
    """Return the logarithm of complex numbers, in a fifth of the time of `np.log`."""
    return np.log(np.abs(z)) + 1j * np.arctan2(z.imag, z.real)


def q_and_r(iw: np.ndarray, damping_ratio: np.ndarray, gamma_dx2: float, alpha_dx: float) -> Roots:
    """Return the square roots q and r of the module docstring at given values of i w.

    4 q^2 and 4 r^2 are quadratic polynomials in i w. Each square root is computed as the product of
    the square roots of two linear factors. Its branch cuts then run straight up from the branch
    points in the plane of w. The factors are

        4 r^2 = (i w)^2 + (4 b + a) i w + 4 + g = (i w + c_1)(i w + c_2),
        4 q^2 = (i w)^2 + a i w + g             = (i w + d_1)(i w + d_2).
    """
    # c_1 and c_2 are m +- sqrt(m^2 - c_1 c_2), where m is their mean.
    mean = 2.0 * (damping_ratio + 0.25 * alpha_dx)
    product = 4.0 + gamma_dx2
    discriminant = mean**2 - product
    are_real = discriminant >= 0.0
    root = np.sqrt(np.abs(discriminant))
    c_1 = mean + np.where(are_real, root, 1j * root)
    # If both are real, the smaller one follows from the product without cancellation. Otherwise c_1
    # is replaced by 1 in the quotient, which is then not used.
    divisor = np.where(are_real, c_1.real, 1.0)
    c_2 = np.where(are_real, product / divisor, np.conj(c_1))
    r = 0.5 * np.sqrt(c_1 + iw) * np.sqrt(c_2 + iw)
    if gamma_dx2 == 0.0:
        # Drag is computed only together with leaf springs. So a = 0, and 4 q^2 = (i w)^2.
        return Roots(0.5 * iw, r)
    # d_1 and d_2 are a/2 -+ this root.
    root_of_q = np.sqrt(complex(0.25 * alpha_dx**2 - gamma_dx2))
    q = 0.5 * np.sqrt(iw + 0.5 * alpha_dx - root_of_q) * np.sqrt(iw + 0.5 * alpha_dx + root_of_q)
    return Roots(q, r)


@lru_cache(maxsize=32)
def make_contour(panel_count: int, angle: float) -> Contour:
    """Return the right half of the contour: its ray and its leg.

    The ray leaves 0 at an angle below the real axis. It has one panel next to 0, and then
    panel_count panels of equal length in ln |z|. The leg rises from the end of the ray, the corner.
    """
    log_edges = np.log(CONTOUR_REACH) - LOG_PANEL_LENGTH * np.arange(panel_count, -1.0, -1.0)
    log_distance, log_weight = _gauss_legendre(log_edges)
    # On these panels dz = z d(ln z).
    distance = np.exp(log_distance)
    next_to_0, weight_next_to_0 = _gauss_legendre(np.array([0.0, np.exp(log_edges[0])]))
    leg, leg_weight = _gauss_legendre(LEG_EDGES)
    ray_direction = np.exp(-1j * angle)
    corner = CONTOUR_REACH * ray_direction
    z = np.concatenate(
        [next_to_0 * ray_direction, distance * ray_direction, corner + leg * LEG_DIRECTION]
    )
    weight = np.concatenate(
        [
            weight_next_to_0 * ray_direction,
            distance * ray_direction * log_weight,
            leg_weight * LEG_DIRECTION,
        ]
    )
    return Contour(
        z=z,
        weight=weight,
        exp_minus_1=np.expm1(1j * z),
        exp_minus_2_terms=_exp_minus_two_terms(1j * z),
    )


def _gauss_legendre(edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the Gauss-Legendre nodes and weights of all panels between some edges."""
    half = 0.5 * np.diff(edges)[:, None]
    nodes = edges[:-1, None] + half * (1.0 + NODES)
    return nodes.ravel(), (half * WEIGHTS).ravel()


# Polynomials P in the series artanh h - h = h^3 P(h^2) and e^x - 1 - x = x^2 P(x), for small
# arguments.
_ARTANH_SERIES = np.polynomial.Polynomial([1.0 / (2 * n + 3) for n in range(8)])
_EXP_SERIES = np.polynomial.Polynomial(1.0 / np.cumprod(np.arange(1.0, 17.0))[1:])


def _exp_minus_two_terms(x: np.ndarray) -> np.ndarray:
    """Return e^x - 1 - x, computed without cancellation."""
    x = np.asarray(x, dtype=complex)
    is_small = np.abs(x) < SERIES_LIMIT
    small_x = np.where(is_small, x, 0.0)
    return np.where(is_small, small_x**2 * _EXP_SERIES(small_x), np.expm1(x) - x)
