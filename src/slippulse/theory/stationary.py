"""The state at rest, p'' - gamma p + tau = 0, on the panels of a rupture front."""

from __future__ import annotations

from itertools import accumulate

import numpy as np

from .curve import CUMULATIVE, SLOPE, TO_POWERS, WEIGHTS, Crossing, Curve, horner


class Stationary:
    """One solution p of p'' - gamma p + tau = 0 along a curve: which one makes no difference to u.

    Parameters
    ----------
    curve : of the fronts
    gamma : elasticity ratio; 0 gives p'' = -tau

    Source: for gamma > 0 the bounded one, exp(-sqrt(gamma) |x|)/(2 sqrt(gamma)) convolved with tau, which is continued
    beyond the curve at its outermost values; summed from panel to panel in the direction in which it decays.
    """

    def __init__(self, curve: Curve, gamma: float) -> None:
        self.curve = curve
        if gamma == 0.0:
            p, slope = _double_integral(curve)
        else:
            k = float(np.sqrt(gamma))
            right = _decaying(k, curve.x, curve.source, curve.edges)
            left = _decaying(k, -curve.x[::-1, ::-1], curve.source[::-1, ::-1], -curve.edges[::-1])[
                ::-1, ::-1
            ]
            p, slope = (right + left) / (2.0 * k), 0.5 * (left - right)
        self.p, self.bend = p, slope
        # Derivatives by the panels' parameter.
        self.time, self.early, self.late = (
            values @ SLOPE.T for values in (curve.time, curve.early, curve.late)
        )
        self._powers = [np.ascontiguousarray((values @ TO_POWERS.T).T) for values in (p, slope)]

    def along(self, panels: slice) -> tuple[np.ndarray, ...]:
        """p and p' at the nodes, and dT/ds, dg/ds, dh/ds."""
        return tuple(a[panels].ravel() for a in (self.p, self.bend, self.time, self.early, self.late))

    def at(self, cross: Crossing) -> np.ndarray:
        """p where characteristics meet the curve."""
        return horner(self._powers[0], cross.panel, cross.place)

    def slope_at(self, cross: Crossing) -> np.ndarray:
        """p' there."""
        return horner(self._powers[1], cross.panel, cross.place)

    def value(self, x: np.ndarray) -> np.ndarray:
        """p at positions."""
        return horner(self._powers[0], *self.curve.place(x))

    def slope(self, x: np.ndarray) -> np.ndarray:
        """p' at positions."""
        return horner(self._powers[1], *self.curve.place(x))


def _decaying(k: float, x: np.ndarray, source: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Int_{-inf}^x exp(-k (x - x')) tau dx' at the nodes."""
    within = np.exp(k * (x - edges[:-1, None]))
    lengths = np.diff(edges)
    first = float(source[0, 0] / (SLOPE[0] @ x[0]))
    gains = np.exp(-k * lengths) * ((source * within) @ WEIGHTS)
    steps = list(zip(np.exp(-k * lengths).tolist(), gains.tolist(), strict=True))
    starts = np.array(
        list(accumulate(steps, lambda value, step: value * step[0] + step[1], initial=first / k))[:-1]
    )
    return (starts[:, None] + (source * within) @ CUMULATIVE.T) / within


def _double_integral(curve: Curve) -> tuple[np.ndarray, np.ndarray]:
    """p'' = -tau with p = p' = 0 at the left end."""
    gain = curve.source @ WEIGHTS
    slope = -(np.cumsum(gain) - gain)[:, None] - curve.source @ CUMULATIVE.T
    speed = slope * (curve.x @ SLOPE.T)
    gain = speed @ WEIGHTS
    return (np.cumsum(gain) - gain)[:, None] + speed @ CUMULATIVE.T, slope
