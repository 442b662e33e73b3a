"""Refuses a configuration before anything runs: keys, types, names, then every scene of every simulation."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from functools import lru_cache

import numpy as np

from ..model.checks import ConfigError
from ..model.scene import Scene
from .expand import accuracy_of, check_scheme, expand, resolve
from .limits import (
    check_affordable,
    check_chunks,
    check_cost,
    check_resolved,
    check_run_count,
    first_and_last,
)
from .refusals import format_problems, name_problems, removal_problems, schema_problems
from .scenes import scene_problems, scene_simulation
from .study_scenes import study_scenes


@np.errstate(all="ignore")
def validate(
    config: Mapping,
    shipped: Mapping | None = None,
    every_run: bool = True,
    removed: Sequence[tuple[str, ...]] = (),
) -> None:
    """Refuse a configuration that its definition does not allow, or whose scenes are refused or cost too much.

    Parameters
    ----------
    config : the configuration, overlays included, builtins
    shipped : the configuration without overlays; names of claims that it does not know are then refused
    every_run : whether the scenes of all simulations are checked too, which takes time where they are many
    removed : places of the nulls that `read_config` took out

    Raises
    ------
    ConfigError
        One line a problem: the key, the value, what is allowed.
    """
    problems = removal_problems(removed, shipped) if shipped else []
    problems += schema_problems(config, shipped, removed)
    problems = problems or name_problems(config, shipped)
    if problems:
        raise ConfigError(format_problems(sorted(set(problems))))
    if not every_run:
        return
    accuracy = accuracy_of(config)
    if "promise" in accuracy:
        check_scheme("model.scheme", config["model"]["scheme"])
    for name, simulation in config["simulations"].items():
        problems += _simulation_problems(f"simulations.{name}", simulation, config, accuracy)
    for name, scene in config.get("scenes", {}).items():
        problems += scene_problems(scene, f"scenes.{name}") or _simulation_problems(
            f"scenes.{name}", scene_simulation(scene, config["model"]), config, accuracy
        )
    if not config.get("allow_large", False):
        problems += _study_problems(json.dumps(config["studies"]))
    if problems:
        raise ConfigError(format_problems(problems))


@lru_cache(maxsize=4)
def _study_problems(studies: str) -> tuple[str, ...]:
    """Which studies cost too much; they are given as JSON."""
    try:
        parts = study_scenes(json.loads(studies))
        check_affordable({key: (scenes, [None] * len(scenes)) for key, scenes in parts.items()})
    except ValueError as error:
        return tuple(str(error).splitlines())
    return ()


def _simulation_problems(key: str, simulation: Mapping, config: Mapping, accuracy: Mapping) -> list[str]:
    """What is wrong with one simulation, on its own lattice and on those of its grid study."""
    lattice = ""
    try:
        _check_together(simulation)
        large = config.get("allow_large", False)
        chunks = simulation.get("chunks", 1)
        for coarser in (1.0, *accuracy["coarser"]):
            resolved = resolve(simulation, config["model"], accuracy, coarser)
            if coarser > 1.0:
                lattice = f" (on the lattice {coarser:g} times coarser of the grid study, presets.{config['preset']})"
            check_chunks(chunks, resolved)
            if not large:
                check_run_count(resolved, chunks)
            scenes, samples = expand(first_and_last(resolved) if large else resolved)
            if coarser == 1.0:
                _check_nucleation(scenes)
                check_resolved(scenes)
                # With `accuracy` a simulation is refused when it is asked for: few want the whole paper that fine.
                if not large and "promise" not in accuracy:
                    check_cost(scenes, samples, chunks)
    except ArithmeticError:
        return [f"{key}: a number too large or too small to compute with; allowed: numbers near 1"]
    except ValueError as error:
        return [f"{key}.{error}{lattice}"]
    return []


def _check_nucleation(scenes: Sequence[Scene]) -> None:
    """Refuse a profile that reaches the threshold at no block, so that nothing ever moves."""
    for profile, dx in dict.fromkeys((scene.prestress, scene.dx) for scene in scenes):
        if (profile.bumps or profile.peak < 1.0) and not (largest := profile.largest(dx)) >= 1.0:
            raise ValueError(
                f"profiles.peak: {profile.peak:g}, and the pre-stress of a block is at most {largest:.9g}"
                f" (dx = {dx:g}); allowed: a pre-stress that reaches 1 somewhere, or nothing moves"
            )


def _check_together(simulation: Mapping) -> None:
    """What types and ranges cannot say: keys that exclude or need each other."""
    displacement = simulation["boundary"] == "displacement"
    if displacement and "gamma" not in simulation:
        raise ValueError("gamma: missing; allowed: a list of numbers > 0 under boundary 'displacement'")
    if not displacement and "gamma" in simulation:
        raise ValueError(
            f"gamma: {simulation['gamma']!r}; allowed: left out under boundary 'stress', which has no leaf springs"
            " (gamma: null removes it)"
        )
    if "profiles" in simulation and any(key in simulation for key in ("left", "right", "width", "beyond")):
        raise ValueError(
            "profiles: given with left, right, width or beyond; allowed: one or the other (null removes a key)"
        )
    if "profiles" not in simulation and not ("left" in simulation and "right" in simulation):
        raise ValueError("left, right: missing; allowed: lists of levels (right may be 'same'), or profiles")
    for one, other in (("dx", "spacing"), ("beta", "damping_ratio")):
        if one in simulation and other in simulation:
            raise ValueError(
                f"{one}: given with {other}; allowed: one or the other ({other}: null removes it)"
            )
    rule = simulation.get("spacing", {})
    if "fixed" in rule and len(rule) > 1:
        raise ValueError(f"spacing.fixed: given with {', '.join({*rule} - {'fixed'})}; allowed: alone")
    for key, given in (
        ("duration.half_periods", "half_periods" in simulation["duration"]),
        ("spacing.gamma_power", "gamma_power" in rule),
    ):
        if given and not displacement:
            raise ValueError(f"{key}: given; allowed: only under boundary 'displacement'")
    if "samples" in simulation["record"] and "samples" not in simulation:
        raise ValueError("samples: missing; allowed: times, positions and extent when record has 'samples'")
    if "samples" in simulation and "samples" not in simulation["record"]:
        raise ValueError(
            "samples: given, but not recorded; allowed: with samples in record (samples: null removes it)"
        )
