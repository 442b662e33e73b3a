"""Only what a scene requires: work a sliding block, bytes a block, cost against duration and spacing."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from ..model.prestress import Prestress
from ..model.scene import Scene
from ..solver.lattice import Lattice
from ..solver.run import run_scene

# What it is made from besides its own section of `studies`.
NEEDS = {}


def table(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Count work and memory, and fit how the work grows.

    Parameters
    ----------
    settings : `studies.requirements` of the configuration

    Returns
    -------
    rows of part "work": scene, value = block updates over sliding blocks and steps (1: nothing else is touched, 1/2:
    half of a symmetric scene), blocks = the lattice of the textbook scheme over the sliding blocks; "events": value =
    blocks that events changed over the block updates; "memory": bytes a block of the lattice for each order;
    "duration" and "spacing": x, value = block updates; "exponent": their slopes
    """
    rows = [row for name, scene in scenes(settings).items() for row in work(name, scene)]
    rows += [
        {"part": "memory", "scene": f"order {order}", "x": order, "value": bytes_a_block(settings, order)}
        for order in settings["orders"]
    ]
    for part, values in (("duration", settings["durations"]), ("spacing", settings["dx"])):
        costs = []
        for value in values:
            changed = {"duration": value} if part == "duration" else {"dx": value}
            costs.append(run_scene(pulse(settings, **changed)).numbers["block_updates"])
            rows.append({"part": part, "scene": "pulse", "x": value, "value": costs[-1]})
        slope = float(np.polyfit(np.log(values), np.log(costs), 1)[0])
        rows.append({"part": "exponent", "scene": f"pulse, {part}", "value": slope})
    return pd.DataFrame(rows)


def pulse(settings: Mapping, **changed) -> Scene:
    """The steady pulse, on half of its symmetric lattice."""
    values = {"duration": settings["durations"][0], "dx": settings["dx"][0]} | changed
    level = settings["level"]
    return Scene(
        "displacement", Prestress(level, level), gamma=settings["gamma"], beta=settings["damping_ratio"] * values["dx"],
        max_step=0.5, **values,
    )  # fmt: skip


def scenes(settings: Mapping) -> dict[str, Scene]:
    """A pulse by symmetry and in full, a growing crack, and the crack that turns into a pulse under held stress."""
    level, dx = settings["level"], settings["dx"][0]
    beta = settings["damping_ratio"] * dx
    more = {"duration": settings["durations"][0], "dx": dx, "beta": beta, "max_step": 0.5}
    return {
        "two pulses, by symmetry": pulse(settings),
        "two pulses, whole lattice": Scene(
            "displacement", Prestress(level, level), gamma=settings["gamma"], half_lattice=False, **more
        ),
        "crack, whole lattice": Scene("stress", Prestress(level, level), half_lattice=False, **more),
        "one pulse, whole lattice": Scene("stress", Prestress(-level, 0.0), **more),
    }


def work(name: str, scene: Scene) -> list[dict]:
    """Block updates a step over the mean number of sliding blocks, from the release and stick times of the run.

    And what events change, over the block updates.
    """
    run = run_scene(scene)
    released = np.isfinite(run.release_time)
    end = run.numbers["end_time"]
    stopped = np.where(np.isfinite(run.stick_time), run.stick_time, end)
    sliding = float(np.sum(stopped[released] - run.release_time[released])) / end
    updates = run.numbers["block_updates"]
    return [
        {
            "part": "work",
            "scene": name,
            "value": updates / run.numbers["steps"] / sliding,
            "blocks": float(released.sum()) / sliding,
        },
        {"part": "events", "scene": name, "value": run.numbers["event_updates"] / updates},
    ]


def bytes_a_block(settings: Mapping, order: int) -> float:
    """Bytes of all arrays that grow with the lattice, over its blocks, after a run."""
    scene = pulse(settings)
    object.__setattr__(scene, "order", order)
    lattice = Lattice(scene, None, scene.beta)
    lattice.run(None)
    blocks = lattice.size
    return sum(array.nbytes for array in lattice.arrays() if array.size >= blocks) / blocks
