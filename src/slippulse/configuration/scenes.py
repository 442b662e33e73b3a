"""A scene by name is a simulation of one run that records everything."""

from __future__ import annotations

from collections.abc import Mapping

from ..model.prestress import Prestress
from ..theory.front_law import LARGEST_RATIO, front_speed

# Keys of a scene that describe its pre-stress, those that become a list of one value, and those that stay.
PROFILE_KEYS = ("left", "right", "width", "peak", "steps", "bumps")
LIST_KEYS = ("gamma", "damping_ratio", "beta", "dx")
PLAIN_KEYS = ("boundary", "release", "scheme", "max_step", "resolved_blocks")
# Samples of a map and of an animation.
TIMES, POSITIONS = 241, 801


def all_simulations(config: Mapping) -> dict[str, dict]:
    """Simulations by name, the scenes of a checked configuration among them."""
    scenes = {
        name: scene_simulation(scene, config["model"]) for name, scene in config.get("scenes", {}).items()
    }
    return {**config["simulations"], **scenes}


def scene_simulation(scene: Mapping, model: Mapping) -> dict:
    """A scene as a simulation of one run that records everything.

    Parameters
    ----------
    scene : an entry of ``scenes``
    model : the entry ``model`` of the configuration, for what the scene leaves out
    """
    simulation = {key: scene[key] for key in PLAIN_KEYS if key in scene}
    simulation |= {key: [scene[key]] for key in LIST_KEYS if key in scene}
    return simulation | {
        "profiles": [{key: scene[key] for key in PROFILE_KEYS if key in scene}],
        "duration": {"time": scene["duration"]},
        "record": ["fronts", "fields", "samples"],
        "samples": {"times": TIMES, "positions": POSITIONS, "extent": _reach(scene, model)},
    }


def _reach(scene: Mapping, model: Mapping) -> float:
    """Where the fronts may be at the end: farther than any, by theory where there is one."""
    levels = [scene["left"], scene["right"], *(level for _, level in scene.get("steps", []))]
    level = min(max(levels), 1.0 - 1e-6)
    ratio = min(scene.get("damping_ratio", model["damping_ratio"]), LARGEST_RATIO)
    speed = 1.0
    if level > 0.0:
        known = "beta" not in scene
        # 1/(1 - tau) is the speed of the rule "total" at beta/dx = 1.
        speed = float(front_speed(level, ratio, "total")) if known else 1.0 / (1.0 - level)
    far = max((abs(centre) + 4.0 * width for centre, _, width in scene.get("bumps", [])), default=0.0)
    width = scene.get("width", Prestress.width)
    return float(f"{far + speed * scene['duration'] + 3.0 * width:.4g}")


def scene_problems(scene: Mapping, key: str) -> list[str]:
    """What is wrong with a scene in words of its own keys, which the check of its simulation does not have."""
    if "beta" in scene and "damping_ratio" in scene:
        return [f"{key}.beta: given with damping_ratio; allowed: one or the other"]
    try:
        profile = Prestress(**{name: scene[name] for name in PROFILE_KEYS if name in scene})
    except ValueError as error:
        return [f"{key}.{error}"]
    if not profile.largest() >= 1.0:
        return [
            f"{key}.peak: {profile.peak}, and the pre-stress is at most {profile.largest():.4g}; allowed: a pre-stress"
            " that reaches 1 somewhere, or nothing moves"
        ]
    return []
