"""The configuration: validated, then expanded into scenes. Plain builtins in, scenes out."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..data.chunks import runs_of
from ..model.balance import prestress_balance_position
from ..model.checks import ConfigError, nearest, shown
from ..model.prestress import Prestress
from ..model.samples import Samples
from ..model.scene import Scene
from ..model.stability import MARGIN, largest_step
from .accuracy import ORDER, STEP, settings_for
from .refusals import (
    check_chunks,
    check_cost,
    check_resolved,
    corners,
    counted,
    misspelt_parent,
    not_finite,
    remedy,
    some,
    unknown_names,
)
from .scenes import check_scene, scene_block

if TYPE_CHECKING:
    import jsonschema


def accuracy_of(config: Mapping) -> dict:
    """The preset that a configuration names; with `accuracy` another step and order, and the promise."""
    preset = dict(config["presets"][config["preset"]])
    promise = config.get("accuracy")
    if promise is None:
        return preset
    return preset | {"max_step": STEP, "order": ORDER, "promise": float(promise)}


def promise_of(block: Mapping) -> float | None:
    """The largest relative uncertainty that a resolved block promises: None unasked, NaN with a spacing of its own."""
    promise = block["accuracy"].get("promise")
    own = "dx" in block or "fixed" in block.get("spacing", {}) or any(block.get("beta", []))
    return math.nan if promise is not None and own else promise


def resolve(simulation: Mapping, model: Mapping, accuracy: Mapping, coarser: float = 1.0) -> dict:
    """One simulation block with everything that its data depend on, as builtins: what a rule passes as params.

    ``coarser`` multiplies the spacing, at fixed beta/dx and step/dx; a fixed spacing stays, and its step is multiplied.
    Into how many chunks a sweep is dealt is not in it: the runs are the same.
    """
    block = {key: value for key, value in simulation.items() if key != "chunks"}
    for key, value in model.items():
        block.setdefault(key, [value] if key == "damping_ratio" else value)
    return block | {
        "accuracy": {key: accuracy[key] for key in ("dx", "max_step", "order", "promise") if key in accuracy},
        "coarser": coarser,
    }


def expand(block: Mapping) -> tuple[list[Scene], list[Samples | None]]:
    """Scenes of a resolved simulation block, in the order of its lists, and what each records.

    Parameters
    ----------
    block : as `resolve` returns it; with ``chunk``, its number and how many there are, only the runs of that chunk

    Raises
    ------
    ValueError
        If a scene is refused, naming the key, the value and what is allowed.
    """
    scenes, samples = [], []
    promise = promise_of(block)
    if promise is not None:
        _check_scheme("scheme", block["scheme"])
    damping = [("beta", value) for value in block.get("beta", [])] or [
        ("damping_ratio", value) for value in block["damping_ratio"]
    ]
    releases = [block["release"]] if isinstance(block["release"], str) else block["release"]
    axes = [releases, *_shapes(block), block.get("gamma", [0.0]), block.get("dx", [None]), damping]
    runs = math.prod(len(axis) for axis in axes)
    profile_of = cache(partial(_profile, block))
    for run in runs_of(*block["chunk"], runs) if "chunk" in block else range(runs):
        release, *shape, gamma, spacing, (kind, value) = _entries(axes, run)
        profile = profile_of(*shape)
        if promise is None or math.isnan(promise):
            dx = _spacing(block, profile.width, gamma, spacing)
        else:
            dx = _promised_spacing(block, promise, profile, gamma, value, release)
        duration = _duration(block["duration"], profile, gamma)
        beta = value if kind == "beta" else value * dx
        ratio = beta / dx
        scene = Scene(
            boundary=block["boundary"],
            prestress=profile,
            duration=duration,
            dx=dx,
            gamma=gamma,
            beta=beta,
            release=release,
            scheme=block["scheme"],
            max_step=_step(block, gamma * dx**2, ratio),
            order=block["accuracy"]["order"],
            friction_ratio=block["friction_ratio"],
            resolved_blocks=block["resolved_blocks"],
        )
        scenes.append(scene)
        samples.append(_samples(block.get("samples"), scene))
    return scenes, samples


def _entries(axes: Sequence[Sequence], run: int) -> list:
    """One entry of each list: those of a run of their product, without the runs before it."""
    entries = []
    for axis in reversed(axes):
        run, place = divmod(run, len(axis))
        entries.append(axis[place])
    return entries[::-1]


def _shapes(block: Mapping) -> list[Sequence]:
    """The lists whose product the profiles of a block are."""
    if "profiles" in block:
        return [range(len(block["profiles"]))]
    rights = [None] if block["right"] == "same" else block["right"]
    return [block["left"], rights, block.get("width", [1.0]), _steps_beyond(block.get("beyond"))]


def _profile(block: Mapping, *shape) -> Prestress:
    if "profiles" in block:
        return Prestress(**{"width": 1.0, **block["profiles"][shape[0]]})
    left, right, width, steps = shape
    return Prestress(left=left, right=left if right is None else right, width=width, steps=steps)


def _steps_beyond(rule: Mapping | None) -> list[tuple]:
    """One step a level, at the position from which the level holds."""
    return [((rule["position"], level),) for level in rule["levels"]] if rule else [()]


def _spacing(block: Mapping, width: float, gamma: float, spacing: float | None) -> float:
    if spacing is not None:
        return float(f"{block['coarser'] * spacing:.12g}")
    rule = block.get("spacing", {})
    if "fixed" in rule:
        return float(rule["fixed"])
    scale = block["coarser"] * rule.get("scale", 1.0) * width ** rule.get("width_power", 0.0)
    if "gamma_power" in rule:
        scale *= gamma ** rule["gamma_power"]
    # Twelve digits, so that a spacing of 0.02 is 0.02 in the data and on a label.
    return float(f"{block['accuracy']['dx'] * scale:.12g}")


def _check_scheme(key: str, scheme: str) -> None:
    """The error of the textbook scheme's step is not seen by a grid study, and large."""
    if scheme != "localised":
        raise ConfigError(f"{key}: {scheme!r}; allowed: 'localised' where accuracy is given")


def _promised_spacing(
    block: Mapping, promise: float, profile: Prestress, gamma: float, ratio: float, release: str
) -> float:
    """What the scene's own lengths ask for, whatever its rule for the preset's spacing."""
    settings = settings_for(
        promise,
        boundary=block["boundary"],
        prestress=profile,
        gamma=gamma,
        damping_ratio=ratio,
        release=release,
        fields="fields" in block["record"],
    )
    return float(f"{block['coarser'] * settings['dx']:.12g}")


def _step(block: Mapping, gamma_dx2: float, ratio: float) -> float:
    """The block's own step, or the preset's, or the safe share of the bound where strong damping allows less."""
    bound = largest_step(block["scheme"], block["accuracy"]["order"], ratio, gamma_dx2)
    step = block.get("max_step", min(block["accuracy"]["max_step"], MARGIN * bound))
    if "promise" in block["accuracy"]:
        step = min(step, block["accuracy"]["max_step"])
    return float(step * block["coarser"] if "fixed" in block.get("spacing", {}) else step)


def _duration(rule: Mapping, profile: Prestress, gamma: float) -> float:
    ((unit, value),) = rule.items()
    if unit == "half_periods":
        return float(value * math.pi / math.sqrt(gamma))
    if unit == "balance_distances":
        return float(value * abs(prestress_balance_position(profile)))
    return float(value)


def _samples(rule: Mapping | None, scene: Scene) -> Samples | None:
    if rule is None:
        return None
    positions = (
        np.linspace(-rule["extent"], rule["extent"], rule["positions"]) if rule["positions"] > 1 else [0.0]
    )
    return Samples(times=np.linspace(0.0, scene.duration, rule["times"]), positions=positions)


def validate(
    config: Mapping, schema_path: str | Path, shipped: Mapping | None = None, every_run: bool = True
) -> None:
    """Refuse a configuration that the schema does not allow, or whose scenes are refused or cost too much.

    Parameters
    ----------
    config : the configuration, overlays included
    schema_path : its JSON Schema
    shipped : the configuration without overlays; names of claims that it does not know are then refused
    every_run : whether the scenes of all blocks are checked too, which takes time where they are many

    Raises
    ------
    ConfigError
        One line a problem: the key, the value, what is allowed.
    """
    # Simulations expand blocks too, and need neither.
    import jsonschema
    import yaml

    from .overlay import LOADER

    schema = yaml.load(Path(schema_path).read_text(encoding="utf-8"), Loader=LOADER)
    validator = jsonschema.Draft202012Validator(schema)
    config = _builtins(config)
    problems = not_finite(config)
    problems += [line for error in validator.iter_errors(config) for line in _describe(error, shipped)]
    problems = problems or unknown_names(config, shipped)
    if problems:
        raise ConfigError(some(sorted(set(problems))))
    if not every_run:
        return
    accuracy = accuracy_of(config)
    if "promise" in accuracy:
        _check_scheme("model.scheme", config["model"]["scheme"])
    for name, simulation in config["simulations"].items():
        problems += _check_block(f"simulations.{name}", simulation, config, accuracy)
    for name, scene in config.get("scenes", {}).items():
        problems += check_scene(scene, f"scenes.{name}") or _check_block(
            f"scenes.{name}", scene_block(scene, config["model"]), config, accuracy
        )
    if problems:
        raise ConfigError(some(problems))


@np.errstate(all="ignore")
def _check_block(key: str, simulation: Mapping, config: Mapping, accuracy: Mapping) -> list[str]:
    """What is wrong with one block of scenes, on its own lattice and on those of its grid study."""
    companion = ""
    try:
        _check_simulation(simulation)
        large = config.get("allow_large", False)
        chunks = simulation.get("chunks", 1)
        for coarser in (1.0, *accuracy["coarser"]):
            block = resolve(simulation, config["model"], accuracy, coarser)
            if coarser > 1.0:
                companion = f" (on the lattice {coarser:g} times coarser of the grid study, presets.{config['preset']})"
            check_chunks(chunks, block)
            scenes, samples = expand(corners(block) if large else counted(block, chunks))
            if coarser == 1.0:
                check_resolved(scenes)
                # With `accuracy` a block is refused when it is asked for: few want the whole paper that fine.
                if not large and "promise" not in accuracy:
                    check_cost(scenes, samples, chunks)
    except ArithmeticError:
        return [f"{key}: a number too large or too small to compute with; allowed: numbers near 1"]
    except ValueError as error:
        return [f"{key}.{error}{companion}"]
    return []


def _check_simulation(simulation: Mapping) -> None:
    """What a schema cannot say: keys that exclude or need each other."""
    displacement = simulation["boundary"] == "displacement"
    if displacement and "gamma" not in simulation:
        raise ValueError("gamma: missing; allowed: a list of numbers > 0 under boundary 'displacement'")
    if not displacement and "gamma" in simulation:
        raise ValueError(
            f"gamma: {simulation['gamma']!r}; allowed: left out under boundary 'stress', which has no leaf springs"
        )
    if "profiles" in simulation and any(key in simulation for key in ("left", "right", "width", "beyond")):
        raise ValueError("profiles: given with left, right, width or beyond; allowed: one or the other")
    if "profiles" not in simulation and not ("left" in simulation and "right" in simulation):
        raise ValueError("left, right: missing; allowed: lists of levels (right may be 'same'), or profiles")
    if "dx" in simulation and "spacing" in simulation:
        raise ValueError("dx: given with spacing; allowed: one or the other")
    if "beta" in simulation and "damping_ratio" in simulation:
        raise ValueError("beta: given with damping_ratio; allowed: one or the other")
    if "half_periods" in simulation["duration"] and not displacement:
        raise ValueError("duration.half_periods: given; allowed: only under boundary 'displacement'")
    if "gamma_power" in simulation.get("spacing", {}) and not displacement:
        raise ValueError("spacing.gamma_power: given; allowed: only under boundary 'displacement'")
    if "samples" in simulation.get("record", []) and "samples" not in simulation:
        raise ValueError("samples: missing; allowed: times, positions and extent when record has 'samples'")


def _describe(error: jsonschema.ValidationError, shipped: Mapping | None) -> list[str]:
    path = [str(part) for part in error.absolute_path]
    key = ".".join(part if re.fullmatch(r"\w{1,80}", part, re.ASCII) else shown(part) for part in path)
    if error.validator == "additionalProperties":
        known = list(error.schema.get("properties", {}))
        lines = []
        for name in error.instance:
            patterns = error.schema.get("patternProperties", {})
            if name in known or any(re.search(pattern, str(name)) for pattern in patterns):
                continue
            word = name if re.fullmatch(r"\w{1,60}", name, re.ASCII) else shown(name)
            full = f"{key}.{word}" if key else word
            lines.append(f"{full}: unknown key{nearest(name, known)}; allowed: {', '.join(known)}")
        return lines
    if error.validator == "required":
        missing = [name for name in error.validator_value if name not in error.instance]
        hint = misspelt_parent(path, shipped)
        return [f"{key}.{name}".lstrip(".") + f": missing; it is required{hint}" for name in missing]
    allowed = error.schema.get("description") or _allowed(error)
    return [
        f"{key or 'the configuration'}: {shown(error.instance)}; allowed: {allowed}{remedy(error.instance)}"
    ]


def _allowed(error: jsonschema.ValidationError) -> str:
    if error.validator == "enum":
        return ", ".join(map(str, error.validator_value))
    return error.schema.get("title") or {"object": "a mapping"}.get(str(error.validator_value), error.message)


def _builtins(value):
    if isinstance(value, Mapping):
        return {str(key): _builtins(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_builtins(entry) for entry in value]
    return value
