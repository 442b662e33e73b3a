"""What a rule passes to its job: a simulation, or a scene by name, with everything that its data depend on."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..theory.front_law import LARGEST_RATIO, front_speed
from .accuracy import ORDER, STEP
from .schema import Configuration, Model, NamedScene, Profile, Simulation

# Samples of a map and of an animation.
TIMES, POSITIONS = 241, 801
# Numbers of a scene that are lists of a simulation.
LISTED = ("gamma", "damping_ratio", "beta", "dx", "rate_strengthening")


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


def all_simulations(config: Configuration) -> dict[str, Simulation]:
    """Simulations by name, the scenes among them."""
    scenes = {name: scene_simulation(scene, config.model) for name, scene in config.scenes.items()}
    return {**config.simulations, **scenes}


def scene_simulation(scene: NamedScene, model: Model) -> Simulation:
    """A scene as a simulation of one run that records everything.

    Parameters
    ----------
    scene : an entry of ``scenes``
    model : the entry ``model`` of the configuration, for what the scene leaves out
    """
    given = scene.plain()
    given["profiles"] = [{key: given.pop(key) for key in Profile.model_fields}]
    given |= {key: [given[key]] for key in LISTED if key in given}
    given["duration"] = {"time": given["duration"]}
    given["record"] = ["fronts", "fields", "samples"]
    given["samples"] = {"times": TIMES, "positions": POSITIONS, "extent": _reach(scene, model)}
    del given["title"]
    return Simulation.model_validate(given)


def _reach(scene: NamedScene, model: Model) -> float:
    """Where the fronts may be at the end: farther than any, by theory where there is one."""
    level = min(max(scene.left, scene.right, *(level for _, level in scene.steps)), 1.0 - 1e-6)
    ratio = min(model.damping_ratio if scene.damping_ratio is None else scene.damping_ratio, LARGEST_RATIO)
    speed = 1.0
    if level > 0.0:
        # 1/(1 - tau) is the speed of the rule "total" at beta/dx = 1.
        speed = float(front_speed(level, ratio, "total")) if scene.beta is None else 1.0 / (1.0 - level)
    far = max((abs(centre) + 4.0 * width for centre, _, width in scene.bumps), default=0.0)
    return float(f"{far + speed * scene.duration + 3.0 * scene.width:.4g}")
