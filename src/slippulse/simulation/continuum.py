"""The exact solution of a scene in the continuum limit.

The exact solution has the form of a solution on a lattice, with the same fields at multiples of dx
and the same numbers. Functions that measure or draw a run can therefore take either.
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

    progress : function that is called once with 0, because there are no steps to report
    """
    if progress is not None:
        progress(0.0)
    # Without a nucleation everything stays at rest.
    rupture = exact_rupture(scene) if nucleation_intervals(scene.prestress) else None
    x = _positions(scene, rupture)
    fields = _fields_at_end(rupture, x, scene.duration)
    numbers = _numbers(rupture, fields, scene.duration)
    fields |= _sampled_fields(rupture, samples) if samples is not None else {}
    flags = ("construction_ended",) if numbers["limit_reason"] else ()
    return Solution(x, scene.prestress(x), numbers=numbers, flags=flags, **fields)


def _positions(scene: Scene, rupture: Rupture | None) -> np.ndarray:
    """Return the multiples of dx between the ends of the fronts, with a margin on both sides.

    Raises ValueError if there are too many of them.
    """
    first, last = 0.0, 0.0
    if rupture:
        # Each connected part of the rupture has a front at either end.
        left_ends, right_ends = zip(*rupture.front_ends, strict=True)
        first = min(end.x for end in left_ends)
        last = max(end.x for end in right_ends)
    check_number("dx", scene.dx, at_least=(last - first) / MAX_POSITIONS)
    first_block = math.floor(first / scene.dx) - MARGIN_BLOCKS
    last_block = math.ceil(last / scene.dx) + MARGIN_BLOCKS
    return np.arange(first_block, last_block + 1) * scene.dx


def _fields_at_end(rupture: Rupture | None, x: np.ndarray, end: float) -> dict[str, np.ndarray]:
    """Return the fields of a run at positions x.

    The fields are release and stick times, and slip, slip velocity and acceleration at the time
    ``end``. Without a rupture, everything is at rest.
    """
    if rupture is None:
        motion = ("slip", "slip_velocity", "slip_acceleration")
        times = dict.fromkeys(("release_time", "stick_time"), np.full(x.size, np.nan))
        return times | dict.fromkeys(motion, np.zeros(x.size))
    interval = ACCELERATION_INTERVAL * end
    velocity = rupture.slip_velocity(x, end)
    velocity_change = velocity - rupture.slip_velocity(x, end - interval)
    # The rupture gives the first stick of a point. The first stick is also the last one where the
    # solution is known until the end.
    is_known = rupture.horizon(x) > end
    return {
        "release_time": rupture.release_time(x),
        "stick_time": np.where(is_known, rupture.stick_time(x), np.nan),
        "slip": rupture.slip(x, end),
        "slip_velocity": velocity,
        "slip_acceleration": np.where(velocity > 0.0, velocity_change / interval, 0.0),
    }


def _sampled_fields(rupture: Rupture | None, samples: Samples) -> dict[str, np.ndarray]:
    """Return slip and slip velocity at the sampled times and positions, 0 without a rupture."""
    if rupture is None:
        zeros = np.zeros((samples.times.size, samples.positions.size))
        return {"sample_slip": zeros, "sample_velocity": zeros}
    fields = rupture.map(samples.times, samples.positions, ("slip", "slip_velocity"))
    return {"sample_slip": fields["slip"], "sample_velocity": fields["slip_velocity"]}


def _numbers(rupture: Rupture | None, fields: dict[str, np.ndarray], end: float) -> dict:
    """Return the numbers of the solution, with the same keys as on a lattice.

    fields : the fields at the time ``end``, see `_fields_at_end`
    """
    first_stick = rupture.first_stick if rupture else None
    # The earliest point (x, time) from which on the solution is not known, with the reason.
    limit = rupture.limit if rupture else None
    # A point may be sliding if its slip velocity is not known (NaN).
    may_slide = not np.all(fields["slip_velocity"] <= 0.0)
    # The stress of stuck points and the energy balance are not computed.
    not_computed = ("min_stuck_stress", "friction_ratio_needed", "energy_residual")
    without_lattice = (
        "steps",
        "block_updates",
        "event_updates",
        "re_releases",
        "half_lattice_used",
    )
    return (
        dict.fromkeys(not_computed, math.nan)
        | dict.fromkeys(without_lattice, 0)
        | {
            "end_time": end,
            "stopped_because": "duration reached" if may_slide else "everything is stuck",
            "releases": int(np.isfinite(fields["release_time"]).sum()),
            "sticks": int(np.isfinite(fields["stick_time"]).sum()),
            "min_velocity": 0.0,
            "first_stick_time": first_stick.time if first_stick else math.nan,
            "first_stick_position": first_stick.x if first_stick else math.nan,
            "limit_position": limit.x if limit else math.nan,
            "limit_time": limit.time if limit else math.nan,
            "limit_reason": limit.reason if limit else "",
        }
    )
