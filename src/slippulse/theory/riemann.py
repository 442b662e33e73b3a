"""Riemann's formula behind a rupture front: slip, velocity and strain as integrals along t = T(x).

Each position feels its pre-stress from T(x) on. u_tt + alpha u_t = u_xx - gamma u + tau has the
retarded solution E J0/2 in the future of an impulse, since exp(alpha t/2) u obeys the equation
without alpha, with k = gamma - alpha^2/4 for gamma. With xi = t - y, eta = t + y, g = T - x,
h = T + x, E = exp(-alpha (t - T)/2), and K(z) = J0(sqrt z) at z = k (xi - g)(eta - h), between the
points x_l and x_r where the characteristics through (y, t) meet the curve,

    2 du/dt = Int tau E K dx
    2 u     = 2 p(y) - E p(x_l) - E p(x_r)
              + Int E { -(p' dT + alpha/2 p dx) K + k p K' [(eta - h) dg - (xi - g) dh] }

as long as no stuck point lies in the past of (y, t). p(x) is any solution at rest,
p'' - gamma p + tau = 0. K is an entire function of z. It is evaluated by polynomials, with an error
below 1e-11, in a third of the time of scipy's j0 (a fifth of that of i0, for z < 0). Where k < 0 it
is I0, whose size would cost the polynomials their digits.
"""

import math
from collections.abc import Callable
from functools import lru_cache, partial
from itertools import accumulate

import numpy as np
from numpy.polynomial import chebyshev
from scipy.special import i0, i1, j0, j1

from .curve import (
    COUNT,
    CUMULATIVE,
    MANY_PANELS,
    PARTIAL,
    SLOPE,
    TO_POWERS,
    WEIGHTS,
    Curve,
    value_and_slope,
)

# Number of points whose integrals are computed together: their arrays stay in the cache.
CHUNK = 96
# A polynomial would cancel beyond this z.
LARGEST = 256.0
AT_ZERO = (1.0, -0.25, 1.0 / 32.0)
# Larger exponents occur only outside the domain of integration.
LARGEST_EXPONENT = 300.0


class Rest:
    """One solution p of p'' - gamma p + tau = 0 along a curve: which one makes no difference to u.

    For gamma > 0 the bounded one: exp(-sqrt(gamma) |x|)/(2 sqrt(gamma)) convolved with tau, which
    keeps its outermost values beyond the curve. The sum runs in the direction in which it decays.
    """

    def __init__(self, curve: Curve, gamma: float) -> None:
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
        derivatives = (values @ SLOPE.T for values in (curve.time, curve.early, curve.late))
        # p, p', and dT/ds, dg/ds and dh/ds, [quantity, panel, node].
        self.at_nodes = np.stack([p, slope, *derivatives])
        self._powers = [TO_POWERS @ values.T for values in (p, slope)]

    def on(self, panels: slice) -> np.ndarray:
        """The values at the nodes of some panels, [quantity, node]."""
        return self.at_nodes[:, panels].reshape(len(self.at_nodes), -1)

    def evaluate(self, panel: np.ndarray, s: np.ndarray, order: int) -> np.ndarray:
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
    """The domains of dependence of points (y, time), flat arrays, behind a curve.

    An integrand along some panels of the curve is a function of xi - g and eta - h, with one row a
    point and one column a node; of a function of the order, K or a derivative of it; and of the
    slice of these panels.
    """

    def __init__(
        self, curve: Curve, gamma: float, alpha: float, y: np.ndarray, time: np.ndarray
    ) -> None:
        self.curve, self.alpha, self.y = curve, alpha, y
        self.stiffness = gamma - 0.25 * alpha**2
        self.xi, self.eta = time - y, time + y
        self.left, self.right = curve.crossings(y, self.xi, self.eta)

    def slip_velocity(self) -> np.ndarray:
        """du/dt."""
        source = self.curve.source
        return 0.5 * self._along(lambda _, __, kernel, panels: kernel(0) * source[panels].ravel())

    def velocity_slopes(self) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives of du/dt by t - y and by t + y, from its ends and its kernel."""
        # E tau dx by dg and by dh where the characteristics meet the curve.
        per_slope = []
        ends = zip(("early", "late"), (self.left, self.right), self._decay_at_ends(), strict=True)
        for name, end, decayed in ends:
            slope = self.curve.evaluate(name, end.panel, end.s, order=1)
            # Where the slope is 0 so is tau, and the end contributes nothing.
            slope = np.where(np.abs(slope) < 1e-300, 1e300, slope)
            per_slope.append(decayed * self.curve.evaluate("source", end.panel, end.s) / slope)
        left, right = per_slope
        # E falls with both alike.
        lag = 0.25 * self.alpha * self.slip_velocity() if self.alpha else 0.0
        if self.stiffness == 0.0:
            return -0.5 * left - lag, 0.5 * right - lag
        source, k = self.curve.source, self.stiffness

        def integrand(d_xi, d_eta, kernel, panels) -> np.ndarray:
            growth = kernel(1) * source[panels].ravel()
            return np.stack([growth * d_eta, growth * d_xi])

        by_xi, by_eta = self._along(integrand, (2,))
        return 0.5 * (k * by_xi - left) - lag, 0.5 * (k * by_eta + right) - lag

    def slip(self, rest: Rest) -> np.ndarray:
        """u."""
        k, alpha = self.stiffness, self.alpha

        def integrand(d_xi, d_eta, kernel, panels) -> np.ndarray:
            p, slope, d_time, d_early, d_late = rest.on(panels)
            push = -slope * d_time - 0.25 * alpha * p * (d_late - d_early)
            sides = d_eta * (k * p * d_early) - d_xi * (k * p * d_late)
            return kernel(0) * push + kernel(1) * sides

        return self._less_ends(rest, 0) + 0.5 * self._along(integrand)

    def strain(self, rest: Rest) -> np.ndarray:
        """du/dx, the derivative of the formula for u."""
        k, alpha, curve = self.stiffness, self.alpha, self.curve
        out = self._less_ends(rest, 1)
        if k == alpha == 0.0:
            return out

        def integrand(d_xi, d_eta, kernel, panels) -> np.ndarray:
            p, slope, d_time, d_early, d_late = rest.on(panels)
            first = kernel(1)
            growth = k**2 * kernel(2) * (d_eta * (p * d_early) - d_xi * (p * d_late))
            sides = first * (k * p * (d_early + d_late))
            push = k * (slope * d_time + 0.25 * alpha * p * (d_late - d_early))
            return (d_eta - d_xi) * (first * push - growth) + sides

        at_left, at_right = self._at_ends(rest, 0)
        d_xi = self.xi - curve.evaluate("early", self.right.panel, self.right.s)
        d_eta = self.eta - curve.evaluate("late", self.left.panel, self.left.s)
        sides = 0.125 * k * (d_xi * at_right - d_eta * at_left)
        out += sides - 0.25 * alpha * (at_right - at_left)
        return out + 0.5 * self._along(integrand)

    def _less_ends(self, rest: Rest, order: int) -> np.ndarray:
        """p or p' at the points less its mean, after decay, at the ends of their integrals."""
        here = rest.evaluate(*self.curve.locate(self.y), order)
        return here - 0.5 * sum(self._at_ends(rest, order))

    def _at_ends(self, rest: Rest, order: int) -> list[np.ndarray]:
        """E p or E p' at the left and the right end of each integral."""
        ends = zip((self.left, self.right), self._decay_at_ends(), strict=True)
        return [rest.evaluate(end.panel, end.s, order) * decayed for end, decayed in ends]

    def _decay_at_ends(self) -> tuple[np.ndarray | float, np.ndarray | float]:
        """E at the left and the right end of each integral."""
        if not self.alpha:
            return 1.0, 1.0
        d_eta = self.eta - self.curve.evaluate("late", self.left.panel, self.left.s)
        d_xi = self.xi - self.curve.evaluate("early", self.right.panel, self.right.s)
        return np.exp(-0.25 * self.alpha * d_eta), np.exp(-0.25 * self.alpha * d_xi)

    def _along(
        self, integrand: Callable[..., np.ndarray], components: tuple[int, ...] = ()
    ) -> np.ndarray:
        """Integrals over each domain of an integrand, per unit of the parameter of the panels."""
        if self.stiffness == self.alpha == 0.0 and len(self.curve.panels) > MANY_PANELS:
            return self._by_sums(integrand)
        curve, out = self.curve, np.empty((*components, self.xi.size))
        # Points of about the same panels are computed together.
        order = np.lexsort((self.right.panel, self.left.panel))
        for start in range(0, order.size, CHUNK):
            points = order[start : start + CHUNK]
            high = self.right.panel[points]
            low = np.minimum(self.left.panel[points], high)
            first, last = int(low.min()), int(high.max()) + 1
            panels = slice(first, last)
            low, high = low - first, high - first
            ends = np.arange(low.size), np.array([high, low])
            d_xi = self.xi[points, None] - curve.early[panels].ravel()
            d_eta = self.eta[points, None] - curve.late[panels].ravel()
            z = self.stiffness * d_xi
            z *= d_eta
            kernel = kernel_of(self.stiffness, z, z.reshape(low.size, -1, COUNT)[ends])
            values = integrand(d_xi, d_eta, kernel, panels)
            if self.alpha:
                values = values * decay(self.alpha, d_xi, d_eta)
            boxes = values.reshape(*components, low.size, -1, COUNT)
            # The panels between both ends, and those that are cut there.
            here = np.arange(last - first)
            inside = (here >= low[:, None]) & (here < high[:, None])
            total = np.add.reduce((boxes @ WEIGHTS) * inside, axis=-1)
            weights = partial_weights(np.concatenate([self.right.s[points], self.left.s[points]]))
            cut = np.add.reduce(boxes[..., *ends, :] * weights.reshape(2, -1, COUNT), axis=-1)
            out[..., points] = total + cut[..., 0, :] - cut[..., 1, :]
        # The domain of a point on the curve, at the end of a panel, is empty.
        return np.where(self.left.panel > self.right.panel, 0.0, out)

    def _by_sums(self, integrand: Callable[..., np.ndarray]) -> np.ndarray:
        """The same for a kernel of 1, where an integrand is the same for all points."""
        zero, every = np.zeros((1, 1)), slice(0, len(self.curve.panels))
        values = np.broadcast_to(
            integrand(zero, zero, lambda _: 1.0, every), (1, self.curve.x.size)
        )
        boxes = values.reshape(-1, COUNT)
        sums = np.concatenate([[0.0], np.cumsum(boxes @ WEIGHTS)])
        low, high = np.minimum(self.left.panel, self.right.panel), self.right.panel
        at_low = sums[low] + np.add.reduce(partial_weights(self.left.s) * boxes[low], axis=-1)
        at_high = sums[high] + np.add.reduce(partial_weights(self.right.s) * boxes[high], axis=-1)
        return np.where(self.left.panel > self.right.panel, 0.0, at_high - at_low)


def partial_weights(s: np.ndarray) -> np.ndarray:
    """Weights at a panel's nodes of the integral from its left end to a parameter."""
    return np.vander(s, COUNT + 1, increasing=True) @ PARTIAL


def kernel_rate(gamma: float, alpha: float) -> float:
    """The fastest rate at which the kernel E K changes."""
    return max(float(np.sqrt(gamma)), 0.5 * abs(alpha))


def decay(alpha: float, d_xi: np.ndarray, d_eta: np.ndarray) -> np.ndarray:
    """E = exp(-alpha (t - T)/2), where d_xi + d_eta = 2 (t - T)."""
    return np.exp(np.minimum(-0.25 * alpha * (d_xi + d_eta), LARGEST_EXPONENT))


def kernel_of(stiffness: float, z: np.ndarray, cut: np.ndarray) -> Callable:
    """K and its derivatives at z, by order; z below 0 counts where the domain is cut only."""
    if stiffness < 0.0:
        return partial(_bessel, z)
    return partial(riemann, z, (float(cut.min()), float(z.max())))


def riemann(z: np.ndarray, bounds: tuple[float, float], order: int = 0) -> np.ndarray:
    """J0(sqrt z), with J0(i y) = I0(y), or its derivative of order 1 or 2, for z within bounds."""
    lower, upper = min(bounds[0], 0.0), max(bounds[1], 0.0)
    if lower == upper == 0.0:
        return np.full(z.shape, AT_ZERO[order])
    if max(-lower, upper) > LARGEST:
        return _bessel(np.clip(z, lower, upper), order)
    # A few polynomials serve all ranges.
    lower, upper = _power_of_two(lower), _power_of_two(upper)
    scaled = z - 0.5 * (lower + upper)
    scaled *= 2.0 / (upper - lower)
    scaled.clip(-1.0, 1.0, out=scaled)
    coefficients = _polynomial(lower, upper, order)
    out = coefficients[0] * scaled
    for coefficient in coefficients[1:-1]:
        out += coefficient
        out *= scaled
    return out + coefficients[-1]


def _power_of_two(bound: float) -> float:
    """The next power of two, from 1 on, away from 0; or 0."""
    return bound and math.copysign(2.0 ** max(0, math.ceil(math.log2(abs(bound)))), bound)


@lru_cache(maxsize=256)
def _polynomial(lower: float, upper: float, order: int) -> tuple[float, ...]:
    """Coefficients of powers, the highest first, of a variable from -1 to 1 between the bounds."""
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
