"""How deep a steady pulse enters a barrier: a level of negative pre-stress under leaf springs."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from ..model.checks import check_domains, check_number
from ..model.prestress import Prestress
from .curve import Curve
from .front_law import front_speed
from .fronts import straight_panel
from .pulse import pulse_behind_front
from .slow_front import advance

# Panels behind the barrier, each so long in units of 1/sqrt(gamma), as far as the barrier remembers.
LONGEST = 2.0
MEMORY = 1.5
# Below it the estimate may be beyond floating point.
SMALLEST = 1e-100
# Levels, in units of the pre-stress before them the weakest, on which slow fronts were found to be resolved, and the
# fastest front before them, whose pulse takes 12000 panels.
SLOWEST, WEAKEST, STRONGEST, FASTEST = 1e-4, 0.005, 1e6, 5e3


def barrier_depth(
    tau0: float, tau_barrier: float, gamma: float, damping_ratio: float = 0.0, release: str = "total"
) -> float:
    """Distance from the edge of a barrier at which a steady pulse dies; a shorter barrier is passed.

    Parameters
    ----------
    tau0 : pre-stress in which the pulse is steady, from 1e-4 to 1, with a front no faster than 5000
    tau_barrier : pre-stress of the barrier, from -1e6 to -tau0/200
    gamma : elasticity ratio, > 0
    damping_ratio : beta/dx, from 0 to 1e100
    release : "total" or "elastic"

    Raises ValueError: outside the domain.
    Source: the free boundary (`slow_front`) behind a front at constant speed, in the continuum limit.
    """
    check_number("tau0", tau0, at_least=SLOWEST, below=1.0)
    check_number("tau_barrier", tau_barrier, at_least=-STRONGEST, at_most=-WEAKEST * tau0)
    check_domains(gamma=gamma, damping_ratio=damping_ratio)
    speed = float(front_speed(tau0, damping_ratio, release))
    check_number(f"front speed at tau0 = {tau0!r}, damping_ratio = {damping_ratio!r}", speed, at_most=FASTEST)
    # The depth scales like 1/sqrt(gamma). Its characteristics entered no further back than the pulse remembers.
    memory = MEMORY * pulse_behind_front(tau0, 1.0, 0.0, speed).width / (speed - 1.0) * speed
    proper = math.sqrt((speed - 1.0) * (speed + 1.0)) / speed
    edges = np.linspace(-memory, 0.0, max(4, math.ceil(memory * proper / LONGEST)) + 1)
    # T rises to the right, as behind a pulse that comes from far away.
    panels = [straight_panel(a, b, 1.0 / speed, tau0) for a, b in pairwise(edges.tolist())]
    level = Prestress(left=tau_barrier, right=tau_barrier, peak=tau_barrier)
    stop = None
    while stop is None:
        panel, stop = advance(Curve(panels), level, tau_barrier, 1.0, math.inf)
        if panel is not None:
            panels.append(panel)
    if stop != "dead":
        raise ValueError(
            f"tau_barrier: {tau_barrier!r}, where the front is {stop} at tau0 = {tau0!r}, damping_ratio ="
            f" {damping_ratio!r}; allowed: levels on which it is resolved"
        )
    return panels[-1].x_ends[1] / math.sqrt(gamma)


def barrier_depth_estimate(tau0: float, tau_barrier: float, gamma: float) -> float:
    """The later estimate of the depth, (2/gamma) ln((tau_barrier - tau_0)/tau_barrier).

    Parameters
    ----------
    tau0 : pre-stress before the barrier, in (0, 1)
    tau_barrier : pre-stress of the barrier, <= -1e-100
    gamma : elasticity ratio, >= 1e-100

    Raises ValueError: outside the domain.
    Source: the authors' public code of later work.
    """
    check_domains(tau0=tau0)
    check_number("tau_barrier", tau_barrier, at_most=-SMALLEST)
    check_number("gamma", gamma, at_least=SMALLEST)
    return 2.0 / gamma * math.log((tau_barrier - tau0) / tau_barrier)
