"""Compare measured and derived limits of the time step, for every scheme and damping ratio."""

import math
from collections.abc import Callable
from functools import partial

import pandas as pd

from slippulse.model.prestress import Prestress
from slippulse.model.scene import ORDERS, Scene
from slippulse.model.stability import largest_step
from slippulse.solver.fixed_step import LATTICES
from slippulse.solver.lattice import UnstableRun

NEEDS = {"settings": ()}

# No damping, the paper's figures (0.1), and the decades in which the form of the limit changes.
DAMPING_RATIOS = (0.0, 0.01, 0.1, 1.0, 10.0, 100.0)
# The bisection searches between these fractions of the derived limit, to a relative resolution.
# Orders with weak growth have a derived limit far below the step at which the growth is visible.
BISECTION_RANGE, RESOLUTION = (0.7, 12.0), 0.01
# Results of a bisection: the limit lies within the range, below it or above it.
WITHIN, BELOW, ABOVE = "within", "below", "above"
# A mode beyond the bound grows from rounding in STEP_COUNT steps, before a wave crosses the blocks.
BLOCK_COUNT, STEP_COUNT = 400, 400
# No stress releases blocks at this pre-stress.
HELD_PRESTRESS = -1.0e9
WALL_LEVELS = (BLOCK_COUNT + 0.5, HELD_PRESTRESS), (-BLOCK_COUNT - 0.5, HELD_PRESTRESS)
# Number of steps between two checks for sticks; in a run that blows up, blocks stick repeatedly.
CHECK_INTERVAL = 100
PROFILES = {
    # A stress far above the threshold releases all blocks at once, and no event follows until they
    # reverse.
    "measured": Prestress(0.9, 0.9, 10.0 * BLOCK_COUNT, peak=100.9, steps=WALL_LEVELS),
    # An endless crack has an event in almost every step.
    "measured_rupture": Prestress(0.5, 0.5, 8.0),
}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the derived limit and the largest steps at which nothing sticks, in units of dx."""
    rows = []
    for scheme, order in [("fixed_step", 1), *(("localised", order) for order in ORDERS)]:
        for ratio in DAMPING_RATIOS:
            bound = largest_step(scheme, order, ratio, 0.0)
            row = {"scheme": scheme, "order": order, "damping_ratio": ratio, "derived": bound}
            for name, profile in PROFILES.items():
                stable = partial(nothing_sticks, profile, bound, scheme, order, ratio)
                fraction, place = largest_stable(stable)
                row |= {name: bound * fraction, f"{name}_ratio": fraction}
                row |= {f"{name}_limit": place}
            rows.append(row)
    return pd.DataFrame(rows)


def largest_stable(stable: Callable[[float], bool]) -> tuple[float, str]:
    """Return the largest stable fraction by bisection, and whether it lies between the ends.

    If it lies beyond an end of BISECTION_RANGE, the fraction is that end.
    """
    lower, upper = BISECTION_RANGE
    if not stable(lower):
        return lower, BELOW
    if stable(upper):
        return upper, ABOVE
    while upper > (1.0 + RESOLUTION) * lower:
        middle = math.sqrt(lower * upper)
        lower, upper = (middle, upper) if stable(middle) else (lower, middle)
    return lower, WITHIN


def nothing_sticks(
    profile: Prestress, bound: float, scheme: str, order: int, ratio: float, fraction: float
) -> bool:
    """Return True if nothing sticks; a growing mode would make velocities negative."""
    step = fraction * bound
    # A chain between walls reverses when a wave has crossed it.
    duration = min(STEP_COUNT * step, 0.8 * BLOCK_COUNT)
    # The textbook scheme has no adjustable order.
    order = max(order, 3)
    scene = Scene("stress", profile, duration, 1.0, 0.0, ratio, "total", scheme, 1e-4, order)
    # A Scene refuses a step beyond the limit.
    object.__setattr__(scene, "max_step", step)
    lattice = LATTICES[scheme](scene, None, scene.beta)
    lattice.call_steps = CHECK_INTERVAL

    def stop_at_the_first_stick(_progress: float) -> None:
        if lattice.tally.sticks > 0:
            raise UnstableRun

    try:
        lattice.advance_to_end(stop_at_the_first_stick)
    except UnstableRun:
        return False
    return bool(lattice.tally.sticks == 0)
