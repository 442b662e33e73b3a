"""Resolved simulations, expanded into scenes. Plain builtins in, scenes out; every job imports this, and no more."""

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np

from ..data.chunks import runs_of
from ..model.prestress import Prestress, prestress_balance_position
from ..model.samples import Samples
from ..model.scene import Scene
from ..model.stability import MARGIN, largest_step


class Run(NamedTuple):
    """One entry of each list of a simulation: what a run is, but for its spacing."""

    release: str
    profile: Prestress
    gamma: float
    dx: float | None
    damping: float
    alpha: float


def promise_of(simulation: Mapping) -> float | None:
    """The relative uncertainty that a resolved simulation promises: None unasked, NaN with a spacing of its own."""
    promise = simulation["accuracy"].get("promise")
    own = "dx" in simulation or "fixed" in simulation["spacing"] or any(simulation.get("beta", []))
    return math.nan if promise is not None and own else promise


def expand(simulation: Mapping) -> tuple[list[Scene], list[Samples | None]]:
    """Scenes of a resolved simulation, or of a chunk, and what each records; a ValueError names what is refused."""
    scenes, accuracy, order = [], simulation["accuracy"], simulation["accuracy"]["order"]
    for place, run in enumerate(runs(simulation)):
        dx = _spacing(simulation, run, place)
        beta = run.damping if "beta" in simulation else run.damping * dx
        of = (simulation["scheme"], order, beta / dx, run.gamma * dx**2, run.alpha * dx)
        bound = largest_step(*of, enough=accuracy["max_step"] / MARGIN)
        # The simulation's own step, or the preset's, or a safe fraction of the bound where damping allows less.
        step = simulation.get("max_step", min(accuracy["max_step"], MARGIN * bound))
        if "promise" in accuracy:
            step = min(step, accuracy["max_step"])
        if "fixed" in simulation["spacing"]:
            step *= simulation["coarser"]
        time = _duration(simulation["duration"], run.profile, run.gamma)
        own = {
            key: simulation[key]
            for key in ("boundary", "scheme", "friction_ratio", "resolved_blocks")
        }
        own |= {
            "order": order,
            "max_step": step,
            "release": run.release,
            "rate_strengthening": run.alpha,
        }
        scenes.append(
            Scene(prestress=run.profile, duration=time, dx=dx, gamma=run.gamma, beta=beta, **own)
        )
    return scenes, [_samples(simulation.get("samples"), scene.duration) for scene in scenes]


def runs(simulation: Mapping) -> Iterator[Run]:
    """The runs of a resolved simulation or of a chunk of it, one after the other."""
    chunk = simulation.get("chunk")
    wanted = set(runs_of(chunk[0], chunk[1], run_count(simulation))) if chunk else None
    for number, (release, *shape, gamma, dx, damping, alpha) in enumerate(
        product(*_axes(simulation))
    ):
        if wanted is None or number in wanted:
            yield Run(release, _profile(*shape), gamma, dx, damping, alpha)


def run_count(simulation: Mapping) -> int:
    """How many runs a resolved simulation is the product of."""
    return math.prod(map(len, _axes(simulation)))


def _axes(simulation: Mapping) -> list[Sequence]:
    """The lists whose product the runs are."""
    release, right, rule = simulation["release"], simulation.get("right"), simulation.get("beyond")
    if "profiles" in simulation:
        shapes = [simulation["profiles"]]
    else:
        # One step a level, at the position from which the level holds.
        steps = [((rule["position"], level),) for level in rule["levels"]] if rule else [()]
        shapes = [
            simulation["left"],
            [None] if right == "same" else right,
            simulation["width"],
            steps,
        ]
    defaults = {
        "gamma": [0.0],
        "dx": [None],
        "beta": simulation["damping_ratio"],
        "rate_strengthening": [0.0],
    }
    others = [simulation.get(key, default) for key, default in defaults.items()]
    return [[release] if isinstance(release, str) else release, *shapes, *others]


def _profile(left, right=None, width=1.0, steps=()) -> Prestress:
    if isinstance(left, Mapping):
        return Prestress(**left)
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
            raise ValueError(
                f"duration.balance_distances: {value} times |x_minus|, but {reason}"
            ) from None
    return float(value)


def _samples(rule: Mapping | None, duration: float) -> Samples | None:
    if rule is None:
        return None
    extent, count = rule["extent"], rule["positions"]
    positions = np.linspace(-extent, extent, count) if count > 1 else np.zeros(1)
    return Samples(np.linspace(0.0, duration, rule["times"]), positions)
