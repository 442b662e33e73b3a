"""What a rule passes to its job: a simulation with everything that its data depend on; and what is refused before it.

A front goes at most at the speed that the highest pre-stress level drives it at, and what it has passed slides at most
until the end. So the work of a run is at most its steps times the blocks that its fronts can reach. What is measured in
the shipped sweeps is at most 0.43 of that; undamped blocks that slip again and again may take twice as much.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ..model.prestress import Prestress
from ..model.samples import Samples
from ..model.scene import Scene
from ..theory.front_speeds import LARGEST_RATIO, front_speed
from ..theory.pulse import pulse_behind_front
from .accuracy import ORDER, STEP, promised
from .expand import expand, run_count
from .schema import Configuration, Model, NamedScene, Profile, Simulation

# Below this fraction of resolved_blocks in every run a sweep says nothing about the continuum.
HARDLY_RESOLVED = 0.5

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


def accuracy_of(config: Configuration) -> dict[str, Any]:
    """The preset that a configuration names; with `accuracy` another step and order, and the promise."""
    preset = config.presets[config.preset].plain()
    promise = {"max_step": STEP, "order": ORDER, "promise": config.accuracy}
    return preset if config.accuracy is None else preset | promise


def resolve(
    simulation: Simulation | Mapping,
    model: Model | Mapping,
    accuracy: Mapping,
    coarser: float = 1.0,
) -> dict[str, Any]:
    """A simulation with everything that its data depend on, as builtins, without the number of its chunks.

    accuracy : as `accuracy_of` returns it
    coarser : multiplies the spacing, at fixed beta/dx and step/dx; a fixed spacing stays, and its step is multiplied
    """
    model = Model.model_validate(model)
    own = Simulation.model_validate(simulation).plain()
    own.pop("chunks")
    kept = {key: accuracy[key] for key in ("dx", "max_step", "order", "promise") if key in accuracy}
    whole = {**model.plain(), "damping_ratio": [model.damping_ratio], **own}
    return whole | {"accuracy": kept, "coarser": coarser}


def all_simulations(config: Configuration) -> dict[str, Simulation]:
    """Simulations by name, the scenes among them."""
    scenes = {name: scene_simulation(scene, config.model) for name, scene in config.scenes.items()}
    return {**config.simulations, **scenes}


def scene_simulation(scene: NamedScene, model: Model) -> Simulation:
    """A scene as a simulation of one run that records everything, where the fronts may go."""
    level = min(max(scene.left, scene.right, *(level for _, level in scene.steps)), 1.0 - 1e-6)
    ratio = min(
        model.damping_ratio if scene.damping_ratio is None else scene.damping_ratio, LARGEST_RATIO
    )
    speed = 1.0
    if level > 0.0:
        # 1/(1 - tau) is the speed of the rule "total" at beta/dx = 1.
        speed = (
            float(front_speed(level, ratio, "total")) if scene.beta is None else 1.0 / (1.0 - level)
        )
    far = max((abs(centre) + 4.0 * width for centre, _, width in scene.bumps), default=0.0)
    extent = float(f"{far + speed * scene.duration + 3.0 * scene.width:.4g}")
    given = scene.plain()
    del given["title"]
    profile = {key: given.pop(key) for key in Profile.model_fields}
    listed = ("gamma", "damping_ratio", "beta", "dx", "rate_strengthening")
    given |= {key: [given[key]] for key in listed if key in given}
    # Samples of a map and of an animation.
    samples = {"times": 241, "positions": 801, "extent": extent}
    given |= {"profiles": [profile], "duration": {"time": scene.duration}, "samples": samples}
    return Simulation.model_validate(given | {"record": ["fronts", "fields", "samples"]})


@np.errstate(all="ignore")
def simulation_problems(config: Configuration) -> list[str]:
    """What is wrong with the scenes of each simulation, on its own lattice and on the coarsest of its grid study."""
    accuracy, problems = accuracy_of(config), []
    coarsest = max(accuracy["coarser"])
    for name, simulation in all_simulations(config).items():
        key, where = f"{'scenes' if name in config.scenes else 'simulations'}.{name}", ""
        try:
            sweep = resolve(simulation, config.model, accuracy)
            if simulation.chunks > (count := run_count(sweep)):
                raise ValueError(
                    f"chunks: {simulation.chunks}; allowed: up to the number of runs, {count}"
                )
            _check_runs(expand(promised(corners(sweep)))[0])
            where = f" (on the lattice {coarsest:g} times coarser of the grid study)"
            expand(promised(corners(sweep | {"coarser": coarsest})))
        except ArithmeticError:
            problems.append(
                f"{key}: a number too large or small to compute with; allowed: numbers near 1"
            )
        except ValueError as error:
            problems.append(f"{key}.{error}{where}")
    return problems


def _largest(profile: Prestress, dx: float) -> float:
    """The largest pre-stress of a block, at the peak and the bumps and around them."""
    if not profile.bumps:
        return max(profile.peak, *(level for *_, level in profile.intervals))
    centres, _, widths = np.array([(0.0, 1.0, profile.width), *profile.bumps]).T
    near = centres[:, None] + np.linspace(-3.0, 3.0, 601)[:, None, None] * widths
    return float(np.max(profile(np.round(np.append(near, centres) / dx) * dx)))


def _check_runs(scenes: Sequence[Scene]) -> None:
    """Refuse profiles by which nothing ever moves, and scenes none of which comes near resolving its pulse."""
    for profile, dx in dict.fromkeys((scene.prestress, scene.dx) for scene in scenes):
        if (profile.bumps or profile.peak < 1.0) and not (largest := _largest(profile, dx)) >= 1.0:
            raise ValueError(
                f"peak: {profile.peak:g}, and the pre-stress of a block is at most {largest:.9g}"
                f" (dx = {dx:g}); allowed: a pre-stress that reaches 1 somewhere, or nothing moves"
            )
    least = HARDLY_RESOLVED * scenes[0].resolved_blocks
    # Wide pulses first, so that the first run usually settles it.
    ordered = sorted(scenes, key=lambda scene: (scene.gamma * scene.dx**2, -scene.prestress.left))
    if not any(_pulse_blocks(scene) >= least for scene in ordered):
        raise ValueError(
            f"resolved_blocks: {scenes[0].resolved_blocks}, while the widest pulse has about"
            f" {max(map(_pulse_blocks, scenes)):.2g} blocks; allowed: a pulse of at least {least:g} blocks: a smaller"
            " dx, or a smaller resolved_blocks where single blocks are the point"
        )


def _pulse_blocks(scene: Scene) -> float:
    """Blocks across the pulse by exact theory, or the Gaussian under a stress boundary; infinite where unknown."""
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
    """What a list of runs takes at most."""

    runs: float
    block_updates: float
    bytes: float

    def exceeded(self, chunks: int = 1) -> str:
        """Which limit one of these jobs exceeds, or all together do, in words; empty where none is."""
        most, shared = min(1.0, MOST_CHUNKS / chunks), f" in each of {chunks} chunks" * (chunks > 1)
        for name, value, limit in zip(self._fields, self, LIMITS, strict=True):
            if not value <= most * limit:
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
    """At most so much for one of the jobs that share a simulation; a run at the ends of its lists takes the most."""
    found = [bound_of(*run) for run in zip(*expand(promised(corners(simulation))), strict=True)]
    runs = run_count(simulation) / chunks
    return Bound(*(runs * max(column) for column in zip(*found, strict=True)))


def corners(simulation: Mapping) -> dict[str, Any]:
    """A resolved simulation of the runs at the ends of its lists: what `Scene` allows there it allows between."""
    found = {key: value for key, value in simulation.items() if key != "chunk"}
    if "beyond" in found:
        found["beyond"] = corners(found["beyond"])
    for key in ("left", "right", "width", "gamma", "damping_ratio", "beta", "dx", "levels"):
        if isinstance(found.get(key), list):
            found[key] = sorted({min(found[key]), max(found[key])})
    return found
