"""The depth to which a steady pulse enters a barrier, a region of negative pre-stress.

The front runs up to the barrier at constant speed. In the barrier it is slower than the waves, and
is followed (`slow_front`) until it stops.
"""

import math

import numpy as np

from ..model.checks import check_number
from ..model.prestress import Prestress
from .closed_pulse import pulse_at_speed
from .curve import Curve, Panel
from .domains import check_domains
from .fast_front import straight_panels
from .front_speeds import front_speed
from .prestress_pieces import uniform_background
from .slow_front import Progress, SlowFront

# Largest length of a panel before the barrier, in units of 1/sqrt(gamma).
MAX_PANEL_LENGTH = 2.0
# Length that the panels before the barrier cover, in units of the memory length of the pulse.
MEMORY_FACTOR = 1.5
# The smallest pre-stress before a barrier.
MIN_PRESTRESS = 1e-4
# The largest front speed, for which the pulse needs 12000 panels.
MAX_SPEED = 5e3
# Slow fronts are known to be resolved if the size of the negative pre-stress of a barrier is at
# least this fraction of the pre-stress before it ...
MIN_BARRIER_RATIO = 0.005
# ... and at most this.
MAX_BARRIER = 1e6


def barrier_depth(
    tau0: float,
    tau_barrier: float,
    gamma: float,
    damping_ratio: float = 0.0,
    release: str = "total",
) -> float:
    """Return the depth (units of H) at which a steady pulse dies in a barrier.

    A barrier is a region of negative pre-stress. A pulse passes through a barrier that is shorter
    than this depth.

    Raises ValueError: outside the domain.
    Source: the path of a front that is slower than the waves (`slow_front`), as dx -> 0.

    Parameters
    ----------
    tau0 : float, pre-stress before the barrier, from 1e-4 to 1; its front runs at most at 5000
        wave speeds
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
    arguments = f"tau0 = {tau0!r}, damping_ratio = {damping_ratio!r}"
    check_number(f"front speed at {arguments}", speed, at_most=MAX_SPEED)
    # The depth is computed at gamma = 1, for a barrier that begins at x = 0.
    panels, reason = _continue_into_barrier(_panels_before_barrier(tau0, speed), tau_barrier)
    if reason != "stops":
        raise ValueError(
            f"tau_barrier: {tau_barrier!r}; the motion of the front in this barrier is {reason}"
            f" ({arguments}); allowed: levels at which the motion of the front is resolved"
        )
    return panels[-1].end.x / math.sqrt(gamma)


def _panels_before_barrier(tau0: float, speed: float) -> list[Panel]:
    """Return the panels of a front that runs right and reaches the barrier, at x = 0, at t = 0.

    tau0 and speed are the pre-stress and the front speed before the barrier. The elasticity ratio
    is 1. The panels cover a little more than the memory length of the pulse, because what happened
    on the front before has no influence on the pulse.
    """
    # A wave that starts on the front follows it at the speed 1. It remains in the pulse until the
    # trailing edge overtakes it, after the time width/(v - 1). In this time the front runs over the
    # memory length.
    width = pulse_at_speed(tau0, gamma=1.0, beta=0.0, speed=speed).width
    length = MEMORY_FACTOR * width / (speed - 1.0) * speed
    # sqrt(dx^2 - dt^2) per unit of length along the front.
    proper_length = math.sqrt((speed - 1.0) * (speed + 1.0)) / speed
    panel_count = max(4, math.ceil(length * proper_length / MAX_PANEL_LENGTH))
    edges = np.linspace(-length, 0.0, panel_count + 1)
    # `straight_panels` takes the arrival time divided by |x|. The arrival time is x/v = -|x|/v.
    return straight_panels(edges, -1.0 / speed, tau0)


def _continue_into_barrier(panels: list[Panel], tau_barrier: float) -> tuple[list[Panel], str]:
    """Continue a front into the barrier, panel by panel, until it ends.

    Return the panels, those before the barrier included, and the reason of the end ("stops" if the
    front stops). The barrier has the pre-stress tau_barrier everywhere. The elasticity ratio is 1.
    """
    panels = list(panels)
    background = uniform_background(tau_barrier)
    prestress = Prestress(left=tau_barrier, right=tau_barrier, width=None)
    # The reason is None as long as the front can go on. progress is the state of the front, which
    # one step hands over to the next.
    reason, progress = None, Progress()
    while reason is None:
        front = SlowFront(Curve(panels), prestress, background, gamma=1.0)
        # The mark, where the negative pre-stress ends, is infinitely far away.
        panel, reason, progress = front.next_panel(mark=math.inf, progress=progress)
        if panel is not None:
            panels.append(panel)
    return panels, reason


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
