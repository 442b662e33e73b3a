"""Map the stability of pulses in the two-dimensional layer by fracture energy and elasticity ratio.

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

# Pre-stress in which a pulse forms, divided by the pre-stress that it enters, by column name.
RELATIVE_LEVELS_BEFORE = {"uniform": 1.0, "from_below": 0.9, "from_above": 1.1}
# Positions of measurement at GAMMA: before the step at 10, halfway, and far beyond.
STATION_POSITIONS = (9.0, 18.0, 24.0)
# Cells of the grid whose run determines the duration of the other runs.
COARSEST_CELLS = 10
# Slips count as equal if their relative difference is smaller than this.
EQUAL_SLIP_TOLERANCE = 0.02


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return one row per gamma and fracture energy, with the slips of three runs and the outcome.

    If the settings have a chunk, such as [3, 8], the table has the rows of that chunk alone.
    """
    given = settings["figures"]["study_layer"]
    points = [*product(given["gamma"], given["fracture_energy"])]
    chunk, chunks = settings.get("chunk", (1, 1))
    numbers = sorted(runs_of(chunk, chunks, len(points)))
    return pd.DataFrame([point(*points[number], given["cells"]) for number in numbers])


def point(gamma: float, energy: float, cells: int) -> dict[str, Any]:
    """Return the row of one point of the map; slips are 0 if the pulse has died."""
    grids, weakening = sorted({COARSEST_CELLS, cells}), energy * LEVEL**2 / gamma
    out = {"gamma": gamma, "tau0": LEVEL, "fracture_energy": energy, "cells": cells}
    for name, ratio in RELATIVE_LEVELS_BEFORE.items():
        rows = across_a_step(gamma, LEVEL, weakening, ratio * LEVEL, grids, STATION_POSITIONS)
        entry, halfway, last = rows[-len(STATION_POSITIONS) :]
        if name == "uniform":
            out |= {key: last[key] for key in ("speed", "pulse_width")}
        out |= {f"{name}_slip_before": entry["pulse_slip"]}
        out |= {f"{name}_slip_halfway": halfway["pulse_slip"], f"{name}_slip": last["pulse_slip"]}
    return out | {"outcome": outcome(out)}


def outcome(slips: Mapping[str, float]) -> str:
    """Classify the pulses of one point of the map.

    "dying" means that the slip in uniform pre-stress falls along the path, "growing" that a slip
    rises. The point is "steady" if pulses from both sides reach the slip of the
    uniform pre-stress. It is "lower dies" if the pulse from above reaches it and the other pulse
    died before it entered. Everything else is "not settled".
    """
    steady = slips["uniform_slip"]
    if not steady > (1.0 - EQUAL_SLIP_TOLERANCE) * slips["uniform_slip_halfway"]:
        return "dying"
    growing = steady > (1.0 + EQUAL_SLIP_TOLERANCE) * slips["uniform_slip_halfway"]
    near = []
    for name in ("from_below", "from_above"):
        slip, halfway = slips[f"{name}_slip"], slips[f"{name}_slip_halfway"]
        growing = growing or slip > max((1.0 + EQUAL_SLIP_TOLERANCE) * steady, halfway)
        near.append(abs(slip - steady) < EQUAL_SLIP_TOLERANCE * steady)
    if growing:
        return "growing"
    if all(near):
        return "steady"
    return "lower dies" if near[1] and slips["from_below_slip"] == 0.0 else "not settled"
