"""Compare measured and derived limits of the time step, for every scheme and damping ratio.

The measured limit is the largest step at which a lattice run is stable. If the run is unstable, a
growing wave makes slip velocities negative, so that blocks stick. For no other reason does a block
stick in the runs of this study.
"""

import math
from collections.abc import Callable
from functools import partial
from itertools import product
from typing import NamedTuple

import pandas as pd

from slippulse.model.prestress import Prestress
from slippulse.model.scene import ORDERS, Scene
from slippulse.model.stability import largest_step
from slippulse.solver.fixed_step import LATTICES
from slippulse.solver.lattice import UnstableRun

NEEDS = {"settings": ()}

# No damping, the damping ratio of the paper's figures (0.1), and one value in each decade.
DAMPING_RATIOS = (0.0, 0.01, 0.1, 1.0, 10.0, 100.0)
# The bisection searches between these fractions of the derived limit, and ends at this relative
# accuracy. The range is wide, because some orders grow so slowly just above their derived limit
# that a run does not show it.
SMALLEST_FRACTION, LARGEST_FRACTION = 0.7, 12.0
RELATIVE_ACCURACY = 0.01
# Numbers of sliding blocks on each side of x = 0, and of time steps. An unstable wave grows from
# rounding errors to a visible size in so many steps. At that time, no wave has crossed the blocks
# yet.
BLOCK_COUNT, STEP_COUNT = 400, 400
# At this pre-stress no block is ever released. Walls of it enclose the sliding blocks.
HELD_PRESTRESS = -1.0e9
WALLS = ((BLOCK_COUNT + 0.5, HELD_PRESTRESS), (-BLOCK_COUNT - 0.5, HELD_PRESTRESS))
# Number of time steps between two checks for sticks.
CHECK_INTERVAL = 100
# Pre-stress of both measurements, by the column of the table.
PROFILES = {
    # A stress far above the threshold releases all blocks at once, and no event follows until they
    # reverse.
    "measured": Prestress(0.9, 0.9, 10.0 * BLOCK_COUNT, peak=100.9, steps=WALLS),
    # An endless crack has an event in almost every step.
    "measured_rupture": Prestress(0.5, 0.5, 8.0),
}


class StableFraction(NamedTuple):
    """The largest stable step divided by the derived limit.

    place : "within" if the bisection found the fraction. The text is "below" if even the smallest
        fraction is unstable, or "above" if even the largest one is stable. The fraction is then
        the smallest or the largest one.
    """

    fraction: float
    place: str


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return one row for each scheme, order and damping ratio, with steps in units of dx.

    derived : the largest stable step, as derived
    measured, measured_rupture : the largest step at which no block sticks, for each of PROFILES
    measured_ratio, measured_rupture_ratio : this step divided by the derived limit
    measured_limit, measured_rupture_limit : "within" if the step was found by bisection, "below" or
        "above" if it is outside the searched range
    """
    schemes_and_orders = [("fixed_step", 1)]
    schemes_and_orders += [("localised", order) for order in ORDERS]
    rows = []
    for (scheme, order), damping_ratio in product(schemes_and_orders, DAMPING_RATIOS):
        derived = largest_step(scheme, order, damping_ratio, gamma_dx2=0.0)
        row = {
            "scheme": scheme,
            "order": order,
            "damping_ratio": damping_ratio,
            "derived": derived,
        }
        for column, prestress in PROFILES.items():
            is_stable_fraction = partial(
                is_stable,
                derived_limit=derived,
                prestress=prestress,
                scheme=scheme,
                order=order,
                damping_ratio=damping_ratio,
            )
            fraction, place = largest_stable(is_stable_fraction)
            row[column] = derived * fraction
            row[f"{column}_ratio"] = fraction
            row[f"{column}_limit"] = place
        rows.append(row)
    return pd.DataFrame(rows)


def largest_stable(is_stable_fraction: Callable[[float], bool]) -> StableFraction:
    """Find the largest stable step by bisection of the logarithm of step/(derived limit).

    is_stable_fraction : function that returns True if a run with this fraction of the derived limit
        as its step is stable
    """
    lower, upper = SMALLEST_FRACTION, LARGEST_FRACTION
    if not is_stable_fraction(lower):
        return StableFraction(lower, "below")
    if is_stable_fraction(upper):
        return StableFraction(upper, "above")
    while upper > (1.0 + RELATIVE_ACCURACY) * lower:
        middle = math.sqrt(lower * upper)
        if is_stable_fraction(middle):
            lower = middle
        else:
            upper = middle
    return StableFraction(lower, "within")


def is_stable(
    fraction: float,
    *,
    derived_limit: float,
    prestress: Prestress,
    scheme: str,
    order: int,
    damping_ratio: float,
) -> bool:
    """Return True if a run with a fraction of the derived limit as its step is stable.

    The run is stable if no block sticks. It is stopped soon after the first stick.
    """
    step = fraction * derived_limit
    scene = Scene(
        boundary="stress",
        prestress=prestress,
        # When waves from the held walls have crossed the blocks, which takes a time of BLOCK_COUNT,
        # blocks stick for a physical reason. The run ends before.
        duration=min(STEP_COUNT * step, 0.8 * BLOCK_COUNT),
        dx=1.0,
        gamma=0.0,
        beta=damping_ratio,
        release="total",
        scheme=scheme,
        # A Scene refuses a step beyond the derived limit, so the step is only set below.
        max_step=1e-4,
        # The textbook scheme does not use the order, but a Scene needs one.
        order=max(order, 3),
    )
    # A Scene is frozen, and this is how an attribute of it can be set without checks.
    object.__setattr__(scene, "max_step", step)
    lattice = LATTICES[scheme](scene, samples=None, beta=scene.beta)
    # The lattice calls `stop_at_first_stick` each time after this number of steps.
    lattice.max_call_steps = CHECK_INTERVAL

    def stop_at_first_stick(_progress: float) -> None:
        """Stop the run if a block has stuck."""
        if lattice.tally.sticks > 0:
            raise UnstableRun

    try:
        lattice.advance_to_end(stop_at_first_stick)
    except UnstableRun:
        return False
    # A block may have stuck after the last call.
    return bool(lattice.tally.sticks == 0)
