"""Find out at which gamma and fracture energy pulses in the two-dimensional layer are stable.

Each pair of gamma and fracture energy is a point of a map, with three runs. One pulse forms in the
final pre-stress, one comes into it from a lower pre-stress, and one from a higher pre-stress. The
pulse width divided by the height of the layer is about sqrt(2/gamma - 1).
"""

from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

import pandas as pd

from ..configuration.chunks import runs_of
from .layer import LEVEL, STEP_POSITION, rows_across_a_step, stretch, weakening_of

NEEDS = {"settings": ["figures.study_layer"]}

# Pre-stress in which a pulse forms, divided by the pre-stress that it enters. The keys are the
# beginnings of column names.
RELATIVE_LEVELS_BEFORE = {"uniform": 1.0, "from_below": 0.9, "from_above": 1.1}
# Positions at which pulses are measured: just before the pre-stress changes (at 10), halfway, and
# far beyond. These are the positions at `layer.GAMMA`.
STATION_POSITIONS = (9.0, 18.0, 24.0)
# Slips count as equal if their relative difference is smaller than this.
EQUAL_SLIP_TOLERANCE = 0.02


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return one row for each point of the map, with the slips of its three runs and the outcome.

    Slips are those on the finer of two grids. The column coarse_outcome has the outcome on the
    other one. The pre-stress changes at step_position from level_below or level_above to tau0.

    The settings may have a chunk, such as [3, 8] for the third of eight chunks. The table then has
    only the rows of this chunk.
    """
    given = settings["figures"]["study_layer"]
    points = list(product(given["gamma"], given["fracture_energy"]))
    chunk, chunk_count = settings.get("chunk", (1, 1))
    rows = []
    # The numbers of the points in the chunk.
    for number in sorted(runs_of(chunk, chunk_count, len(points))):
        gamma, energy = points[number]
        rows.append(row_of_point(gamma, energy, given["cells"]))
    return pd.DataFrame(rows)


def row_of_point(gamma: float, energy: float, cells: int) -> dict[str, Any]:
    """Return the row of one point of the map; slips are 0 if the pulse has died.

    energy : fracture energy divided by the energy that the layer releases, G_0
    cells : number of cells over the height of the layer on the finer grid; the other has half as
        many
    """
    coarse, fine = slips_on_grids(gamma, energy, (cells // 2, cells))
    row = {
        "gamma": gamma,
        "tau0": LEVEL,
        "fracture_energy": energy,
        "cells": cells,
        "coarse_cells": cells // 2,
        "level_below": RELATIVE_LEVELS_BEFORE["from_below"] * LEVEL,
        "level_above": RELATIVE_LEVELS_BEFORE["from_above"] * LEVEL,
        "step_position": STEP_POSITION * stretch(gamma),
        "last_position": STATION_POSITIONS[-1] * stretch(gamma),
    }
    return row | fine | {"outcome": outcome(fine), "coarse_outcome": outcome(coarse)}


def slips_on_grids(gamma: float, energy: float, grids: Sequence[int]) -> list[dict[str, float]]:
    """Return speed, width and slips of the three pulses of one point of the map, for each grid.

    energy : fracture energy divided by the energy that the layer releases, G_0
    grids : numbers of cells over the height of the layer
    """
    weakening = weakening_of(energy, LEVEL, gamma)
    numbers: list[dict[str, float]] = [{} for _ in grids]
    for name, relative_level in RELATIVE_LEVELS_BEFORE.items():
        before = relative_level * LEVEL
        rows = rows_across_a_step(
            gamma, LEVEL, weakening, before=before, grids=grids, stations=STATION_POSITIONS
        )
        for cells, numbers_on_grid in zip(grids, numbers, strict=True):
            # There is one row for each of STATION_POSITIONS.
            before_step, halfway, last = (row for row in rows if row["cells"] == cells)
            # Speed and width are those of the pulse that forms in the final pre-stress.
            if name == "uniform":
                numbers_on_grid |= {"speed": last["speed"], "pulse_width": last["pulse_width"]}
            numbers_on_grid |= {
                f"{name}_slip_before": before_step["pulse_slip"],
                f"{name}_slip_halfway": halfway["pulse_slip"],
                f"{name}_slip": last["pulse_slip"],
            }
    return numbers


def outcome(slips: Mapping[str, float]) -> str:
    """Classify the pulses of one point of the map, from their slips along the path.

    A pulse is named by where it forms: uniform (in the final pre-stress), from_below (in a lower
    one) or from_above. The slip of this pulse at the last position is in NAME_slip, and halfway in
    NAME_slip_halfway. The steady slip is uniform_slip.

    The outcomes are:

    dying : the slip in uniform pre-stress falls along the path
    growing : the slip in uniform pre-stress rises along the path, or one of the other pulses rises
        beyond the steady slip
    steady : the pulses from below and from above both end with the steady slip
    lower dies : the pulse from above ends with the steady slip, and the one from below has died
    not settled : everything else
    """
    steady_slip, halfway_slip = slips["uniform_slip"], slips["uniform_slip_halfway"]
    if steady_slip <= (1.0 - EQUAL_SLIP_TOLERANCE) * halfway_slip:
        return "dying"
    if steady_slip > (1.0 + EQUAL_SLIP_TOLERANCE) * halfway_slip:
        return "growing"
    for name in ("from_below", "from_above"):
        slip = slips[f"{name}_slip"]
        is_above_steady_slip = slip > (1.0 + EQUAL_SLIP_TOLERANCE) * steady_slip
        if is_above_steady_slip and slip > slips[f"{name}_slip_halfway"]:
            return "growing"
    difference_from_below = abs(slips["from_below_slip"] - steady_slip)
    difference_from_above = abs(slips["from_above_slip"] - steady_slip)
    if difference_from_above < EQUAL_SLIP_TOLERANCE * steady_slip:
        if difference_from_below < EQUAL_SLIP_TOLERANCE * steady_slip:
            return "steady"
        if slips["from_below_slip"] == 0.0:
            return "lower dies"
    return "not settled"
