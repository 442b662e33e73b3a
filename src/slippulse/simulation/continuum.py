"""The exact solution of the continuum limit, as a run: the same arrays and numbers as a lattice leaves behind."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..model.samples import Samples
from ..model.scene import Scene
from ..theory.rupture import Rupture

# Positions at rest that are kept beyond the outermost released one, as on the lattice.
MARGIN = 16
# The acceleration at the end is the slope of slip velocity over this share of the duration.
SHORTLY = 1e-5


@dataclass
class ContinuumRun:
    """What the exact solution has for one scene; positions are multiples of dx, left to right."""

    x: np.ndarray
    prestress: np.ndarray
    release_time: np.ndarray
    stick_time: np.ndarray
    slip: np.ndarray
    slip_velocity: np.ndarray
    slip_acceleration: np.ndarray
    sample_slip: np.ndarray | None
    sample_velocity: np.ndarray | None
    numbers: dict


def solve_scene(scene: Scene, samples: Samples | None = None) -> ContinuumRun:
    """Solve a scene exactly in the limit dx -> 0 at its damping ratio; dx is where it is sampled.

    Parameters
    ----------
    scene : with scheme "continuum"
    samples : where and when slip and slip velocity are wanted on the way

    Where the construction ends before the scene does, what it cannot tell is NaN and the numbers say where and why
    (``limit_position``, ``limit_time``, ``limit_reason``).
    """
    gamma = scene.gamma if scene.boundary == "displacement" else 0.0
    rupture = Rupture(scene.prestress, gamma, scene.damping_ratio, scene.release, scene.duration)
    x = _positions(rupture, scene)
    release, stick = rupture.release_time(x), rupture.stick_time(x)
    slip, velocity = rupture.slip(x, scene.duration), rupture.slip_velocity(x, scene.duration)
    shortly = SHORTLY * scene.duration
    before = rupture.slip_velocity(x, scene.duration - shortly)
    acceleration = np.where(velocity > 0.0, (velocity - before) / shortly, 0.0)
    sampled = {"slip": None, "slip_velocity": None}
    if samples is not None:
        late = samples.times > scene.duration
        times = np.minimum(samples.times, scene.duration)
        sampled = rupture.map(times, samples.positions, tuple(sampled))
        for values in sampled.values():
            values[late] = np.nan
    first = rupture.first_stick or (math.nan, math.nan)
    limit = rupture.limit
    numbers = {
        "end_time": scene.duration,
        "stopped_because": "everything is stuck" if not np.any(velocity > 0.0) else "duration reached",
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
        "first_stick_time": first[0],
        "first_stick_position": first[1],
        "half_lattice_used": 0,
        "energy_residual": math.nan,
        "limit_position": limit.x if limit else math.nan,
        "limit_time": limit.time if limit else math.nan,
        "limit_reason": limit.reason if limit else "",
    }
    return ContinuumRun(
        x, scene.prestress(x), release, stick, slip, velocity, acceleration, sampled["slip"],
        sampled["slip_velocity"], numbers,
    )  # fmt: skip


def _positions(rupture: Rupture, scene: Scene) -> np.ndarray:
    """Multiples of dx over all that is released until the end, and a margin."""
    ends = [end.x for pair in rupture.front_ends for end in pair]
    first = math.floor(min(ends, default=0.0) / scene.dx) - MARGIN
    last = math.ceil(max(ends, default=0.0) / scene.dx) + MARGIN
    return np.arange(first, last + 1) * scene.dx
