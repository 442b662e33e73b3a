"""The Wiener-Hopf factor of a front on the lattice, leaf springs and damping included.

In lattice units (w = v k, S(k) = 4 sin^2(k/2), b = beta/dx, g = gamma dx^2, a = alpha dx) the front
has the symbol

    M(k) = 1 - [S(k) (1 + i b w) + g + i a w]/w^2 = M_+(k) M_-(k),

with M_+ analytic and free of zeros for Im k > 0. The symbol is an exact product of an algebraic
function and two factors that decay on opposite sides of the axis,

    M = -((r + q)/w)^2 (1 - rho e^{ik}) (1 - rho e^{-ik}),   rho = (r - q)/(r + q),
    r = sqrt(1 + i b w - (w^2 - g - i a w)/4),   q = (i/2) sqrt(w^2 - g - i a w),

with the branch points of r and q above the contour: those of q, w = +-sqrt(g) at a = 0, and the
waves that are radiated behind the front lie there by causality, since damping moves them up. (For
a < 0 waves grow behind the front, and the contour leaves 0 more steeply, below them.) Then every
factor but 1 - rho e^{ik} is analytic and free of zeros below the contour C, which passes below all
of them, and closing C downwards leaves

    ln M_+(k) = 1/(2 pi i) Int_C ln(1 - rho(z) e^{iz}) dz/(z - k).

C is bent upwards at its ends, where e^{iz} decays and nothing oscillates: no tail is left, whatever
b is. At b = 1, g = 0 the root is 1 + i w/2 and M_+(k) = (1 + i v k - e^{ik})/(i v k) in closed
form, hence M_+(0) = 1 - 1/v; for g = 0 only the ratio to it is integrated.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

# Gauss-Legendre nodes on each panel.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(14)
# The contour leaves 0 at this angle below the real axis, away from branch points and waves above
# it. It goes beyond the farthest of them, |k| <= pi, and stays short of the zeros of M below the
# axis, Re k > pi.
ANGLE = 0.5
REACH = 3.5
# Then it goes up at 60 degrees to where e^{-Im z} is 1e-14.
LEG_EDGES = np.array([0.0, 1.2, 3.0, 7.0, 14.0, 24.0, 38.0])
LEG_DIRECTION = np.exp(1j * np.pi / 3.0)
# Length of the panels along the ray, in ln |z|.
PANEL = 0.9
# Below these sizes differences of nearly equal numbers are taken from their series.
SMALL = 0.5
SMALL_ARTANH = 0.1


class Nodes(NamedTuple):
    """Nodes z of the right half of the contour, with weights dz, e^{iz} - 1 and e^{iz} - 1 - iz."""

    z: np.ndarray
    weight: np.ndarray
    bent: np.ndarray
    curved: np.ndarray


def log_prestress(
    excess: np.ndarray,
    ratio: np.ndarray,
    springs: float = 0.0,
    release: str = "total",
    drag: float = 0.0,
) -> np.ndarray:
    """ln tau_0 of steady fronts at speeds v = 1 + excess.

    excess and ratio are 1-d; excess > 0, or >= 0 with leaf springs g = gamma dx^2, and
    v >= sqrt(4 + g)/pi. drag is a = alpha dx, with springs only, above -2 sqrt(g (1 - 1/v^2)). The
    release is "total", M_+(0) = tau_0, or "elastic", M_+(0)/M_+(i/(b v)) = tau_0. Both hold with
    springs as without: a block ahead of the front has not slipped, so its leaf spring is relaxed.
    """
    # Below this size no zero or branch point comes near 0, where the contour starts.
    nearest = np.minimum(np.sqrt(springs) if springs > 0.0 else excess, 1.0)
    angle = ANGLE
    if drag:
        nearest = min(nearest, springs / abs(drag))
    if drag < 0.0:
        slowest = float(np.min(excess))
        size = -0.5 * drag * (1.0 + slowest) / np.sqrt(springs * slowest * (2.0 + slowest))
        angle = max(ANGLE, 0.5 * (np.arcsin(min(size, 1.0)) + 0.5 * np.pi))
    scale = np.min(nearest / ((1.0 + ratio) * (1.0 + excess)))
    contour = nodes(int(np.ceil(np.log(2.0 * REACH / scale) / PANEL)), angle)
    f = log_factor(contour, excess[:, None], ratio[:, None], springs, drag)
    out = (f @ (contour.weight / contour.z)).imag / np.pi
    if springs > 0.0:
        edge = 0.5 * np.sqrt(springs)
        origin = np.log(2.0 * edge / (np.sqrt(1.0 + edge**2) + edge))
        # The contour leaves 0 at an angle: the value there enters with the rest of half a residue.
        out = (0.5 - angle / np.pi) * origin + out
    else:
        out += np.log(excess / (1.0 + excess))
    if release == "elastic" and np.any(ratio > 0.0):
        # With b = 0 both rules are the same: M_+(i infinity) = 1.
        y = 1.0 / np.maximum(ratio * (1.0 + excess), 1e-300)
        from_pole = contour.z - 1j * y[:, None]
        at_pole = np.sum(f * (contour.weight / from_pole), axis=1).imag / np.pi
        if springs == 0.0:
            at_pole += np.log((excess * y + _exp_beyond(-y).real) / ((1.0 + excess) * y))
        out -= np.where(ratio > 0.0, at_pole, 0.0)
    return out


def log_factor(
    contour: Nodes, excess: np.ndarray, ratio: np.ndarray, springs: float, drag: float
) -> np.ndarray:
    """ln(1 - rho e^{iz}) at the nodes, for g = 0 less that of b = 1; excess, ratio are columns."""
    z = contour.z
    iw = 1j * z * (1.0 + excess)
    q, r = roots(iw, ratio, springs, drag)
    both = r + q
    rho = (1.0 + ratio * iw) / both**2
    factor = 2.0 * q / both - rho * contour.bent
    # Near 0 both parts cancel as v -> 1: there it is -expm1(i z + ln rho), ln rho = -2 artanh(q/r).
    slope = q / r
    close = (np.abs(slope) < SMALL) & (np.abs(z) < SMALL) & (excess < 1.0)
    if np.any(close):
        last = int(np.flatnonzero(close.any(axis=0))[-1]) + 1
        part = np.s_[:, :last]
        size = -2j * q[part]
        h = np.where(close[part], slope[part], 0.0)
        shift = (ratio * iw[part] - 0.25 * size**2) / (r[part] + 1.0)
        lag = -excess * z[:last] + size * shift / r[part]
        if springs > 0.0:
            lag = lag + (springs + drag * iw[part]) / (-1j * iw[part] + size)
        # artanh h - h without cancellation.
        square, large = h * h, np.abs(h) >= SMALL_ARTANH
        curved = h * square * _ARTANH(square)
        curved[large] = np.arctanh(h[large]) - h[large]
        exponent = np.where(close[part], 1j * lag - 2.0 * curved, 0.0)
        factor[part] = np.where(close[part], -np.expm1(exponent), factor[part])
    if springs > 0.0:
        return log(factor)
    reference = (1j * excess * z - contour.curved) / (1.0 + iw)
    return log(factor / reference)


def log(z: np.ndarray) -> np.ndarray:
    """The logarithm, in a fifth of the time of `np.log` of complex numbers."""
    return np.log(np.abs(z)) + 1j * np.arctan2(z.imag, z.real)


def roots(
    iw: np.ndarray, ratio: np.ndarray, springs: float, drag: float
) -> tuple[np.ndarray, np.ndarray]:
    """q and r (module docstring) with cuts that run straight up from their branch points."""
    four = 4.0 + springs
    ratio = ratio + 0.25 * drag
    under = 4.0 * ratio**2 - four
    strong = under >= 0.0
    root = np.sqrt(np.abs(under))
    large = 2.0 * ratio + np.where(strong, root, 1j * root)
    small = np.where(strong, four / np.where(strong, large.real, 1.0), np.conj(large))
    r = 0.5 * np.sqrt(large + iw) * np.sqrt(small + iw)
    if springs == 0.0:
        return 0.5 * iw, r
    side = np.sqrt(complex(0.25 * drag**2 - springs))
    return 0.5 * np.sqrt(iw + 0.5 * drag - side) * np.sqrt(iw + 0.5 * drag + side), r


@lru_cache(maxsize=32)
def nodes(panels: int, angle: float) -> Nodes:
    """Nodes on the contour, with its ray in panels."""
    edges = np.log(REACH) - PANEL * np.arange(panels, -1.0, -1.0)
    ray, ray_weight = _panels(edges)
    inner, inner_weight = _panels(np.array([0.0, np.exp(edges[0])]))
    leg, leg_weight = _panels(LEG_EDGES)
    turn, size = np.exp(-1j * angle), np.exp(ray)
    z = np.concatenate([inner * turn, size * turn, REACH * turn + leg * LEG_DIRECTION])
    weights = inner_weight * turn, size * turn * ray_weight, leg_weight * LEG_DIRECTION
    weight = np.concatenate(weights)
    return Nodes(z, weight, np.expm1(1j * z), _exp_beyond(1j * z))


def _panels(edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    half = 0.5 * np.diff(edges)[:, None]
    return (edges[:-1, None] + half * (1.0 + NODES)).ravel(), (half * WEIGHTS).ravel()


# artanh h - h = h^3 P(h^2) for small h, and e^x - 1 - x = x^2 P(x) for small x.
_ARTANH = np.polynomial.Polynomial([1.0 / (2 * n + 3) for n in range(8)])
_EXP = np.polynomial.Polynomial(1.0 / np.cumprod(np.arange(1.0, 17.0))[1:])


def _exp_beyond(x: np.ndarray) -> np.ndarray:
    """e^x - 1 - x without cancellation."""
    x = np.asarray(x, dtype=complex)
    series = np.where(np.abs(x) < SMALL, x, 0.0)
    return np.where(np.abs(x) < SMALL, series**2 * _EXP(series), np.expm1(x) - x)
