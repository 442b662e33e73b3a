"""Test whether pulses that are unstable in a thick layer are steady in a thin one.

The strength of the fault recovers while a point slows down (see `rate` of
`slippulse.solver.layer.LayerScene`), so that friction alone can end a pulse. The thick layer is so
thick that no wave returns from its held top before the pulses have passed. Lengths, times and slips
in both layers are in units of the thickness of the thin layer.
"""

import math
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from slippulse.model.prestress import Prestress
from slippulse.solver.layer import LayerScene, simulate_layer

NEEDS = {"settings": ()}

GAMMA = 2.0 / 3.0
# Columns with the parameters of a run.
RUN_COLUMNS = ["thickness", "tau0", "before", "patch_half_length"]
# Slip velocity at which the strength is halved, and the slip over which it changes.
RATE, WEAKENING = 0.05, 0.1
# Thick layer: its thickness, the duration, the number of cells per unit of height, and the
# positions at which the slip is recorded.
THICKNESS = 36.0
THICK_DURATION = 80.0
THICK_CELLS = 10
THICK_POSITIONS = tuple(range(16, 49, 4))
# Each pulse of the thick layer has a level of pre-stress, and a half-length of the region without
# friction in which it starts. Longer regions start wider pulses.
THICK_PULSES = ((0.36, 4.0), (0.41, 1.5), (0.41, 2.5), (0.41, 5.0), (0.44, 2.5))
# Nothing that happens this far behind the compressional wave can affect the pulses.
THICK_TRAIL = 30.0
# Thin layer: levels, the pre-stress at |x| < STEP_POSITION divided by the level, and the same
# parameters as above.
THIN_LEVELS = (0.52, 0.56)
RELATIVE_LEVELS_BEFORE = (0.94, 1.0, 1.1)
STEP_POSITION = 10.0
THIN_DURATION = 44.0
THIN_CELLS = 40
THIN_POSITIONS = (9.0, *range(12, 33, 4))
THIN_HALF_LENGTH = 2.0


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the rows of two parts of the study. The column ``part`` has these values:

    position : the final slip behind a pulse, one row for each pulse and position
    run : the final slip at the last position, one row for each pulse. The column change has the
        relative change of slip since the first position. The column spread has the largest relative
        difference between the slips of all pulses in the same layer and pre-stress.

    The slip is 0 where a pulse has died before.
    """
    rows = []
    for level, half_length in THICK_PULSES:
        rows += slips(THICKNESS, level, level, half_length)
    for level, relative_level in product(THIN_LEVELS, RELATIVE_LEVELS_BEFORE):
        rows += slips(1.0, level, relative_level * level, THIN_HALF_LENGTH)
    positions = pd.DataFrame(rows).assign(part="position")
    slip = positions.groupby(RUN_COLUMNS, sort=False)["pulse_slip"]
    runs = slip.last().to_frame().assign(change=slip.last() / slip.first() - 1.0)
    slip_at_level = runs.groupby(["thickness", "tau0"])["pulse_slip"]
    runs["spread"] = slip_at_level.transform("max") / slip_at_level.transform("min") - 1.0
    return pd.concat([positions, runs.reset_index().assign(part="run")], ignore_index=True)


def slips(
    thickness: float, level: float, before: float, half_length: float, refinement: int = 1
) -> list[dict[str, Any]]:
    """Simulate one pulse, and return one row for each position with the slip there.

    thickness : THICKNESS for the thick layer, 1 for the thin one
    level, before : pre-stress beyond STEP_POSITION, and pre-stress before it
    half_length : half-length of the region without friction
    refinement : factor of the number of cells

    Raises ValueError if the pulse has not passed a position in time. In the thick layer it must
    pass before waves may return from the top, and in the thin layer before the end.
    """
    is_thick = thickness > 1.0
    scene = scene_in_own_units(thickness, level, before, half_length, refinement)
    run = simulate_layer(scene)
    parameters = dict(zip(RUN_COLUMNS, (thickness, level, before, half_length), strict=True))
    rows = []
    for position in THICK_POSITIONS if is_thick else THIN_POSITIONS:
        node = int(np.argmin(np.abs(thickness * run.x - position)))
        slip = thickness * float(run.slip[node])
        stick_time = thickness * float(run.stick_time[node])
        # In the thick layer, a wave from the nucleation returns from the top after this time.
        end = math.hypot(position, 2.0 * thickness) if is_thick else THIN_DURATION
        has_stuck_in_time = stick_time < end
        if slip > 0.0 and not has_stuck_in_time:
            raise ValueError(f"{parameters}: still slides at {position}")
        rows.append(parameters | {"sample_position": float(position), "pulse_slip": slip})
    return rows


def scene_in_own_units(
    thickness: float, level: float, before: float, half_length: float, refinement: int
) -> LayerScene:
    """Return the scene of a run, with lengths, times and slips in units of its own thickness.

    The arguments are those of `slips`.
    """
    is_thick = thickness > 1.0
    duration, cells = (THICK_DURATION, THICK_CELLS) if is_thick else (THIN_DURATION, THIN_CELLS)
    step = STEP_POSITION / thickness
    steps = ((step, level), (-step, level)) if before != level else ()
    return LayerScene(
        boundary="displacement",
        gamma=GAMMA,
        prestress=Prestress(before, before, width=None, steps=steps),
        weakening=WEAKENING / thickness,
        duration=duration / thickness,
        cells=round(refinement * cells * thickness),
        nucleation=half_length / thickness,
        rate=RATE,
        trail=THICK_TRAIL / thickness if is_thick else math.inf,
    )
