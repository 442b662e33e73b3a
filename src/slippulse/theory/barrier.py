"""The distance that a steady pulse enters into a barrier of negative pre-stress.

A front at constant speed, as long as the pulse behind it, is continued into the barrier as a slow
front (`slow_front`) until it stops.
"""

import math

import numpy as np

from ..model.checks import check_number
from ..model.prestress import Prestress
from .closed_pulse import pulse_at_speed
from .curve import Curve
from .domains import check_domains
from .fast_front import straight_panels
from .front_speeds import front_speed
from .prestress_pieces import uniform_background
from .slow_front import Progress, SlowFront

# Largest length of a panel before the barrier, in units of 1/sqrt(gamma).
MAX_PANEL_LENGTH = 2.0
# Length that the panels before the barrier cover, in units of the memory of the pulse.
MEMORY_FACTOR = 1.5
# The smallest pre-stress before a barrier.
MIN_PRESTRESS = 1e-4
# The largest front speed, for which the pulse needs 12000 panels.
MAX_SPEED = 5e3
# The weakest barrier in which slow fronts are known to be resolved, in units of the pre-stress
# before it.
MIN_BARRIER_RATIO = 0.005
# The strongest such barrier.
MAX_BARRIER = 1e6


def barrier_depth(
    tau0: float,
    tau_barrier: float,
    gamma: float,
    damping_ratio: float = 0.0,
    release: str = "total",
) -> float:
    """Return the depth (units of H) at which a steady pulse dies in a barrier.

    A pulse passes through a barrier that is shorter than this.

    Raises ValueError: outside the domain.
    Source: the free boundary (`slow_front`) behind a front at constant speed, as dx -> 0.

    Parameters
    ----------
    tau0 : float, pre-stress before the barrier, from 1e-4 to 1, whose front is no faster than 5000
    tau_barrier : float, pre-stress of the barrier, from -1e6 to -tau0/200
    gamma : float, elasticity ratio, > 0
    damping_ratio, release : beta/dx, from 0 to 1e100; "total" or "elastic"

    Returns
    -------
    float, distance from the edge of the barrier (units of H), proportional to 1/sqrt(gamma)

    Examples
    --------
    >>> round(barrier_depth(0.5, -0.5, 0.65), 3)
    3.618
    """
    check_number("tau0", tau0, at_least=MIN_PRESTRESS, below=1.0)
    check_number(
        "tau_barrier", tau_barrier, at_least=-MAX_BARRIER, at_most=-MIN_BARRIER_RATIO * tau0
    )
    check_domains(gamma=gamma, damping_ratio=damping_ratio)
    speed = float(front_speed(tau0, damping_ratio, release))
    place = f"at tau0 = {tau0!r}, damping_ratio = {damping_ratio!r}"
    check_number(f"front speed {place}", speed, at_most=MAX_SPEED)
    # The depth is computed at gamma = 1, behind a front that is as long as the memory of its pulse:
    # a wave from the trailing edge, which follows at the pulse width, catches up over this length.
    width = pulse_at_speed(tau0, gamma=1.0, beta=0.0, speed=speed).width
    memory = MEMORY_FACTOR * width / (speed - 1.0) * speed
    # sqrt(dx^2 - dt^2) per unit of length along the front.
    proper_length = math.sqrt((speed - 1.0) * (speed + 1.0)) / speed
    panel_count = max(4, math.ceil(memory * proper_length / MAX_PANEL_LENGTH))
    edges = np.linspace(-memory, 0.0, panel_count + 1)
    # The front runs right and reaches the barrier, at x = 0, at t = 0. At x <= 0 its arrival time
    # x/v is that of `straight_panels` with the slowness -1/v.
    panels = straight_panels(edges, -1.0 / speed, tau0)
    background = uniform_background(tau_barrier)
    level = Prestress(left=tau_barrier, right=tau_barrier, width=None)
    # The slow front is continued by one panel at a time until it ends. The barrier is infinitely
    # long, so that there is no mark at which its negative pre-stress ends.
    stop, progress = None, Progress()
    while stop is None:
        front = SlowFront(Curve(panels), level, background, gamma=1.0)
        panel, stop, progress = front.next_panel(mark=math.inf, progress=progress)
        if panel is not None:
            panels.append(panel)
    if stop != "stops":
        raise ValueError(
            f"tau_barrier: {tau_barrier!r}, where the front is {stop} {place};"
            " allowed: levels on which it is resolved"
        )
    return panels[-1].end.x / math.sqrt(gamma)


def barrier_depth_estimate(tau0: float, tau_barrier: float, gamma: float) -> float:
    """Return an estimate of the depth, (2/gamma) ln((tau_barrier - tau_0)/tau_barrier).

    The paper does not have this estimate; its authors use it in public code that they wrote later.
    Raises ValueError: outside the domain.

    Parameters
    ----------
    tau0, tau_barrier, gamma : floats, pre-stress before the barrier, in (0, 1), pre-stress in it,
        < 0, and elasticity ratio, > 0

    Returns
    -------
    float, distance (units of H)

    Examples
    --------
    >>> round(barrier_depth_estimate(0.5, -0.5, 0.65), 3)
    2.133
    """
    check_domains(tau0=tau0, gamma=gamma)
    check_number("tau_barrier", tau_barrier, below=0.0)
    return 2.0 / gamma * math.log((tau_barrier - tau0) / tau_barrier)
