"""Test whether a held top makes pulses steady that are unstable in a thick layer.

The strength recovers while a point slows down (`rate` of `slippulse.solver.layer.LayerScene`), so
that friction alone can end a pulse. The same pulses run in a layer that is so thick that no wave
returns from its top before they have passed, and in a thin layer. Lengths, times and slips of both
are in units of the thickness of the thin layer. Each pulse runs on two grids.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from slippulse.model.prestress import Prestress
from slippulse.solver.layer import LayerScene, simulate_layer

NEEDS = {"settings": ()}

GAMMA = 2.0 / 3.0
# Slip velocity at which the strength is halved, and the slip over which it changes.
RATE, WEAKENING = 0.05, 0.1
# Pre-stress of the pulses of the thick layer, and the half-length of the region without friction in
# which each of them starts. Longer regions start wider pulses.
THICK_LEVEL, THICK_HALF_LENGTHS = 0.41, (1.5, 5.0)
# Pre-stress of the pulses of the thin layer, and the pre-stress at |x| < STEP_POSITION relative to
# it. All start in a region without friction of this half-length.
THIN_LEVELS, RELATIVE_LEVELS_BEFORE, STEP_POSITION = (0.52, 0.56), (0.94, 1.0, 1.1), 10.0
THIN_HALF_LENGTH = 2.0


@dataclass(frozen=True)
class Layer:
    """A layer, and the times, positions and grids of its runs."""

    thickness: float
    duration: float
    # Columns farther than this behind the compressional wave are no longer advanced. At the
    # positions, all pulses are nearer.
    trail: float
    positions: tuple[float, ...]
    cells: tuple[int, int]  # per unit of length, on a coarse and on a fine grid


THICK = Layer(20.0, 52.0, 22.0, tuple(range(12, 33, 4)), (10, 20))
THIN = Layer(1.0, 44.0, 12.0, (9.0, *range(12, 33, 4)), (20, 40))


@dataclass(frozen=True)
class Pulse:
    """Pre-stress and start of a pulse in one of the layers."""

    tau0: float
    before: float  # pre-stress at distances up to STEP_POSITION
    patch_half_length: float  # of the region without friction


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the rows of two parts of the study, which the column part names.

    position : the slip that each pulse leaves (pulse_slip) on the fine grid, one row for each
        position, and the slip on the coarse grid (coarse_slip)
    run : one row for each pulse, with its slip at the last position, the relative change of slip
        since the first position on both grids (change, coarse_change), and the largest relative
        difference between the slips of the pulses at one level (spread)

    A pulse that has died leaves no slip.
    """
    thick = [Pulse(THICK_LEVEL, THICK_LEVEL, length) for length in THICK_HALF_LENGTHS]
    thin = [
        Pulse(level, ratio * level, THIN_HALF_LENGTH)
        for level in THIN_LEVELS
        for ratio in RELATIVE_LEVELS_BEFORE
    ]
    positions = [slips_on_both_grids(THICK, pulse) for pulse in thick]
    positions += [slips_on_both_grids(THIN, pulse) for pulse in thin]
    runs = pd.DataFrame([numbers_of_run(rows) for rows in positions])
    at_level = runs.groupby(["thickness", "tau0"])["pulse_slip"]
    runs["spread"] = at_level.transform("max") / at_level.transform("min") - 1.0
    all_positions = pd.concat(positions).assign(part="position")
    return pd.concat([all_positions, runs.assign(part="run")], ignore_index=True)


def slips_on_both_grids(layer: Layer, pulse: Pulse) -> pd.DataFrame:
    """Return one row for each position, with the parameters and the slip on both grids."""
    coarse_cells, fine_cells = layer.cells
    return pd.DataFrame(
        {
            "thickness": layer.thickness,
            **vars(pulse),
            "rate": RATE,
            "weakening": WEAKENING,
            "cells": fine_cells,
            "sample_position": layer.positions,
            "pulse_slip": slips(layer, pulse, fine_cells),
            "coarse_slip": slips(layer, pulse, coarse_cells),
        }
    )


def numbers_of_run(rows: pd.DataFrame) -> pd.Series:
    """Return the last row of a pulse, with the relative changes of slip since the first one."""
    first, last = rows.iloc[0], rows.iloc[-1]
    changes = {
        "first_slip": first["pulse_slip"],
        "change": last["pulse_slip"] / first["pulse_slip"] - 1.0,
        "coarse_change": last["coarse_slip"] / first["coarse_slip"] - 1.0,
    }
    return pd.concat([last, pd.Series(changes)])


def slips(layer: Layer, pulse: Pulse, cells: int) -> np.ndarray:
    """Simulate one pulse, and return its slip at each position of the layer.

    cells : number of cells per unit of length

    Raises ValueError if a point still slides when waves may have returned from the top of the thick
    layer, or at the end in the thin one.
    """
    thickness = layer.thickness
    # The layer is simulated in units of its own thickness.
    step = STEP_POSITION / thickness
    steps = ((step, pulse.tau0), (-step, pulse.tau0)) if pulse.before != pulse.tau0 else ()
    scene = LayerScene(
        "displacement",
        GAMMA,
        Prestress(pulse.before, pulse.before, width=None, steps=steps),
        WEAKENING / thickness,
        layer.duration / thickness,
        round(cells * thickness),
        pulse.patch_half_length / thickness,
        rate=RATE,
        trail=layer.trail / thickness,
    )
    run = simulate_layer(scene)
    positions = np.array(layer.positions)
    nodes = np.abs(thickness * run.x - positions[:, np.newaxis]).argmin(axis=1)
    slip, stick_times = thickness * run.slip[nodes], thickness * run.stick_time[nodes]
    # A wave from the nucleation returns from the top of the thick layer after this time.
    returns = np.hypot(positions, 2.0 * thickness) if layer is THICK else layer.duration
    for position in positions[(slip > 0.0) & ~(stick_times < returns)]:
        raise ValueError(f"{pulse} in a layer of {thickness:g}: still slides at {position:g}")
    return slip
