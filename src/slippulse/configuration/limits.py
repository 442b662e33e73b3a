"""Limits of a simulation: how many runs, at what cost, in how many chunks, resolved by how many blocks."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from ..data.chunks import runs_of
from ..model.checks import ConfigError
from ..model.samples import Samples
from ..model.scene import Scene
from ..theory.front_law import front_speed
from ..theory.pulse import steady_pulse
from .cost import HOW_TO_GO_ON, LARGEST_RUNS, LARGEST_WHOLE, exceeded_limit, expected_cost, most_expected

# Lists of a simulation whose product its runs are.
LISTS = ("left", "right", "width", "profiles", "gamma", "damping_ratio", "beta", "dx", "release")
# Below this share of resolved_blocks in every run a sweep says nothing about the continuum.
HARDLY_RESOLVED = 0.5


def run_count(simulation: Mapping) -> int:
    """How many runs a simulation is the product of."""
    lengths = [len(simulation[key]) for key in LISTS if isinstance(simulation.get(key), list)]
    return math.prod(lengths) * len(simulation.get("beyond", {"levels": [0]})["levels"])


def check_run_count(simulation: Mapping, chunks: int = 1) -> None:
    """Refuse a simulation of too many runs for so many chunks, before its scenes are built.

    Raises
    ------
    ValueError
        Naming the number of runs.
    """
    allowed = min(chunks, LARGEST_WHOLE) * LARGEST_RUNS
    if run_count(simulation) > allowed:
        lists = ", ".join(
            f"{key} {len(simulation[key])}" for key in LISTS if isinstance(simulation.get(key), list)
        )
        shared = "" if chunks == 1 else f" in {chunks} chunks"
        raise ValueError(
            f"runs: {run_count(simulation)} ({lists}); allowed: up to {allowed} runs{shared} ({HOW_TO_GO_ON})"
        )


def first_and_last(simulation: Mapping) -> dict:
    """The simulation, or with the first and last entry of each list where it is too large to check run by run."""
    if run_count(simulation) <= LARGEST_RUNS:
        return dict(simulation)
    return {
        key: value[:1] + value[1:][-1:] if key in LISTS and isinstance(value, list) else value
        for key, value in simulation.items()
    }


def check_chunks(chunks: int, simulation: Mapping) -> None:
    """Refuse more chunks than runs.

    Raises
    ------
    ValueError
        Naming both numbers.
    """
    if chunks > run_count(simulation):
        raise ValueError(f"chunks: {chunks}; allowed: up to the number of runs, {run_count(simulation)}")


def check_cost(scenes: Sequence[Scene], samples: Sequence[Samples | None], chunks: int = 1) -> None:
    """Refuse scenes that cost more than a night or a small machine's memory, in one of their chunks or altogether.

    Raises
    ------
    ValueError
        With the estimate, what is allowed and how to go on.
    """
    if not exceeded_limit(most_expected(scenes, samples)):
        return
    cost = expected_cost(scenes, samples)
    if limit := exceeded_limit(cost, LARGEST_WHOLE if chunks > 1 else 1):
        raise ValueError(f"cost: {cost}; allowed: {limit} ({HOW_TO_GO_ON})")
    if chunks == 1 or not exceeded_limit(cost):
        return
    for number in range(1, chunks + 1):
        runs = list(runs_of(number, chunks, len(scenes)))
        cost = expected_cost([scenes[run] for run in runs], [samples[run] for run in runs])
        if limit := exceeded_limit(cost):
            raise ValueError(
                f"chunks: {chunks}, and chunk {number} costs {cost}; allowed: {limit} a chunk: more chunks"
                f" ({HOW_TO_GO_ON})"
            )


def check_affordable(simulations: Mapping[str, tuple[Sequence[Scene], Sequence[Samples | None]]]) -> None:
    """Refuse lists of scenes, by key, each of which `check_cost` refuses.

    Raises
    ------
    ConfigError
        One line a simulation.
    """
    problems = []
    for key, (scenes, samples) in simulations.items():
        try:
            check_cost(scenes, samples)
        except ValueError as error:
            problems.append(f"{key}.{error}")
    if problems:
        raise ConfigError("\n".join(problems))


def check_resolved(scenes: Sequence[Scene]) -> None:
    """Refuse scenes none of which comes near resolving its pulse.

    Runs with fewer than ``resolved_blocks`` blocks in a pulse go on, and are flagged in the data.

    Raises
    ------
    ValueError
        Naming the widest pulse, in blocks, and what is allowed.
    """
    widest, needed = 0.0, 0
    # Wide pulses first, so that the first run usually settles it.
    for scene in sorted(scenes, key=lambda scene: (scene.gamma * scene.dx**2, -scene.prestress.left)):
        blocks = pulse_blocks(scene)
        if blocks >= HARDLY_RESOLVED * scene.resolved_blocks:
            return
        if blocks >= widest:
            widest, needed = blocks, scene.resolved_blocks
    raise ValueError(
        f"resolved_blocks: {needed}, while the widest pulse has about {widest:.2g} blocks; allowed: a pulse of at least"
        f" {HARDLY_RESOLVED * needed:g} blocks: a smaller dx, or a smaller resolved_blocks where single blocks are the"
        " point"
    )


def pulse_blocks(scene: Scene) -> float:
    """Blocks across the narrowest thing that a scene must resolve; infinite where nothing is predicted.

    The steady pulse of the exact theory under a displacement boundary, the Gaussian under a stress boundary.
    """
    if scene.scheme == "continuum":
        return math.inf
    if scene.boundary == "stress":
        return scene.prestress.width / scene.dx
    levels = [level for level in (scene.prestress.left, scene.prestress.right) if 0.0 < level < 1.0]
    if not levels:
        return math.inf
    tau = max(levels)
    try:
        speed = float(front_speed(tau, scene.damping_ratio, scene.release))
        return steady_pulse(tau, scene.gamma, scene.beta, speed).width / scene.dx
    except (ValueError, ArithmeticError):
        return math.inf
