"""Checks of the scenes of each simulation, and upper bounds on their computing cost."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from slippulse.model.checks import check_that
from slippulse.model.cost import Bound, bound_cost
from slippulse.model.prestress import Prestress
from slippulse.model.scene import Scene, used_extra_terms
from slippulse.theory.closed_pulse import pulse_at_speed
from slippulse.theory.front_speeds import front_speed

from .altered import Alterations
from .expand import expand
from .promised_spacings import with_promised_spacings
from .resolve import accuracy_of, all_simulations, resolve, with_ends_of_lists
from .runs import run_count
from .schema import Configuration, Model, Simulation

# A sweep is refused if the pulse of every run has fewer blocks than this fraction of the key
# resolved_blocks, since its results would say nothing about the continuum.
HARDLY_RESOLVED = 0.5


@np.errstate(all="ignore")
def simulation_problems(config: Configuration) -> list[str]:
    """Return a line for each simulation with a scene that cannot be run.

    The scenes are checked on their own lattice and on the coarsest lattice of the grid study.
    Extreme values may overflow. The checks refuse them, and so numpy need not warn.
    """
    accuracy, problems = accuracy_of(config), []
    for name, simulation in all_simulations(config).items():
        try:
            _check_simulation(simulation, config.model, accuracy)
        except ArithmeticError:
            problem = "a number too large or small to compute with; allowed: numbers near 1"
            problems.append(f"{config.key_of(name)}: {problem}")
        except ValueError as error:
            problems.append(f"{config.key_of(name)}.{error}{_note_on_units(config, name)}")
    return problems


def _check_simulation(simulation: Simulation, model: Model, accuracy: Mapping) -> None:
    """Raise ValueError or ArithmeticError if a scene of a simulation cannot be run."""
    sweep = resolve(simulation, model, accuracy)
    count = run_count(sweep)
    allowed = f"at most the number of runs, {count}"
    check_that(simulation.chunks <= count, "chunks", simulation.chunks, allowed)
    # If any run is refused, one at the ends of the lists is, too. Only these are checked.
    scenes, _ = expand(with_promised_spacings(with_ends_of_lists(sweep)))
    _refuse_low_prestress(scenes)
    _check_resolution(scenes)
    # A scene may also be refused on the coarsest lattice of the grid study.
    coarsest = max(accuracy["coarser"])
    try:
        expand(with_promised_spacings(with_ends_of_lists(sweep | {"coarser": coarsest})))
    except ValueError as error:
        lattice = (
            f"on the coarsest lattice of the grid study, on which dx is {coarsest:g} times the dx"
            " of the run"
        )
        raise ValueError(f"{error} ({lattice})") from None


def _note_on_units(config: Configuration, name: str) -> str:
    """Return a note on the units in the refusal of a scene that is given in SI units.

    The refusal has non-dimensional numbers. The note is empty for all other simulations.
    """
    scene = config.scenes.get(name)
    if scene is None or scene.layer is None:
        return ""
    return f" ({scene.layer.layer(scene.boundary).units_in_words})"


def _refuse_low_prestress(scenes: Sequence[Scene]) -> None:
    """Raise ValueError for a pre-stress with which nothing ever moves."""
    # Many scenes share a profile. A dictionary keeps each profile and spacing once.
    different_profiles = dict.fromkeys((scene.prestress, scene.dx) for scene in scenes)
    for profile, dx in different_profiles:
        largest = _largest_prestress(profile, dx)
        # NaN is refused too.
        if not largest >= 1.0:
            raise ValueError(
                f"peak: {profile.peak:g}, and the pre-stress of a block is at most {largest:.9g}"
                f" (dx = {dx:g}); allowed: a pre-stress that reaches 1 somewhere, since otherwise"
                " nothing moves"
            )


def _largest_prestress(profile: Prestress, dx: float) -> float:
    """Return the largest pre-stress of a block, if the blocks have the spacing ``dx``."""
    # Without bumps and tables, only the Gaussian at x = 0 exceeds the levels. A block is at x = 0.
    has_only_levels = not (profile.bumps or profile.points or profile.width is None)
    if has_only_levels:
        levels = [interval.right_value for interval in profile.intervals]
        return max(profile.peak, *levels)
    # The largest pre-stress is at a block near x = 0, or within three widths of the centre of a
    # Gaussian, or next to a point of the table.
    positions = [np.zeros(1)]
    for centre, width in profile.gaussians:
        positions.append(centre + width * np.linspace(-3.0, 3.0, 601))
    table_positions = np.array([x for x, _ in profile.points])
    positions += [table_positions - dx, table_positions, table_positions + dx]
    block_positions = np.round(np.concatenate(positions) / dx) * dx
    return float(np.max(profile(block_positions)))


def _check_resolution(scenes: Sequence[Scene]) -> None:
    """Raise ValueError if the pulse has far too few blocks in every scene.

    A run is only flagged if its pulse has fewer than ``resolved_blocks`` blocks. A simulation is
    refused if no pulse has the fraction HARDLY_RESOLVED of them.
    """
    # All scenes of a simulation have the same resolved_blocks.
    fewest_blocks = HARDLY_RESOLVED * scenes[0].resolved_blocks
    # Computing the width takes time. Scenes with wide pulses come first, so that one is usually
    # enough. A pulse has many blocks if sqrt(gamma) dx is small and the pre-stress is large.
    widest_first = sorted(
        scenes, key=lambda scene: (scene.gamma * scene.dx**2, -scene.prestress.left)
    )
    if not any(_pulse_blocks(scene) >= fewest_blocks for scene in widest_first):
        widest = max(map(_pulse_blocks, scenes))
        raise ValueError(
            f"resolved_blocks: {scenes[0].resolved_blocks}, while the widest pulse has about"
            f" {widest:.2g} blocks; allowed: a pulse of at least {fewest_blocks:g} blocks; use"
            " a smaller dx, or a smaller resolved_blocks if the simulation is about single blocks"
        )


def _pulse_blocks(scene: Scene) -> float:
    """Return the number of blocks across the pulse of a scene.

    If the stress is held, return the number of blocks across the narrowest Gaussian instead, since
    a pulse then has no constant width. The result is infinity, with which no scene is refused, if
    there are no blocks or theory gives no pulse width.
    """
    if scene.boundary == "stress" and scene.scheme != "continuum":
        return scene.prestress.narrowest / scene.dx
    level = max(scene.prestress.left, scene.prestress.right)
    if scene.scheme == "continuum" or level <= 0.0 or used_extra_terms(vars(scene)):
        return math.inf
    try:
        # The pulse is widest in uniform pre-stress at the higher of the two levels.
        speed = float(front_speed(level, scene.damping_ratio, scene.release))
        return pulse_at_speed(level, scene.gamma, scene.beta, speed).width / scene.dx
    except (ValueError, ArithmeticError):
        return math.inf


def bound_of_sweep(simulation: Mapping, chunks: int) -> Bound:
    """Return an upper bound on the cost of one chunk of a sweep.

    Only the runs with the smallest or largest value of each list are examined. Every run of the
    chunk counts as much as the most expensive one of these.
    """
    scenes, samples = expand(with_promised_spacings(with_ends_of_lists(simulation)))
    bounds = [*map(bound_cost, scenes, samples)]
    runs = run_count(simulation) / chunks
    # The memory of the solver is for one run, since it is freed at the end of a run.
    return Bound(
        runs=runs,
        block_updates=runs * max(bound.block_updates for bound in bounds),
        data_bytes=runs * max(bound.data_bytes for bound in bounds),
        solver_bytes=max(bound.solver_bytes for bound in bounds),
    )


def cost_problems(config: Configuration, altered: Alterations) -> list[str]:
    """Return a line for each altered simulation whose runs would take too much time or memory.

    Simulations with their shipped values are not checked.
    """
    shipped = altered.shipped
    are_lattices_altered = (config.accuracy, config.presets) != (shipped.accuracy, shipped.presets)
    shipped_simulations, accuracy = all_simulations(shipped), accuracy_of(config)
    problems = []
    for name, simulation in all_simulations(config).items():
        # The recorded changes exclude the number of chunks, and the keys of new simulations.
        is_altered = altered.changes_of[name] or shipped_simulations.get(name) != simulation
        if not (are_lattices_altered or is_altered):
            continue
        sweep = resolve(simulation, config.model, accuracy)
        exceeded_limit = bound_of_sweep(sweep, simulation.chunks).exceeded(simulation.chunks)
        if exceeded_limit:
            problems.append(f"{config.key_of(name)}.{exceeded_limit}")
    return problems
