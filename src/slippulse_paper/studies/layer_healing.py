"""Test whether pulses that are unstable in a thick layer are steady in a thin one.

The strength of the fault recovers while a point slows down (see `rate` of
`slippulse.solver.layer.LayerScene`), so that friction alone can end a pulse. The thick layer is so
thick that no wave returns from its held top before the pulses have passed. Lengths, times and slips
in both layers are in units of the thickness of the thin layer. Each pulse runs on two grids.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np
import pandas as pd

from slippulse.model.prestress import Prestress
from slippulse.solver.layer import LayerScene, simulate_layer

NEEDS = {"settings": ()}

GAMMA = 2.0 / 3.0
# Slip velocity at which the strength is halved, and the slip over which it changes.
RATE, WEAKENING = 0.05, 0.1
# Pulses of the thick layer: their pre-stress, and the half-length of the region without friction in
# which each of them starts. Longer regions start wider pulses.
THICK_LEVEL = 0.41
THICK_HALF_LENGTHS = (1.5, 5.0)
# Pulses of the thin layer: their pre-stress, the pre-stress at |x| < STEP_POSITION divided by it,
# and the half-length of the region without friction.
THIN_LEVELS = (0.52, 0.56)
RELATIVE_LEVELS_BEFORE = (0.94, 1.0, 1.1)
STEP_POSITION = 10.0
THIN_HALF_LENGTH = 2.0


@dataclass(frozen=True)
class Layer:
    """A layer, and what all its runs have in common.

    trail : length behind the compressional wave in which the layer is computed. All pulses are
        nearer to the wave while they pass the positions.
    positions : positions on the fault at which the slip is recorded
    coarse_cells, fine_cells : number of cells per unit of length on each grid
    """

    thickness: float
    duration: float
    trail: float
    positions: tuple[float, ...]
    coarse_cells: int
    fine_cells: int


THICK = Layer(
    thickness=20.0,
    duration=52.0,
    trail=22.0,
    positions=tuple(range(12, 33, 4)),
    coarse_cells=10,
    fine_cells=20,
)
THIN = Layer(
    thickness=1.0,
    duration=44.0,
    trail=12.0,
    positions=(9.0, *range(12, 33, 4)),
    coarse_cells=20,
    fine_cells=40,
)


@dataclass(frozen=True)
class Pulse:
    """The pre-stress of a pulse, and how it starts.

    tau0, before : pre-stress beyond STEP_POSITION, and pre-stress before it
    patch_half_length : half-length of the region without friction
    """

    tau0: float
    before: float
    patch_half_length: float


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the rows of two parts of the study. The column ``part`` has these values:

    position : final slip behind a pulse, one row for each pulse and position
    run : final slip at the last position, one row for each pulse, with `numbers_of_run`. The column
        spread has the largest relative difference between the slips of all pulses in the same layer
        and pre-stress.

    The slip is 0 where a pulse has died before. It is given on the fine grid (pulse_slip) and on
    the coarse grid (coarse_slip).
    """
    thick_pulses = [
        Pulse(tau0=THICK_LEVEL, before=THICK_LEVEL, patch_half_length=half_length)
        for half_length in THICK_HALF_LENGTHS
    ]
    thin_pulses = [
        Pulse(tau0=level, before=relative_before * level, patch_half_length=THIN_HALF_LENGTH)
        for level, relative_before in product(THIN_LEVELS, RELATIVE_LEVELS_BEFORE)
    ]
    rows_by_pulse = [slips_on_both_grids(THICK, pulse) for pulse in thick_pulses]
    rows_by_pulse += [slips_on_both_grids(THIN, pulse) for pulse in thin_pulses]
    runs = pd.DataFrame([numbers_of_run(rows) for rows in rows_by_pulse])
    slip_at_level = runs.groupby(["thickness", "tau0"])["pulse_slip"]
    runs["spread"] = slip_at_level.transform("max") / slip_at_level.transform("min") - 1.0
    positions = pd.concat(rows_by_pulse).assign(part="position")
    return pd.concat([positions, runs.assign(part="run")], ignore_index=True)


def slips_on_both_grids(layer: Layer, pulse: Pulse) -> pd.DataFrame:
    """Return one row for each position, with the parameters and the slip on both grids."""
    return pd.DataFrame(
        {
            "thickness": layer.thickness,
            "gamma": GAMMA,
            **vars(pulse),
            "rate": RATE,
            "weakening": WEAKENING,
            "cells": layer.fine_cells,
            "sample_position": layer.positions,
            "pulse_slip": slips(layer, pulse, layer.fine_cells),
            "coarse_slip": slips(layer, pulse, layer.coarse_cells),
        }
    )


def numbers_of_run(rows: pd.DataFrame) -> pd.Series:
    """Return the row of the last position, with the changes of slip since the first position.

    rows : slips of one pulse, one row for each position, from `slips_on_both_grids`

    The additional columns are:

    first_slip : slip at the first position, on the fine grid
    change, coarse_change : relative change of slip from the first to the last position, on the fine
        and on the coarse grid
    grid_change : relative difference between the last slips on both grids
    cells_in_weakening : cells of the fine grid in the length over which the strength falls
    """
    first, last = rows.iloc[0], rows.iloc[-1]
    # The weakening is the slip over which the strength falls. A pulse slips by as much within a
    # length of the order of gamma times the weakening.
    changes = {
        "first_slip": first["pulse_slip"],
        "change": last["pulse_slip"] / first["pulse_slip"] - 1.0,
        "coarse_change": last["coarse_slip"] / first["coarse_slip"] - 1.0,
        "grid_change": abs(last["pulse_slip"] / last["coarse_slip"] - 1.0),
        "cells_in_weakening": GAMMA * WEAKENING * last["cells"],
    }
    return pd.concat([last, pd.Series(changes)])


def slips(layer: Layer, pulse: Pulse, cells: int) -> np.ndarray:
    """Simulate one pulse, and return its slip at each position; 0 where it has died before.

    cells : number of cells per unit of length

    Raises ValueError if a position has slipped but has not stuck in time, or if the pulse may still
    arrive there. In the thick layer it must stick before waves may return from the top, and in the
    thin layer before the end.
    """
    thickness = layer.thickness
    # All results of the run are in units of the thickness of its own layer, and converted below.
    run = simulate_layer(scene_in_own_units(layer, pulse, cells))
    positions = np.array(layer.positions)
    distances = np.abs(thickness * run.x - positions[:, np.newaxis])
    nearest_nodes = distances.argmin(axis=1)
    slip = thickness * run.slip[nearest_nodes]
    stick_times = thickness * run.stick_time[nearest_nodes]
    # A wave from the nucleation returns from the top of the thick layer at these times.
    latest_times = np.hypot(positions, 2.0 * thickness) if layer is THICK else layer.duration
    has_stuck_in_time = stick_times < latest_times
    # The pulse has died if the outermost node that slipped has stuck.
    outermost_node = np.flatnonzero(run.slip)[-1]
    has_died = np.isfinite(run.stick_time[outermost_node])
    undecided = positions[~has_stuck_in_time & ((slip > 0.0) | ~has_died)]
    if undecided.size:
        raise ValueError(
            f"{pulse} in a layer of thickness {thickness:g}: the run ends before the slip at x ="
            f" {undecided[0]:g} is known"
        )
    return slip


def scene_in_own_units(layer: Layer, pulse: Pulse, cells: int) -> LayerScene:
    """Return the scene of a run, with lengths, times and slips in units of its own thickness.

    cells : number of cells per unit of length
    """
    thickness = layer.thickness
    # A pulse starts in the pre-stress ``before`` and may enter another one, tau0, at a step.
    step = STEP_POSITION / thickness
    steps = ((step, pulse.tau0), (-step, pulse.tau0)) if pulse.before != pulse.tau0 else ()
    return LayerScene(
        boundary="displacement",
        gamma=GAMMA,
        prestress=Prestress(pulse.before, pulse.before, width=None, steps=steps),
        weakening=WEAKENING / thickness,
        duration=layer.duration / thickness,
        cells=round(cells * thickness),
        nucleation=pulse.patch_half_length / thickness,
        # Velocities are the same in all units, because times and slips have the same factor.
        rate=RATE,
        trail=layer.trail / thickness,
        precision="single",
    )
