"""Resolved simulations, plain builtins, expanded into scenes. Every job imports this module."""

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np

from ..data.chunks import runs_of
from ..model.balance import prestress_balance_position
from ..model.friction import COULOMB, Friction, friction_from
from ..model.prestress import Prestress
from ..model.samples import Samples
from ..model.scene import Scene
from ..model.stability import MARGIN, chosen_step


class Run(NamedTuple):
    """One run of a simulation: one entry of each of its lists."""

    release: str
    profile: Prestress
    gamma: float
    dx: float | None
    damping: float
    friction: Friction


def promise_of(simulation: Mapping) -> float | None:
    """Relative error that is promised; None if none is, NaN if a simulation sets its spacing."""
    promise = simulation["accuracy"].get("promise")
    chosen = "dx" in simulation or "fixed" in simulation["spacing"]
    if promise is not None and (chosen or any(simulation.get("beta", []))):
        return math.nan
    return promise


def expand(simulation: Mapping) -> tuple[list[Scene], list[Samples | None]]:
    """Scenes of a resolved simulation, or of a chunk, and what each samples; or ValueError."""
    scenes = [_scene(simulation, run, index) for index, run in enumerate(runs(simulation))]
    rule = simulation.get("samples")
    if rule is None:
        return scenes, [None] * len(scenes)
    extent, count = rule["extent"], rule["positions"]
    positions = np.linspace(-extent, extent, count) if count > 1 else np.zeros(1)
    times = [np.linspace(0.0, scene.duration, rule["times"]) for scene in scenes]
    return scenes, [Samples(instants, positions) for instants in times]


def runs(simulation: Mapping) -> Iterator[Run]:
    """The runs of a resolved simulation, or of a chunk of it, one after the other."""
    chunk = simulation.get("chunk")
    wanted = set(runs_of(chunk[0], chunk[1], run_count(simulation))) if chunk else None
    for number, entries in enumerate(product(*_axes(simulation))):
        if wanted is None or number in wanted:
            release, *shape, gamma, dx, damping, law = entries
            if "profiles" in simulation:
                profile = Prestress(**shape[0])
            else:
                left, right, width, steps = shape
                profile = Prestress(left, left if right is None else right, width, steps=steps)
            yield Run(release, profile, gamma, dx, damping, friction_from(law))


def run_count(simulation: Mapping) -> int:
    """Number of runs of a resolved simulation, the product of the lengths of its lists."""
    return math.prod(map(len, _axes(simulation)))


def _axes(simulation: Mapping) -> list[Sequence]:
    """The lists whose product the runs are."""
    release = simulation["release"]
    releases = [release] if isinstance(release, str) else release
    if "profiles" in simulation:
        shapes = [simulation["profiles"]]
    else:
        right, rule = simulation["right"], simulation.get("beyond")
        # Each level is one step, at the position from which the level holds.
        steps = [((rule["position"], level),) for level in rule["levels"]] if rule else [()]
        rights = [None] if right == "same" else right
        shapes = [simulation["left"], rights, simulation["width"], steps]
    gamma, dx = simulation.get("gamma", [0.0]), simulation.get("dx", [None])
    damping = simulation.get("beta", simulation["damping_ratio"])
    laws = simulation.get("friction", [COULOMB.mapping()])
    return [releases, *shapes, gamma, dx, damping, laws]


def _scene(simulation: Mapping, run: Run, index: int) -> Scene:
    accuracy, rule = simulation["accuracy"], simulation["spacing"]
    if "fixed" in rule:
        dx = float(rule["fixed"])
    else:
        spacing = simulation["spacings"][index] if "spacings" in simulation else run.dx
        if spacing is None:
            powers = run.profile.width ** rule["width_power"] * run.gamma ** rule["gamma_power"]
            spacing = accuracy["dx"] * rule["scale"] * powers
        # Twelve digits: a spacing of 0.02 is 0.02 in the data and on a label.
        dx = float(f"{simulation['coarser'] * spacing:.12g}")
    beta = run.damping if "beta" in simulation else run.damping * dx
    # The simulation's own step, or the preset's, cut where it is not stable or accurate.
    traits, largest = run.friction.traits, accuracy["max_step"]
    ratios = beta / dx, run.gamma * dx**2, traits.steepest * dx
    step = chosen_step(simulation["scheme"], accuracy["order"], *ratios, enough=largest)
    step = simulation.get("max_step", min(step, MARGIN * traits.longest_step / dx))
    if "promise" in accuracy:
        step = min(step, largest)
    if "fixed" in rule:
        step *= simulation["coarser"]
    common = ("boundary", "scheme", "friction_ratio", "resolved_blocks")
    return Scene(
        prestress=run.profile,
        duration=_duration(simulation["duration"], run.profile, run.gamma),
        dx=dx,
        gamma=run.gamma,
        beta=beta,
        release=run.release,
        max_step=step,
        order=accuracy["order"],
        friction=run.friction,
        **{key: simulation[key] for key in common},
    )


def _duration(rule: Mapping, profile: Prestress, gamma: float) -> float:
    ((unit, value),) = rule.items()
    if unit == "half_periods":
        value = value * math.pi / math.sqrt(gamma)
    if unit == "balance_distances":
        try:
            value *= abs(prestress_balance_position(profile))
        except ValueError as error:
            # The configuration names levels or profiles, and not `prestress`.
            reason = f"{value} times |x_minus|, but {str(error).removeprefix('prestress.')}"
            raise ValueError(f"duration.balance_distances: {reason}") from None
    return float(value)
