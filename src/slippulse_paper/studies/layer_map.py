"""Stability of pulses of the layer in the plane, over fracture energy and elasticity ratio.

Each pulse runs three times: in a uniform pre-stress, and sent into it from a lower and from a
higher one. Its width is about sqrt(2/gamma - 1), so that gamma sets the width over the height.
"""

from collections.abc import Mapping
from itertools import product
from typing import Any

import pandas as pd

from ..configuration.chunks import runs_of
from .layer import LEVEL, across_a_step

NEEDS = {"settings": ["figures.study_layer"]}

# Pre-stress in which a pulse forms, divided by the one that it enters, by column.
BEFORE = {"uniform": 1.0, "from_below": 0.9, "from_above": 1.1}
# Places at GAMMA: before the step at 10, halfway, and far beyond.
PLACES = (9.0, 18.0, 24.0)
# The grid that tells how long a run lasts.
COARSEST = 10
# Slips are equal if they differ by less than this, relatively.
EQUAL = 0.02


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """One row per gamma and fracture energy, with the slips of its three runs and their outcome.

    If the settings have a chunk, such as [3, 8], the table has the rows of that chunk alone.
    """
    given = settings["figures"]["study_layer"]
    points = [*product(given["gamma"], given["fracture_energy"])]
    chunk, chunks = settings.get("chunk", (1, 1))
    numbers = sorted(runs_of(chunk, chunks, len(points)))
    return pd.DataFrame([point(*points[number], given["cells"]) for number in numbers])


def point(gamma: float, energy: float, cells: int) -> dict[str, Any]:
    """Row of one point of the map; slips are 0 where the pulse has died."""
    grids, weakening = sorted({COARSEST, cells}), energy * LEVEL**2 / gamma
    out = {"gamma": gamma, "tau0": LEVEL, "fracture_energy": energy, "cells": cells}
    for name, ratio in BEFORE.items():
        rows = across_a_step(gamma, LEVEL, weakening, ratio * LEVEL, grids, PLACES)
        entry, halfway, last = rows[-len(PLACES) :]
        if name == "uniform":
            out |= {key: last[key] for key in ("speed", "pulse_width")}
        out |= {f"{name}_slip_before": entry["pulse_slip"]}
        out |= {f"{name}_slip_halfway": halfway["pulse_slip"], f"{name}_slip": last["pulse_slip"]}
    return out | {"outcome": outcome(out)}


def outcome(slips: Mapping[str, float]) -> str:
    """Return what the pulses of one point do.

    dying: the slip in uniform pre-stress falls. growing: that slip, or that of a pulse from another
    pre-stress, rises above the uniform one. steady: pulses from both sides reach the uniform slip.
    lower dies: the one from above does, and the other one died in the lower pre-stress.
    """
    steady = slips["uniform_slip"]
    if not steady > (1.0 - EQUAL) * slips["uniform_slip_halfway"]:
        return "dying"
    growing = steady > (1.0 + EQUAL) * slips["uniform_slip_halfway"]
    near = []
    for name in ("from_below", "from_above"):
        slip, halfway = slips[f"{name}_slip"], slips[f"{name}_slip_halfway"]
        growing = growing or slip > max((1.0 + EQUAL) * steady, halfway)
        near.append(abs(slip - steady) < EQUAL * steady)
    if growing:
        return "growing"
    if all(near):
        return "steady"
    return "lower dies" if near[1] and slips["from_below_slip"] == 0.0 else "not settled"
