"""Resolution of simulations.

A resolved simulation is a dictionary with everything that the results of a simulation depend on:
its own keys, the defaults of the model, and the accuracy of the preset. Rules pass it to their
jobs.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from slippulse.model.cost import bound_front_reach
from slippulse.model.friction import COULOMB, LinearRate
from slippulse.model.scene import EXTRA_TERMS
from slippulse.simulation.accuracy import LARGEST_STEP, TAYLOR_ORDER
from slippulse.theory.front_speeds import LARGEST_RATIO, front_speed

from .profiles import ExpandedProfiles, ends_of_ensembles, prestress_of, without_files
from .schema import Configuration, Model, NamedScene, Profile, Simulation

# Numbers of times and positions at which a scene is sampled, for its figure and its animation.
SAMPLED_TIMES, SAMPLED_POSITIONS = 241, 801
# Number of values of the pre-stress at which the exact front speed is computed for a table.
FRONT_SPEED_LEVELS = 65
# Keys that have one value in a scene and a list of values in a simulation.
LISTED = ("gamma", "damping_ratio", "beta", "dx", "friction", "rate_strengthening", *EXTRA_TERMS)
# Keys of a preset on which the results of a simulation depend.
NUMERICAL_KEYS = ("dx", "max_step", "order", "promise")
# Lists of a simulation that may be replaced by their smallest and largest value when simulations
# are checked: if any value of such a list is refused or expensive, one of these two is, too.
ORDERED = ("left", "right", "width", "gamma", "damping_ratio", "beta", "dx", "levels", *EXTRA_TERMS)


def accuracy_of(config: Configuration) -> dict[str, Any]:
    """Return the numerical parameters of the preset, changed if the user requires an accuracy.

    The required accuracy (key `accuracy`) is then in ``promise``, and limits the block spacing of
    each run.
    """
    preset = config.presets[config.preset].plain()
    if config.accuracy is None:
        return preset
    # With this step and order, nearly all of the error is due to the spacing.
    return preset | {"max_step": LARGEST_STEP, "order": TAYLOR_ORDER, "promise": config.accuracy}


def resolve(simulation: Simulation | Mapping, model: Model | Mapping, accuracy: Mapping) -> dict:
    """Return a simulation as a dictionary with everything that its results depend on.

    Keys of the simulation take precedence over the defaults of the model. The number of chunks is
    left out, since results do not depend on it. ``accuracy`` has the numerical parameters from
    `accuracy_of`.
    """
    defaults = Model.model_validate(model).plain()
    # The model has one value of these keys, and a simulation a list.
    defaults |= {key: [defaults[key]] for key in LISTED if key in defaults}
    given = Simulation.model_validate(simulation).plain()
    del given["chunks"]
    # Turn this deprecated key, a list of numbers, into laws of friction.
    if "rate_strengthening" in given:
        given["friction"] = [*map(_linear_law, given.pop("rate_strengthening"))]
    if "profiles" in given:
        given["profiles"] = without_files(given["profiles"])
    numerical = {key: accuracy[key] for key in NUMERICAL_KEYS if key in accuracy}
    # The accuracy that the user requires (promise) can only be kept if the spacing is free. A
    # spacing may be given as dx or as spacing.fixed. A beta other than 0 also fixes it, because
    # another spacing would change beta/dx.
    has_own_spacing = "dx" in given or "fixed" in given["spacing"] or any(given.get("beta", []))
    if "promise" in numerical and has_own_spacing:
        # NaN means that no accuracy is promised.
        numerical["promise"] = math.nan
    # The factor coarser is 1 except in a grid study, whose lattices are coarser by this factor.
    return {**defaults, **given, "accuracy": numerical, "coarser": 1.0}


def _linear_law(alpha: float) -> Mapping:
    """Return the law of friction for an entry of the deprecated key `rate_strengthening`."""
    law = LinearRate(alpha) if alpha else COULOMB
    return law.mapping()


def all_simulations(config: Configuration) -> dict[str, Simulation]:
    """Return all simulations by name. Scenes are simulations of one run."""
    preset_dx = accuracy_of(config)["dx"]
    scenes = {
        name: scene_simulation(scene, config.model, preset_dx)
        for name, scene in config.scenes.items()
    }
    return {**config.simulations, **scenes}


def scene_simulation(scene: NamedScene, model: Model, dx: float) -> Simulation:
    """Return a scene as a simulation of one run.

    The simulation records all kinds of data. Its samples cover all positions that the fronts may
    reach.

    dx : block spacing of the preset, which is used unless the scene sets its own
    """
    # The friction ratio follows from the layer, which the conversion to model units removes.
    friction_ratio = None
    if scene.layer is not None:
        friction_ratio = scene.layer.layer(scene.boundary).friction_ratio
    scene = scene.in_model_units()
    given = scene.plain()
    del given["title"]
    # Turn the single values of the scene into the profiles and lists of a simulation, in which the
    # keys of LISTED have lists.
    profile = {key: given.pop(key) for key in Profile.model_fields if key in given}
    extent = _extent(scene, _largest_damping_ratio(scene, model, dx), profile)
    given |= {key: [given[key]] for key in LISTED if key in given}
    given["profiles"] = [profile]
    given["duration"] = {"time": scene.duration}
    given["samples"] = {
        "times": SAMPLED_TIMES,
        "positions": SAMPLED_POSITIONS,
        "extent": float(f"{extent:.4g}"),
    }
    given["record"] = ["fronts", "fields", "samples"]
    if friction_ratio is not None:
        given["friction_ratio"] = friction_ratio
    return Simulation.model_validate(given)


def _largest_damping_ratio(scene: NamedScene, model: Model, dx: float) -> float:
    """Return an upper bound on the damping ratio beta/dx in a scene."""
    if scene.beta is not None:
        # With a fixed beta, this ratio depends on the spacing of the preset. It is below 1 in most
        # cases, and the bound is then 1, so that a scene has the same samples at all presets.
        return max(1.0, scene.beta / (scene.dx or dx))
    return model.damping_ratio if scene.damping_ratio is None else scene.damping_ratio


def _bounds_of_front_speeds(levels: np.ndarray, damping_ratio: float) -> np.ndarray:
    """Return an upper bound on the front speed at each value of the pre-stress.

    levels : values of the pre-stress
    """
    # The speed is infinite at the pre-stress 1.
    levels = np.minimum(levels, 1.0 - 1e-6)
    # At a pre-stress of 0 or less, a front is not faster than waves, whose speed is 1.
    is_fast, speeds = levels > 0.0, np.ones(levels.shape)
    if is_fast.any():
        # `front_speed` refuses damping ratios above 1e100, which no useful scene has. With the
        # release rule "total", fronts are at least as fast as with the other one.
        ratio = min(damping_ratio, LARGEST_RATIO)
        speeds[is_fast] = front_speed(levels[is_fast], ratio, release="total")
    return speeds


def _extent(scene: NamedScene, damping_ratio: float, profile: Mapping[str, Any]) -> float:
    """Return an upper bound on the distance from x = 0 that the fronts of a scene reach.

    The bound is the sum of the distance of the farthest bump, where slip may start, the distance
    that a front covers in the duration, and the width in which the Gaussian at x = 0 makes it
    faster.

    damping_ratio : largest damping ratio of the scene
    profile : the keys of the scene that describe its pre-stress
    """
    # Four widths away from its centre, a bump is negligible.
    farthest_bump = max((abs(x) + 4.0 * width for x, _, width in scene.bumps), default=0.0)
    if scene.left is not None and scene.right is not None:
        step_levels = [level for _, level in scene.steps]
        highest = max(scene.left, scene.right, *step_levels)
        (speed,) = _bounds_of_front_speeds(np.array([highest]), damping_ratio)
        reach = float(speed) * scene.duration
    else:
        # The pre-stress is a table, so that the front speed depends on the position.
        (expanded_profile,) = ExpandedProfiles([profile])
        table = prestress_of(expanded_profile)
        # Exact speeds at all points of a table would take seconds. The speed is a convex function
        # of the pre-stress, and so linear interpolation between a few values is an upper bound.
        table_levels = [tau for _, tau in table.points]
        highest = max([0.0, *table_levels])
        levels = np.linspace(0.0, highest, FRONT_SPEED_LEVELS)
        speeds = _bounds_of_front_speeds(levels, damping_ratio)
        # In a table, slip may start at any point within nucleation_reach.
        reach = bound_front_reach(
            table,
            start=table.nucleation_reach,
            duration=scene.duration,
            speeds_at=lambda tau: np.interp(tau, levels, speeds),
        )
    # Three widths away from x = 0, the Gaussian is negligible.
    width = scene.width or 0.0
    return farthest_bump + reach + 3.0 * width


def with_ends_of_lists(simulation: Mapping) -> dict[str, Any]:
    """Return a resolved simulation with only the smallest and largest number of each list.

    If any run is refused or expensive, one at these values is, too. Of an ensemble of rough
    profiles, the first and the last seed are kept. The job checks all seeds before it simulates.
    """
    # The number of a chunk would have no meaning for the shorter lists.
    ends = {key: value for key, value in simulation.items() if key != "chunk"}
    if "profiles" in ends:
        ends["profiles"] = ends_of_ensembles(ends["profiles"])
    if "beyond" in ends:
        # ``beyond`` has a list of levels, which the pre-stress has beyond a step.
        ends["beyond"] = with_ends_of_lists(ends["beyond"])
    for key in ORDERED:
        if isinstance(ends.get(key), list):
            ends[key] = sorted({min(ends[key]), max(ends[key])})
    return ends
