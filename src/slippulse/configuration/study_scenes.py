"""The dearest scenes of each part of the studies, about as it will run them: for the check of what they cost."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import lru_cache

from ..model.balance import prestress_balance_position
from ..model.prestress import Prestress
from ..model.scene import Scene
from ..model.stability import MARGIN, largest_step
from ..theory.barrier import barrier_depth_estimate
from ..theory.front_law import front_speed
from ..theory.pulse import steady_pulse

# Of a scene of `studies.extremes` that does not say otherwise, and about its T_trans.
LEVEL, GAMMA, RATIO, TRANSITION = 0.5, 0.65, 0.1, 6.0
# About the time to cover most of the way to where the pre-stress is balanced, over its length.
COVERED = 3.0


def study_scenes(studies: Mapping) -> dict[str, list[Scene]]:
    """Scenes by the key of the part that runs them.

    Parameters
    ----------
    studies : `studies` of the configuration

    Raises
    ------
    ValueError
        If a scene is refused, naming the key, the value and what is allowed.
    """
    parts = {f"studies.extremes.{name}": scenes for name, scenes in _extremes(studies["extremes"]).items()}
    rule = studies["accuracy_cost"]
    # One order for all, the dearest.
    parts["studies.accuracy_cost"] = _trade(rule, rule, "localised") * len(rule["orders"])
    parts["studies.accuracy_cost"] += _trade(rule, rule["textbook"], "fixed_step")
    rule, steps = rule["locking"], rule["locking"]["steps"]
    crack = _scene(rule["level"], rule["dx"], rule["duration"], 0.0, 0.0, steps["from"])
    parts["studies.accuracy_cost.locking"] = [crack] * steps["count"]
    rule = studies["barriers"]
    parts["studies.barriers"] = [
        _to_barrier(level, max(rule["barriers"]), min(rule["gamma"]), ratio, dx)
        for level in rule["levels"]
        for ratio in rule["damping_ratios"]
        for dx in (*rule["dx"], rule["passing"]["dx"])
    ]
    parts["studies.published_figure"] = _published_figure(studies["published_figure"])
    rule = studies["requirements"]
    (dx, *_), (duration, *_) = rule["dx"], rule["durations"]
    settings = [(dx, longer, rule["gamma"]) for longer in rule["durations"]]
    settings += [(finer, duration, rule["gamma"]) for finer in rule["dx"]]
    # Besides the pulses a crack, in which all slides.
    parts["studies.requirements"] = [
        _scene(rule["level"], *setting, rule["damping_ratio"]) for setting in [*settings, (dx, duration, 0.0)]
    ]
    return parts


def _trade(rule: Mapping, lattices: Mapping, scheme: str) -> list[Scene]:
    """A pulse and a crack on each lattice."""
    times, more = rule["stress_duration"], {"scheme": scheme, "order": 8}
    return [
        scene
        for dx in lattices["dx"]
        for step in lattices["steps"]
        for ratio in rule["damping_ratios"]
        for scene in (
            _scene(rule["level"], dx, rule["duration"], rule["gamma"], ratio, step, **more),
            _crack(rule["negative_level"], rule["stress_scale"] * dx, ratio, times, step=step, **more),
        )
    ]


def _extremes(rule: Mapping) -> dict[str, list[Scene]]:
    def pulses(part: Mapping, **more) -> list[Scene]:
        return [_scene(dx=part["dx"], duration=part["duration"], **more)]

    near, damping, spacing = rule["level_near_one"], rule["damping_ratio"], rule["dx"]
    two, rows = rule["two_nucleations"], rule["negative_level"]["level_dx_friction_ratio_damping"]
    return {
        "level_near_one": [_scene(level, near["dx"], near["duration"], ratio=0.0) for level in near["levels"]],
        "level_near_zero": [
            _scene(level, dx, duration) for level, dx, duration in rule["level_near_zero"]["level_dx_duration"]
        ],
        "gamma": [
            _scene(LEVEL, rule["gamma"]["dx"], 40.0 / math.sqrt(gamma), gamma, 0.0) for gamma in rule["gamma"]["large"]
        ],
        "damping_ratio": [
            _scene(
                damping["level"], damping["dx"], damping["duration"] / (1.0 + 0.05 * ratio * (release == "total")),
                ratio=ratio, release=release,
            )
            for release in ("total", "elastic")
            for ratio in damping[release]
        ],
        "dx": [
            *(_scene(LEVEL, dx, spacing["duration"]) for dx in spacing["pulse"]),
            *(_scene(LEVEL, dx, TRANSITION) for dx in spacing["transition"]),
        ],
        "width": pulses(rule["width"]),
        "negative_level": [_crack(level, dx, ratio, 1.5) for level, dx, _, ratio in rows],
        "long_run": [_scene(LEVEL, 1.0, rule["long_run"]["duration"], rule["long_run"]["gamma"])],
        "float32": [
            _scene(LEVEL, rule["float32"]["dx"], math.pi / math.sqrt(gamma), gamma, 0.0, 0.4, scheme="fixed_step")
            for gamma in rule["float32"]["gamma"]
        ],
        "peak": pulses(rule["peak"]),
        "two_nucleations": [_scene(LEVEL, two["dx"], 1.5 * two["distance"])],
        "barrier": pulses(rule["barrier"]),
    }  # fmt: skip


def _scene(
    level: float = LEVEL,
    dx: float = 1.0,
    duration: float = 1.0,
    gamma: float = GAMMA,
    ratio: float = RATIO,
    step: float = 0.5,
    profile: Prestress | None = None,
    **more,
) -> Scene:
    """A scene under the displacement boundary, or under the stress boundary when gamma is 0; its step is stable."""
    bound = largest_step(more.get("scheme", "localised"), more.get("order", 4), ratio, gamma * dx**2)
    return Scene(
        "displacement" if gamma > 0.0 else "stress", profile or Prestress(level, level), duration, dx, gamma,
        ratio * dx, max_step=min(step, MARGIN * bound), **more,
    )  # fmt: skip


def _crack(level: float, dx: float, ratio: float, times: float, **more) -> Scene:
    """A crack into a negative level on the left, for so many times the time to cover its way."""
    profile = Prestress(level, 0.0)
    return _scene(
        dx=dx, duration=times * COVERED * _way(profile), gamma=0.0, ratio=ratio, profile=profile, **more
    )


@lru_cache
def _way(profile: Prestress) -> float:
    return abs(prestress_balance_position(profile))


def _to_barrier(level: float, barrier: float, gamma: float, ratio: float, dx: float) -> Scene:
    """A pulse that goes on until it has forgotten how it began, and then into a barrier."""
    speed = float(front_speed(level, ratio))
    width = steady_pulse(level, gamma, 0.0, speed).width
    depth = barrier_depth_estimate(level, barrier, gamma)
    return _scene(level, dx, 5.0 + width / (speed - 1.0) + width + 4.0 * depth, gamma, ratio)


def _published_figure(rule: Mapping) -> list[Scene]:
    left, right, notebook = rule["near"], rule["stress"], rule["notebook"]
    settings = [
        (ratio, rule["beta"] / ratio, release)
        for release, ratios in rule["damping_ratios"].items()
        for ratio in ratios
    ]
    settings.append((notebook["damping_ratio"], notebook["dx"], notebook["release"]))
    scenes = [
        _scene(left["tau0"], dx, rule["end"], left["gamma"], ratio, 1.0, release=release, order=8)
        for ratio, dx, release in settings
    ]
    profile = Prestress(right["left"], 0.0, right["width"])
    return scenes + [
        _scene(
            dx=rule["beta"] / ratio, duration=right["duration"], gamma=0.0, ratio=ratio, step=1.0, profile=profile,
            order=8,
        )
        for ratio in right["damping_ratios"]
    ]  # fmt: skip
