"""Measure how deep pulses enter barriers of negative pre-stress, and which barriers they pass.

The depths come from exact theory and from lattices of three spacings.
"""

import math
from collections.abc import Sequence
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
# Each pair of levels (before and in the barrier) has one of the gammas, as in a Latin square.
LEVELS = (0.3, 0.5, 0.65, 0.8)
BARRIERS = (-0.2, -0.5, -1.0)
GAMMAS = (0.3, 0.65, 1.0)
# Three spacings show the order of convergence.
SPACINGS = (0.04, 0.02, 0.01)
# Barrier levels in the map of exact depths are spaced about evenly in their logarithm.
MAP_LEVELS = (0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9)
MAP_BARRIERS = (-1.3, -0.85, -0.55, -0.36, -0.23, -0.15, -0.1)
# Barrier lengths divided by the exact depth. At this spacing a block is shorter than the
# differences between these lengths and the depth.
RELATIVE_LENGTHS = (0.8, 0.95, 1.05, 1.2)
PASSING_SPACING = 0.0125
# Beyond TAIL_WIDTHS widths of the Gaussian the pre-stress is taken as its level.
GAUSSIAN_WIDTH = 1.0
TAIL_WIDTHS = 5.0
# A pulse has died or passed before a wave has run this many times the exact depth.
DURATION_IN_CROSSINGS = 4.0


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the rows of three parts of the study, which the column part names.

    map : exact depths and the paper's estimates at gamma = 1, by both levels
    depth : depth of a barrier without end, exact and on lattices, by spacing
    passing : barriers of several lengths; measured is 1 if the pulse has passed, else 0
    """
    map_rows = [
        exact_row(tau0, barrier, 1.0, ratio)
        for ratio, tau0, barrier in product(DAMPING_RATIOS, MAP_LEVELS, MAP_BARRIERS)
    ]
    depth_rows, passing_rows = [], []
    pairs_of_levels = product(enumerate(LEVELS), enumerate(BARRIERS), DAMPING_RATIOS)
    for (line, tau0), (column, barrier), ratio in pairs_of_levels:
        gamma = GAMMAS[(line + column) % len(GAMMAS)]
        exact = exact_row(tau0, barrier, gamma, ratio)
        pulse = steady_pulse(tau0, gamma, damping_ratio=ratio)
        for dx in SPACINGS:
            depth = depth_on_lattice(exact, pulse, dx, [(0.0, barrier)])
            depth_rows.append(exact | {"part": "depth", "dx": dx, "measured": depth})
        for relative_length in RELATIVE_LENGTHS:
            went_past = passes(exact, pulse, relative_length)
            row = {"part": "passing", "paper": math.nan, "dx": PASSING_SPACING}
            row |= {"length": relative_length, "measured": float(went_past)}
            passing_rows.append(exact | row)
    return pd.DataFrame(map_rows + depth_rows + passing_rows)


def exact_row(tau0: float, barrier: float, gamma: float, ratio: float) -> dict[str, Any]:
    """Return a row of the map, which is also the beginning of a row of the other parts.

    The columns exact and paper are depths, by exact theory and by the paper's estimate.

    tau0 : pre-stress before the barrier, in which the pulse is steady
    barrier : negative pre-stress in the barrier
    """
    return {
        "part": "map",
        "tau0": tau0,
        "barrier": barrier,
        "gamma": gamma,
        "damping_ratio": ratio,
        "exact": barrier_depth(tau0, barrier, gamma, ratio),
        "paper": barrier_depth_estimate(tau0, barrier, gamma),
    }


def passes(exact: dict[str, Any], pulse: SteadyPulse, relative_length: float) -> bool:
    """Return True if a pulse on a lattice passes a barrier with this length.

    exact : a row of `exact_row`, with the parameters and the exact depth
    relative_length : length of the barrier divided by the exact depth
    """
    exact_depth = exact["exact"]
    length = relative_length * exact_depth
    steps = [(0.0, exact["barrier"]), (length, exact["tau0"])]
    depth = depth_on_lattice(exact, pulse, PASSING_SPACING, steps)
    return depth > (relative_length + 0.5) * exact_depth


def depth_on_lattice(
    exact: dict[str, Any], pulse: SteadyPulse, dx: float, steps: Sequence[tuple[float, float]]
) -> float:
    """Return how far a pulse on a lattice enters a barrier.

    This is the distance from the beginning of the barrier to half a block beyond the last released
    block.

    exact : a row of `exact_row`, with the parameters and the exact depth
    steps : distances from the beginning of the barrier, and the pre-stress from there on
    """
    tau0, gamma, exact_depth = exact["tau0"], exact["gamma"], exact["exact"]
    # The barrier begins between two blocks, and farther out than the pulse remembers its
    # nucleation.
    memory = pulse.width / (pulse.speed - 1.0)
    undisturbed = TAIL_WIDTHS * GAUSSIAN_WIDTH + memory
    start = (math.floor(undisturbed / dx) + 0.5) * dx
    on_the_right = [(start + distance, level) for distance, level in steps]
    on_the_left = [(-position, level) for position, level in on_the_right]
    scene = Scene(
        boundary="displacement",
        prestress=Prestress(tau0, tau0, GAUSSIAN_WIDTH, steps=(*on_the_right, *on_the_left)),
        duration=start + DURATION_IN_CROSSINGS * exact_depth + pulse.width,
        dx=dx,
        gamma=gamma,
        beta=exact["damping_ratio"] * dx,
        max_step=0.5,
        order=4,
    )
    run = solve_on_lattice(scene)
    last_released = float(run.x[np.isfinite(run.release_time)].max())
    return last_released + 0.5 * dx - start
