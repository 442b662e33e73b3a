"""Resolved simulations, expanded into scenes. Plain builtins in, scenes out; every job imports this, and no more."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cache, partial

import numpy as np

from ..data.chunks import runs_of
from ..model.balance import prestress_balance_position
from ..model.checks import ConfigError
from ..model.prestress import Prestress
from ..model.samples import Samples
from ..model.scene import Scene
from ..model.stability import MARGIN, largest_step
from .accuracy import ORDER, STEP, settings_for


def accuracy_of(config: Mapping) -> dict:
    """The preset that a configuration names; with `accuracy` another step and order, and the promise."""
    preset = dict(config["presets"][config["preset"]])
    promise = config.get("accuracy")
    if promise is None:
        return preset
    return preset | {"max_step": STEP, "order": ORDER, "promise": float(promise)}


def promise_of(simulation: Mapping) -> float | None:
    """The relative uncertainty that a resolved simulation promises: None unasked, NaN with a spacing of its own."""
    promise = simulation["accuracy"].get("promise")
    own = "dx" in simulation or "fixed" in simulation.get("spacing", {}) or any(simulation.get("beta", []))
    return math.nan if promise is not None and own else promise


def resolve(simulation: Mapping, model: Mapping, accuracy: Mapping, coarser: float = 1.0) -> dict:
    """A simulation with everything that its data depend on, as builtins: what a rule passes as params.

    Parameters
    ----------
    simulation, model : entries of the configuration; the number of chunks is left out, since the runs are the same
    accuracy : as `accuracy_of` returns it
    coarser : multiplies the spacing, at fixed beta/dx and step/dx; a fixed spacing stays, and its step is multiplied
    """
    resolved = {key: value for key, value in simulation.items() if key != "chunks"}
    for key, value in model.items():
        resolved.setdefault(key, [value] if key == "damping_ratio" else value)
    return resolved | {
        "accuracy": {key: accuracy[key] for key in ("dx", "max_step", "order", "promise") if key in accuracy},
        "coarser": coarser,
    }


def expand(simulation: Mapping) -> tuple[list[Scene], list[Samples | None]]:
    """Scenes of a resolved simulation, in the order of its lists, and what each records.

    Parameters
    ----------
    simulation : as `resolve` returns it; with ``chunk``, its number and how many there are, only the runs of that chunk

    Raises
    ------
    ValueError
        If a scene is refused, naming the key, the value and what is allowed.
    """
    scenes, samples = [], []
    promise = promise_of(simulation)
    if promise is not None:
        check_scheme("scheme", simulation["scheme"])
    damping = [("beta", value) for value in simulation.get("beta", [])] or [
        ("damping_ratio", value) for value in simulation["damping_ratio"]
    ]
    releases = [simulation["release"]] if isinstance(simulation["release"], str) else simulation["release"]
    axes = [
        releases,
        *_shapes(simulation),
        simulation.get("gamma", [0.0]),
        simulation.get("dx", [None]),
        damping,
    ]
    runs = math.prod(len(axis) for axis in axes)
    profile_of = cache(partial(_profile, simulation))
    for run in runs_of(*simulation["chunk"], runs) if "chunk" in simulation else range(runs):
        release, *shape, gamma, spacing, (kind, value) = _entries(axes, run)
        profile = profile_of(*shape)
        if promise is None or math.isnan(promise):
            dx = _spacing(simulation, profile.width, gamma, spacing)
        else:
            dx = _promised_spacing(simulation, promise, profile, gamma, value, release)
        duration = _duration(simulation["duration"], profile, gamma)
        beta = value if kind == "beta" else value * dx
        ratio = beta / dx
        scene = Scene(
            boundary=simulation["boundary"],
            prestress=profile,
            duration=duration,
            dx=dx,
            gamma=gamma,
            beta=beta,
            release=release,
            scheme=simulation["scheme"],
            max_step=_step(simulation, gamma * dx**2, ratio),
            order=simulation["accuracy"]["order"],
            friction_ratio=simulation["friction_ratio"],
            resolved_blocks=simulation["resolved_blocks"],
        )
        scenes.append(scene)
        samples.append(_samples(simulation.get("samples"), scene))
    return scenes, samples


def _entries(axes: Sequence[Sequence], run: int) -> list:
    """One entry of each list: those of a run of their product, without the runs before it."""
    entries = []
    for axis in reversed(axes):
        run, place = divmod(run, len(axis))
        entries.append(axis[place])
    return entries[::-1]


def _shapes(simulation: Mapping) -> list[Sequence]:
    """The lists whose product its profiles are."""
    if "profiles" in simulation:
        return [range(len(simulation["profiles"]))]
    rights = [None] if simulation["right"] == "same" else simulation["right"]
    widths = simulation.get("width", [Prestress.width])
    return [simulation["left"], rights, widths, _steps_beyond(simulation.get("beyond"))]


def _profile(simulation: Mapping, *shape) -> Prestress:
    if "profiles" in simulation:
        return Prestress(**simulation["profiles"][shape[0]])
    left, right, width, steps = shape
    return Prestress(left=left, right=left if right is None else right, width=width, steps=steps)


def _steps_beyond(rule: Mapping | None) -> list[tuple]:
    """One step a level, at the position from which the level holds."""
    return [((rule["position"], level),) for level in rule["levels"]] if rule else [()]


def _spacing(simulation: Mapping, width: float, gamma: float, spacing: float | None) -> float:
    if spacing is not None:
        return float(f"{simulation['coarser'] * spacing:.12g}")
    rule = simulation.get("spacing", {})
    if "fixed" in rule:
        return float(rule["fixed"])
    scale = simulation["coarser"] * rule.get("scale", 1.0) * width ** rule.get("width_power", 0.0)
    if "gamma_power" in rule:
        scale *= gamma ** rule["gamma_power"]
    # Twelve digits, so that a spacing of 0.02 is 0.02 in the data and on a label.
    return float(f"{simulation['accuracy']['dx'] * scale:.12g}")


def check_scheme(key: str, scheme: str) -> None:
    """Refuse to promise an accuracy of another scheme: the textbook scheme's error is not seen by a grid study.

    Raises
    ------
    ConfigError
        Naming the scheme.
    """
    if scheme != "localised":
        raise ConfigError(f"{key}: {scheme!r}; allowed: 'localised' where accuracy is given")


def _promised_spacing(
    simulation: Mapping, promise: float, profile: Prestress, gamma: float, ratio: float, release: str
) -> float:
    """What the scene's own lengths ask for, whatever its rule for the preset's spacing."""
    settings = settings_for(
        promise,
        boundary=simulation["boundary"],
        prestress=profile,
        gamma=gamma,
        damping_ratio=ratio,
        release=release,
        fields="fields" in simulation["record"],
    )
    return float(f"{simulation['coarser'] * settings['dx']:.12g}")


def _step(simulation: Mapping, gamma_dx2: float, ratio: float) -> float:
    """The simulation's own step, or the preset's, or the safe share of the bound where strong damping allows less."""
    bound = largest_step(simulation["scheme"], simulation["accuracy"]["order"], ratio, gamma_dx2)
    step = simulation.get("max_step", min(simulation["accuracy"]["max_step"], MARGIN * bound))
    if "promise" in simulation["accuracy"]:
        step = min(step, simulation["accuracy"]["max_step"])
    return float(step * simulation["coarser"] if "fixed" in simulation.get("spacing", {}) else step)


def _duration(rule: Mapping, profile: Prestress, gamma: float) -> float:
    ((unit, value),) = rule.items()
    if unit == "half_periods":
        return float(value * math.pi / math.sqrt(gamma))
    if unit == "balance_distances":
        try:
            return float(value * abs(prestress_balance_position(profile)))
        except ValueError as error:
            # In the words of the configuration, whose keys are levels or profiles.
            reason = str(error).removeprefix("prestress.")
            raise ValueError(f"duration.balance_distances: {value} times |x_minus|, but {reason}") from None
    return float(value)


def _samples(rule: Mapping | None, scene: Scene) -> Samples | None:
    if rule is None:
        return None
    positions = (
        np.linspace(-rule["extent"], rule["extent"], rule["positions"]) if rule["positions"] > 1 else [0.0]
    )
    return Samples(times=np.linspace(0.0, scene.duration, rule["times"]), positions=positions)
