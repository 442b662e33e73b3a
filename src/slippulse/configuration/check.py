"""Refuses simulations whose scenes are refused, before anything runs: at the ends of their lists."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..model.scene import Scene
from ..theory.front_law import front_speed
from ..theory.pulse import pulse_behind_front
from .accuracy import promised
from .bound import corners
from .expand import expand, run_count
from .resolve import accuracy_of, all_simulations, resolve
from .schema import Configuration

# Below this fraction of resolved_blocks in every run a sweep says nothing about the continuum.
HARDLY_RESOLVED = 0.5


@np.errstate(all="ignore")
def simulation_problems(config: Configuration) -> list[str]:
    """What is wrong with each simulation, on its own lattice and on the coarsest of its grid study.

    A rule of `Scene` that holds at the smallest and the largest entries of all lists holds between them too.
    """
    accuracy, problems = accuracy_of(config), []
    coarsest = max(accuracy["coarser"])
    for name, simulation in all_simulations(config).items():
        key, where = f"{'scenes' if name in config.scenes else 'simulations'}.{name}", ""
        try:
            sweep = resolve(simulation, config.model, accuracy)
            if simulation.chunks > (count := run_count(sweep)):
                raise ValueError(f"chunks: {simulation.chunks}; allowed: up to the number of runs, {count}")
            scenes, _ = expand(promised(corners(sweep)))
            _check_nucleation(scenes)
            _check_resolved(scenes)
            where = f" (on the lattice {coarsest:g} times coarser of the grid study)"
            expand(promised(corners(resolve(simulation, config.model, accuracy, coarsest))))
        except ArithmeticError:
            problems.append(
                f"{key}: a number too large or too small to compute with; allowed: numbers near 1"
            )
        except ValueError as error:
            problems.append(f"{key}.{error}{where}")
    return problems


def _check_nucleation(scenes: Sequence[Scene]) -> None:
    """Refuse a profile that reaches the threshold at no block, so that nothing ever moves."""
    for profile, dx in dict.fromkeys((scene.prestress, scene.dx) for scene in scenes):
        if (profile.bumps or profile.peak < 1.0) and not (largest := profile.largest(dx)) >= 1.0:
            raise ValueError(
                f"peak: {profile.peak:g}, and the pre-stress of a block is at most {largest:.9g}"
                f" (dx = {dx:g}); allowed: a pre-stress that reaches 1 somewhere, or nothing moves"
            )


def _check_resolved(scenes: Sequence[Scene]) -> None:
    """Refuse scenes none of which comes near resolving its pulse; those of somewhat few blocks are flagged."""
    widest, needed = 0.0, scenes[0].resolved_blocks
    # Wide pulses first, so that the first run usually settles it.
    for scene in sorted(scenes, key=lambda scene: (scene.gamma * scene.dx**2, -scene.prestress.left)):
        widest = max(widest, pulse_blocks(scene))
        if widest >= HARDLY_RESOLVED * needed:
            return
    raise ValueError(
        f"resolved_blocks: {needed}, while the widest pulse has about {widest:.2g} blocks; allowed: a pulse of at least"
        f" {HARDLY_RESOLVED * needed:g} blocks: a smaller dx, or a smaller resolved_blocks where single blocks are the"
        " point"
    )


def pulse_blocks(scene: Scene) -> float:
    """Blocks across the steady pulse of the exact theory, or across the Gaussian under a stress boundary.

    Infinite where nothing is predicted.
    """
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
