"""The exact solution of a scene in the continuum limit.

It has the form of a solution on a lattice (the same fields at multiples of dx, and the same
numbers), so that everything that measures or draws a run takes either.
"""

import math
from collections.abc import Callable

import numpy as np

from ..model.checks import check_number
from ..model.samples import Samples
from ..model.scene import Scene
from ..solver.solution import MARGIN_BLOCKS, Solution
from ..theory.prestress_pieces import nucleation_intervals
from ..theory.rupture import Rupture
from .exact_rupture import exact_rupture

# The acceleration at the end is the change of slip velocity in this last fraction of the duration.
ACCELERATION_INTERVAL = 1e-5
# Each position takes about 300 bytes.
MAX_POSITIONS = 10**6


def solve_exactly(
    scene: Scene, samples: Samples | None = None, progress: Callable[[float], None] | None = None
) -> Solution:
    """Solve a scene exactly in the limit dx -> 0 at its damping ratio.

    Values that the construction of the solution does not reach are NaN. The numbers
    ``limit_position``, ``limit_time`` and ``limit_reason`` report where and why it ended. Raises
    ValueError if the theory does not cover the scene.
    """
    if progress is not None:
        progress(0.0)
    # Without a nucleation everything stays at rest.
    rupture = exact_rupture(scene) if nucleation_intervals(scene.prestress) else None
    # The positions are the multiples of dx in the part that is released, and a margin.
    first, last = 0.0, 0.0
    if rupture:
        left_ends, right_ends = zip(*rupture.front_ends, strict=True)
        first = min(end.x for end in left_ends)
        last = max(end.x for end in right_ends)
    check_number("dx", scene.dx, at_least=(last - first) / MAX_POSITIONS)
    first_block = math.floor(first / scene.dx) - MARGIN_BLOCKS
    last_block = math.ceil(last / scene.dx) + MARGIN_BLOCKS
    x = np.arange(first_block, last_block + 1) * scene.dx
    fields = _fields(rupture, x, scene.duration)
    numbers = _numbers(rupture, fields, scene.duration)
    recorded = _sampled(rupture, samples) if samples is not None else {}
    flags = ("construction_ended",) if numbers["limit_reason"] else ()
    return Solution(x, scene.prestress(x), numbers=numbers, flags=flags, **fields | recorded)


def _fields(rupture: Rupture | None, x: np.ndarray, end: float) -> dict[str, np.ndarray]:
    """Return release and stick times, and slip, slip velocity and acceleration at the end."""
    if rupture is None:
        motion = ("slip", "slip_velocity", "slip_acceleration")
        times = dict.fromkeys(("release_time", "stick_time"), np.full(x.size, np.nan))
        return times | dict.fromkeys(motion, np.zeros(x.size))
    interval = ACCELERATION_INTERVAL * end
    velocity = rupture.slip_velocity(x, end)
    change = velocity - rupture.slip_velocity(x, end - interval)
    return {
        "release_time": rupture.release_time(x),
        # The first stick is the last one where all is known until the end.
        "stick_time": np.where(rupture.horizon(x) > end, rupture.stick_time(x), np.nan),
        "slip": rupture.slip(x, end),
        "slip_velocity": velocity,
        "slip_acceleration": np.where(velocity > 0.0, change / interval, 0.0),
    }


def _sampled(rupture: Rupture | None, samples: Samples) -> dict[str, np.ndarray]:
    """Return the samples of slip and slip velocity."""
    if rupture is None:
        zeros = np.zeros((samples.times.size, samples.positions.size))
        return {"sample_slip": zeros, "sample_velocity": zeros}
    maps = rupture.map(samples.times, samples.positions, ("slip", "slip_velocity"))
    return {"sample_slip": maps["slip"], "sample_velocity": maps["slip_velocity"]}


def _numbers(rupture: Rupture | None, fields: dict[str, np.ndarray], end: float) -> dict:
    """Return the numbers of the solution, with the same keys as on a lattice."""
    stick = rupture.first_stick if rupture else None
    limit = rupture.limit if rupture else None
    # A point may be sliding if its slip velocity is not known (NaN).
    sliding = not np.all(fields["slip_velocity"] <= 0.0)
    # The stress of a stuck point between the waves and the threshold is not computed.
    not_computed = "min_stuck_stress", "friction_ratio_needed", "energy_residual"
    without_lattice = "steps", "block_updates", "event_updates", "re_releases", "half_lattice_used"
    return (
        dict.fromkeys(not_computed, math.nan)
        | dict.fromkeys(without_lattice, 0)
        | {
            "end_time": end,
            "stopped_because": "duration reached" if sliding else "everything is stuck",
            "releases": int(np.isfinite(fields["release_time"]).sum()),
            "sticks": int(np.isfinite(fields["stick_time"]).sum()),
            "min_velocity": 0.0,
            "first_stick_time": stick.time if stick else math.nan,
            "first_stick_position": stick.x if stick else math.nan,
            "limit_position": limit.x if limit else math.nan,
            "limit_time": limit.time if limit else math.nan,
            "limit_reason": limit.reason if limit else "",
        }
    )
