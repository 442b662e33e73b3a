"""What scenes cost to run, before they run."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ..model.samples import Samples
from ..model.scene import Scene
from .front_paths import STOPPED, front_paths, sliding_times

# Seconds on one core of the reference machine: the start of a scene; a step; a sliding block in a step, by order; an
# event, by order; a block of the lattice, to be set up and written; a block that is looked at by the textbook scheme.
START, STEP, UPDATE, EVENT, BLOCK, LOOK = 1.1e-3, 1.8e-7, 0.8e-9, (0.35e-6, 0.1e-6), 0.7e-7, 5e-9
# The exact solution: its start; a place, and one behind a slow front for each unit of time; a sample.
EXACT, PLACE, SLOW_PLACE, SAMPLE = 0.15, 5e-5, 4e-5, 1.5e-6
# An instant of a stick, to be found.
SEEK = 2e-7
# A step ends early after so many events; the lattice has so many blocks at the start.
EVENTS_OF_A_STEP, FIRST_BLOCKS = 64, 512
# The run in so many parts, short ones at first.
PARTS = np.linspace(0.0, 1.0, 33) ** 2
LENGTHS = np.diff(PARTS)
# What runs without being asked twice: a night on one core, the memory of a small machine, a large sweep.
LARGEST_HOURS = 12.0
LARGEST_BYTES = 4e9
LARGEST_RUNS = 20_000
# How many times as much a sweep in chunks may be altogether: a million runs, a day on 25 cores.
LARGEST_WHOLE = 50
HOW_TO_GO_ON = "--config allow_large=true to go on"
# A run that takes so many times its estimate, and longer than so many seconds, says so.
FAR_BEYOND, WORTH_A_WORD = 10.0, 5.0


@dataclass(frozen=True)
class Cost:
    """An estimate, right to a factor of 3.

    Attributes
    ----------
    runs : scenes
    seconds : on one core
    bytes : recorded data, and the lattice of the largest scene
    """

    runs: int
    seconds: float
    bytes: float

    @property
    def hours(self) -> float:
        """On one core."""
        return self.seconds / 3600.0

    def __str__(self) -> str:
        return f"{self.runs} runs, about {self.hours:.2g} hours on one core, {self.bytes / 1e9:.2g} GB"


def expected_cost(scenes: Sequence[Scene], samples: Sequence[Samples | None]) -> Cost:
    """Cost of a list of scenes with what each records."""
    seconds, recorded, lattice = 0.0, 0.0, 0.0
    for scene, recording in zip(scenes, samples, strict=True):
        of_scene, blocks = _scene_cost(scene)
        seconds += of_scene
        lattice = max(lattice, 16.0 * (scene.order + 16) * blocks)
        recorded += 8.0 * 7.0 * blocks
        if recording is not None:
            points = recording.times.size * recording.positions.size
            recorded += 16.0 * points
            seconds += SAMPLE * points if scene.scheme == "continuum" else 0.0
    return Cost(len(scenes), seconds, recorded + lattice)


def expected_seconds(scene: Scene) -> float:
    """What one scene takes on one core, right to a factor of 3."""
    return _scene_cost(scene)[0]


def most_expected(scenes: Sequence[Scene], samples: Sequence[Samples | None]) -> Cost:
    """A cost that is not exceeded: every block slides from the start, as far as a front can come; found at once."""
    seconds, recorded, lattice = 0.0, 0.0, 0.0
    for scene, recording in zip(scenes, samples, strict=True):
        profile = scene.prestress
        level = max(profile.left, profile.right, *(level for _, level in profile.steps), 0.0)
        speed = 1.0 / (1.0 - level) * (1.0 + scene.damping_ratio)
        far = max((abs(centre) + 10.0 * width for centre, _, width in profile.bumps), default=0.0)
        blocks = 2.0 * FIRST_BLOCKS + 4.0 * (speed * scene.duration + 10.0 * profile.width + far) / scene.dx
        steps = scene.duration / (scene.max_step * scene.dx) + blocks / EVENTS_OF_A_STEP
        one = START + steps * (STEP + LOOK + UPDATE * (scene.order + 1)) * blocks
        seconds += one + blocks * (BLOCK + 2.0 * (EVENT[0] + EVENT[1] * scene.order))
        lattice = max(lattice, 16.0 * (scene.order + 16) * blocks)
        recorded += 8.0 * 7.0 * blocks
        if recording is not None:
            recorded += 16.0 * recording.times.size * recording.positions.size
    return Cost(len(scenes), seconds, recorded + lattice)


@np.errstate(all="ignore")
def _scene_cost(scene: Scene) -> tuple[float, float]:
    """Seconds, and blocks of the lattice, of one scene."""
    fold = 0.5 if scene.symmetric else 1.0
    step = min(scene.max_step * scene.dx, scene.duration)
    profile, paths = scene.prestress, front_paths(scene)
    weight = fold * paths.size / scene.dx
    reach = max((abs(centre) + 4.0 * width for centre, _, width in profile.bumps), default=0.0)
    smallest = FIRST_BLOCKS / fold + 2.0 * fold * reach / scene.dx
    if not np.isfinite(paths.release).any():
        return START + BLOCK * smallest, smallest
    # The run begins with a whole block.
    first = paths.start == 0.0
    weight[first] *= max(1.0, fold / float(np.sum(weight[first])))
    # A block between stuck neighbours that is damped far beyond its oscillation creeps for ever.
    creeps = scene.damping_ratio**2 > 5.0 * (2.0 + scene.gamma * scene.dx**2)
    stick = paths.release + sliding_times(scene, paths)
    end = scene.duration
    if not creeps:
        end = min(end, float(np.max(stick[paths.release < STOPPED], initial=step)))
    times, lengths = end * PARTS, end * LENGTHS
    released, stuck = _passed(paths.release, weight, times), _passed(stick, weight, times)
    sliding = released - stuck
    sliding = 0.5 * (sliding[1:] + sliding[:-1])
    if creeps:
        sliding = np.maximum(sliding, np.minimum(released[1:], 2.0 * fold))
    events = released[1:] - released[:-1] + stuck[1:] - stuck[:-1]
    blocks = max(smallest, float(released[-1]))
    if scene.scheme == "continuum":
        slow = min(profile.left, profile.right) < 0.0 and scene.boundary == "stress"
        places = 0.5 * blocks if scene.symmetric else blocks
        return EXACT + places * (PLACE + SLOW_PLACE * scene.duration * slow), blocks
    seconds = START + BLOCK * blocks
    # A block of a symmetric scene counts half.
    steps = np.where(sliding > 0.4, lengths / step, 0.0)
    if scene.scheme == "fixed_step":
        lattice = smallest * 2.0 ** np.ceil(np.log2(np.maximum(released[1:] / smallest, 1.0)))
        return seconds + float(np.sum(steps * (STEP + LOOK * lattice))), blocks
    steps = np.where(steps > 0.0, np.maximum(steps, events / EVENTS_OF_A_STEP), 0.0)
    update, event = UPDATE * (scene.order + 1), EVENT[0] + EVENT[1] * scene.order
    # A step that ends early looks again at all that would have stuck within it.
    sought = (stuck[1:] - stuck[:-1]) * np.minimum(1.0, step / lengths)
    each = STEP + update * sliding + SEEK * sought
    return seconds + float(np.sum(steps * each + event * events)), blocks


def _passed(when: np.ndarray, weight: np.ndarray, times: np.ndarray) -> np.ndarray:
    """How much has passed by each time."""
    order = np.argsort(when)
    return np.interp(times, when[order], np.cumsum(weight[order]), left=0.0)


def overrun_watch(scene: Scene, say: Callable[[str], None]) -> Callable[[float], None]:
    """A callback for the progress of a run, in its own thread, that says once when it takes ten times its estimate.

    Parameters
    ----------
    scene : that runs
    say : called with one line
    """
    started, allowed = time.thread_time(), max(WORTH_A_WORD, FAR_BEYOND * expected_seconds(scene))

    def watch(share: float) -> None:
        nonlocal allowed
        seconds = time.thread_time() - started
        if seconds > allowed:
            say(
                f"a run takes {FAR_BEYOND:g} times its estimate ({share:.0%} done after {seconds:.3g} s) and goes on"
            )
            allowed = math.inf

    return watch


def exceeded_limit(cost: Cost, times: int = 1) -> str:
    """What a cost exceeds, in words, where ``times`` that of one job is allowed; empty when it is within bounds."""
    if cost.runs > times * LARGEST_RUNS:
        return f"up to {times * LARGEST_RUNS} runs"
    if not cost.hours <= times * LARGEST_HOURS:
        return f"up to {times * LARGEST_HOURS:g} hours on one core"
    if not cost.bytes <= times * LARGEST_BYTES:
        return f"up to {times * LARGEST_BYTES / 1e9:g} GB"
    return ""
