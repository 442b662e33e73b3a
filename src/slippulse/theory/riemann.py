"""Riemann's formula behind a rupture front: slip, velocity and strain as integrals along the curve t = T(x).

Each position feels its pre-stress from T(x) on, and the undamped equation u_tt = u_xx - gamma u + tau has the
retarded solution J0/2 inside the cone. With xi = t - y, eta = t + y, g = T - x, h = T + x and K(z) = J0(sqrt z) at
z = gamma (xi - g)(eta - h), between the points x_l, x_r where the characteristics through (y, t) meet the curve,

    2 du/dt = Int tau K dx
    2 u     = 2 p(y) - p(x_l) - p(x_r) + Int { -p' K dT + gamma p K' [(eta - h) dg - (xi - g) dh] }

as long as no stuck point lies in the past of (y, t). p(x) is any solution at rest, p'' - gamma p + tau = 0.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import legendre

from .curve import COUNT, INTEGRATE, WEIGHTS, Curve
from .kernel import riemann, riemann_bend, riemann_slope
from .stationary import Stationary

# Points whose cones are computed together: their arrays stay in the cache.
CHUNK = 192


class Cones:
    """The past cones of points behind a curve.

    Parameters
    ----------
    curve : of the fronts
    gamma : elasticity ratio, or 0
    y, time : the points, flat arrays
    """

    def __init__(self, curve: Curve, gamma: float, y: np.ndarray, time: np.ndarray) -> None:
        self.curve, self.gamma, self.y = curve, gamma, y
        self.xi, self.eta = time - y, time + y
        self.left, self.right = curve.left(y, self.xi), curve.right(y, self.eta)

    def slip_velocity(self) -> np.ndarray:
        """du/dt."""
        weight = self.curve.source

        def kernel(behind, beside, z, bounds, panels):
            return riemann(z, bounds) * weight[panels].ravel()

        return 0.5 * self._along(kernel)

    def velocity_slopes(self) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives of du/dt by t - y and by t + y: of the formula's ends and of its kernel."""
        curve, gamma = self.curve, self.gamma
        ends = []
        for name, cross in (("early", self.left), ("late", self.right)):
            slope = curve.slope(name, cross.panel, cross.place)
            # Where the slope is 0 so is tau, and the end contributes nothing.
            slope = np.where(np.abs(slope) < 1e-300, 1e300, slope)
            ends.append(curve.at("source", cross.panel, cross.place) / slope)
        if gamma == 0.0:
            return -0.5 * ends[0], 0.5 * ends[1]

        def by_xi(behind, beside, z, bounds, panels):
            return gamma * riemann_slope(z, bounds) * beside * curve.source[panels].ravel()

        def by_eta(behind, beside, z, bounds, panels):
            return gamma * riemann_slope(z, bounds) * behind * curve.source[panels].ravel()

        return 0.5 * (self._along(by_xi) - ends[0]), 0.5 * (self._along(by_eta) + ends[1])

    def slip(self, rest: Stationary) -> np.ndarray:
        """u."""
        gamma = self.gamma

        def kernel(behind, beside, z, bounds, panels):
            p, bend, time, early, late = rest.along(panels)
            out = riemann(z, bounds) * (-bend * time)
            if gamma > 0.0:
                out += riemann_slope(z, bounds) * (beside * (gamma * p * early) - behind * (gamma * p * late))
            return out

        ends = rest.at(self.left) + rest.at(self.right)
        return rest.value(self.y) - 0.5 * ends + 0.5 * self._along(kernel)

    def strain(self, rest: Stationary) -> np.ndarray:
        """du/dx, the derivative of the formula for u."""
        gamma, curve = self.gamma, self.curve
        ends = rest.slope_at(self.left) + rest.slope_at(self.right)
        out = rest.slope(self.y) - 0.5 * ends
        if gamma == 0.0:
            return out

        def kernel(behind, beside, z, bounds, panels):
            p, bend, time, early, late = rest.along(panels)
            apart = beside - behind
            slope = riemann_slope(z, bounds)
            growth = gamma**2 * riemann_bend(z, bounds) * (beside * (p * early) - behind * (p * late))
            return apart * (slope * (gamma * bend * time) - growth) + slope * (gamma * p * (early + late))

        behind = self.xi - curve.at("early", self.right.panel, self.right.place)
        beside = self.eta - curve.at("late", self.left.panel, self.left.place)
        out += 0.125 * gamma * (rest.at(self.right) * behind - rest.at(self.left) * beside)
        return out + 0.5 * self._along(kernel)

    def _along(self, kernel) -> np.ndarray:
        """Integral of a kernel, given per unit of the panels' parameter, between the ends of each cone."""
        curve, gamma = self.curve, self.gamma
        out = np.empty(self.xi.shape)
        # Cones of about the same panels together.
        order = np.lexsort((self.right.panel, self.left.panel))
        for start in range(0, out.size, CHUNK):
            part = order[start : start + CHUNK]
            high = self.right.panel[part]
            low = np.minimum(self.left.panel[part], high)
            first, last = int(low.min()), int(high.max()) + 1
            panels = slice(first, last)
            behind = self.xi[part, None] - curve.early[panels].ravel()
            beside = self.eta[part, None] - curve.late[panels].ravel()
            z = gamma * behind * beside
            rows, here = np.arange(low.size), np.arange(last - first)
            ends = (low - first, high - first)
            boxes = kernel(behind, beside, z, _bounds(z, rows, ends), panels).reshape(low.size, -1, COUNT)
            whole = (here >= ends[0][:, None]) & (here < ends[1][:, None])
            total = np.sum(np.where(whole, boxes @ WEIGHTS, 0.0), axis=1)
            # The panels at both ends are cut.
            for sign, end, cross in zip((-1.0, 1.0), ends, (self.left, self.right), strict=True):
                total += sign * np.sum(boxes[rows, end] * partial_weights(cross.place[part]), axis=1)
            out[part] = total
        # A point on the curve, at the end of a panel: its cone is empty.
        return np.where(self.left.panel > self.right.panel, 0.0, out)


def partial_weights(place: np.ndarray) -> np.ndarray:
    """Weights at a panel's nodes of the integral from its left end to a place on it."""
    return legendre.legvander(place, COUNT) @ INTEGRATE


def _bounds(z: np.ndarray, rows: np.ndarray, ends) -> tuple[float, float]:
    """The range of z that counts: all above 0, and below it that of the cut panels, continued beyond the cone."""
    boxes = z.reshape(z.shape[0], -1, COUNT)
    lower = min(float(boxes[rows, end].min()) for end in ends)
    return min(lower, 0.0), max(float(z.max()), 0.0)
