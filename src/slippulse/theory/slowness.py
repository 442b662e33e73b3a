"""1/v of a front into given pre-stress, for many pre-stresses at once.

With 1/v = cos(psi), tau_0 = M_+(0) is smooth in psi at every damping ratio b, and is sin(psi) at
b = 0. For small b it bends within a distance of about b of psi = 0 (from psi^2 to psi) and of
psi = pi/2. So it is interpolated on panels that are halved until they resolve it, and inverted by
Newton's method.
"""

from functools import lru_cache

import numpy as np
from numpy.polynomial import legendre

from .curve import power_basis, value_and_slope, with_slopes
from .front_speeds import log_prestress_in_chunks, slowness_nearly_one

# Nodes on a panel, and the largest last coefficients of the pre-stress on it.
NODE_COUNT = 14
NODES = legendre.leggauss(NODE_COUNT)[0]
NODES_TO_SERIES = np.linalg.inv(legendre.legvander(NODES, NODE_COUNT - 1))
SERIES_TO_POWERS = with_slopes(np.pad(power_basis(NODE_COUNT), ((0, 2), (0, 0))))
RESOLVED = 2e-12
NARROWEST = 1e-7
# So near 1, in 1 - tau, the panels lose as many digits as the first terms in 1/v leave out.
NEARLY_ONE = 1e-8
# Beyond this ratio, under rule "total", psi is so near pi/2 that 1/v loses its digits: 5e-10 of it
# are lost here, all of it at 1e9.
LARGEST_RATIO = 1e6


def slowness(tau, damping_ratio: float, release: str = "total") -> np.ndarray:
    """1/v of a front into pre-stress tau, to 1e-11, and to 1e-8 next to tau = 1.

    It is 0 where tau >= 1 and 1 where tau <= 0.
    """
    tau = np.clip(np.asarray(tau, dtype=float), 0.0, 1.0)
    if damping_ratio == 0.0:
        return np.sqrt((1.0 - tau) * (1.0 + tau))
    edges, edge_tau, powers = _panels(float(damping_ratio), release)
    shape, tau = tau.shape, tau.ravel()
    panel = np.clip(np.searchsorted(edge_tau, tau, side="right") - 1, 0, edges.size - 2)
    low, high = edge_tau[panel], edge_tau[panel + 1]
    s = 2.0 * (tau - low) / (high - low) - 1.0
    # On the first panel tau grows like psi^2, and Newton's method starts from above.
    s = np.where(panel == 0, 2.0 * np.sqrt((tau - low) / (high - low)) - 1.0, s)
    coefficients = powers.take(panel, axis=-1)
    for _ in range(12):
        value, slope = value_and_slope(coefficients, s)
        step = (value - tau) / np.maximum(slope, 1e-12)
        s = (s - step).clip(-1.0, 1.0)
        if np.max(np.abs(step), initial=0.0) < 1e-11:
            break
    # The end of the first panel is a double root.
    s = np.where(tau <= 0.0, -1.0, s)
    out = np.cos(edges[panel] + 0.5 * (edges[panel + 1] - edges[panel]) * (1.0 + s))
    # The end of the last panel may be one, too, and the first terms in 1/v are better there.
    near = (1.0 - tau < NEARLY_ONE) & ((release == "total") | (damping_ratio < 1e3))
    out[near] = slowness_nearly_one(tau[near], damping_ratio, release)
    return out.reshape(shape)


@lru_cache(maxsize=32)
def _panels(damping_ratio: float, release: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Edges of panels in psi, the pre-stress there, and on each panel for `value_and_slope`."""

    def prestress(psi: np.ndarray) -> np.ndarray:
        excess = 2.0 * np.sin(0.5 * psi) ** 2 / np.cos(psi)
        return np.exp(log_prestress_in_chunks(excess, np.full(excess.size, damping_ratio), release))

    quarter = 0.5 * np.pi
    todo = [(0.0, 0.5 * quarter), (0.5 * quarter, quarter)]
    done = []
    while todo:
        left, right = todo.pop()
        series = NODES_TO_SERIES @ prestress(left + 0.5 * (right - left) * (1.0 + NODES))
        if np.max(np.abs(series[-2:])) < RESOLVED or right - left < NARROWEST:
            done.append((left, right, series))
        else:
            middle = 0.5 * (left + right)
            todo += [(left, middle), (middle, right)]
    done.sort(key=lambda panel: panel[0])
    edges = np.array([done[0][0]] + [right for _, right, _ in done])
    inner = prestress(edges[1:-1])
    powers = SERIES_TO_POWERS @ np.array([series for *_, series in done]).T
    return edges, np.concatenate([[0.0], inner, [1.0]]), powers
