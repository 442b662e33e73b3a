"""Expansion of a resolved simulation into the scenes of its runs."""

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
    """Return the scenes of a resolved simulation, or of a chunk, and the samples of each.

    Raises ValueError if a scene is not allowed.
    """
    scenes = [_scene(simulation, run) for run in runs(simulation)]
    recording = simulation.get("samples")
    if recording is None:
        return scenes, [None] * len(scenes)
    extent, count = recording["extent"], recording["positions"]
    positions = np.linspace(-extent, extent, count) if count > 1 else np.zeros(1)
    samples: list[Samples | None] = []
    for scene in scenes:
        times = np.linspace(0.0, scene.duration, recording["times"])
        samples.append(Samples(times, positions))
    return scenes, samples


def _scene(simulation: Mapping, run: Run) -> Scene:
    """Return the scene of one run."""
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
    """Return the largest time step of a run, divided by dx."""
    accuracy = simulation["accuracy"]
    step = simulation.get("max_step", _default_time_step(simulation, run, friction))
    if "promise" in accuracy:
        step = min(step, accuracy["max_step"])
    # A grid study of a fixed spacing uses longer steps instead of larger spacings.
    return step * simulation["coarser"] if "fixed" in simulation["spacing"] else step


def _default_time_step(simulation: Mapping, run: Run, friction: Friction) -> float:
    """Return the time step of the preset, or a smaller one if that is not stable or accurate."""
    accuracy = simulation["accuracy"]
    ratios = stability_ratios(run.parameters(), friction)
    stable_step = choose_step(simulation["scheme"], accuracy["order"], *ratios)
    longest_step = STABILITY_MARGIN * friction.traits.longest_step / run.dx
    return min(accuracy["max_step"], stable_step, longest_step)


def _duration(rule: Mapping, profile: Prestress, gamma: float) -> float:
    """Return the duration of a run in H/c."""
    ((unit, value),) = rule.items()
    if unit == "half_periods":
        value = value * math.pi / math.sqrt(gamma)
    if unit == "balance_distances":
        try:
            value *= abs(prestress_balance_position(profile))
        except ValueError as error:
            # Keys of the configuration do not begin with `prestress`.
            reason = str(error).removeprefix("prestress.")
            given = f"{value} times |x_minus|"
            raise ValueError(f"duration.balance_distances: {given}, but {reason}") from None
    return float(value)
