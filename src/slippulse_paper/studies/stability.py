"""Steps that blow up: the measured bound and the derived one, for every scheme and damping."""

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

# No damping, that of the paper's figures (0.1), and the decades in which the bound changes its law.
DAMPING_RATIOS = (0.0, 0.01, 0.1, 1.0, 10.0, 100.0)
# Bisected between these fractions of the derived bound, down to a relative resolution. The derived
# bound of orders with weak growth stands far below the step at which that growth is seen.
BETWEEN, RESOLUTION = (0.7, 12.0), 0.01
# What a bisection found: a limit between both ends, or that the limit lies beyond one of them.
WITHIN, BELOW, ABOVE = "within", "below", "above"
# A mode beyond the bound grows from rounding in STEPS steps, before a wave crosses the blocks.
BLOCKS, STEPS = 400, 400
# Blocks never slide this far below any stress.
HELD = -1.0e9
WALLS = (BLOCKS + 0.5, HELD), (-BLOCKS - 0.5, HELD)
# Steps between two counts of sticks: blocks of a run that blows up stick over and over.
LOOK_AFTER = 100
PROFILES = {
    # A stress far above the threshold releases all blocks at once: no event until they turn.
    "measured": Prestress(0.9, 0.9, 10.0 * BLOCKS, peak=100.9, steps=WALLS),
    # A crack that grows for ever has an event in almost every step.
    "measured_rupture": Prestress(0.5, 0.5, 8.0),
}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """The bound and the largest steps at which nothing sticks, in units of dx."""
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

    If it lies beyond an end of BETWEEN, the fraction is that end.
    """
    lower, upper = BETWEEN
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
    """True if nothing sticks: velocities are positive until a growing mode makes one negative."""
    step = fraction * bound
    # A chain between walls turns back after a wave has crossed it.
    duration = min(STEPS * step, 0.8 * BLOCKS)
    # The textbook scheme has no order to choose.
    order = max(order, 3)
    scene = Scene("stress", profile, duration, 1.0, 0.0, ratio, "total", scheme, 1e-4, order)
    # A Scene refuses a step beyond the bound.
    object.__setattr__(scene, "max_step", step)
    lattice = LATTICES[scheme](scene, None, scene.beta)
    lattice.call_steps = LOOK_AFTER

    def stop_at_the_first_stick(_progress: float) -> None:
        if lattice.tally.sticks > 0:
            raise UnstableRun

    try:
        lattice.advance_to_end(stop_at_the_first_stick)
    except UnstableRun:
        return False
    return bool(lattice.tally.sticks == 0)
