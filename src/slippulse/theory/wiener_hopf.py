"""The Wiener-Hopf factor of a front on the lattice, with leaf springs and damping.

In the frame of a front at speed v, the equation of motion holds with unknown slip behind the front
and unknown stress ahead of it. Its Fourier transform is one equation for both unknowns. The method
of Wiener and Hopf solves it by writing the symbol M(k) of the equation as a product of two factors,
one without zeros and poles in the upper and one in the lower half plane of k. (See Slepyan, Models
and Phenomena in Fracture Mechanics, for fronts on lattices.) The factor at k = 0 gives the
pre-stress of the front.

In lattice units (w = v k, S(k) = 4 sin^2(k/2), b = beta/dx, g = gamma dx^2, a = alpha dx) the
symbol is the following M(k). The functions below call v - 1 the excess, b the ratio, g the springs
and a the drag.

    M(k) = 1 - [S(k) (1 + i b w) + g + i a w]/w^2 = M_+(k) M_-(k),

where M_+ is analytic and without zeros for Im k > 0. The symbol is an exact product of an algebraic
function and two factors that decay on opposite sides of the real axis,

    M = -((r + q)/w)^2 (1 - rho e^{ik}) (1 - rho e^{-ik}),   rho = (r - q)/(r + q),
    r = sqrt(1 + i b w - (w^2 - g - i a w)/4),   q = (i/2) sqrt(w^2 - g - i a w).

An integration contour C passes below the branch points of r and q, and below the waves that are
radiated behind the front. (At a = 0 the branch points of q are w = +-sqrt(g). The waves lie above C
by causality, since damping moves them up. For a < 0 waves grow behind the front, and C leaves 0
more steeply, below them.) Then every factor except 1 - rho e^{ik} is analytic and without zeros
below C. Closing C downwards leaves

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


class Nodes(NamedTuple):
    """Quadrature on the right half of the contour: z, dz, e^{iz} - 1 and e^{iz} - 1 - iz."""

    z: np.ndarray
    weight: np.ndarray
    exp_minus_1: np.ndarray
    exp_minus_2_terms: np.ndarray


class Roots(NamedTuple):
    """The functions q and r of the module docstring at some nodes."""

    q: np.ndarray
    r: np.ndarray


def log_prestress(
    excess_speed: np.ndarray,
    damping_ratio: np.ndarray,
    gamma_dx2: float = 0.0,
    release: str = "total",
    alpha_dx: float = 0.0,
) -> np.ndarray:
    """Return ln tau_0 of steady fronts at speeds v = 1 + excess.

    excess and ratio (beta/dx) have one dimension. excess is > 0, or >= 0 with leaf springs (springs
    = g = gamma dx^2), and v >= sqrt(4 + g)/pi. drag is a = alpha dx, which requires springs and is
    above -2 sqrt(g (1 - 1/v^2)). The release rule is "total", M_+(0) = tau_0, or "elastic",
    M_+(0)/M_+(i/(b v)) = tau_0. Both hold with leaf springs as without: a block ahead of the front
    has not slipped, so that its leaf spring is relaxed.
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
    # ln M_+(0): the two halves of the contour contribute complex conjugate integrals.
    log_tau = (log_values @ (contour.weight / contour.z)).imag / np.pi
    if gamma_dx2 > 0.0:
        # The factor 1 - rho at z = 0, where q = sqrt(g)/2 and r = sqrt(1 + g/4).
        q_at_0 = 0.5 * np.sqrt(gamma_dx2)
        log_at_0 = np.log(2.0 * q_at_0 / (np.sqrt(1.0 + q_at_0**2) + q_at_0))
        # The contour leaves 0 at an angle, so that the value at 0 contributes the rest of half a
        # residue.
        log_tau = (0.5 - angle / np.pi) * log_at_0 + log_tau
    else:
        # The closed form at b = 1, whose ratio to the factor has been integrated.
        log_tau += np.log(excess_speed / (1.0 + excess_speed))
    if release == "elastic" and np.any(damping_ratio > 0.0):
        # ln M_+ at k = i y, with y = 1/(b v). For b = 0 it is 0, so that both rules are the same.
        y = 1.0 / np.maximum(damping_ratio * (1.0 + excess_speed), 1e-300)
        distance = contour.z - 1j * y[:, None]
        log_at_iy = np.sum(log_values * (contour.weight / distance), axis=1).imag / np.pi
        if gamma_dx2 == 0.0:
            # The closed form at b = 1 is 1 - (1 - e^{-y})/(v y) there.
            numerator = excess_speed * y + _exp_minus_two_terms(-y).real
            log_at_iy += np.log(numerator / ((1.0 + excess_speed) * y))
        log_tau -= np.where(damping_ratio > 0.0, log_at_iy, 0.0)
    return log_tau


def _choose_contour(
    excess_speed: np.ndarray, damping_ratio: np.ndarray, gamma_dx2: float, alpha_dx: float
) -> tuple[Nodes, float]:
    """Return a contour that serves all fronts, and the angle of its ray below the real axis.

    Its panels begin at half of the smallest distance at which a zero or a branch point of M can lie
    from 0. From there to CONTOUR_REACH they have equal lengths in ln |z|.
    """
    # At a zero or branch point |w| is at least this divided by 1 + b. The limits are the branch
    # points of q (with leaf springs) or the zero of M next to 0 (without), and those of r.
    smallest_w = np.minimum(np.sqrt(gamma_dx2) if gamma_dx2 > 0.0 else excess_speed, 1.0)
    if alpha_dx:
        smallest_w = min(smallest_w, gamma_dx2 / abs(alpha_dx))
    # As w = v z, this is the smallest |z|.
    smallest_z = np.min(smallest_w / ((1.0 + damping_ratio) * (1.0 + excess_speed)))
    panels = int(np.ceil(np.log(2.0 * CONTOUR_REACH / smallest_z) / LOG_PANEL_LENGTH))
    angle = _contour_angle(excess_speed, gamma_dx2, alpha_dx)
    return nodes(panels, angle), angle


def _contour_angle(excess_speed: np.ndarray, gamma_dx2: float, alpha_dx: float) -> float:
    """Return the angle below the real axis at which the contour leaves 0.

    If waves grow behind the front (drag < 0), the contour must pass below them. It then leaves 0
    halfway between the waves of the slowest front and the imaginary axis, if that is steeper than
    CONTOUR_ANGLE.
    """
    if alpha_dx >= 0.0:
        return CONTOUR_ANGLE
    slowest = float(np.min(excess_speed))
    # The sine of the angle between the real axis and the growing waves, with v^2 - 1 written in
    # terms of v - 1.
    sine = -0.5 * alpha_dx * (1.0 + slowest) / np.sqrt(gamma_dx2 * slowest * (2.0 + slowest))
    halfway = 0.5 * (np.arcsin(min(sine, 1.0)) + 0.5 * np.pi)
    return max(CONTOUR_ANGLE, halfway)


def log_factor(
    contour: Nodes,
    excess_speed: np.ndarray,
    damping_ratio: np.ndarray,
    gamma_dx2: float,
    alpha_dx: float,
) -> np.ndarray:
    """Return ln(1 - rho e^{iz}) at the nodes, [front, node]; for g = 0 less its value at b = 1.

    excess and ratio are columns.
    """
    z = contour.z
    iw = 1j * z * (1.0 + excess_speed)
    q, r = roots(iw, damping_ratio=damping_ratio, gamma_dx2=gamma_dx2, alpha_dx=alpha_dx)
    # 1 - rho e^{iz} = (1 - rho) - rho (e^{iz} - 1), where rho = (r^2 - q^2)/(r + q)^2 and
    # r^2 - q^2 = 1 + i b w.
    r_plus_q = r + q
    rho = (1.0 + damping_ratio * iw) / r_plus_q**2
    factor = 2.0 * q / r_plus_q - rho * contour.exp_minus_1
    # Near 0 the two terms cancel as v -> 1.
    quotient = q / r
    is_close = (np.abs(quotient) < SERIES_LIMIT) & (np.abs(z) < SERIES_LIMIT) & (excess_speed < 1.0)
    if np.any(is_close):
        # Only the first nodes, up to the last one that is close for some front, are computed again.
        last = int(np.flatnonzero(is_close.any(axis=0))[-1]) + 1
        first_nodes = np.s_[:, :last]
        exponent = _exponent_near_zero(
            z[:last],
            iw=iw[first_nodes],
            q_and_r=Roots(q[first_nodes], r[first_nodes]),
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
        return log(factor)
    # The factor at b = 1, i z (v - 1) - (e^{iz} - 1 - i z), divided by 1 + i w.
    reference = (1j * excess_speed * z - contour.exp_minus_2_terms) / (1.0 + iw)
    return log(factor / reference)


def _exponent_near_zero(
    z: np.ndarray,
    iw: np.ndarray,
    q_and_r: Roots,
    is_close: np.ndarray,
    excess_speed: np.ndarray,
    damping_ratio: np.ndarray,
    gamma_dx2: float,
    alpha_dx: float,
) -> np.ndarray:
    """Return i z + ln rho near z = 0, computed without cancellation; 0 where it is not close.

    With h = q/r, ln rho is -2 artanh h, so that the exponent is i z - 2 h - 2 (artanh h - h). The
    first two terms are i times a small lag: with z = w/v and -2 i q = W = sqrt(w^2 - g - i a w),

        lag = -(v - 1) z + (w - W) + W (r - 1)/r.
    """
    q, r = q_and_r
    wave = -2j * q
    r_minus_1 = (damping_ratio * iw - 0.25 * wave**2) / (r + 1.0)
    lag = -excess_speed * z + wave * r_minus_1 / r
    if gamma_dx2 > 0.0:
        w_minus_wave = (gamma_dx2 + alpha_dx * iw) / (-1j * iw + wave)
        lag = lag + w_minus_wave
    h = np.where(is_close, q / r, 0.0)
    square, is_large = h * h, np.abs(h) >= ARTANH_SERIES_LIMIT
    artanh_minus_h = h * square * _ARTANH(square)
    artanh_minus_h[is_large] = np.arctanh(h[is_large]) - h[is_large]
    return np.where(is_close, 1j * lag - 2.0 * artanh_minus_h, 0.0)


def log(z: np.ndarray) -> np.ndarray:
    """Return the logarithm of complex numbers, in a fifth of the time of `np.log`."""
    return np.log(np.abs(z)) + 1j * np.arctan2(z.imag, z.real)


def roots(iw: np.ndarray, damping_ratio: np.ndarray, gamma_dx2: float, alpha_dx: float) -> Roots:
    """Return q and r (see the module docstring).

    Both are square roots of quadratic polynomials in i w, and are computed as products of the
    square roots of their linear factors, so that their branch cuts run straight up from the branch
    points. With c = b + a/4, 4 r^2 = (i w)^2 + 4 c i w + 4 + g = (i w + c_1)(i w + c_2), where
    c_1 and c_2 are 2 c +- sqrt(4 c^2 - 4 - g).
    """
    product = 4.0 + gamma_dx2
    half_sum = 2.0 * (damping_ratio + 0.25 * alpha_dx)
    discriminant = 4.0 * (damping_ratio + 0.25 * alpha_dx) ** 2 - product
    are_real = discriminant >= 0.0
    root = np.sqrt(np.abs(discriminant))
    c_1 = half_sum + np.where(are_real, root, 1j * root)
    # The smaller real one follows from the product, without cancellation.
    c_2 = np.where(are_real, product / np.where(are_real, c_1.real, 1.0), np.conj(c_1))
    r = 0.5 * np.sqrt(c_1 + iw) * np.sqrt(c_2 + iw)
    if gamma_dx2 == 0.0:
        return Roots(0.5 * iw, r)
    # Likewise 4 q^2 = (i w)^2 + a i w + g.
    root_of_q = np.sqrt(complex(0.25 * alpha_dx**2 - gamma_dx2))
    q = 0.5 * np.sqrt(iw + 0.5 * alpha_dx - root_of_q) * np.sqrt(iw + 0.5 * alpha_dx + root_of_q)
    return Roots(q, r)


@lru_cache(maxsize=32)
def nodes(panels: int, angle: float) -> Nodes:
    """Return the nodes on the contour: one panel next to 0, the panels of the ray, and the leg.

    panels is the number of panels of the ray, which are of equal length in ln |z|, and angle is the
    angle of the ray below the real axis.
    """
    log_edges = np.log(CONTOUR_REACH) - LOG_PANEL_LENGTH * np.arange(panels, -1.0, -1.0)
    log_size, log_weight = _panels(log_edges)
    inner, inner_weight = _panels(np.array([0.0, np.exp(log_edges[0])]))
    leg, leg_weight = _panels(LEG_EDGES)
    ray_direction, size = np.exp(-1j * angle), np.exp(log_size)
    corner = CONTOUR_REACH * ray_direction
    z = np.concatenate([inner * ray_direction, size * ray_direction, corner + leg * LEG_DIRECTION])
    weight = np.concatenate(
        [
            inner_weight * ray_direction,
            size * ray_direction * log_weight,
            leg_weight * LEG_DIRECTION,
        ]
    )
    return Nodes(
        z=z,
        weight=weight,
        exp_minus_1=np.expm1(1j * z),
        exp_minus_2_terms=_exp_minus_two_terms(1j * z),
    )


def _panels(edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return nodes and weights on panels between edges."""
    half = 0.5 * np.diff(edges)[:, None]
    return (edges[:-1, None] + half * (1.0 + NODES)).ravel(), (half * WEIGHTS).ravel()


# Series of artanh h - h = h^3 P(h^2) for small h, and of e^x - 1 - x = x^2 P(x) for small x.
_ARTANH = np.polynomial.Polynomial([1.0 / (2 * n + 3) for n in range(8)])
_EXP = np.polynomial.Polynomial(1.0 / np.cumprod(np.arange(1.0, 17.0))[1:])


def _exp_minus_two_terms(x: np.ndarray) -> np.ndarray:
    """Return e^x - 1 - x, computed without cancellation."""
    x = np.asarray(x, dtype=complex)
    series = np.where(np.abs(x) < SERIES_LIMIT, x, 0.0)
    return np.where(np.abs(x) < SERIES_LIMIT, series**2 * _EXP(series), np.expm1(x) - x)
