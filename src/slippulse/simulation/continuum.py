"""The exact solution of the continuum limit, as a run: the same arrays and numbers as a lattice leaves behind."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from ..model.checks import check_number
from ..model.samples import Samples
from ..model.scene import Scene
from ..solver.run import LatticeRun
from ..theory.fronts import nucleations
from ..theory.rupture import Rupture

# Positions at rest that are kept beyond the outermost released one, as on the lattice.
MARGIN = 16
# The acceleration at the end is the slope of slip velocity over this fraction of the duration.
SHORTLY = 1e-5
# Positions, at some 300 bytes each.
MOST_POSITIONS = 10**6


def solve_scene(
    scene: Scene, samples: Samples | None = None, progress: Callable[[float], None] | None = None
) -> LatticeRun:
    """Solve a scene exactly in the limit dx -> 0 at its damping ratio; dx is where it is sampled.

    ``progress`` is called once, before it begins. Where the construction ends before the scene does, what it cannot
    tell is NaN and the numbers say where and why (``limit_position``, ``limit_time``, ``limit_reason``).

    Raises ValueError: if `Rupture` refuses the scene, or dx is too small for its fronts.
    """
    if progress is not None:
        progress(0.0)
    # Where nothing nucleates, all stays at rest.
    ends, first, limit = [0.0], None, None
    if starts := nucleations(scene.prestress):
        rupture = Rupture(
            scene.prestress, scene.gamma, scene.damping_ratio, scene.release, scene.duration,
            rate_strengthening=scene.rate_strengthening,
        )  # fmt: skip
        ends = [end.x for pair in rupture.front_ends for end in pair]
        first, limit = rupture.first_stick, rupture.limit
    check_number("dx", scene.dx, at_least=(max(ends) - min(ends)) / MOST_POSITIONS)
    # Multiples of dx over all that is released until the end.
    span = math.floor(min(ends) / scene.dx) - MARGIN, math.ceil(max(ends) / scene.dx) + MARGIN
    x = np.arange(span[0], span[1] + 1) * scene.dx
    release = stick = np.full(x.size, np.nan)
    slip = velocity = acceleration = np.zeros(x.size)
    recorded: tuple[Any, Any] = (None, None)
    if samples is not None:
        recorded = 2 * (np.zeros((samples.times.size, samples.positions.size)),)
    if starts:
        release, stick = rupture.release_time(x), rupture.stick_time(x)
        slip, velocity = rupture.slip(x, scene.duration), rupture.slip_velocity(x, scene.duration)
        shortly = SHORTLY * scene.duration
        before = rupture.slip_velocity(x, scene.duration - shortly)
        acceleration = np.where(velocity > 0.0, (velocity - before) / shortly, 0.0)
        if samples is not None:
            found = rupture.map(samples.times, samples.positions, ("slip", "slip_velocity"))
            recorded = found["slip"], found["slip_velocity"]
    numbers = {
        "end_time": scene.duration,
        "stopped_because": "duration reached" if np.any(velocity > 0.0) else "everything is stuck",
        "steps": 0,
        "block_updates": 0,
        "event_updates": 0,
        "releases": int(np.isfinite(release).sum()),
        "sticks": int(np.isfinite(stick).sum()),
        "re_releases": 0,
        "min_velocity": 0.0,
        # Between the waves and the threshold a stuck point's stress is not looked at.
        "min_stuck_stress": math.nan,
        "friction_ratio_needed": math.nan,
        "first_stick_time": first[0] if first else math.nan,
        "first_stick_position": first[1] if first else math.nan,
        "half_lattice_used": 0,
        "energy_residual": math.nan,
        "limit_position": limit.x if limit else math.nan,
        "limit_time": limit.time if limit else math.nan,
        "limit_reason": limit.reason if limit else "",
    }
    fields = (x, scene.prestress(x), release, stick, slip, velocity, acceleration)
    return LatticeRun(*fields, *recorded, numbers)
