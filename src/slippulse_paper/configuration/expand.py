"""Conversion of a resolved simulation into a list of scenes, one for each run."""

import math
from collections.abc import Mapping

import numpy as np

from slippulse.model.balance import prestress_balance_position
from slippulse.model.friction import Friction, friction_from
from slippulse.model.prestress import Prestress
from slippulse.model.run import Run
from slippulse.model.samples import Samples
from slippulse.model.scene import Scene, stability_ratios
from slippulse.model.stability import STABILITY_MARGIN, choose_step

from .runs import runs


def expand(simulation: Mapping) -> tuple[list[Scene], list[Samples | None]]:
    """Return the scene of each run of a resolved simulation, or of a chunk, and its samples.

    Samples are the times and positions at which data are recorded, or None if there are none.
    Raises ValueError if a scene is not allowed.
    """
    scenes = [_scene(simulation, run) for run in runs(simulation)]
    recording = simulation.get("samples")
    if recording is None:
        return scenes, [None] * len(scenes)
    extent, count = recording["extent"], recording["positions"]
    # A single position is x = 0.
    positions = np.linspace(-extent, extent, count) if count > 1 else np.zeros(1)
    samples: list[Samples | None] = []
    for scene in scenes:
        times = np.linspace(0.0, scene.duration, recording["times"])
        samples.append(Samples(times, positions))
    return scenes, samples


def _scene(simulation: Mapping, run: Run) -> Scene:
    """Return the scene of one run of a simulation."""
    friction = friction_from(run.friction)
    return Scene(
        **(run.parameters() | {"friction": friction}),
        duration=_duration(simulation["duration"], run.prestress, run.gamma),
        scheme=simulation["scheme"],
        max_step=_time_step(simulation, run, friction),
        order=simulation["accuracy"]["order"],
        friction_ratio=simulation["friction_ratio"],
        resolved_blocks=simulation["resolved_blocks"],
    )


def _time_step(simulation: Mapping, run: Run, friction: Friction) -> float:
    """Return the largest time step of a run, divided by dx.

    The result is the user-defined step of the simulation, or the default step.
    """
    accuracy = simulation["accuracy"]
    step = simulation.get("max_step", _default_time_step(simulation, run, friction))
    # The promise is the accuracy that the user requires. This accuracy also limits a user-defined
    # step.
    if "promise" in accuracy:
        step = min(step, accuracy["max_step"])
    # The coarser runs of a grid study have a spacing that is larger by the factor coarser. If the
    # spacing is fixed, they have a larger step instead.
    if "fixed" in simulation["spacing"]:
        step *= simulation["coarser"]
    return step


def _default_time_step(simulation: Mapping, run: Run, friction: Friction) -> float:
    """Return the time step of the preset, or a smaller one if it is not stable or accurate.

    All these time steps, also that of the preset, are divided by dx.
    """
    accuracy = simulation["accuracy"]
    # The stability depends on beta/dx, gamma dx^2 and alpha dx (alpha: rate strengthening).
    ratios = stability_ratios(run.parameters(), friction)
    stable_step = choose_step(simulation["scheme"], accuracy["order"], *ratios)
    # The largest step that resolves the law of friction.
    step_of_law = STABILITY_MARGIN * friction.traits.longest_step / run.dx
    return min(accuracy["max_step"], stable_step, step_of_law)


def _duration(rule: Mapping, profile: Prestress, gamma: float) -> float:
    """Return the duration of a run in H/c.

    ``rule`` has one entry: a unit of the duration, and the value in this unit.
    """
    ((unit, value),) = rule.items()
    if unit == "half_periods":
        return float(value * math.pi / math.sqrt(gamma))
    if unit == "balance_distances":
        try:
            return float(value * abs(prestress_balance_position(profile)))
        except ValueError as error:
            # The library begins its message with `prestress.`, which is no key here.
            reason = str(error).removeprefix("prestress.")
            given = f"{value} times |x_minus|"
            raise ValueError(f"duration.balance_distances: {given}, but {reason}") from None
    return float(value)
