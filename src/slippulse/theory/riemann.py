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

    The curve is t = T(x). g is T - x, and h is T + x.
    """

    p: np.ndarray
    dp_dx: np.ndarray
    dt_ds: np.ndarray
    dg_ds: np.ndarray
    dh_ds: np.ndarray


class StaticSolution:
    """A static slip p under the pre-stress: p'' - gamma p + tau = 0 along a curve.

    The equation for p has many solutions, and any of them gives the same slip u. For gamma > 0 the
    bounded one is used, tau convolved with exp(-sqrt(gamma) |x|)/(2 sqrt(gamma)). Beyond the curve,
    tau keeps its outermost values.
    """

    def __init__(self, curve: Curve, gamma: float) -> None:
        """Compute p, dp/dx and the derivatives of the curve at the nodes of all panels."""
        if gamma == 0.0:
            # Then p'' = -tau. The solution with p = p' = 0 at the left end of the curve is used.
            # The source is tau dx/ds.
            dx_ds = curve.x @ NODES_TO_DERIVATIVES.T
            dp_dx = -_integrate_to_nodes(curve.source)
            p = _integrate_to_nodes(dp_dx * dx_ds)
        else:
            # p is tau convolved with exp(-rate |x|)/(2 rate). This is an integral over tau on the
            # left of each position, and one over tau on its right. The second one is computed on
            # the curve mirrored at x = 0, on which the order of panels and nodes is reversed.
            rate = float(np.sqrt(gamma))
            over_left = _integrate_over_left(
                rate, x=curve.x, source=curve.source, edges=curve.edges
            )
            mirrored = _integrate_over_left(
                rate,
                x=-curve.x[::-1, ::-1],
                source=curve.source[::-1, ::-1],
                edges=-curve.edges[::-1],
            )
            over_right = mirrored[::-1, ::-1]
            p = (over_left + over_right) / (2.0 * rate)
            dp_dx = 0.5 * (over_right - over_left)
        dt_ds, dg_ds, dh_ds = (
            values @ NODES_TO_DERIVATIVES.T
            for values in (curve.time, curve.t_minus_x, curve.t_plus_x)
        )
        # The fields of StaticValues at the nodes, [field, panel, node].
        self.node_values = np.stack([p, dp_dx, dt_ds, dg_ds, dh_ds])
        # The polynomials of p and dp/dx on each panel, for `evaluate`.
        self._polynomials = [NODES_TO_POWERS @ values.T for values in (p, dp_dx)]

    def values_on(self, panels: slice) -> StaticValues:
        """Return the values at the nodes of some panels, in flat arrays."""
        return StaticValues(*self.node_values[:, panels].reshape(len(self.node_values), -1))

    def evaluate(self, panel: np.ndarray, s: np.ndarray, order: int) -> np.ndarray:
        """Return p (order 0) or dp/dx (order 1) at a parameter s on each of the panels."""
        return value_and_slope(self._polynomials[order].take(panel, axis=-1), s)[0]


def _integrate_to_nodes(values: np.ndarray) -> np.ndarray:
    """Return the integral of a function over s, from the left end of the curve to each node.

    values are those of the function at the nodes, [panel, node].
    """
    over_panel = values @ WEIGHTS
    over_earlier_panels = np.cumsum(over_panel) - over_panel
    from_left_end_of_panel = values @ NODES_TO_INTEGRALS.T
    return over_earlier_panels[:, None] + from_left_end_of_panel


def _integrate_over_left(
    rate: float, x: np.ndarray, source: np.ndarray, edges: np.ndarray
) -> np.ndarray:
    """Return I(x) = Int exp(-rate (x - x')) tau(x') dx' over all x' < x, at the nodes x.

    x and source, which is tau dx/ds, are given at the nodes, [panel, node]. On a panel with the
    left end a, I(x) = {I(a) + Int_a^x exp(rate (x' - a)) tau(x') dx'} / exp(rate (x - a)).

    edges : the ends of all panels, from left to right
    """
    # exp(rate (x - a)) at the nodes of each panel.
    growth = np.exp(rate * (x - edges[:-1, None]))
    decay_over_panel = np.exp(-rate * np.diff(edges))
    added_by_panel = decay_over_panel * ((source * growth) @ WEIGHTS)
    # On the left of the curve, where tau does not matter, it is assumed to keep the value at the
    # first node, so that I is tau/rate.
    first_tau = float(source[0, 0] / (NODES_TO_DERIVATIVES[0] @ x[0]))
    at_left_ends = [first_tau / rate]
    for panel in range(len(x) - 1):
        at_right_end = at_left_ends[-1] * decay_over_panel[panel] + added_by_panel[panel]
        at_left_ends.append(at_right_end)
    return (np.array(at_left_ends)[:, None] + (source * growth) @ NODES_TO_INTEGRALS.T) / growth


class PanelNodes(NamedTuple):
    """The nodes of some panels, seen from some points (y, t): the arguments of an integrand.

    xi_minus_g is (t - y) - (T - x), and eta_minus_h is (t + y) - (T + x), with a row for each point
    and a column for each node. kernel(order) returns the kernel K (order 0) or its derivative K' or
    K'' by its argument, of the same shape. panels are the panels to which the nodes belong.
    """

    xi_minus_g: np.ndarray
    eta_minus_h: np.ndarray
    kernel: Callable[[int], np.ndarray | float]
    panels: slice


class DependenceDomains:
    """The domains of dependence of points (y, time) behind a curve, and the fields at the points.

    The domain of a point is the part of the curve in its past. Every field is an integral over it.
    Each method defines the integrand without the decay factor E, as a function of `PanelNodes`, and
    `_integrate` multiplies it by E. y and time are flat arrays.

    The symbols in the methods are those of the module docstring: the decay factor E, the kernel K,
    the curve t = T(x), g = T - x, h = T + x, xi = t - y, eta = t + y, and a static solution p(x).
    stiffness is k. left and right are the ends x_l and x_r of the integrals.
    """

    def __init__(
        self, curve: Curve, gamma: float, alpha: float, y: np.ndarray, time: np.ndarray
    ) -> None:
        """Find the domain of dependence of each point (y, time) on the front curve t = T(x).

        It ends where the characteristics t - y = xi and t + y = eta of the point meet the curve.
        """
        self.curve, self.y = curve, y
        self.alpha = alpha
        self.stiffness = gamma - 0.25 * alpha**2
        self.xi, self.eta = time - y, time + y
        self.left, self.right = curve.crossings(y, self.xi, self.eta)
        # A point on the curve at the end of a panel has an empty domain. Its left end is found on
        # the next panel. The integrals then use only the panel of the right end.
        self.is_empty = self.left.panel > self.right.panel
        self.first_panel = np.minimum(self.left.panel, self.right.panel)

    def slip_velocity(self) -> np.ndarray:
        """Return du/dt at the points."""
        # The source is tau dx/ds.
        source = self.curve.source
        return 0.5 * self._integrate(lambda nodes: nodes.kernel(0) * source[nodes.panels].ravel())

    def velocity_slopes(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the derivatives of du/dt by xi = t - y and by eta = t + y.

        The formula du/dt = 1/2 Int tau E K dx, where the integral is over the front from x_l to x_r
        and the argument of the kernel K is k (xi - g) (eta - h), has the derivatives

            by xi:   1/2 [k Int tau E K' (eta - h) dx - (E tau dx/dg at x_l)] - alpha/4 du/dt,
            by eta:  1/2 [k Int tau E K' (xi - g) dx  + (E tau dx/dh at x_r)] - alpha/4 du/dt.

        K' is the derivative of K by its argument. The terms at the ends arise because x_l (where
        g = xi) and x_r (where h = eta) move. K is 1 at both ends, because its argument is 0 there.
        The last terms arise from the decay factor E = exp(-alpha/4 [(xi - g) + (eta - h)]).
        """
        decay_left, decay_right = self._decay_at_ends()
        # E tau dx/dg at x_l, and E tau dx/dh at x_r.
        at_left_end = self._source_by_field("t_minus_x", self.left, decay_left)
        at_right_end = self._source_by_field("t_plus_x", self.right, decay_right)
        by_decay = 0.25 * self.alpha * self.slip_velocity() if self.alpha else 0.0
        if self.stiffness == 0.0:
            # K is 1 everywhere.
            return -0.5 * at_left_end - by_decay, 0.5 * at_right_end - by_decay
        source, k = self.curve.source, self.stiffness

        def kernel_terms(nodes: PanelNodes) -> np.ndarray:
            """Return tau K' (eta - h) and tau K' (xi - g), each times dx/ds, at nodes of the curve.

            The source is tau dx/ds. `_integrate` multiplies the result by E.
            """
            # The kernel of order 1 is K'.
            source_times_slope = nodes.kernel(1) * source[nodes.panels].ravel()
            return np.stack(
                [source_times_slope * nodes.eta_minus_h, source_times_slope * nodes.xi_minus_g]
            )

        # The two integrals with K', each named after its factor (eta - h) or (xi - g).
        with_eta_minus_h, with_xi_minus_g = self._integrate(kernel_terms, component_shape=(2,))
        by_xi = 0.5 * (k * with_eta_minus_h - at_left_end) - by_decay
        by_eta = 0.5 * (k * with_xi_minus_g + at_right_end) - by_decay
        return by_xi, by_eta

    def _source_by_field(
        self, field: str, end: Crossing, decay_at_end: np.ndarray | float
    ) -> np.ndarray:
        """Return E tau dx/dg (field "t_minus_x") or E tau dx/dh (field "t_plus_x") at an end.

        g = T - x and h = T + x are fields of the curve. end is the left or right end of each
        integral, and decay_at_end is the decay factor E there.
        """
        # dg/ds or dh/ds. The source is tau dx/ds, so that its quotient with dg/ds is tau dx/dg.
        slope = self.curve.evaluate(field, end.panel, end.s, order=1)
        # Where this slope is 0, tau is 0 too, and the quotient is set to about 0.
        slope = np.where(np.abs(slope) < 1e-300, 1e300, slope)
        return decay_at_end * self.curve.evaluate("source", end.panel, end.s) / slope

    def slip(self, static_solution: StaticSolution) -> np.ndarray:
        """Return the slip u at the points (y, t), by the formula

        2 u = 2 p(y) - E p(x_l) - E p(x_r)
              + Int E { -(p' dT + alpha/2 p dx) K + k p K' [(eta - h) dg - (xi - g) dh] },

        where p is the static solution, E the decay factor, and K the kernel.
        """
        k, alpha = self.stiffness, self.alpha

        def braces(nodes: PanelNodes) -> np.ndarray:
            """Return the braces in the formula for the slip, at nodes of the curve:

            { -(p' dT + alpha/2 p dx) K + k p K' [(eta - h) dg - (xi - g) dh] },

            where d means d/ds, the derivative by the parameter of the curve. `_integrate`
            multiplies the result by E.
            """
            p, dp_dx, dt_ds, dg_ds, dh_ds = static_solution.values_on(nodes.panels)
            kernel, kernel_slope = nodes.kernel(0), nodes.kernel(1)
            # Since x = (h - g)/2, alpha/2 p dx is alpha/4 p (dh - dg).
            factor_of_kernel = -dp_dx * dt_ds - 0.25 * alpha * p * (dh_ds - dg_ds)
            factor_of_slope = nodes.eta_minus_h * (k * p * dg_ds)
            factor_of_slope -= nodes.xi_minus_g * (k * p * dh_ds)
            return kernel * factor_of_kernel + kernel_slope * factor_of_slope

        # The first line of the formula, divided by 2. Order 0 means p itself.
        first_line = self._p_minus_mean_at_ends(static_solution, order=0)
        return first_line + 0.5 * self._integrate(braces)

    def strain(self, static_solution: StaticSolution) -> np.ndarray:
        """Return the strain du/dx at the points (y, t).

        The slip u is known from the formula

        2 u = 2 p(y) - E p(x_l) - E p(x_r)
              + Int E { -(p' dT + alpha/2 p dx) K + k p K' [(eta - h) dg - (xi - g) dh] },

        where p is the static solution, E the decay factor, and K the kernel with the argument
        z = k (xi - g) (eta - h). The derivative of this formula by y at constant t is

        2 du/dx = 2 p'(y) - E p'(x_l) - E p'(x_r)
                  + (alpha - k (t - T))/2 E p at x_l - (alpha - k (t - T))/2 E p at x_r
                  + Int E d{ ... }/dy.

        The second line, and p' at the ends, include the motion of the ends x_l and x_r, at which
        z = 0, K = 1 and K' = -1/4. In the integral, xi = t - y has the derivative -1 by y, and
        eta = t + y has the derivative 1. So dz/dy is k [(xi - g) - (eta - h)], the derivative of
        the square bracket is dg + dh, and E does not depend on y.
        """
        k, alpha = self.stiffness, self.alpha
        # The first line of the formula, divided by 2. Order 1 means dp/dx. Each further term has a
        # factor k or alpha.
        strain = self._p_minus_mean_at_ends(static_solution, order=1)
        if k == alpha == 0.0:
            return strain

        def derivative_of_braces(nodes: PanelNodes) -> np.ndarray:
            """Return the derivative by y of the braces in the formula for the slip:

            { -(p' dT + alpha/2 p dx) K + k p K' [(eta - h) dg - (xi - g) dh] },

            where d means d/ds, the derivative by the parameter of the curve. `_integrate`
            multiplies the result by E, which does not depend on y.
            """
            p, dp_dx, dt_ds, dg_ds, dh_ds = static_solution.values_on(nodes.panels)
            kernel_slope, kernel_curvature = nodes.kernel(1), nodes.kernel(2)
            # In the first term, only K depends on y. Since x = (h - g)/2, alpha/2 p dx is
            # alpha/4 p (dh - dg).
            factor_of_kernel = -dp_dx * dt_ds - 0.25 * alpha * p * (dh_ds - dg_ds)
            by_kernel = kernel_slope * (k * factor_of_kernel)
            # In the second term, K' and the square bracket depend on y.
            p_times_bracket = nodes.eta_minus_h * (p * dg_ds) - nodes.xi_minus_g * (p * dh_ds)
            by_kernel_slope = k**2 * kernel_curvature * p_times_bracket
            by_bracket = kernel_slope * (k * p * (dg_ds + dh_ds))
            # The derivative by y of the argument z of the kernel, divided by k.
            z_slope = nodes.xi_minus_g - nodes.eta_minus_h
            return z_slope * (by_kernel + by_kernel_slope) + by_bracket

        # The second line of the formula, divided by 2. Here p includes the factor E, and elapsed is
        # t - T.
        p_left, p_right = self._decayed_at_ends(static_solution, order=0)
        elapsed_left, elapsed_right = self._elapsed_at_ends()
        terms_with_k = 0.25 * k * (elapsed_right * p_right - elapsed_left * p_left)
        strain += terms_with_k - 0.25 * alpha * (p_right - p_left)
        return strain + 0.5 * self._integrate(derivative_of_braces)

    def _p_minus_mean_at_ends(self, static_solution: StaticSolution, order: int) -> np.ndarray:
        """Return p(y) - [E p(x_l) + E p(x_r)]/2 (order 0), or the same with dp/dx (order 1).

        p is the static solution, E the decay factor, and x_l and x_r are the ends of the integral.
        """
        at_points = static_solution.evaluate(*self.curve.locate(self.y), order)
        return at_points - 0.5 * sum(self._decayed_at_ends(static_solution, order))

    def _decayed_at_ends(
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
        elapsed_left, elapsed_right = self._elapsed_at_ends()
        return np.exp(-0.5 * self.alpha * elapsed_left), np.exp(-0.5 * self.alpha * elapsed_right)

    def _elapsed_at_ends(self) -> tuple[np.ndarray, np.ndarray]:
        """Return t - T at the left and right end of each integral: the time since the front came.

        In general 2 (t - T) = (xi - g) + (eta - h). At the left end xi = g, and at the right end
        eta = h.
        """
        eta_minus_h = self.eta - self.curve.evaluate("t_plus_x", self.left.panel, self.left.s)
        xi_minus_g = self.xi - self.curve.evaluate("t_minus_x", self.right.panel, self.right.s)
        return 0.5 * eta_minus_h, 0.5 * xi_minus_g

    def _integrate(
        self, integrand: Callable[[PanelNodes], np.ndarray], component_shape: tuple[int, ...] = ()
    ) -> np.ndarray:
        """Return the integral of a function times the decay factor E over the domain of each point.

        The integral is over the parameter s of the panels. integrand returns the values of the
        function at nodes of the curve. If component_shape is (2,), it returns those of two
        functions, and the result has one row of integrals for each of them.
        """
        # Without stiffness and drag the kernel and E are 1, and long curves have a faster way.
        if self.stiffness == self.alpha == 0.0 and len(self.curve.panels) > MAX_EAGER_PANELS:
            integrals = self._integrate_without_kernel(integrand)
        else:
            integrals = np.empty((*component_shape, self.xi.size))
            # Points whose integrals cover similar panels are computed together.
            order = np.lexsort((self.right.panel, self.left.panel))
            for start in range(0, order.size, POINTS_PER_CHUNK):
                points = order[start : start + POINTS_PER_CHUNK]
                integrals[..., points] = self._integrate_chunk(points, integrand, component_shape)
        integrals[..., self.is_empty] = 0.0
        return integrals

    def _integrate_chunk(
        self,
        points: np.ndarray,
        integrand: Callable[[PanelNodes], np.ndarray],
        component_shape: tuple[int, ...],
    ) -> np.ndarray:
        """Return the integrals of `_integrate` for some of the points, given by their numbers.

        The integrand is evaluated at the nodes of all panels that one of the points needs. Then the
        integral of each point is added up over its own panels. component_shape is () for one
        integrand, and (2,) for two.
        """
        curve = self.curve
        first_panel, last_panel = self.first_panel[points], self.right.panel[points]
        start, stop = int(first_panel.min()), int(last_panel.max()) + 1
        needed_panels = slice(start, stop)
        # From here on, panels are counted from `start`.
        first_panel, last_panel = first_panel - start, last_panel - start
        # Arrays with one row for each point and one column for each node of these panels.
        xi_minus_g = self.xi[points, None] - curve.t_minus_x[needed_panels].ravel()
        eta_minus_h = self.eta[points, None] - curve.t_plus_x[needed_panels].ravel()
        z = self.stiffness * xi_minus_g
        z *= eta_minus_h
        # z on the first and last panel of each point.
        z_by_panel = z.reshape(points.size, -1, NODE_COUNT)
        z_at_ends = z_by_panel[np.arange(points.size), np.array([last_panel, first_panel])]
        kernel = kernel_function(self.stiffness, z, z_at_ends)
        values = integrand(PanelNodes(xi_minus_g, eta_minus_h, kernel, needed_panels))
        if self.alpha:
            values = values * decay(self.alpha, xi_minus_g, eta_minus_h)
        return _integrate_between(
            values.reshape(*component_shape, points.size, -1, NODE_COUNT),
            first_panel=first_panel,
            first_s=self.left.s[points],
            last_panel=last_panel,
            last_s=self.right.s[points],
        )

    def _integrate_without_kernel(
        self, integrand: Callable[[PanelNodes], np.ndarray]
    ) -> np.ndarray:
        """Return the integrals of `_integrate` if the kernel K and the decay factor E are 1.

        Then the integrand is the same for all points. The integral over the domain of a point is
        the one from the left end of the curve to the right end of the domain, minus the one to the
        left end of the domain.
        """
        # Where an integrand contains xi - g, eta - h or a derivative of K, it has the factor k = 0.
        # So any values of them will do.
        unused, all_panels = np.zeros((1, 1)), slice(0, len(self.curve.panels))
        nodes = PanelNodes(unused, unused, kernel=lambda order: 1.0, panels=all_panels)
        values = np.broadcast_to(integrand(nodes), (1, self.curve.x.size))
        values_by_panel = values.reshape(-1, NODE_COUNT)
        before_panel = np.concatenate([[0.0], np.cumsum(values_by_panel @ WEIGHTS)])

        def integral_up_to(panel: np.ndarray, s: np.ndarray) -> np.ndarray:
            """Return the integrals from the left end of the curve to parameters s on panels."""
            on_panel = np.add.reduce(partial_weights(s) * values_by_panel[panel], axis=-1)
            return before_panel[panel] + on_panel

        up_to_right_end = integral_up_to(self.right.panel, self.right.s)
        return up_to_right_end - integral_up_to(self.first_panel, self.left.s)


def _integrate_between(
    values: np.ndarray,
    first_panel: np.ndarray,
    first_s: np.ndarray,
    last_panel: np.ndarray,
    last_s: np.ndarray,
) -> np.ndarray:
    """Return the integral over s for each point: from first_s on a panel to last_s on another one.

    values : the integrand at the nodes of all panels, [..., point, panel, node]
    first_panel, first_s, last_panel, last_s : one element for each point
    """
    # The sum over whole panels, from the first panel of a point to the one before its last.
    point, panel = np.arange(values.shape[-3]), np.arange(values.shape[-2])
    is_added = (panel >= first_panel[:, None]) & (panel < last_panel[:, None])
    over_whole_panels = np.add.reduce((values @ WEIGHTS) * is_added, axis=-1)
    # The part of the last panel up to last_s is added. The part of the first panel up to first_s is
    # subtracted.
    weights = partial_weights(np.concatenate([last_s, first_s]))
    last_weights, first_weights = weights.reshape(2, -1, NODE_COUNT)
    up_to_last_s = np.add.reduce(values[..., point, last_panel, :] * last_weights, axis=-1)
    up_to_first_s = np.add.reduce(values[..., point, first_panel, :] * first_weights, axis=-1)
    return over_whole_panels + up_to_last_s - up_to_first_s


def partial_weights(s: np.ndarray) -> np.ndarray:
    """Return weights of the nodes that integrate from the left end of a panel to a parameter s.

    There is one row for each s, and one column for each node of the panel.
    """
    return np.vander(s, NODE_COUNT + 1, increasing=True) @ POWERS_TO_WEIGHTS


def kernel_rate(gamma: float, alpha: float) -> float:
    """Return the fastest rate at which waves change in time, by leaf springs or by drag."""
    return max(float(np.sqrt(gamma)), 0.5 * abs(alpha))


def decay(alpha: float, xi_minus_g: np.ndarray, eta_minus_h: np.ndarray) -> np.ndarray:
    """Return the decay factor E = exp(-alpha (t - T)/2), where 2 (t - T) = (xi - g) + (eta - h)."""
    return np.exp(np.minimum(-0.25 * alpha * (xi_minus_g + eta_minus_h), MAX_EXPONENT))


def kernel_function(stiffness: float, z: np.ndarray, z_at_ends: np.ndarray) -> Callable:
    """Return a function that computes, for an order 0, 1 or 2, the kernel K, K' or K'' at z.

    z_at_ends are the values on the first and the last panel of each integral. The integral ends
    within these panels, but uses all of their nodes. For a positive stiffness, z is negative at the
    nodes beyond the ends, so the lowest z that is used is among z_at_ends. Lower values in z belong
    to panels that an integral does not reach.
    """
    if stiffness < 0.0:
        return partial(_bessel, z)
    return partial(_kernel_between, z, float(z_at_ends.min()), float(z.max()))


def _kernel_between(z: np.ndarray, lowest: float, highest: float, order: int) -> np.ndarray:
    """Return the kernel K(z) = J0(sqrt z), or its derivative of order 1 or 2 by z.

    For negative z it is I0(sqrt(-z)). A z below lowest or above highest belongs to a node that does
    not count. It is clipped, so that nothing overflows.
    """
    lower, upper = min(lowest, 0.0), max(highest, 0.0)
    if lower == upper == 0.0:
        return np.full(z.shape, KERNEL_AT_ZERO[order])
    if max(-lower, upper) > MAX_POLYNOMIAL_ARGUMENT:
        return _bessel(np.clip(z, lower, upper), order)
    # Bounds are widened to powers of two, so that a few polynomials serve all ranges. The
    # variable of the polynomial is -1 at the lower bound and 1 at the upper bound.
    lower, upper = _next_power_of_two(lower), _next_power_of_two(upper)
    scaled = z - 0.5 * (lower + upper)
    scaled *= 2.0 / (upper - lower)
    scaled.clip(-1.0, 1.0, out=scaled)
    # Horner's rule, in place.
    coefficients = _kernel_polynomial(lower, upper, order)
    value = coefficients[0] * scaled
    for coefficient in coefficients[1:-1]:
        value += coefficient
        value *= scaled
    return value + coefficients[-1]


def _next_power_of_two(bound: float) -> float:
    """Return a bound with its size rounded up to a power of two, at least 1; 0 remains 0."""
    if bound == 0.0:
        return 0.0
    exponent = max(0, math.ceil(math.log2(abs(bound))))
    return math.copysign(2.0**exponent, bound)


@lru_cache(maxsize=256)
def _kernel_polynomial(lower: float, upper: float, order: int) -> tuple[float, ...]:
    """Return the coefficients of a polynomial that approximates K(z) for z between two bounds.

    With order 1 or 2 it approximates K' or K''. The highest power comes first. The variable of the
    polynomial is -1 at the lower bound and 1 at the upper bound.
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
    # The smallest value avoids 0/0 at z = 0.
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
    # the terms of this equation cancel, the Taylor series is used. The divisor 1 there only avoids
    # a division by 0.
    is_small = np.abs(z) < 0.1
    series = (1.0 - z / 12.0 * (1.0 - z / 32.0 * (1.0 - z / 60.0 * (1.0 - z / 96.0)))) / 32.0
    divisor = np.where(is_small, 1.0, z)
    return np.where(is_small, series, -(slope + 0.25 * value) / divisor)
