"""A scene by name is a simulation of one run that records everything."""

from __future__ import annotations

from ..theory.front_law import LARGEST_RATIO, front_speed
from .schema import Configuration, Model
from .simulations import NamedScene, Profile, Simulation

# Samples of a map and of an animation.
TIMES, POSITIONS = 241, 801


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
    kept = ("boundary", "release", "scheme", "max_step", "resolved_blocks")
    lists = ("gamma", "damping_ratio", "beta", "dx")
    simulation = {key: given[key] for key in kept if key in given}
    simulation |= {key: [given[key]] for key in lists if key in given}
    simulation["profiles"] = [{key: given[key] for key in Profile.model_fields}]
    return Simulation.model_validate(
        simulation
        | {
            "duration": {"time": scene.duration},
            "record": ["fronts", "fields", "samples"],
            "samples": {"times": TIMES, "positions": POSITIONS, "extent": _reach(scene, model)},
        }
    )


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
