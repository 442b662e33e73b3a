"""Where a step blows up: the measured boundary on the derived one, for each scheme, order and damping ratio."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd

from ..model.prestress import Prestress
from ..model.scene import ORDERS, Scene
from ..model.stability import MARGIN, largest_step
from ..simulation.simulate import UnstableRun
from ..solver.lattice import Lattice

# What it is made from besides its own section of `studies`.
NEEDS = {"settings": ["presets"]}

# Far below any stress: blocks there never slide.
HELD = -1.0e9
# Steps between two looks at whether anything has stuck: a run that blows up sticks and is released over and over.
LOOK_AFTER = 100


def table(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Bisect for the largest sound step of every scheme, order and damping ratio.

    Parameters
    ----------
    settings : `studies.stability` of the configuration, and presets

    Returns
    -------
    one row a scheme, order and damping ratio: derived (the bound, in units of dx), measured (a chain between walls,
    nothing but the linear step) and measured_rupture (fronts, an event in most steps), and their ratios to the bound;
    then one row a preset and damping ratio with the step that it takes
    """
    rows = []
    for scheme, order in [("fixed_step", 1), *(("localised", order) for order in ORDERS)]:
        for ratio in settings["damping_ratios"]:
            bound = largest_step(scheme, order, ratio, 0.0)
            row = {
                "kind": "boundary",
                "scheme": scheme,
                "order": order,
                "damping_ratio": ratio,
                "derived": bound,
            }
            for name, make in (("measured", chain), ("measured_rupture", rupture)):
                row[name] = bound * boundary(make, scheme, order, ratio, bound, settings)
                row[f"{name}_ratio"] = row[name] / bound
            rows.append(row)
    for name, preset in settings["presets"].items():
        for ratio in settings["damping_ratios"]:
            bound = largest_step("localised", preset["order"], ratio, 0.0)
            rows.append(
                {
                    "kind": name,
                    "scheme": "localised",
                    "order": preset["order"],
                    "damping_ratio": ratio,
                    "derived": bound,
                    "measured": min(preset["max_step"], MARGIN * bound),
                }
            )
    return pd.DataFrame(rows)


def boundary(make, scheme: str, order: int, ratio: float, bound: float, settings: Mapping) -> float:
    """Largest sound step over the bound, by bisection between two shares of it; an end where it lies beyond."""
    lower, upper = settings["between"]
    values = (scheme, order, ratio, settings["blocks"], settings["steps"])
    if not sound(make, lower * bound, *values):
        return lower
    if sound(make, upper * bound, *values):
        return upper
    while upper - lower > settings["resolution"]:
        middle = 0.5 * (lower + upper)
        lower, upper = (middle, upper) if sound(make, middle * bound, *values) else (lower, middle)
    return lower


def sound(make, step: float, scheme: str, order: int, ratio: float, blocks: int, steps: int) -> bool:
    """Whether nothing sticks: in these scenes every velocity is positive, and a growing mode throws one below 0."""
    # No longer than a wave takes to cross, after which a chain between walls turns back.
    scene = make(min(steps * step, 0.8 * blocks), step, scheme, order, ratio, blocks)
    lattice = Lattice(scene, None, scene.beta)
    lattice.call_steps = LOOK_AFTER

    def stop_at_the_first_stick(share: float) -> None:
        if lattice.tally.sticks > 0:
            raise UnstableRun

    try:
        lattice.run(stop_at_the_first_stick)
    except UnstableRun:
        return False
    return bool(lattice.tally.sticks == 0)


def chain(duration: float, step: float, scheme: str, order: int, ratio: float, blocks: int) -> Scene:
    """Blocks between two walls, all released at once by a stress far above the threshold: no event until they turn."""
    profile = Prestress(
        0.9,
        0.9,
        1.0,
        peak=0.9,
        steps=((blocks + 0.5, HELD), (-blocks - 0.5, HELD)),
        bumps=((0.0, 100.0, 10.0 * blocks),),
    )
    return _with_step(profile, duration, step, scheme, order, ratio)


def rupture(duration: float, step: float, scheme: str, order: int, ratio: float, blocks: int) -> Scene:
    """A crack that grows for ever: an event in almost every step."""
    return _with_step(Prestress(0.5, 0.5, 8.0), duration, step, scheme, order, ratio)


def _with_step(
    profile: Prestress, duration: float, step: float, scheme: str, order: int, ratio: float
) -> Scene:
    """A scene on dx = 1 whose step may lie beyond the bound, which a Scene refuses."""
    scene = Scene(
        "stress", profile, duration, 1.0, beta=ratio, scheme=scheme, order=max(order, 3), max_step=1e-4
    )
    object.__setattr__(scene, "max_step", step)
    return scene
