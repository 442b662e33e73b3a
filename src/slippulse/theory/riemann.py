"""Riemann's formula behind a rupture front: slip, velocity and strain as integrals along t = T(x).

Each position slides under its pre-stress from the arrival time T(x) of the front on, so that the
slip u obeys

    u_tt + alpha u_t = u_xx - gamma u + tau(x)   for t > T(x).

For this linear wave equation the response to an impulse is known as Riemann's function (Courant and
Hilbert, Methods of Mathematical Physics II, chapter V). It is 0 outside of the future of the
impulse. Inside it is half the product of a decay factor E and a kernel K, a Bessel function. (The
drag alpha causes the decay: exp(alpha t/2) u obeys the equation without alpha, with the stiffness
k = gamma - alpha^2/4 in place of gamma.) Slip, velocity and strain at a point (y, t) are then
integrals over the part of the front in the past of the point. It lies between the positions x_l and
x_r where the characteristics through (y, t) meet the front (see the sketch in `curve`). With

    xi = t - y,   eta = t + y,   g = T - x,   h = T + x,
    E = exp(-alpha (t - T)/2),   K(z) = J0(sqrt z)   at   z = k (xi - g) (eta - h),

the formulas are

    2 du/dt = Int tau E K dx
    2 u     = 2 p(y) - E p(x_l) - E p(x_r)
              + Int E { -(p' dT + alpha/2 p dx) K + k p K' [(eta - h) dg - (xi - g) dh] }

as long as no stuck point lies in the past of (y, t). Here p(x) is any static solution:
p'' - gamma p + tau = 0.

K is computed by polynomials in z, with an error below 1e-11, in a third of the time of scipy's j0.
Where z < 0, K is I0(sqrt(-z)). If k < 0 this is so everywhere, and I0 is computed by scipy, because
it becomes so large that polynomials would lose their digits.
"""

import math
from collections.abc import Callable
from functools import lru_cache, partial
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from scipy.special import i0, i1, j0, j1

from .curve import (
    MAX_EAGER_PANELS,
    NODE_COUNT,
    NODES_TO_DERIVATIVES,
    NODES_TO_INTEGRALS,
    NODES_TO_POWERS,
    POWERS_TO_WEIGHTS,
    WEIGHTS,
    Crossing,
    Curve,
    value_and_slope,
)

# Number of points whose integrals are computed together, so that their arrays fit in the cache.
POINTS_PER_CHUNK = 96
# For larger arguments z the terms of a polynomial would cancel, and scipy is used.
MAX_POLYNOMIAL_ARGUMENT = 256.0
# The kernel K and its first two derivatives at z = 0.
KERNEL_AT_ZERO = (1.0, -0.25, 1.0 / 32.0)
# Larger exponents occur only at nodes outside of the domain of integration, which do not count.
MAX_EXPONENT = 300.0


class StaticValues(NamedTuple):
    """A static solution p at nodes of a curve, and derivatives of the curve by its parameter s.

    slope is dp/dx. The last three are the derivatives of T, of T - x and of T + x.
    """

    p: np.ndarray
    slope: np.ndarray
    d_time: np.ndarray
    d_t_minus_x: np.ndarray
    d_t_plus_x: np.ndarray


class StaticSolution:
    """A static slip p under the pre-stress: p'' - gamma p + tau = 0 along a curve.

    This equation has many solutions, and any of them gives the same slip u. For gamma > 0 the
    bounded one is used, tau convolved with exp(-sqrt(gamma) |x|)/(2 sqrt(gamma)). Beyond the curve,
    tau keeps its outermost values.
    """

    def __init__(self, curve: Curve, gamma: float) -> None:
        if gamma == 0.0:
            # Without leaf springs the solution with p = p' = 0 at the left end is used.
            slope = -_integral(curve.source)
            p = _integral(slope * (curve.x @ NODES_TO_DERIVATIVES.T))
        else:
            rate = float(np.sqrt(gamma))
            # The convolution has a part over tau on the left of each position, and a part over tau
            # on its right. The second one is computed on the mirrored curve.
            over_left = _convolve_left(rate, x=curve.x, source=curve.source, edges=curve.edges)
            mirrored = _convolve_left(
                rate,
                x=-curve.x[::-1, ::-1],
                source=curve.source[::-1, ::-1],
                edges=-curve.edges[::-1],
            )
            over_right = mirrored[::-1, ::-1]
            p = (over_left + over_right) / (2.0 * rate)
            slope = 0.5 * (over_right - over_left)
        derivatives = (
            values @ NODES_TO_DERIVATIVES.T
            for values in (curve.time, curve.t_minus_x, curve.t_plus_x)
        )
        # The fields of StaticValues at the nodes, [field, panel, node].
        self.node_values = np.stack([p, slope, *derivatives])
        self._powers = [NODES_TO_POWERS @ values.T for values in (p, slope)]

    def values_on(self, panels: slice) -> StaticValues:
        """Return the values at the nodes of some panels, in flat arrays."""
        return StaticValues(*self.node_values[:, panels].reshape(len(self.node_values), -1))

    def evaluate(self, panel: np.ndarray, s: np.ndarray, order: int) -> np.ndarray:
        """Return p (order 0) or dp/dx (order 1) at a parameter s on each of the panels."""
        return value_and_slope(self._powers[order].take(panel, axis=-1), s)[0]


def _integral(values: np.ndarray) -> np.ndarray:
    """Return the integral of a function over s, from the left end of the curve to each node.

    values are those of the function at the nodes, [panel, node].
    """
    by_panel = values @ WEIGHTS
    before_panel = np.cumsum(by_panel) - by_panel
    return before_panel[:, None] + values @ NODES_TO_INTEGRALS.T


def _convolve_left(rate: float, x: np.ndarray, source: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Return the integral of exp(-rate (x - x')) tau(x') dx' over all x' < x, at the nodes x.

    x and source, which is tau dx'/ds, are given at the nodes, [panel, node]. The integral is
    computed from panel to panel: along a panel its value at the left end decays, and the part of
    the panel itself is added.
    """
    # exp(rate (x - left end)) at the nodes of each panel.
    growth = np.exp(rate * (x - edges[:-1, None]))
    decays = np.exp(-rate * np.diff(edges))
    parts_of_panels = decays * ((source * growth) @ WEIGHTS)
    # Before the curve, tau has the value at its first node: the integral there is tau/rate.
    first_tau = float(source[0, 0] / (NODES_TO_DERIVATIVES[0] @ x[0]))
    at_left_ends = [first_tau / rate]
    for decay_of_panel, part in zip(decays[:-1], parts_of_panels[:-1], strict=True):
        at_left_ends.append(at_left_ends[-1] * decay_of_panel + part)
    return (np.array(at_left_ends)[:, None] + (source * growth) @ NODES_TO_INTEGRALS.T) / growth


class PanelNodes(NamedTuple):
    """The nodes of some panels, seen from some points (y, t): the arguments of an integrand.

    d_xi is (t - y) - (T - x), and d_eta is (t + y) - (T + x), with a row for each point and a
    column for each node. kernel(order) returns the kernel K or a derivative of it by its argument,
    of the same shape. panels are the panels of the curve to which the nodes belong.
    """

    d_xi: np.ndarray
    d_eta: np.ndarray
    kernel: Callable[[int], np.ndarray | float]
    panels: slice


class DependenceDomains:
    """The domains of dependence of points (y, time) behind a curve, and the fields at the points.

    The domain of a point is the part of the curve in its past. Every field is an integral over it
    (`_integrate`). The integrand is a function of `PanelNodes`. y and time are flat arrays.

    The symbols in the methods are those of the module docstring: the decay factor E, the kernel K,
    the curve t = T(x), g = T - x, h = T + x, xi = t - y, eta = t + y, and a static solution p(x).
    stiffness is k. left and right are the ends x_l and x_r of the integrals.
    """

    def __init__(
        self, curve: Curve, gamma: float, alpha: float, y: np.ndarray, time: np.ndarray
    ) -> None:
        self.curve, self.y = curve, y
        self.alpha = alpha
        self.stiffness = gamma - 0.25 * alpha**2
        self.xi, self.eta = time - y, time + y
        self.left, self.right = curve.crossings(y, self.xi, self.eta)

    def slip_velocity(self) -> np.ndarray:
        """Return du/dt at the points."""
        source = self.curve.source
        return 0.5 * self._integrate(lambda nodes: nodes.kernel(0) * source[nodes.panels].ravel())

    def velocity_slopes(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the derivatives of du/dt by xi = t - y and by eta = t + y.

        They are derivatives of the formula 2 du/dt = Int tau E K dx. If xi changes, three things
        change: the left end of the integral by dx/dg, the kernel K by k (eta - h) K', and the decay
        factor E by -alpha/4 E. The derivative by eta is similar, with the right end.
        """
        decay_left, decay_right = self._decay_at_ends()
        by_left_end = self._source_at_end("t_minus_x", self.left, decay_left)
        by_right_end = self._source_at_end("t_plus_x", self.right, decay_right)
        # E changes by the same amount with xi and with eta.
        by_decay = 0.25 * self.alpha * self.slip_velocity() if self.alpha else 0.0
        if self.stiffness == 0.0:
            return -0.5 * by_left_end - by_decay, 0.5 * by_right_end - by_decay
        source, k = self.curve.source, self.stiffness

        def integrand(nodes: PanelNodes) -> np.ndarray:
            """Return tau K' (eta - h) dx/ds and tau K' (xi - g) dx/ds."""
            kernel_slope = nodes.kernel(1) * source[nodes.panels].ravel()
            return np.stack([kernel_slope * nodes.d_eta, kernel_slope * nodes.d_xi])

        kernel_by_xi, kernel_by_eta = self._integrate(integrand, (2,))
        by_xi = 0.5 * (k * kernel_by_xi - by_left_end) - by_decay
        by_eta = 0.5 * (k * kernel_by_eta + by_right_end) - by_decay
        return by_xi, by_eta

    def _source_at_end(self, name: str, end: Crossing, decayed: np.ndarray | float) -> np.ndarray:
        """Return E tau dx/dg (name "t_minus_x") or E tau dx/dh ("t_plus_x") at an end.

        end is the left or right end of each integral, and decayed is the decay factor E there. g is
        T - x, and h is T + x.
        """
        # The source is tau dx/ds, so that its quotient with dg/ds is tau dx/dg.
        slope = self.curve.evaluate(name, end.panel, end.s, order=1)
        # Where this slope is 0, tau is 0 too, and the end contributes nothing.
        slope = np.where(np.abs(slope) < 1e-300, 1e300, slope)
        return decayed * self.curve.evaluate("source", end.panel, end.s) / slope

    def slip(self, static_solution: StaticSolution) -> np.ndarray:
        """Return the slip u at the points (y, t), by the formula

        2 u = 2 p(y) - E p(x_l) - E p(x_r)
              + Int E { -(p' dT + alpha/2 p dx) K + k p K' [(eta - h) dg - (xi - g) dh] }.
        """
        k, alpha = self.stiffness, self.alpha

        def integrand(nodes: PanelNodes) -> np.ndarray:
            """Return the expression in braces, per unit of the parameter s of the curve."""
            p, slope, d_time, d_g, d_h = static_solution.values_on(nodes.panels)
            factor_of_kernel = -slope * d_time
            # alpha/2 p dx, where 2 dx = dh - dg.
            factor_of_kernel -= 0.25 * alpha * p * (d_h - d_g)
            factor_of_slope = nodes.d_eta * (k * p * d_g)
            factor_of_slope -= nodes.d_xi * (k * p * d_h)
            return nodes.kernel(0) * factor_of_kernel + nodes.kernel(1) * factor_of_slope

        return self._minus_mean_of_ends(static_solution, 0) + 0.5 * self._integrate(integrand)

    def strain(self, static_solution: StaticSolution) -> np.ndarray:
        """Return the strain du/dx at the points (y, t), the derivative by y of the formula

        2 u = 2 p(y) - E p(x_l) - E p(x_r)
              + Int E { -(p' dT + alpha/2 p dx) K + k p K' [(eta - h) dg - (xi - g) dh] }.

        If y increases at constant t, xi decreases and eta increases at the same rate. So the
        argument z of the kernel K changes by k [(xi - g) - (eta - h)], and the square bracket by
        dg + dh. The decay factor E does not change.
        """
        k, alpha = self.stiffness, self.alpha
        curve = self.curve
        strain = self._minus_mean_of_ends(static_solution, 1)
        if k == alpha == 0.0:
            return strain

        def integrand(nodes: PanelNodes) -> np.ndarray:
            """Return the derivative of the expression in braces, per unit of the parameter s."""
            p, slope, d_time, d_g, d_h = static_solution.values_on(nodes.panels)
            kernel_slope = nodes.kernel(1)
            # K' in the second term changes.
            bracket = nodes.d_eta * (p * d_g) - nodes.d_xi * (p * d_h)
            by_kernel_slope = k**2 * nodes.kernel(2) * bracket
            # K in the first term changes, and so does the bracket in the second one.
            factor_of_kernel = slope * d_time + 0.25 * alpha * p * (d_h - d_g)
            by_kernel = kernel_slope * (k * factor_of_kernel)
            by_bracket = kernel_slope * (k * p * (d_g + d_h))
            return (nodes.d_eta - nodes.d_xi) * (by_kernel - by_kernel_slope) + by_bracket

        # The ends of the integral move with y. At the left end xi = g, and at the right end
        # eta = h, so that K = 1 and K' = -1/4 at both of them.
        at_left, at_right = self._at_ends(static_solution, 0)
        d_xi = self.xi - curve.evaluate("t_minus_x", self.right.panel, self.right.s)
        d_eta = self.eta - curve.evaluate("t_plus_x", self.left.panel, self.left.s)
        by_motion_of_ends = 0.125 * k * (d_xi * at_right - d_eta * at_left)
        strain += by_motion_of_ends - 0.25 * alpha * (at_right - at_left)
        return strain + 0.5 * self._integrate(integrand)

    def _minus_mean_of_ends(self, static_solution: StaticSolution, order: int) -> np.ndarray:
        """Return p(y) - [E p(x_l) + E p(x_r)]/2, or the same of dp/dx (order 1), for all points.

        p is the static solution, E the decay factor, and x_l and x_r are the ends of the integral.
        """
        at_points = static_solution.evaluate(*self.curve.locate(self.y), order)
        return at_points - 0.5 * sum(self._at_ends(static_solution, order))

    def _at_ends(
        self, static_solution: StaticSolution, order: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return E p (order 0) or E dp/dx (order 1) at the left and right end of each integral.

        p is the static solution, and E the decay factor.
        """
        decay_left, decay_right = self._decay_at_ends()
        at_left = static_solution.evaluate(self.left.panel, self.left.s, order)
        at_right = static_solution.evaluate(self.right.panel, self.right.s, order)
        return at_left * decay_left, at_right * decay_right

    def _decay_at_ends(self) -> tuple[np.ndarray | float, np.ndarray | float]:
        """Return the decay factor E at the left and at the right end of each integral."""
        if not self.alpha:
            return 1.0, 1.0
        # At the left end xi - g is 0, and at the right end eta - h, so that 2 (t - T) is the other
        # difference.
        d_eta = self.eta - self.curve.evaluate("t_plus_x", self.left.panel, self.left.s)
        d_xi = self.xi - self.curve.evaluate("t_minus_x", self.right.panel, self.right.s)
        return np.exp(-0.25 * self.alpha * d_eta), np.exp(-0.25 * self.alpha * d_xi)

    def _integrate(
        self, integrand: Callable[[PanelNodes], np.ndarray], components: tuple[int, ...] = ()
    ) -> np.ndarray:
        """Return the integral of a function times the decay factor E over the domain of each point.

        The integrand is the function per unit of the parameter s of the panels. If it has several
        components, components is a tuple with their number, and the result is
        [component, point].
        """
        if self.stiffness == self.alpha == 0.0 and len(self.curve.panels) > MAX_EAGER_PANELS:
            return self._integrate_without_kernel(integrand)
        integrals = np.empty((*components, self.xi.size))
        # Points whose integrals cover similar panels are computed together.
        order = np.lexsort((self.right.panel, self.left.panel))
        for start in range(0, order.size, POINTS_PER_CHUNK):
            points = order[start : start + POINTS_PER_CHUNK]
            integrals[..., points] = self._integrate_chunk(points, integrand, components)
        # A point on the curve at the end of a panel has an empty domain.
        return np.where(self.left.panel > self.right.panel, 0.0, integrals)

    def _integrate_chunk(
        self,
        points: np.ndarray,
        integrand: Callable[[PanelNodes], np.ndarray],
        components: tuple[int, ...],
    ) -> np.ndarray:
        """Return the integrals of `_integrate` for some of the points, given by their numbers.

        The integrand is evaluated on all panels that one of the points needs. For each point its
        own panels are then added up, of which the first and the last one count only in part.
        """
        curve = self.curve
        # The last and the first panel in the domain of each point.
        high = self.right.panel[points]
        low = np.minimum(self.left.panel[points], high)
        first, last = int(low.min()), int(high.max()) + 1
        panels = slice(first, last)
        # From here on, panels are counted from the first one of this chunk.
        low, high = low - first, high - first
        row = np.arange(low.size)
        d_xi = self.xi[points, None] - curve.t_minus_x[panels].ravel()
        d_eta = self.eta[points, None] - curve.t_plus_x[panels].ravel()
        z = self.stiffness * d_xi
        z *= d_eta
        # Only the first and the last panel of a point may have nodes outside of its domain.
        z_at_ends = z.reshape(low.size, -1, NODE_COUNT)[row, np.array([high, low])]
        kernel = kernel_function(self.stiffness, z, z_at_ends)
        values = integrand(PanelNodes(d_xi, d_eta, kernel, panels))
        if self.alpha:
            values = values * decay(self.alpha, d_xi, d_eta)
        by_panel = values.reshape(*components, low.size, -1, NODE_COUNT)
        # First the panels from `low` to the one before `high` are added. Then the part of `high` in
        # the domain is added, and the part of `low` outside of the domain is subtracted.
        panel = np.arange(last - first)
        is_between = (panel >= low[:, None]) & (panel < high[:, None])
        over_panels = np.add.reduce((by_panel @ WEIGHTS) * is_between, axis=-1)
        weights = partial_weights(np.concatenate([self.right.s[points], self.left.s[points]]))
        weights_high, weights_low = weights.reshape(2, -1, NODE_COUNT)
        in_high = np.add.reduce(by_panel[..., row, high, :] * weights_high, axis=-1)
        outside_in_low = np.add.reduce(by_panel[..., row, low, :] * weights_low, axis=-1)
        return over_panels + in_high - outside_in_low

    def _integrate_without_kernel(
        self, integrand: Callable[[PanelNodes], np.ndarray]
    ) -> np.ndarray:
        """Return the integrals of `_integrate` if the kernel K is 1.

        Then the integrand is the same for all points. Each integral is the difference of two, from
        the left end of the curve to the ends of the domain.
        """
        zero, all_panels = np.zeros((1, 1)), slice(0, len(self.curve.panels))
        nodes = PanelNodes(d_xi=zero, d_eta=zero, kernel=lambda _: 1.0, panels=all_panels)
        values = np.broadcast_to(integrand(nodes), (1, self.curve.x.size))
        by_panel = values.reshape(-1, NODE_COUNT)
        before_panel = np.concatenate([[0.0], np.cumsum(by_panel @ WEIGHTS)])
        low, high = np.minimum(self.left.panel, self.right.panel), self.right.panel
        in_low = np.add.reduce(partial_weights(self.left.s) * by_panel[low], axis=-1)
        in_high = np.add.reduce(partial_weights(self.right.s) * by_panel[high], axis=-1)
        integrals = (before_panel[high] + in_high) - (before_panel[low] + in_low)
        return np.where(self.left.panel > self.right.panel, 0.0, integrals)


def partial_weights(s: np.ndarray) -> np.ndarray:
    """Return weights of the nodes that integrate from the left end of a panel to a parameter s.

    There is one row for each s, and one column for each node of the panel.
    """
    return np.vander(s, NODE_COUNT + 1, increasing=True) @ POWERS_TO_WEIGHTS


def kernel_rate(gamma: float, alpha: float) -> float:
    """Return the fastest rate at which waves change in time, by leaf springs or by drag."""
    return max(float(np.sqrt(gamma)), 0.5 * abs(alpha))


def decay(alpha: float, d_xi: np.ndarray, d_eta: np.ndarray) -> np.ndarray:
    """Return the decay factor E = exp(-alpha (t - T)/2), where d_xi + d_eta = 2 (t - T)."""
    return np.exp(np.minimum(-0.25 * alpha * (d_xi + d_eta), MAX_EXPONENT))


def kernel_function(stiffness: float, z: np.ndarray, z_at_ends: np.ndarray) -> Callable:
    """Return a function that computes the kernel K (order 0) or a derivative of it at z, by order.

    z_at_ends are the values of z at the ends of the domains. For positive stiffness only these may
    be negative, so that the lowest of them is the lowest z.
    """
    if stiffness < 0.0:
        return partial(_bessel, z)
    return partial(riemann_kernel, z, (float(z_at_ends.min()), float(z.max())))


def riemann_kernel(z: np.ndarray, bounds: tuple[float, float], order: int = 0) -> np.ndarray:
    """Return J0(sqrt z), or its derivative of order 1 or 2 by z, for z within bounds.

    For negative z it is I0(sqrt(-z)).
    """
    lower, upper = min(bounds[0], 0.0), max(bounds[1], 0.0)
    if lower == upper == 0.0:
        return np.full(z.shape, KERNEL_AT_ZERO[order])
    if max(-lower, upper) > MAX_POLYNOMIAL_ARGUMENT:
        return _bessel(np.clip(z, lower, upper), order)
    # Bounds are rounded up to powers of two, so that a few polynomials serve all ranges.
    lower, upper = _power_of_two(lower), _power_of_two(upper)
    scaled = z - 0.5 * (lower + upper)
    scaled *= 2.0 / (upper - lower)
    scaled.clip(-1.0, 1.0, out=scaled)
    # Horner's rule, in place.
    coefficients = _polynomial(lower, upper, order)
    value = coefficients[0] * scaled
    for coefficient in coefficients[1:-1]:
        value += coefficient
        value *= scaled
    return value + coefficients[-1]


def _power_of_two(bound: float) -> float:
    """Return a bound rounded away from 0 to a power of two of a size of at least 1.

    A bound of 0 remains 0.
    """
    if bound == 0.0:
        return 0.0
    exponent = max(0, math.ceil(math.log2(abs(bound))))
    return math.copysign(2.0**exponent, bound)


@lru_cache(maxsize=256)
def _polynomial(lower: float, upper: float, order: int) -> tuple[float, ...]:
    """Return the coefficients of the polynomial for the kernel K between bounds.

    The highest power comes first. The variable of the polynomial is -1 at the lower bound and 1 at
    the upper bound.
    """
    # The degree 40 is sufficient for all bounds. Terms as small as rounding errors are dropped.
    points = chebyshev.chebpts1(41)
    values = _bessel(0.5 * (lower + upper) + 0.5 * (upper - lower) * points, order)
    series = chebyshev.chebfit(points, values, 40)
    series = chebyshev.chebtrim(series, 1e-14 * np.max(np.abs(series)))
    return tuple(chebyshev.cheb2poly(series)[::-1].tolist())


def _bessel(z: np.ndarray, order: int) -> np.ndarray:
    """Return f(z) = J0(sqrt z), or its derivative of order 1 or 2 by z, from scipy's functions.

    For negative z, f(z) = I0(sqrt(-z)).
    """
    root = np.maximum(np.sqrt(np.abs(z)), 1e-9)
    # I0 and I1 would overflow at the square root of a large positive z, where they are not needed.
    root_of_negative = np.where(z < 0.0, root, 0.0)
    value = np.where(z >= 0.0, j0(root), i0(root_of_negative))
    if order == 0:
        return value
    slope = np.where(z >= 0.0, -j1(root), -i1(root_of_negative)) / (2.0 * root)
    if order == 1:
        return slope
    # The second derivative follows from Bessel's equation, z f'' + f' + f/4 = 0. Near z = 0, where
    # the terms of this equation cancel, the Taylor series is used.
    is_small = np.abs(z) < 0.1
    series = (1.0 - z / 12.0 * (1.0 - z / 32.0 * (1.0 - z / 60.0 * (1.0 - z / 96.0)))) / 32.0
    return np.where(is_small, series, -(slope + 0.25 * value) / np.where(is_small, 1.0, z))
