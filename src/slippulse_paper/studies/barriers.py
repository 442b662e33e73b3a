"""Measure how deep pulses enter barriers, and which barriers they pass.

A barrier is a stretch of negative pre-stress. Depths come from exact theory and from lattices.
"""

import math
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from slippulse.model.prestress import Prestress
from slippulse.model.scene import Scene
from slippulse.solver.solution import solve_on_lattice
from slippulse.theory.barrier import barrier_depth, barrier_depth_estimate
from slippulse.theory.closed_pulse import SteadyPulse
from slippulse.theory.pulse import steady_pulse

NEEDS = {"settings": ()}

# No damping, and the damping ratio of the paper's figures.
DAMPING_RATIOS = (0.0, 0.1)
# Lattices: levels of pre-stress before the barrier and in it. Each pair of them has one of the
# gammas. Three spacings show the order of convergence.
LEVELS = (0.3, 0.5, 0.65, 0.8)
BARRIERS = (-0.2, -0.5, -1.0)
GAMMAS = (0.3, 0.65, 1.0)
SPACINGS = (0.04, 0.02, 0.01)
# Map of exact depths: its gamma and both levels. Those in the barrier are spaced about evenly in
# their logarithm.
MAP_GAMMA = 1.0
MAP_LEVELS = (0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9)
MAP_BARRIERS = (-1.3, -0.85, -0.55, -0.36, -0.23, -0.15, -0.1)
# Barriers that a pulse passes or not: their lengths divided by the exact depth, and the spacing of
# the lattice. A block is shorter than the differences between these lengths and the depth.
RELATIVE_LENGTHS = (0.8, 0.95, 1.05, 1.2)
PASSING_SPACING = 0.0125
# The nucleation is a Gaussian of this width. Beyond TAIL_WIDTHS widths from its middle the
# pre-stress is practically equal to the level.
GAUSSIAN_WIDTH = 1.0
TAIL_WIDTHS = 5.0
# After it has met the barrier, a pulse dies or passes within the time in which a wave runs this
# many times the exact depth.
DURATION_IN_CROSSINGS = 4.0


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the rows of three parts of the study. The column ``part`` has these values:

    map : exact and estimated depths, by the levels before the barrier and in it
    depth : depth of a barrier without end, exact and on lattices, by spacing
    passing : barriers of several lengths, each divided by the exact depth; measured is 1 if the
        pulse has passed, else 0
    """
    map_rows = [
        exact_row(tau0, barrier, MAP_GAMMA, damping_ratio)
        for damping_ratio, tau0, barrier in product(DAMPING_RATIOS, MAP_LEVELS, MAP_BARRIERS)
    ]
    depth_rows: list[dict] = []
    passing_rows: list[dict] = []
    for tau0, barrier, damping_ratio in product(LEVELS, BARRIERS, DAMPING_RATIOS):
        # The gammas take turns, so that each of them occurs with each barrier level.
        index = LEVELS.index(tau0) + BARRIERS.index(barrier)
        gamma = GAMMAS[index % len(GAMMAS)]
        case = exact_row(tau0, barrier, gamma, damping_ratio)
        pulse = steady_pulse(tau0, gamma, damping_ratio=damping_ratio)
        depth_rows += rows_by_spacing(case, pulse)
        passing_rows += rows_by_length(case, pulse)
    return pd.DataFrame(map_rows + depth_rows + passing_rows)


def rows_by_spacing(case: dict[str, Any], pulse: SteadyPulse) -> list[dict[str, Any]]:
    """Return the depth to which a pulse enters a barrier without end, for each spacing.

    case : a row of `exact_row`, with the parameters and the exact depth
    pulse : the exact steady pulse before the barrier
    """
    rows = []
    for dx in SPACINGS:
        depth = penetration_on_lattice(case, pulse, dx, barrier_length=math.inf)
        rows.append(case | {"part": "depth", "dx": dx, "measured": depth})
    return rows


def rows_by_length(case: dict[str, Any], pulse: SteadyPulse) -> list[dict[str, Any]]:
    """Return one row for each length of a barrier, with whether a pulse passes it.

    The column length has the length divided by the exact depth, from RELATIVE_LENGTHS. The column
    measured is 1 if the pulse passes, else 0.

    case : a row of `exact_row`, with the parameters and the exact depth
    pulse : the exact steady pulse before the barrier
    """
    rows = []
    for relative_length in RELATIVE_LENGTHS:
        has_passed = passes(case, pulse, relative_length)
        row = {"part": "passing", "dx": PASSING_SPACING, "length": relative_length}
        # The column paper would have the estimate of the depth, which is not measured here.
        row |= {"measured": float(has_passed), "paper": math.nan}
        rows.append(case | row)
    return rows


def exact_row(tau0: float, barrier: float, gamma: float, damping_ratio: float) -> dict[str, Any]:
    """Return the depth to which a pulse enters a barrier, as a row of the map.

    Rows of the other parts are copies of such a row with more columns. The column exact has the
    depth by exact theory. The column paper has an estimate that the authors use in later code.

    tau0 : pre-stress before the barrier, in which the pulse is steady
    barrier : negative pre-stress in the barrier
    """
    return {
        "part": "map",
        "tau0": tau0,
        "barrier": barrier,
        "gamma": gamma,
        "damping_ratio": damping_ratio,
        "exact": barrier_depth(tau0, barrier, gamma, damping_ratio),
        "paper": barrier_depth_estimate(tau0, barrier, gamma),
    }


def passes(case: dict[str, Any], pulse: SteadyPulse, relative_length: float) -> bool:
    """Return True if a pulse on a lattice passes a barrier.

    case : a row of `exact_row`, with the parameters and the exact depth
    pulse : the exact steady pulse before the barrier
    relative_length : length of the barrier divided by the exact depth
    """
    exact_depth = case["exact"]
    length = relative_length * exact_depth
    distance = penetration_on_lattice(case, pulse, PASSING_SPACING, barrier_length=length)
    # A pulse that has passed goes on far beyond the end of the barrier, and one that has not passed
    # ends in the barrier.
    return distance > length + 0.5 * exact_depth


def penetration_on_lattice(
    case: dict[str, Any], pulse: SteadyPulse, dx: float, barrier_length: float
) -> float:
    """Return how far a pulse on a lattice goes on after it has met a barrier.

    The pulse ends half a block beyond the last released block.

    case : a row of `exact_row`, with the parameters and the exact depth
    pulse : the exact steady pulse before the barrier
    """
    # The pulse must have forgotten its nucleation before it meets the barrier. A pulse remembers
    # what it met within this distance.
    memory = pulse.width / (pulse.speed - 1.0)
    steady_from = TAIL_WIDTHS * GAUSSIAN_WIDTH + memory
    # The barrier begins halfway between two blocks.
    start = (math.floor(steady_from / dx) + 0.5) * dx
    tau0 = case["tau0"]
    # The levels of the pre-stress beyond the positions x = start and x = start + barrier_length.
    steps_on_the_right = [(start, case["barrier"])]
    if math.isfinite(barrier_length):
        steps_on_the_right.append((start + barrier_length, tau0))
    steps_on_the_left = [(-position, level) for position, level in steps_on_the_right]
    prestress = Prestress(
        tau0, tau0, GAUSSIAN_WIDTH, steps=(*steps_on_the_right, *steps_on_the_left)
    )
    scene = Scene(
        boundary="displacement",
        prestress=prestress,
        duration=start + DURATION_IN_CROSSINGS * case["exact"] + pulse.width,
        dx=dx,
        gamma=case["gamma"],
        beta=case["damping_ratio"] * dx,
        max_step=0.5,
        order=4,
    )
    run = solve_on_lattice(scene)
    last_released = float(run.x[np.isfinite(run.release_time)].max())
    return last_released + 0.5 * dx - start
