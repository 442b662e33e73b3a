"""A scene by name: one run of the configuration, with everything recorded."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..model.prestress import Prestress
from ..theory.front_law import STRONGEST_DAMPING, front_speed

# Keys of a scene that describe its pre-stress, and those that become a list of one value.
PROFILE = ("left", "right", "width", "peak", "steps", "bumps")
AXES = ("gamma", "damping_ratio", "beta", "dx")
PLAIN = ("boundary", "release", "scheme", "max_step", "resolved_blocks")
# Samples of a map and of an animation.
TIMES, POSITIONS = 241, 801


def scene_block(scene: Mapping, model: Mapping) -> dict:
    """A scene of the configuration as a simulation block of one run that records everything.

    Parameters
    ----------
    scene : an entry of ``scenes``
    model : the block ``model``, for what the scene leaves out
    """
    block = {key: scene[key] for key in PLAIN if key in scene}
    block |= {key: [scene[key]] for key in AXES if key in scene}
    return block | {
        "profiles": [{key: scene[key] for key in PROFILE if key in scene}],
        "duration": {"time": scene["duration"]},
        "record": ["fronts", "fields", "samples"],
        "samples": {"times": TIMES, "positions": POSITIONS, "extent": _reach(scene, model)},
    }


def _reach(scene: Mapping, model: Mapping) -> float:
    """Where the fronts may be at the end: farther than any, by theory where there is one."""
    levels = [scene["left"], scene["right"], *(level for _, level in scene.get("steps", []))]
    level = min(max(levels), 1.0 - 1e-6)
    ratio = scene.get("damping_ratio", model["damping_ratio"])
    speed = 1.0
    if level > 0.0:
        known = "beta" not in scene and ratio <= STRONGEST_DAMPING
        # 1/(1 - tau) is the speed of the rule "total" at beta/dx = 1.
        speed = float(front_speed(level, ratio, "total")) if known else 1.0 / (1.0 - level)
    far = max((abs(centre) + 4.0 * width for centre, _, width in scene.get("bumps", [])), default=0.0)
    return float(f"{far + speed * scene['duration'] + 3.0 * scene.get('width', 1.0):.4g}")


def check_scene(scene: Mapping, key: str) -> list[str]:
    """What is wrong with a scene that its schema and the check of its block do not see."""
    if "beta" in scene and "damping_ratio" in scene:
        return [f"{key}.beta: given with damping_ratio; allowed: one or the other"]
    try:
        profile = Prestress(**{name: scene[name] for name in PROFILE if name in scene})
    except ValueError as error:
        return [f"{key}.{error}"]
    places = np.array([0.0, *(centre for centre, *_ in profile.bumps)])
    near = places[:, None] + np.linspace(-3.0, 3.0, 601) * profile.width
    largest = float(np.max(profile(np.concatenate([near.ravel(), places]))))
    if not largest >= 1.0:
        return [
            f"{key}.peak: {profile.peak}, and the pre-stress is at most {largest:.4g}; allowed: a pre-stress that"
            " reaches 1 somewhere, or nothing moves"
        ]
    return []
