"""Riemann's formula behind a rupture front: slip, velocity and strain as integrals along the curve t = T(x).

Each position feels its pre-stress from T(x) on, and u_tt + alpha u_t = u_xx - gamma u + tau has the retarded solution
E J0/2 in its future, since exp(alpha t/2) u obeys the equation without alpha at k = gamma - alpha^2/4 for gamma. With
xi = t - y, eta = t + y, g = T - x, h = T + x, E = exp(-alpha (t - T)/2) and K(z) = J0(sqrt z) at
z = k (xi - g)(eta - h), between the points x_l, x_r where the characteristics through (y, t) meet the curve,

    2 du/dt = Int tau E K dx
    2 u     = 2 p(y) - E p(x_l) - E p(x_r) + Int E { -(p' dT + alpha/2 p dx) K + k p K' [(eta - h) dg - (xi - g) dh] }

as long as no stuck point lies in the past of (y, t). p(x) is any solution at rest, p'' - gamma p + tau = 0. K,
entire in z, is evaluated by polynomials, a third of the time of scipy's j0 (a fifth of i0's, for z < 0); error
below 1e-11. Where k < 0 it is I0, whose size would cost them their digits.
"""

import math
from collections.abc import Callable
from functools import lru_cache, partial
from itertools import accumulate

import numpy as np
from numpy.polynomial import chebyshev
from scipy.special import i0, i1, j0, j1

from .curve import COUNT, CUMULATIVE, PARTIAL, SLOPE, TO_POWERS, WEIGHTS, Curve, value_and_slope

# Points whose integrals are computed together: their arrays stay in the cache.
CHUNK = 96
# Beyond this z a polynomial would cancel.
LARGEST = 256.0
AT_ZERO = (1.0, -0.25, 1.0 / 32.0)
# Exponents beyond it occur only outside the domain of integration.
LARGEST_EXPONENT = 300.0


class Rest:
    """One solution p of p'' - gamma p + tau = 0 along a curve: which one makes no difference to u.

    For gamma > 0 the bounded one, exp(-sqrt(gamma) |x|)/(2 sqrt(gamma)) convolved with tau, which is continued beyond
    the curve at its outermost values; summed from panel to panel in the direction in which it decays.
    """

    def __init__(self, curve: Curve, gamma: float) -> None:
        self.curve = curve
        if gamma == 0.0:
            # p = p' = 0 at the left end.
            slope = -_integral(curve.source)
            p = _integral(slope * (curve.x @ SLOPE.T))
        else:
            k = float(np.sqrt(gamma))
            right = _decaying(k, curve.x, curve.source, curve.edges)
            left = _decaying(k, -curve.x[::-1, ::-1], curve.source[::-1, ::-1], -curve.edges[::-1])
            left = left[::-1, ::-1]
            p, slope = (right + left) / (2.0 * k), 0.5 * (left - right)
        # p, p' and dT/ds, dg/ds, dh/ds at the nodes.
        self.at_nodes = (
            p,
            slope,
            *(values @ SLOPE.T for values in (curve.time, curve.early, curve.late)),
        )
        self._powers = [TO_POWERS @ values.T for values in (p, slope)]

    def at(self, panel: np.ndarray, s: np.ndarray, order: int) -> np.ndarray:
        """p (order 0) or p' (1) at a parameter on panels."""
        return value_and_slope(self._powers[order].take(panel, axis=-1), s)[0]


def _integral(values: np.ndarray) -> np.ndarray:
    """From the left end of the curve, of values per unit of the parameter."""
    gain = values @ WEIGHTS
    return (np.cumsum(gain) - gain)[:, None] + values @ CUMULATIVE.T


def _decaying(k: float, x: np.ndarray, source: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Int_{-inf}^x exp(-k (x - x')) tau dx' at the nodes."""
    within = np.exp(k * (x - edges[:-1, None]))
    loss = np.exp(-k * np.diff(edges))
    gains = loss * ((source * within) @ WEIGHTS)
    first = float(source[0, 0] / (SLOPE[0] @ x[0])) / k
    steps = zip(loss, gains, strict=True)
    starts = list(accumulate(steps, lambda p, step: p * step[0] + step[1], initial=first))
    return (np.array(starts[:-1])[:, None] + (source * within) @ CUMULATIVE.T) / within


class Past:
    """The domains of dependence of points (y, time), flat arrays as gamma may be for du/dt, behind a curve."""

    def __init__(
        self,
        curve: Curve,
        gamma: float | np.ndarray,
        y: np.ndarray,
        time: np.ndarray,
        alpha: float = 0.0,
    ):
        self.curve, self.alpha, self.y = curve, alpha, y
        self.stiffness = gamma - 0.25 * alpha**2
        self.xi, self.eta = time - y, time + y
        self.left, self.right = curve.crossings(y, self.xi, self.eta)

    def slip_velocity(self) -> np.ndarray:
        """du/dt."""
        source = self.curve.source
        return 0.5 * self._along(
            lambda behind, ahead, kernel, panels: kernel(0) * source[panels].ravel()
        )

    def velocity_slopes(self) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives of du/dt by t - y and by t + y: of the formula's ends and of its kernel."""
        ends = []
        crossings = zip(
            ("early", "late"), (self.left, self.right), self._decay_at_ends(), strict=True
        )
        for name, (panel, s, _), fall in crossings:
            slope = self.curve.at(name, panel, s, order=1)
            # Where the slope is 0 so is tau, and the end contributes nothing.
            slope = np.where(np.abs(slope) < 1e-300, 1e300, slope)
            ends.append(fall * self.curve.at("source", panel, s) / slope)
        # E falls with both alike.
        lag = 0.25 * self.alpha * self.slip_velocity() if self.alpha else 0.0
        if self.stiffness == 0.0:
            return -0.5 * ends[0] - lag, 0.5 * ends[1] - lag
        source, k = self.curve.source, self.stiffness

        def integrand(behind, ahead, kernel, panels):
            growth = kernel(1) * source[panels].ravel()
            return np.stack([growth * ahead, growth * behind])

        by_xi, by_eta = self._along(integrand, 2)
        return 0.5 * (k * by_xi - ends[0]) - lag, 0.5 * (k * by_eta + ends[1]) - lag

    def slip(self, rest: Rest) -> np.ndarray:
        """u."""
        k, alpha = self.stiffness, self.alpha

        def integrand(behind, ahead, kernel, panels):
            p, slope, time, early, late = (values[panels].ravel() for values in rest.at_nodes)
            out = kernel(0) * (-slope * time - 0.25 * alpha * p * (late - early))
            if k:
                out += kernel(1) * (ahead * (k * p * early) - behind * (k * p * late))
            return out

        return self._less_ends(rest, 0) + 0.5 * self._along(integrand)

    def strain(self, rest: Rest) -> np.ndarray:
        """du/dx, the derivative of the formula for u."""
        k, alpha, curve = self.stiffness, self.alpha, self.curve
        out = self._less_ends(rest, 1)
        if k == alpha == 0.0:
            return out

        def integrand(behind, ahead, kernel, panels):
            p, slope, time, early, late = (values[panels].ravel() for values in rest.at_nodes)
            first = kernel(1)
            growth = k**2 * kernel(2) * (ahead * (p * early) - behind * (p * late))
            sides = first * (k * p * (early + late))
            push = k * (slope * time + 0.25 * alpha * p * (late - early))
            return (ahead - behind) * (first * push - growth) + sides

        (on_left, s_left, _), (on_right, s_right, _) = self.left, self.right
        at_left, at_right = self._at_ends(rest, 0)
        behind = (self.xi - curve.at("early", on_right, s_right)) * at_right
        ahead = (self.eta - curve.at("late", on_left, s_left)) * at_left
        out += 0.125 * k * (behind - ahead) - 0.25 * alpha * (at_right - at_left)
        return out + 0.5 * self._along(integrand)

    def _less_ends(self, rest: Rest, order: int) -> np.ndarray:
        """p or p' at the points less its mean, after decay, at the ends of their integrals."""
        return rest.at(*self.curve.locate(self.y), order) - 0.5 * sum(self._at_ends(rest, order))

    def _at_ends(self, rest: Rest, order: int) -> list[np.ndarray]:
        """E p or E p' at the left and the right end of each integral."""
        crossings = zip((self.left, self.right), self._decay_at_ends(), strict=True)
        return [rest.at(panel, s, order) * fall for (panel, s, _), fall in crossings]

    def _decay_at_ends(self) -> tuple[np.ndarray | float, np.ndarray | float]:
        """E at the left and the right end of each integral."""
        if not self.alpha:
            return 1.0, 1.0
        (on_left, s_left, _), (on_right, s_right, _) = self.left, self.right
        ahead = self.eta - self.curve.at("late", on_left, s_left)
        behind = self.xi - self.curve.at("early", on_right, s_right)
        return np.exp(-0.25 * self.alpha * ahead), np.exp(-0.25 * self.alpha * behind)

    def _along(self, integrand: Callable, *count: int) -> np.ndarray:
        """Integrals of an integrand (or a count), per unit of the panels' parameter, over each domain."""
        curve = self.curve
        out, stiffness = (
            np.empty((*count, self.xi.size)),
            np.broadcast_to(self.stiffness, self.xi.shape),
        )
        # Points of about the same panels together.
        order = np.lexsort((self.right.panel, self.left.panel))
        for start in range(0, order.size, CHUNK):
            part = order[start : start + CHUNK]
            high = self.right.panel[part]
            low = np.minimum(self.left.panel[part], high)
            first, last = int(low.min()), int(high.max()) + 1
            panels = slice(first, last)
            behind = self.xi[part, None] - curve.early[panels].ravel()
            ahead = self.eta[part, None] - curve.late[panels].ravel()
            z = stiffness[part, None] * behind
            z *= ahead
            here, low, high = np.arange(last - first), low - first, high - first
            ends = np.arange(low.size), np.array([high, low])
            kernel = kernel_of(stiffness[0], z, z.reshape(low.size, -1, COUNT)[ends])
            values = integrand(behind, ahead, kernel, panels)
            if self.alpha:
                values = values * decay(self.alpha, behind + ahead)
            boxes = values.reshape(*count, low.size, -1, COUNT)
            whole = (here >= low[:, None]) & (here < high[:, None])
            # The panels at both ends are cut.
            weights = partial_weights(np.concatenate([self.right.s[part], self.left.s[part]]))
            cut = np.add.reduce(boxes[..., *ends, :] * weights.reshape(2, -1, COUNT), axis=-1)
            total = np.add.reduce((boxes @ WEIGHTS) * whole, axis=-1)
            out[..., part] = total + cut[..., 0, :] - cut[..., 1, :]
        # A point on the curve, at the end of a panel: its domain is empty.
        return np.where(self.left.panel > self.right.panel, 0.0, out)


def partial_weights(s: np.ndarray) -> np.ndarray:
    """Weights at a panel's nodes of the integral from its left end to a parameter."""
    return np.vander(s, COUNT + 1, increasing=True) @ PARTIAL


def decay(alpha: float, twice: np.ndarray) -> np.ndarray:
    """E = exp(-alpha (t - T)/2), from twice t - T."""
    return np.exp(np.minimum(-0.25 * alpha * twice, LARGEST_EXPONENT))


def kernel_of(stiffness: float, z: np.ndarray, cut: np.ndarray) -> Callable:
    """K or, by order, its derivatives at z; for k >= 0 only cut values may be below 0, continued beyond the domain."""
    if stiffness < 0.0:
        return partial(_bessel, z)
    return partial(riemann, z, (float(cut.min()), float(z.max())))


def riemann(z: np.ndarray, bounds: tuple[float, float], order: int = 0) -> np.ndarray:
    """J0(sqrt z), J0(i y) = I0(y), or its first or second derivative by z, for z within bounds (clipped there)."""
    lower, upper = min(bounds[0], 0.0), max(bounds[1], 0.0)
    if lower == upper == 0.0:
        return np.full(z.shape, AT_ZERO[order])
    if max(-lower, upper) > LARGEST:
        return _bessel(np.clip(z, lower, upper), order)
    # Few polynomials serve all ranges.
    lower, upper = (
        e and math.copysign(2.0 ** max(0, math.ceil(math.log2(abs(e)))), e) for e in (lower, upper)
    )
    scaled = z - 0.5 * (lower + upper)
    scaled *= 2.0 / (upper - lower)
    scaled.clip(-1.0, 1.0, out=scaled)
    coefficients = _polynomial(lower, upper, order)
    out = coefficients[0] * scaled
    for coefficient in coefficients[1:-1]:
        out += coefficient
        out *= scaled
    return out + coefficients[-1]


@lru_cache(maxsize=256)
def _polynomial(lower: float, upper: float, order: int) -> tuple[float, ...]:
    """Coefficients by powers, the highest first, of the scaled variable, which runs from -1 to 1 between the bounds."""
    points = chebyshev.chebpts1(41)
    values = _bessel(0.5 * (lower + upper) + 0.5 * (upper - lower) * points, order)
    series = chebyshev.chebfit(points, values, 40)
    series = chebyshev.chebtrim(series, 1e-14 * np.max(np.abs(series)))
    return tuple(chebyshev.cheb2poly(series)[::-1].tolist())


def _bessel(z: np.ndarray, order: int) -> np.ndarray:
    root = np.maximum(np.sqrt(np.abs(z)), 1e-9)
    outside = np.where(z < 0.0, root, 0.0)
    even = np.where(z >= 0.0, j0(root), i0(outside))
    if order == 0:
        return even
    slope = np.where(z >= 0.0, -j1(root), -i1(outside)) / (2.0 * root)
    if order == 1:
        return slope
    # Bessel's equation, z f'' + f' + f/4 = 0, and its series where that cancels.
    small = np.abs(z) < 0.1
    series = (1.0 - z / 12.0 * (1.0 - z / 32.0 * (1.0 - z / 60.0 * (1.0 - z / 96.0)))) / 32.0
    return np.where(small, series, -(slope + 0.25 * even) / np.where(small, 1.0, z))
