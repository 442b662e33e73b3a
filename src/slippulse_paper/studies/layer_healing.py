"""Test whether a held top makes pulses steady that are unstable in a thick layer.

The strength recovers while a point slows down (`rate` of `slippulse.solver.layer.LayerScene`), so
that friction alone can end a pulse. The same pulses run in a layer that is so thick that no wave
returns from its top before they have passed, and in a thin layer. Lengths, times and slips of both
are in units of the thickness of the thin layer.
"""

import math
from typing import Any

import numpy as np
import pandas as pd

from slippulse.model.prestress import Prestress
from slippulse.solver.layer import LayerScene, simulate_layer

NEEDS = {"settings": ()}

GAMMA = 2.0 / 3.0
CASE = ["thickness", "tau0", "before", "patch_half_length"]
# Slip velocity at which the strength is halved, and the slip over which it changes.
RATE, WEAKENING = 0.05, 0.1
# Thickness of the thick layer. Each of its pulses has a level of pre-stress and a half-length of
# the region without friction; longer regions start wider pulses.
THICKNESS, THICK_DURATION, THICK_CELLS = 36.0, 80.0, 10
THICK_PULSES = ((0.36, 4.0), (0.41, 1.5), (0.41, 2.5), (0.41, 5.0), (0.44, 2.5))
THICK_POSITIONS = tuple(range(16, 49, 4))
# Nothing that happens this far behind the compressional wave can affect the pulses.
THICK_TRAIL = 30.0
# Levels of the thin layer, and those at |x| < STEP_POSITION relative to them.
THIN_LEVELS, RELATIVE_LEVELS_BEFORE, STEP_POSITION = (0.52, 0.56), (0.94, 1.0, 1.1), 10.0
THIN_DURATION, THIN_CELLS, THIN_HALF_LENGTH = 44.0, 40, 2.0
THIN_POSITIONS = (9.0, *range(12, 33, 4))


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the rows of two parts of the study, which the column part names.

    position : the slip that each pulse leaves (pulse_slip), one row for each position
    run : one row for each pulse, with its slip at the last position, the relative change of slip
        since the first position (change), and the largest relative difference between the slips of
        the pulses at one level (spread)

    A pulse that has died leaves no slip.
    """
    rows = []
    for level, half_length in THICK_PULSES:
        rows += slips(THICKNESS, level, level, half_length)
    for level in THIN_LEVELS:
        for ratio in RELATIVE_LEVELS_BEFORE:
            rows += slips(1.0, level, ratio * level, THIN_HALF_LENGTH)
    positions = pd.DataFrame(rows)
    slip = positions.groupby(CASE, sort=False)["pulse_slip"]
    runs = slip.last().to_frame().assign(change=slip.last() / slip.first() - 1.0)
    at_level = runs.groupby(["thickness", "tau0"])["pulse_slip"]
    runs["spread"] = at_level.transform("max") / at_level.transform("min") - 1.0
    runs = runs.reset_index().assign(part="run")
    return pd.concat([positions.assign(part="position"), runs], ignore_index=True)


def slips(
    thickness: float, level: float, before: float, half_length: float, refinement: int = 1
) -> list[dict[str, Any]]:
    """Simulate one pulse, and return its slip at each position.

    thickness : THICKNESS for the thick layer, 1 for the thin one
    level, before : pre-stress, and pre-stress at distances up to STEP_POSITION
    half_length : half-length of the region without friction
    refinement : factor of the number of cells

    Raises ValueError if a point still slides when waves may have returned from the top of the thick
    layer, or at the end in the thin one.
    """
    is_thick = thickness > 1.0
    duration, cells = (THICK_DURATION, THICK_CELLS) if is_thick else (THIN_DURATION, THIN_CELLS)
    # The layer is simulated in units of its own thickness.
    step = STEP_POSITION / thickness
    steps = ((step, level), (-step, level)) if before != level else ()
    scene = LayerScene(
        "displacement",
        GAMMA,
        Prestress(before, before, width=None, steps=steps),
        WEAKENING / thickness,
        duration / thickness,
        round(refinement * cells * thickness),
        half_length / thickness,
        rate=RATE,
        trail=THICK_TRAIL / thickness if is_thick else math.inf,
    )
    run = simulate_layer(scene)
    case = dict(zip(CASE, (thickness, level, before, half_length), strict=True))
    rows = []
    for position in THICK_POSITIONS if is_thick else THIN_POSITIONS:
        node = int(np.argmin(np.abs(thickness * run.x - position)))
        slip = thickness * float(run.slip[node])
        stick_time = thickness * float(run.stick_time[node])
        # In the thick layer, a wave from the nucleation returns from the top after this time.
        end = math.hypot(position, 2.0 * thickness) if is_thick else duration
        has_stuck_in_time = stick_time < end
        if slip > 0.0 and not has_stuck_in_time:
            raise ValueError(f"{case}: still slides at {position}")
        rows.append(case | {"sample_position": float(position), "pulse_slip": slip})
    return rows
