"""What a list of scenes costs to run, before it runs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ..model.samples import Samples
from ..model.scene import Scene

# Block updates a second on one core at order 8, and what a release or stick and the start of a scene cost in them.
RATE, EVENT, START = 2.5e8, 250.0, 8e5
# What runs without being asked twice: a night on one core, the memory of a small machine, a large sweep.
LARGEST_HOURS = 12.0
LARGEST_BYTES = 4e9
LARGEST_RUNS = 20_000
# How many times as much a sweep in chunks may be altogether: a million runs, a day on 25 cores.
LARGEST_WHOLE = 50
HOW_TO_GO_ON = "--config allow_large=true to go on"


@dataclass(frozen=True)
class Cost:
    """An estimate, right to a factor of about 3 over the shipped sweeps.

    Attributes
    ----------
    runs : scenes
    block_updates : all of them, events and the start of each scene included by what they cost
    bytes : recorded data, and the lattice of the largest scene
    """

    runs: int
    block_updates: float
    bytes: float

    @property
    def hours(self) -> float:
        """On one core."""
        return self.block_updates / RATE / 3600.0

    def __str__(self) -> str:
        return (
            f"{self.runs} runs, {self.block_updates:.2g} block updates, about {self.hours:.2g} hours on one core,"
            f" {self.bytes / 1e9:.2g} GB"
        )


def expected_cost(scenes: Sequence[Scene], samples: Sequence[Samples | None]) -> Cost:
    """Cost of a list of scenes with what each records.

    Fronts run at about the wave speed; between them slides a crack (Gamma = 0), or two pulses of about one half period
    of the leaf springs, which stick behind. Each block is released once.
    """
    updates, recorded, lattice = 0.0, 0.0, 0.0
    for scene, recording in zip(scenes, samples, strict=True):
        fold = 0.5 if scene.symmetric else 1.0
        blocks = 2.0 * fold * scene.duration / scene.dx
        pulses = scene.boundary == "displacement"
        sliding = 2.0 * fold * _mean_sliding_length(scene) / scene.dx
        updates += scene.duration / (scene.max_step * scene.dx) * sliding
        updates += START + EVENT * blocks * (2.0 if pulses else 1.0)
        lattice = max(lattice, 8.0 * (scene.order + 12) * blocks)
        recorded += 8.0 * 7.0 * blocks
        if recording is not None:
            recorded += 16.0 * recording.times.size * recording.positions.size
    return Cost(len(scenes), updates, recorded + lattice)


def _mean_sliding_length(scene: Scene) -> float:
    """Over the time of the run, on each side: a crack grows from nothing."""
    if scene.boundary == "displacement":
        return min(0.5 * scene.duration, math.pi / math.sqrt(scene.gamma))
    return 0.5 * scene.duration


def exceeded_limit(cost: Cost, times: int = 1) -> str:
    """What a cost exceeds, in words, where ``times`` that of one job is allowed; empty when it is within bounds."""
    if cost.runs > times * LARGEST_RUNS:
        return f"up to {times * LARGEST_RUNS} runs"
    if not cost.hours <= times * LARGEST_HOURS:
        return f"up to {times * LARGEST_HOURS:g} hours on one core"
    if not cost.bytes <= times * LARGEST_BYTES:
        return f"up to {times * LARGEST_BYTES / 1e9:g} GB"
    return ""
