"""At most how much a simulation takes: block updates and bytes, before any of it runs.

A front goes at most at the speed that the highest pre-stress level drives it at, and what it has passed slides at most
until the end. So the work of a run is at most its steps times the blocks that its fronts can reach. What is measured in
the shipped sweeps is at most 0.43 of that; undamped blocks that slip again and again may take twice as much.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from ..model.samples import Samples
from ..model.scene import Scene
from .accuracy import promised
from .expand import expand, run_count

# What one job may take without being asked twice: runs, block updates (days on one core), bytes (a small machine).
LIMITS = 20_000, 4e13, 4e9
# How many times as much a sweep in chunks may be altogether.
MOST_CHUNKS = 50
HOW_TO_GO_ON = "--config allow_large=true"
# Bytes of a block: seven recorded numbers, and two arrays an order and sixteen others while it runs.
RECORDED, ARRAYS = 56.0, 16.0
# A run that does nothing takes as long as this number of block updates; a block of the exact solution too.
START, EXACT_BLOCK = 1e5, 3e4
# A step ends early after this number of events.
EVENTS_OF_A_STEP = 64
# Seconds of a block update at the highest order, on a slow machine; block updates from which two threads pay.
UPDATE_SECONDS, LONG_SWEEP = 2e-8, 1e11
# Start of a job in minutes, and the interpreter with its libraries in MB.
START_MINUTES, START_MEGABYTES = 10, 1000


class Bound(NamedTuple):
    """What a list of runs takes at most."""

    runs: float
    block_updates: float
    bytes: float

    def exceeded(self, chunks: int = 1) -> str:
        """Which limit one of these jobs exceeds, or all together do, in words; empty where none is."""
        most = min(1.0, MOST_CHUNKS / chunks)
        for name, value, limit in zip(self._fields, self, LIMITS, strict=True):
            if not value <= most * limit:
                shared = f" in each of {chunks} chunks" if chunks > 1 else ""
                takes = f"{value:.3g} {name.replace('_', ' ')}{shared}"
                return f"cost: up to {takes}; allowed: {most * limit:.3g}, with more chunks or {HOW_TO_GO_ON}"
        return ""

    @property
    def threads(self) -> int:
        """Of the job: two for long sweeps; short ones run side by side and waste less on starting."""
        return 2 if self.block_updates > LONG_SWEEP else 1

    @property
    def minutes(self) -> int:
        """Time limit of the job on a cluster."""
        return START_MINUTES + math.ceil(UPDATE_SECONDS * self.block_updates / 60.0 / self.threads)

    @property
    def megabytes(self) -> int:
        """Memory limit of the job on a cluster."""
        return START_MEGABYTES + math.ceil(2.0 * self.bytes / 1e6)


def bound_of(scene: Scene, samples: Samples | None = None) -> Bound:
    """At most so much for one run."""
    profile, ratio = scene.prestress, scene.damping_ratio
    level = max(profile.left, profile.right, *(level for _, level in profile.steps), 0.0)
    # Above the exact speeds at any damping, under either rule.
    speed = 1.3 / math.sqrt((1.0 - level) * (1.0 + level))
    if scene.release == "total":
        speed += 1.3 * ratio * level / (1.0 - level)
    start = max((abs(centre) + 5.0 * width for centre, _, width in profile.bumps), default=0.0)
    reach = start + 5.0 * profile.width + speed * scene.duration
    blocks = (1.0 if scene.symmetric else 2.0) * (reach / scene.dx + 16.0)
    steps = scene.duration / (scene.max_step * scene.dx) + 2.0 * blocks / EVENTS_OF_A_STEP
    updates = EXACT_BLOCK * blocks if scene.scheme == "continuum" else steps * blocks
    recorded = 0.0 if samples is None else 16.0 * samples.times.size * samples.positions.size
    return Bound(1, START + updates, (RECORDED + ARRAYS * (scene.order + 16)) * blocks + recorded)


def bound_of_sweep(simulation: Mapping, chunks: int = 1) -> Bound:
    """At most so much for one of the jobs that share a resolved simulation.

    The run that takes the most is at the end of each list, the smallest entry or the largest.
    """
    found = [bound_of(*run) for run in zip(*expand(promised(corners(simulation))), strict=True)]
    runs = run_count(simulation) / chunks
    return Bound(runs, runs * max(one.block_updates for one in found), runs * max(one.bytes for one in found))


def corners(simulation: Mapping) -> dict[str, Any]:
    """A resolved simulation of the runs at the ends of the lists of numbers."""
    found = {key: value for key, value in simulation.items() if key != "chunk"}
    if "beyond" in found:
        found["beyond"] = corners(found["beyond"])
    for key in ("left", "right", "width", "gamma", "damping_ratio", "beta", "dx", "levels"):
        if isinstance(found.get(key), list):
            found[key] = sorted({min(found[key]), max(found[key])})
    return found
