"""What a rule passes to its job: a simulation with everything that its data depend on, as builtins."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .accuracy import ORDER, STEP
from .schema import Configuration, Model
from .simulations import Simulation


def accuracy_of(config: Configuration) -> dict[str, Any]:
    """The preset that a configuration names; with `accuracy` another step and order, and the promise."""
    preset = config.presets[config.preset].plain()
    if config.accuracy is None:
        return preset
    return preset | {"max_step": STEP, "order": ORDER, "promise": config.accuracy}


def resolve(
    simulation: Simulation | Mapping, model: Model | Mapping, accuracy: Mapping, coarser: float = 1.0
) -> dict[str, Any]:
    """A simulation with everything that its data depend on, as builtins.

    Parameters
    ----------
    simulation, model : entries of the configuration; the number of chunks is left out, since the runs are the same
    accuracy : as `accuracy_of` returns it
    coarser : multiplies the spacing, at fixed beta/dx and step/dx; a fixed spacing stays, and its step is multiplied
    """
    model = Model.model_validate(model)
    own = Simulation.model_validate(simulation).plain()
    own.pop("chunks")
    return {**model.plain(), "damping_ratio": [model.damping_ratio], **own} | {
        "accuracy": {key: accuracy[key] for key in ("dx", "max_step", "order", "promise") if key in accuracy},
        "coarser": coarser,
    }
