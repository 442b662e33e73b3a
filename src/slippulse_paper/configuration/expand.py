"""Expansion of a resolved simulation into the scenes of its runs."""

import math
from collections.abc import Mapping

import numpy as np

from slippulse.model.balance import prestress_balance_position
from slippulse.model.friction import friction_from
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
    rule = simulation.get("samples")
    if rule is None:
        return scenes, [None] * len(scenes)
    extent, count = rule["extent"], rule["positions"]
    positions = np.linspace(-extent, extent, count) if count > 1 else np.zeros(1)
    times = [np.linspace(0.0, scene.duration, rule["times"]) for scene in scenes]
    return scenes, [Samples(instants, positions) for instants in times]


def _scene(simulation: Mapping, run: Run) -> Scene:
    """Return the scene of one run."""
    accuracy, scheme = simulation["accuracy"], simulation["scheme"]
    # A simulation without `max_step` takes the step of the preset, or a smaller one if that would
    # not be stable or accurate.
    friction, largest = friction_from(run.friction), accuracy["max_step"]
    traits = friction.traits
    parameters = run.parameters() | {"friction": friction}
    ratios = stability_ratios(parameters, friction)
    step = min(largest, choose_step(scheme, accuracy["order"], *ratios))
    step = simulation.get("max_step", min(step, STABILITY_MARGIN * traits.longest_step / run.dx))
    if "promise" in accuracy:
        step = min(step, largest)
    if "fixed" in simulation["spacing"]:
        step *= simulation["coarser"]
    return Scene(
        **parameters,
        duration=_duration(simulation["duration"], run.prestress, run.gamma),
        scheme=scheme,
        max_step=step,
        order=accuracy["order"],
        friction_ratio=simulation["friction_ratio"],
        resolved_blocks=simulation["resolved_blocks"],
    )


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
            reason = f"{value} times |x_minus|, but {str(error).removeprefix('prestress.')}"
            raise ValueError(f"duration.balance_distances: {reason}") from None
    return float(value)
