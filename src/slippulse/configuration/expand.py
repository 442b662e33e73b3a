"""Resolved simulations, expanded into scenes. Plain builtins in, scenes out; every job imports this, and no more."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import cache, partial
from typing import NamedTuple

import numpy as np

from ..data.chunks import runs_of
from ..model.balance import prestress_balance_position
from ..model.prestress import Prestress
from ..model.samples import Samples
from ..model.scene import Scene
from ..model.stability import MARGIN, largest_step


class Run(NamedTuple):
    """One entry of each list of a simulation: what a run is, but for its spacing."""

    release: str
    profile: Prestress
    gamma: float
    dx: float | None
    damping: tuple[str, float]
    alpha: float


def promise_of(simulation: Mapping) -> float | None:
    """The relative uncertainty that a resolved simulation promises: None unasked, NaN with a spacing of its own."""
    promise = simulation["accuracy"].get("promise")
    own = "dx" in simulation or "fixed" in simulation["spacing"] or any(simulation.get("beta", []))
    return math.nan if promise is not None and own else promise


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
    for place, run in enumerate(runs(simulation)):
        kind, value = run.damping
        dx = _spacing(simulation, run, place)
        beta = value if kind == "beta" else value * dx
        scene = Scene(
            prestress=run.profile,
            duration=_duration(simulation["duration"], run.profile, run.gamma),
            dx=dx,
            gamma=run.gamma,
            beta=beta,
            release=run.release,
            rate_strengthening=run.alpha,
            max_step=_step(simulation, run.gamma * dx**2, beta / dx, run.alpha * dx),
            order=simulation["accuracy"]["order"],
            **{key: simulation[key] for key in ("boundary", "scheme", "friction_ratio", "resolved_blocks")},
        )
        scenes.append(scene)
        samples.append(_samples(simulation.get("samples"), scene))
    return scenes, samples


def runs(simulation: Mapping) -> Iterator[Run]:
    """The runs of a resolved simulation or of a chunk of it, one after the other."""
    axes, profile_of = _axes(simulation), cache(partial(_profile, simulation))
    count, chunk = run_count(simulation), simulation.get("chunk")
    for run in runs_of(chunk[0], chunk[1], count) if chunk else range(count):
        places = np.unravel_index(run, [len(axis) for axis in axes])
        release, *shape, gamma, dx, damping, alpha = (
            axis[int(at)] for axis, at in zip(axes, places, strict=True)
        )
        yield Run(release, profile_of(*shape), gamma, dx, damping, alpha)


def run_count(simulation: Mapping) -> int:
    """How many runs a resolved simulation is the product of."""
    return math.prod(len(axis) for axis in _axes(simulation))


def _axes(simulation: Mapping) -> list[Sequence]:
    """The lists whose product the runs are."""
    release, rule = simulation["release"], simulation.get("beyond")
    shapes: list[Sequence] = [range(len(simulation.get("profiles", ())))]
    if "profiles" not in simulation:
        right = simulation["right"]
        # One step a level, at the position from which the level holds.
        steps = [((rule["position"], level),) for level in rule["levels"]] if rule else [()]
        shapes = [simulation["left"], [None] if right == "same" else right, simulation["width"], steps]
    kind = "beta" if "beta" in simulation else "damping_ratio"
    return [
        [release] if isinstance(release, str) else release,
        *shapes,
        simulation.get("gamma", [0.0]),
        simulation.get("dx", [None]),
        [(kind, value) for value in simulation[kind]],
        simulation.get("rate_strengthening", [0.0]),
    ]


def _profile(simulation: Mapping, *shape) -> Prestress:
    if "profiles" in simulation:
        return Prestress(**simulation["profiles"][shape[0]])
    left, right, width, steps = shape
    return Prestress(left=left, right=left if right is None else right, width=width, steps=steps)


def _spacing(simulation: Mapping, run: Run, place: int) -> float:
    """Of twelve digits, so that a spacing of 0.02 is 0.02 in the data and on a label."""
    rule = simulation["spacing"]
    if "fixed" in rule:
        return float(rule["fixed"])
    dx = simulation["spacings"][place] if "spacings" in simulation else run.dx
    if dx is None:
        dx = simulation["accuracy"]["dx"] * rule["scale"]
        dx *= run.profile.width ** rule["width_power"] * run.gamma ** rule["gamma_power"]
    return float(f"{simulation['coarser'] * dx:.12g}")


def _step(simulation: Mapping, gamma_dx2: float, ratio: float, alpha_dx: float) -> float:
    """The simulation's own step, or the preset's, or a safe fraction of the bound where damping allows less."""
    bound = largest_step(simulation["scheme"], simulation["accuracy"]["order"], ratio, gamma_dx2, alpha_dx)
    step = simulation.get("max_step", min(simulation["accuracy"]["max_step"], MARGIN * bound))
    if "promise" in simulation["accuracy"]:
        step = min(step, simulation["accuracy"]["max_step"])
    return float(step * simulation["coarser"] if "fixed" in simulation["spacing"] else step)


def _duration(rule: Mapping, profile: Prestress, gamma: float) -> float:
    ((unit, value),) = rule.items()
    if unit == "half_periods":
        value = value * math.pi / math.sqrt(gamma)
    if unit == "balance_distances":
        try:
            value *= abs(prestress_balance_position(profile))
        except ValueError as error:
            # In the words of the configuration, whose keys are levels or profiles.
            reason = str(error).removeprefix("prestress.")
            raise ValueError(f"duration.balance_distances: {value} times |x_minus|, but {reason}") from None
    return float(value)


def _samples(rule: Mapping | None, scene: Scene) -> Samples | None:
    if rule is None:
        return None
    positions = np.zeros(1)
    if rule["positions"] > 1:
        positions = np.linspace(-rule["extent"], rule["extent"], rule["positions"])
    return Samples(times=np.linspace(0.0, scene.duration, rule["times"]), positions=positions)
