"""The inverse speed 1/v of a front as a function of the pre-stress ahead, for many pre-stresses.

A formula in `front_speeds` gives the pre-stress for a speed. This module interpolates and inverts
that function, since a front needs the speed at many positions. The variable is an angle psi from 0
to pi/2, with 1/v = cos(psi). The pre-stress is a smooth function of psi at every damping ratio b.
At b = 0 it is sin(psi). For small b it differs from sin(psi) only within a distance of about b from
both ends of the range. The pre-stress is interpolated on panels in psi, which are halved until they
resolve it, and inverted by Newton's method.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from .curve import power_basis, value_and_slope, with_slopes
from .front_speeds import log_prestress_in_chunks, slowness_nearly_one

# Number of nodes on a panel, the nodes, and matrices from values at the nodes to a Legendre series
# and from the series to powers. Two powers are added, because `with_slopes` needs a multiple of 4.
NODE_COUNT = 14
NODES = legendre.leggauss(NODE_COUNT)[0]
NODES_TO_SERIES = np.linalg.inv(legendre.legvander(NODES, NODE_COUNT - 1))
SERIES_TO_POWERS = with_slopes(np.pad(power_basis(NODE_COUNT), ((0, 2), (0, 0))))
# A panel is resolved if the last two coefficients of the Legendre series on it are below this.
SERIES_TOLERANCE = 2e-12
# A narrower panel is not halved.
MIN_PANEL_WIDTH = 1e-7
MAX_NEWTON_STEPS = 12
# If 1 - tau is below this, the panels lose more digits than the neglected terms of the expansion in
# 1/v.
NEARLY_ONE_DISTANCE = 1e-8
# Beyond this damping ratio, under rule "total", psi is so near to pi/2 that 1/v loses its digits.
# At this ratio the relative error is 5e-10, and at 1e9 no digits are left.
LARGEST_RATIO = 1e6


class FrontLawPanels(NamedTuple):
    """Panels in psi: their edges, the pre-stress at the edges, and the pre-stress as polynomials.

    powers has the coefficients of one polynomial for each panel, as `value_and_slope` needs them.
    """

    edges: np.ndarray
    edge_tau: np.ndarray
    powers: np.ndarray


def slowness(tau, damping_ratio: float, release: str = "total") -> np.ndarray:
    """Return 1/v of a front into pre-stress tau; 0 where tau >= 1 and 1 where tau <= 0.

    damping_ratio is beta/dx, and release is the rule "total" or "elastic". The error of 1/v is
    1e-11, and 1e-8 next to tau = 1.
    """
    tau = np.clip(np.asarray(tau, dtype=float), 0.0, 1.0)
    if damping_ratio == 0.0:
        return np.sqrt((1.0 - tau) * (1.0 + tau))
    panels = _make_panels(float(damping_ratio), release)
    shape, tau = tau.shape, tau.ravel()
    inverse_speed = np.cos(_angle_of_prestress(tau, panels))
    # Next to tau = 1 an expansion in 1/v is more accurate. Under rule "elastic" it holds only for
    # fronts that are much faster than the damping ratio.
    may_be_expanded = (release == "total") | (damping_ratio < 1e3)
    is_nearly_one = (1.0 - tau < NEARLY_ONE_DISTANCE) & may_be_expanded
    inverse_speed[is_nearly_one] = slowness_nearly_one(tau[is_nearly_one], damping_ratio, release)
    return inverse_speed.reshape(shape)


def _angle_of_prestress(tau: np.ndarray, panels: FrontLawPanels) -> np.ndarray:
    """Return the angle psi of the front into each pre-stress tau, where 1/v = cos(psi).

    On its panel, tau is a polynomial of a parameter s from -1 to 1. Newton's method finds s.
    """
    edges, edge_tau, powers = panels
    panel = np.clip(np.searchsorted(edge_tau, tau, side="right") - 1, 0, edges.size - 2)
    fraction = (tau - edge_tau[panel]) / (edge_tau[panel + 1] - edge_tau[panel])
    # On the first panel tau grows like psi^2 from psi = 0 on, and elsewhere nearly linearly.
    fraction_of_panel = np.where(panel == 0, np.sqrt(fraction), fraction)
    s = 2.0 * fraction_of_panel - 1.0
    coefficients = powers.take(panel, axis=-1)
    for _ in range(MAX_NEWTON_STEPS):
        value, slope = value_and_slope(coefficients, s)
        step = (value - tau) / np.maximum(slope, 1e-12)
        s = (s - step).clip(-1.0, 1.0)
        if np.max(np.abs(step), initial=0.0) < 1e-11:
            break
    # The double root at psi = 0 is set, because Newton's method converges slowly to it.
    s = np.where(tau <= 0.0, -1.0, s)
    return edges[panel] + 0.5 * (edges[panel + 1] - edges[panel]) * (1.0 + s)


@lru_cache(maxsize=32)
def _make_panels(damping_ratio: float, release: str) -> FrontLawPanels:
    """Return panels on which the pre-stress is resolved as a function of psi."""

    def prestress(psi: np.ndarray) -> np.ndarray:
        """Return the pre-stress of fronts with 1/v = cos(psi)."""
        # v - 1 = (1 - cos psi)/cos psi, written without cancellation.
        excess_speed = 2.0 * np.sin(0.5 * psi) ** 2 / np.cos(psi)
        damping_ratios = np.full(excess_speed.size, damping_ratio)
        return np.exp(log_prestress_in_chunks(excess_speed, damping_ratios, release))

    # psi runs from 0 (v = 1) to pi/2 (infinite speed).
    last_psi = 0.5 * np.pi
    unresolved_panels = [(0.0, 0.5 * last_psi), (0.5 * last_psi, last_psi)]
    # Legendre series of the resolved panels, by the left end of each panel.
    series_by_left_end = {}
    while unresolved_panels:
        left, right = unresolved_panels.pop()
        series = NODES_TO_SERIES @ prestress(left + 0.5 * (right - left) * (1.0 + NODES))
        is_resolved = np.max(np.abs(series[-2:])) < SERIES_TOLERANCE
        if is_resolved or right - left < MIN_PANEL_WIDTH:
            series_by_left_end[left] = series
        else:
            middle = 0.5 * (left + right)
            unresolved_panels += [(left, middle), (middle, right)]
    left_ends = sorted(series_by_left_end)
    edges = np.array([*left_ends, last_psi])
    edge_tau = np.concatenate([[0.0], prestress(edges[1:-1]), [1.0]])
    powers = SERIES_TO_POWERS @ np.array([series_by_left_end[left] for left in left_ends]).T
    return FrontLawPanels(edges, edge_tau, powers)
