"""Compare measured and derived limits of the time step, for every scheme and damping ratio.

The measured limit is the largest step at which a lattice run stays stable. A growing mode makes
slip velocities negative, so that blocks stick; in the runs of this study nothing sticks otherwise.
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

# No damping, the paper's figures (0.1), and the decades in which the form of the limit changes.
DAMPING_RATIOS = (0.0, 0.01, 0.1, 1.0, 10.0, 100.0)
# The bisection searches between these fractions of the derived limit, to a relative resolution.
# Orders with weak growth have a derived limit far below the step at which the growth is visible.
SMALLEST_FRACTION, LARGEST_FRACTION = 0.7, 12.0
RESOLUTION = 0.01
# A mode beyond the bound grows from rounding in STEP_COUNT steps, before a wave crosses the blocks.
BLOCK_COUNT, STEP_COUNT = 400, 400
# No stress releases blocks at this pre-stress. Beyond walls of it the lattice stays at rest.
HELD_PRESTRESS = -1.0e9
WALLS = ((BLOCK_COUNT + 0.5, HELD_PRESTRESS), (-BLOCK_COUNT - 0.5, HELD_PRESTRESS))
# Number of steps between two checks for sticks; in a run that blows up, blocks stick repeatedly.
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

    ``place`` is "within" if the bisection found it. It is "below" or "above" if it lies beyond the
    smallest or the largest fraction that was tried, and the fraction is then that end.
    """

    fraction: float
    place: str


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return one row for each scheme, order and damping ratio, with steps in units of dx.

    derived : the derived limit
    measured, measured_rupture : the largest step at which nothing sticks, for each of PROFILES.
        There are also its ratio to the derived limit (measured_ratio), and where it lies in the
        searched range (measured_limit, see `StableFraction`).
    """
    schemes = [("fixed_step", 1)]
    schemes += [("localised", order) for order in ORDERS]
    rows = []
    for (scheme, order), ratio in product(schemes, DAMPING_RATIOS):
        derived = largest_step(scheme, order, ratio, 0.0)
        row = {"scheme": scheme, "order": order, "damping_ratio": ratio, "derived": derived}
        for name, profile in PROFILES.items():
            stable = partial(is_stable, profile, derived, scheme, order, ratio)
            fraction, place = largest_stable(stable)
            row[name] = derived * fraction
            row[f"{name}_ratio"] = fraction
            row[f"{name}_limit"] = place
        rows.append(row)
    return pd.DataFrame(rows)


def largest_stable(stable: Callable[[float], bool]) -> StableFraction:
    """Find the largest stable fraction of the derived limit by bisection of its logarithm.

    stable : function that returns True if a fraction is stable
    """
    lower, upper = SMALLEST_FRACTION, LARGEST_FRACTION
    if not stable(lower):
        return StableFraction(lower, "below")
    if stable(upper):
        return StableFraction(upper, "above")
    while upper > (1.0 + RESOLUTION) * lower:
        middle = math.sqrt(lower * upper)
        if stable(middle):
            lower = middle
        else:
            upper = middle
    return StableFraction(lower, "within")


def is_stable(
    profile: Prestress, derived: float, scheme: str, order: int, ratio: float, fraction: float
) -> bool:
    """Run a lattice with a fraction of the derived limit as step; return True if nothing sticks.

    The run ends at the first stick.
    """
    step = fraction * derived
    scene = Scene(
        boundary="stress",
        prestress=profile,
        # A chain between walls reverses when a wave has crossed it.
        duration=min(STEP_COUNT * step, 0.8 * BLOCK_COUNT),
        dx=1.0,
        gamma=0.0,
        beta=ratio,
        release="total",
        scheme=scheme,
        max_step=1e-4,
        # The textbook scheme has no adjustable order.
        order=max(order, 3),
    )
    # A Scene refuses a step beyond the limit, so the step is set afterwards.
    object.__setattr__(scene, "max_step", step)
    lattice = LATTICES[scheme](scene, None, scene.beta)
    lattice.call_steps = CHECK_INTERVAL

    def stop_at_first_stick(_progress: float) -> None:
        if lattice.tally.sticks > 0:
            raise UnstableRun

    try:
        lattice.advance_to_end(stop_at_first_stick)
    except UnstableRun:
        return False
    return bool(lattice.tally.sticks == 0)
