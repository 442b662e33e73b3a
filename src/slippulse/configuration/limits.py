"""Limits of a simulation: refusals of its scenes, and an upper bound on what its runs cost.

A front goes at most at the speed that the highest level of the pre-stress drives it at, and the
blocks that it has passed slide at most until the end. So the work of a run is at most its steps
times the blocks that its fronts can reach. The shipped sweeps take at most 0.43 of that. Undamped
blocks that slip again and again may take twice as much.
"""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..model.prestress import Prestress
from ..model.samples import Samples
from ..model.scene import Scene
from ..theory.front_speeds import front_speed
from ..theory.pulse import pulse_behind_front
from .accuracy import promised
from .expand import expand, run_count
from .resolve import accuracy_of, all_simulations, corners, resolve
from .schema import Configuration

# A sweep says nothing about the continuum if every run is below this fraction of resolved_blocks.
HARDLY_RESOLVED = 0.5

# One job may take so much without a second question: runs, block updates (days on one core), bytes
# (a small machine). A sweep in chunks may take this number of times as much in total.
LIMITS = 20_000, 4e13, 4e9
MOST_CHUNKS = 50
HOW_TO_GO_ON = "--config allow_large=true"
# Bytes of a block: seven recorded numbers; two arrays an order and sixteen others while it runs.
RECORDED, ARRAYS = 56.0, 16.0
# Block updates that take as long as a run that does nothing, and as a block of the exact solution.
START, EXACT_BLOCK = 1e5, 3e4
# A step ends early after this number of events.
EVENTS_OF_A_STEP = 64
# Seconds of a block update at the highest order on a slow machine, and the number of block updates
# from which a second thread pays.
UPDATE_SECONDS, LONG_SWEEP = 2e-8, 1e11
# Minutes to start a job, and MB of the interpreter with its libraries.
START_MINUTES, START_MEGABYTES = 10, 1000


@np.errstate(all="ignore")
def simulation_problems(config: Configuration) -> list[str]:
    """Problems of the scenes of each simulation, on its lattice and the coarsest of its study."""
    accuracy, problems = accuracy_of(config), []
    coarsest = max(accuracy["coarser"])
    for name, simulation in all_simulations(config).items():
        key = f"scenes.{name}" if name in config.scenes else f"simulations.{name}"
        lattice = ""
        try:
            sweep = resolve(simulation, config.model, accuracy)
            count = run_count(sweep)
            if simulation.chunks > count:
                allowed = f"up to the number of runs, {count}"
                raise ValueError(f"chunks: {simulation.chunks}; allowed: {allowed}")
            scenes, _ = expand(promised(corners(sweep)))
            _check_profiles(scenes)
            _check_resolution(scenes)
            lattice = f" (on the lattice {coarsest:g} times coarser of the grid study)"
            expand(promised(corners(sweep | {"coarser": coarsest})))
        except ArithmeticError:
            allowed = "numbers near 1"
            problem = "a number too large or small to compute with"
            problems.append(f"{key}: {problem}; allowed: {allowed}")
        except ValueError as error:
            problems.append(f"{key}.{error}{lattice}")
    return problems


def _check_profiles(scenes: Sequence[Scene]) -> None:
    """Refuse a pre-stress with which nothing ever moves."""
    for profile, dx in dict.fromkeys((scene.prestress, scene.dx) for scene in scenes):
        largest = _largest(profile, dx)
        if not largest >= 1.0:
            raise ValueError(
                f"peak: {profile.peak:g}, and the pre-stress of a block is at most {largest:.9g}"
                f" (dx = {dx:g}); allowed: a pre-stress that reaches 1 somewhere, or nothing moves"
            )


def _largest(profile: Prestress, dx: float) -> float:
    """The largest pre-stress of a block, at the peak and the bumps and around them."""
    if not profile.bumps:
        return max([profile.peak, *(level for *_, level in profile.intervals)])
    centres, _, widths = np.array([(0.0, 1.0, profile.width), *profile.bumps]).T
    near = centres[:, None] + np.linspace(-3.0, 3.0, 601)[:, None, None] * widths
    return float(np.max(profile(np.round(np.append(near, centres) / dx) * dx)))


def _check_resolution(scenes: Sequence[Scene]) -> None:
    """Refuse scenes none of which comes near resolving its pulse."""
    least = HARDLY_RESOLVED * scenes[0].resolved_blocks
    # Wide pulses come first, so that the first run usually settles it.
    ordered = sorted(scenes, key=lambda scene: (scene.gamma * scene.dx**2, -scene.prestress.left))
    if not any(_pulse_blocks(scene) >= least for scene in ordered):
        widest = max(map(_pulse_blocks, scenes))
        raise ValueError(
            f"resolved_blocks: {scenes[0].resolved_blocks}, while the widest pulse has about"
            f" {widest:.2g} blocks; allowed: a pulse of at least {least:g} blocks: a smaller"
            " dx, or a smaller resolved_blocks where single blocks are the point"
        )


def _pulse_blocks(scene: Scene) -> float:
    """Blocks across the pulse (under a stress boundary, the Gaussian); infinite where unknown."""
    if scene.boundary == "stress" and scene.scheme != "continuum":
        return scene.prestress.width / scene.dx
    level = max(scene.prestress.left, scene.prestress.right)
    if scene.scheme == "continuum" or level <= 0.0:
        return math.inf
    try:
        speed = float(front_speed(level, scene.damping_ratio, scene.release))
        return pulse_behind_front(level, scene.gamma, scene.beta, speed).width / scene.dx
    except (ValueError, ArithmeticError):
        return math.inf


class Bound(NamedTuple):
    """Upper bound on what a list of runs takes."""

    runs: float
    block_updates: float
    bytes: float

    def exceeded(self, chunks: int = 1) -> str:
        """The limit that one job, or all jobs together, exceed, in words; empty if none is."""
        fraction = min(1.0, MOST_CHUNKS / chunks)
        shared = f" in each of {chunks} chunks" if chunks > 1 else ""
        for name, value, limit in zip(self._fields, self, LIMITS, strict=True):
            allowed = fraction * limit
            if not value <= allowed:
                takes = f"up to {value:.3g} {name.replace('_', ' ')}{shared}"
                return f"cost: {takes}; allowed: {allowed:.3g}, with more chunks or {HOW_TO_GO_ON}"
        return ""

    @property
    def threads(self) -> int:
        """Threads of the job; short sweeps run side by side instead, and start faster."""
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
    """Upper bound on what one run takes."""
    profile, ratio = scene.prestress, scene.damping_ratio
    level = max([0.0, *(level for *_, level in profile.intervals)])
    # This is above the exact speed at any damping, under either release rule.
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
    """Upper bound on one of the jobs that share a simulation: its runs times its largest run."""
    scenes, samples = expand(promised(corners(simulation)))
    bounds = [*map(bound_of, scenes, samples)]
    runs = run_count(simulation) / chunks
    updates = max(bound.block_updates for bound in bounds)
    return Bound(runs, runs * updates, runs * max(bound.bytes for bound in bounds))
