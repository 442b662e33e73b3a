"""What scenes cost to run, before they run."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ..model.samples import Samples
from ..model.scene import Scene
from .front_paths import STOPPED, FrontPaths, front_paths, sliding_times, viscous

# Seconds on one core of the reference machine: the start of a scene; a step; a sliding block in a step, by order; an
# event, by order; a block of the lattice, to be laid, and one that slips, to be written.
START, STEP, UPDATE, EVENT, LAID, WRITTEN = 0.8e-3, 1.8e-7, 0.8e-9, (0.35e-6, 0.1e-6), 6e-8, 7e-8
# A step of the textbook scheme: a block of the lattice, a sliding one on top.
LOOK, SLIDE = 3.2e-9, 2.2e-9
# The exact solution: its start, and with slow fronts times the root of time; a place that sticks, one that slides on
# with leaf springs, one that does without, and for each unit of time; a wave of the leaf springs, and a pair of those
# that slide together; a panel of the Gaussian, which has so many a width and is laid whole, its bytes; a sample.
EXACT, SLOW, STUCK_PLACE, PLACE, FREE_PLACE, WAVE, PAIR = (
    0.07,
    0.015,
    4e-5,
    9e-5,
    (2.6e-4, 1.3e-6),
    1.5e-4,
    2e-7,
)
PANEL, PANELS_A_WIDTH, PANEL_BYTES, SAMPLE = 3e-5, (2.25, 4.5), 4e3, 1.5e-6
# An instant of a stick, to be found.
SEEK = 4e-7
# So many cells together tell how many sticks fall into a step.
AT_ONCE = 4
# A step ends early after so many events; the lattice has so many blocks on a side at the start.
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
        exact = scene.scheme == "continuum"
        lattice = max(lattice, PANEL_BYTES * _panels(scene) if exact else 16.0 * (scene.order + 16) * blocks)
        recorded += 8.0 * 7.0 * blocks
        if recording is not None:
            points = recording.times.size * recording.positions.size
            recorded += 16.0 * points
            seconds += SAMPLE * points if exact else 0.0
    return Cost(len(scenes), seconds, recorded + lattice)


def expected_seconds(scene: Scene) -> float:
    """What one scene takes on one core, right to a factor of 3."""
    return _scene_cost(scene)[0]


def most_expected(scenes: Sequence[Scene], samples: Sequence[Samples | None]) -> Cost:
    """A cost that is not exceeded: every block slides from the start, as far as a front can come; found at once."""
    exact = [i for i, scene in enumerate(scenes) if scene.scheme == "continuum"]
    cost = expected_cost([scenes[i] for i in exact], [samples[i] for i in exact])
    seconds, recorded, lattice = cost.seconds, cost.bytes, 0.0
    for scene, recording in zip(scenes, samples, strict=True):
        if scene.scheme == "continuum":
            continue
        profile = scene.prestress
        level = max(profile.left, profile.right, *(level for _, level in profile.steps), 0.0)
        speed = 1.0 / (1.0 - level) * (1.0 + scene.damping_ratio)
        far = max((abs(centre) + 10.0 * width for centre, _, width in profile.bumps), default=0.0)
        blocks = 6.0 * FIRST_BLOCKS + 12.0 * (speed * scene.duration + 10.0 * profile.width + far) / scene.dx
        steps = scene.duration / (scene.max_step * scene.dx) + blocks / EVENTS_OF_A_STEP
        seconds += START + steps * (STEP + LOOK + SLIDE + UPDATE * (scene.order + 1)) * blocks
        events = EVENT[0] + EVENT[1] * scene.order + SEEK * blocks / EVENTS_OF_A_STEP
        seconds += blocks * (LAID + WRITTEN + 2.0 * events)
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
    if not np.isfinite(paths.release).any():
        blocks = float(_lattice_blocks(scene, np.zeros(1))[0])
        return START + LAID * blocks, blocks
    weight = fold * paths.size / scene.dx
    # The run begins with a whole block.
    first = paths.start == 0.0
    weight[first] *= max(1.0, fold / float(np.sum(weight[first])))
    # One block creeps for ever where it is damped beyond its oscillation between stuck neighbours; the last of many
    # where it is so far beyond, unless a strong pre-stress drives it back (measured).
    alone = float(np.sum(weight[paths.release < scene.duration])) < 2.0 * fold
    beyond = 1.0 if alone else 5.0 if profile.symmetric else 2.0
    creeps = scene.damping_ratio**2 > beyond * (2.0 + scene.gamma * scene.dx**2)
    creeps &= scene.scheme != "continuum"
    creeps &= viscous(scene, paths) or max(profile.left, profile.right) > -1.0
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
    lattice = _lattice_blocks(scene, _farthest(paths, times[1:]))
    blocks = float(lattice[-1])
    if scene.scheme == "continuum":
        return _exact_cost(scene, released, stuck), blocks
    seconds = START + LAID * blocks + WRITTEN * float(released[-1])
    # A block of a symmetric scene counts half.
    steps = np.where(sliding > 0.4, lengths / step, 0.0)
    if scene.scheme == "fixed_step":
        return seconds + float(np.sum(steps * (STEP + LOOK * lattice + SLIDE * sliding))), blocks
    steps = np.where(steps > 0.0, np.maximum(steps, events / EVENTS_OF_A_STEP), 0.0)
    update, event = UPDATE * (scene.order + 1), EVENT[0] + EVENT[1] * scene.order
    # A step that ends early looks again at all that would have stuck within it.
    together = _together(stick, np.where(stick < end, weight, 0.0), step)
    seconds += SEEK / EVENTS_OF_A_STEP * together
    return seconds + float(np.sum(steps * (STEP + update * sliding) + event * events)), blocks


def _exact_cost(scene: Scene, released: np.ndarray, stuck: np.ndarray) -> float:
    """Seconds of the exact solution, from what is released and stuck by the times of the parts."""
    profile, gamma = scene.prestress, scene.gamma
    lowest = min(profile.left, profile.right, *(level for _, level in profile.steps))
    seconds = EXACT + (SLOW * math.sqrt(scene.duration) if gamma == 0.0 and lowest <= 0.0 else 0.0)
    sliding = released - stuck
    place = PLACE if gamma else FREE_PLACE[0] + FREE_PLACE[1] * scene.duration
    seconds += STUCK_PLACE * float(stuck[-1]) + place * float(sliding[-1])
    waves = scene.dx * math.sqrt(gamma)
    seconds += waves * float(released[-1]) * (WAVE + PAIR * waves * float(np.max(sliding)))
    return seconds + PANEL * _panels(scene)


def _panels(scene: Scene) -> float:
    """Panels that the exact solution lays over the Gaussian."""
    free, springs = PANELS_A_WIDTH
    return scene.prestress.width * max(free, springs * math.sqrt(scene.gamma))


def _together(when: np.ndarray, weight: np.ndarray, span: float) -> float:
    """Pairs of what passes within a time span."""
    passes = weight > 0.0
    order = np.argsort(when[passes])
    count = (
        np.add.reduceat(weight[passes][order], np.arange(0, order.size, AT_ONCE))
        if order.size
        else np.zeros(0)
    )
    lasts = np.diff(when[passes][order][::AT_ONCE], append=math.inf)
    return float(np.sum(count**2 * np.minimum(1.0, span / np.maximum(lasts, 0.1 * span))))


def _farthest(paths: FrontPaths, times: np.ndarray) -> np.ndarray:
    """How far from the middle fronts have come by each time."""
    order = np.argsort(paths.release)
    far = np.maximum.accumulate(np.abs(paths.x[order]))
    return np.interp(times, paths.release[order], far, left=0.0)


def _lattice_blocks(scene: Scene, farthest: np.ndarray) -> np.ndarray:
    """Blocks of the lattice that reaches so far: it doubles on the side, or on both, whenever a front is at its end."""
    sides = 1.0 if scene.symmetric else 2.0
    reach = max((abs(centre) + 4.0 * width for centre, _, width in scene.prestress.bumps), default=0.0)
    times = np.maximum(farthest, reach) / (scene.dx * FIRST_BLOCKS)
    return (
        sides
        * FIRST_BLOCKS
        * (1.0 + sides) ** np.ceil(np.log(np.maximum(times, 1.0)) / math.log(1.0 + sides))
    )


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
