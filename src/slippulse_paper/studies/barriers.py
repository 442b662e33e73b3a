"""Measure how deep pulses enter barriers of negative pre-stress, and which barriers they pass.

The depths come from exact theory and from lattices of three spacings.
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
# Each pair of levels (before and in the barrier) has one of the gammas, as in a Latin square.
LEVELS, BARRIERS = (0.3, 0.5, 0.65, 0.8), (-0.2, -0.5, -1.0)
GAMMAS = (0.3, 0.65, 1.0)
# Three spacings show the order of convergence.
SPACINGS = (0.04, 0.02, 0.01)
# Barrier levels in the map of exact depths are spaced about evenly in their logarithm.
MAP_LEVELS = (0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9)
MAP_BARRIERS = (-1.3, -0.85, -0.55, -0.36, -0.23, -0.15, -0.1)
# Barrier lengths divided by the exact depth. At this spacing a block is shorter than the
# differences between these lengths and the depth.
RELATIVE_LENGTHS, PASSING_SPACING = (0.8, 0.95, 1.05, 1.2), 0.0125
# Beyond TAIL_WIDTHS widths of the Gaussian the pre-stress is taken as its level.
TAIL_WIDTHS, GAUSSIAN_WIDTH = 5.0, 1.0
# A pulse has died or passed before a wave has run this many times the exact depth.
DURATION_IN_CROSSINGS = 4.0


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the parts map (depths at gamma = 1), depth (lattices) and passing (short barriers)."""
    rows, passing = [], []
    for ratio, tau0, barrier in product(DAMPING_RATIOS, MAP_LEVELS, MAP_BARRIERS):
        rows.append(depths(tau0, barrier, 1.0, ratio))
    pairs = product(enumerate(LEVELS), enumerate(BARRIERS), DAMPING_RATIOS)
    for (line, tau0), (column, barrier), ratio in pairs:
        known = depths(tau0, barrier, GAMMAS[(line + column) % len(GAMMAS)], ratio)
        pulse = steady_pulse(tau0, known["gamma"], damping_ratio=ratio)
        for dx in SPACINGS:
            depth = depth_on_lattice(known, pulse, dx, (0.0, barrier))
            rows.append(known | {"part": "depth", "dx": dx, "measured": depth})
        passes = known | {"part": "passing", "paper": math.nan, "dx": PASSING_SPACING}
        for length in RELATIVE_LENGTHS:
            steps = (0.0, barrier), (length * known["exact"], tau0)
            depth = depth_on_lattice(known, pulse, PASSING_SPACING, *steps)
            went_past = float(depth > (length + 0.5) * known["exact"])
            passing.append(passes | {"length": length, "measured": went_past})
    return pd.DataFrame(rows + passing)


def depths(tau0: float, barrier: float, gamma: float, ratio: float) -> dict[str, Any]:
    """Return a row of the map, which is also the beginning of a row of the other parts."""
    row = {"part": "map", "tau0": tau0, "barrier": barrier, "gamma": gamma, "damping_ratio": ratio}
    exact = barrier_depth(tau0, barrier, gamma, ratio)
    return row | {"exact": exact, "paper": barrier_depth_estimate(tau0, barrier, gamma)}


def depth_on_lattice(
    known: dict[str, Any], pulse: SteadyPulse, dx: float, *steps: tuple[float, float]
) -> float:
    """Return the depth of a pulse in a barrier, half a block beyond the last released block.

    The pre-stress has ``steps``, counted from where the barrier begins, on both sides. It begins
    between two blocks, and farther out than the pulse remembers its nucleation.
    """
    tau0, gamma = known["tau0"], known["gamma"]
    start = (
        math.floor((TAIL_WIDTHS * GAUSSIAN_WIDTH + pulse.width / (pulse.speed - 1.0)) / dx) + 0.5
    ) * dx
    right = [(start + position, level) for position, level in steps]
    left = [(-position, level) for position, level in right]
    profile = Prestress(tau0, tau0, GAUSSIAN_WIDTH, steps=(*right, *left))
    duration = start + DURATION_IN_CROSSINGS * known["exact"] + pulse.width
    beta = known["damping_ratio"] * dx
    scene = Scene("displacement", profile, duration, dx, gamma, beta, max_step=0.5, order=4)
    run = solve_on_lattice(scene)
    return float(run.x[np.isfinite(run.release_time)].max()) + 0.5 * dx - start
