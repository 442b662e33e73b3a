"""Limits of a simulation: refusals of its scenes, and an upper bound on what its runs cost."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from slippulse.model.checks import check_that
from slippulse.model.cost import Bound, bound_cost
from slippulse.model.scene import Scene, used_extra_terms
from slippulse.theory.closed_pulse import pulse_at_speed
from slippulse.theory.front_speeds import front_speed

from .altered import Alterations
from .expand import expand
from .promised_spacings import promised
from .resolve import accuracy_of, all_simulations, corners, resolve
from .runs import run_count
from .schema import Configuration

# A sweep says nothing about the continuum if every run is below this fraction of resolved_blocks.
HARDLY_RESOLVED = 0.5


@np.errstate(all="ignore")
def simulation_problems(config: Configuration) -> list[str]:
    """Problems of the scenes of each simulation, on its lattice and the coarsest of its study."""
    accuracy, problems = accuracy_of(config), []
    coarsest = max(accuracy["coarser"])
    for name, simulation in all_simulations(config).items():
        key, lattice = config.key_of(name), ""
        try:
            sweep = resolve(simulation, config.model, accuracy)
            count = run_count(sweep)
            allowed = f"up to the number of runs, {count}"
            check_that(simulation.chunks <= count, "chunks", simulation.chunks, allowed)
            scenes, _ = expand(promised(corners(sweep)))
            _check_profiles(scenes)
            _check_resolution(scenes)
            lattice = f" (on the lattice {coarsest:g} times coarser of the grid study)"
            expand(promised(corners(sweep | {"coarser": coarsest})))
        except ArithmeticError:
            problem = "a number too large or small to compute with; allowed: numbers near 1"
            problems.append(f"{key}: {problem}")
        except ValueError as error:
            problems.append(f"{key}.{error}{lattice}{_units(config, name)}")
    return problems


def _units(config: Configuration, name: str) -> str:
    """What the numbers of a refusal are in, if a scene has a layer."""
    scene = config.scenes.get(name)
    if scene is None or scene.layer is None:
        return ""
    return f" ({scene.layer.layer(scene.boundary).units_in_words})"


def _check_profiles(scenes: Sequence[Scene]) -> None:
    """Refuse a pre-stress with which nothing ever moves."""
    for profile, dx in dict.fromkeys((scene.prestress, scene.dx) for scene in scenes):
        if profile.bumps or profile.points or profile.width is None:
            # The largest pre-stress is at a point, at the peak and the bumps, or around them.
            centres, widths = np.array([(0.0, 0.0), *profile.gaussians]).T
            near = centres[:, None] + np.linspace(-3.0, 3.0, 601)[:, None, None] * widths
            around = np.array([x for x, _ in profile.points]) + np.array([[-dx], [0.0], [dx]])
            blocks = np.round(np.concatenate([near.ravel(), around.ravel()]) / dx) * dx
            largest = float(np.max(profile(blocks)))
        else:
            largest = max([profile.peak, *(level for *_, level in profile.intervals)])
        if not largest >= 1.0:
            raise ValueError(
                f"peak: {profile.peak:g}, and the pre-stress of a block is at most {largest:.9g}"
                f" (dx = {dx:g}); allowed: a pre-stress that reaches 1 somewhere, or nothing moves"
            )


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
        return scene.prestress.narrowest / scene.dx
    level = max(scene.prestress.left, scene.prestress.right)
    if scene.scheme == "continuum" or level <= 0.0 or used_extra_terms(vars(scene)):
        return math.inf
    try:
        speed = float(front_speed(level, scene.damping_ratio, scene.release))
        return pulse_at_speed(level, scene.gamma, scene.beta, speed).width / scene.dx
    except (ValueError, ArithmeticError):
        return math.inf


def bound_of_sweep(simulation: Mapping, chunks: int) -> Bound:
    """Upper bound on one of the jobs that share a simulation: its runs times its largest run."""
    scenes, samples = expand(promised(corners(simulation)))
    bounds = [*map(bound_cost, scenes, samples)]
    runs = run_count(simulation) / chunks
    updates = max(bound.block_updates for bound in bounds)
    return Bound(runs, runs * updates, runs * max(bound.bytes for bound in bounds))


def cost_problems(config: Configuration, altered: Alterations) -> list[str]:
    """Return a line for each simulation that costs too much, of those that the user has changed."""
    shipped, here = altered.shipped, altered.here
    lattice = (config.accuracy, config.presets) != (shipped.accuracy, shipped.presets)
    before, accuracy, problems = all_simulations(shipped), accuracy_of(here), []
    for name, simulation in all_simulations(here).items():
        if not (lattice or altered.simulations[name] or before.get(name) != simulation):
            continue
        whole = resolve(simulation, here.model, accuracy)
        exceeded = bound_of_sweep(whole, simulation.chunks).exceeded(simulation.chunks)
        if exceeded:
            problems.append(f"{here.key_of(name)}.{exceeded}")
    return problems
