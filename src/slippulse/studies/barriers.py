"""Pulses sent into barriers: how deep they come, at several spacings, and past which barriers."""

import math
from itertools import product

import numpy as np
import pandas as pd

from ..model.prestress import Prestress
from ..model.scene import Scene
from ..solver.run import run_scene
from ..theory.front_law import front_speed
from ..theory.pulse import pulse_behind_front
from ..theory.slow_front import barrier_depth, barrier_depth_estimate

NEEDS = {}  # type: dict[str, list[str]]

# Without damping, and that of the paper's figures.
DAMPING_RATIOS = (0.0, 0.1)
# Every pair of levels before and in the barrier, each with one of the gammas as in a Latin square.
LEVELS, BARRIERS, GAMMAS = (0.3, 0.5, 0.65, 0.8), (-0.2, -0.5, -1.0), (0.3, 0.65, 1.0)
# Three spacings show the order of convergence.
SPACINGS = (0.04, 0.02, 0.01)
# Of the map of exact depths, the barriers about evenly in their logarithm.
MAP_LEVELS = (0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9)
MAP_BARRIERS = (-1.3, -0.85, -0.55, -0.36, -0.23, -0.15, -0.1)
# Lengths of barriers over the exact depth, about it; and a spacing at which a block is less than the difference.
LENGTHS, PASSING_SPACING = (0.8, 0.95, 1.05, 1.2), 0.0125
# Widths of the Gaussian after which the pre-stress is its level, and a width small enough for every pulse.
TAIL, WIDTH = 5.0, 1.0
# A pulse dies or passes before a wave would have gone this many times as deep.
CROSSINGS = 4.0


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Exact depths, lattice depths at each spacing, and barriers shorter and longer than the depth.

    Returns rows of part "map": tau0, barrier, damping_ratio, exact (depth at gamma = 1; it scales like 1/sqrt(gamma))
    and paper (the later estimate; it scales like 1/gamma); "depth": gamma and dx too, measured, exact, paper;
    "passing": length (of the barrier, over the exact depth), measured (1 where the front went past, 0 where it did not)

    Source: `barrier_depth`; lattice runs whose barrier lies where the pulse is steady, by its finite memory.
    """
    rows, passing = [], []
    for ratio, tau0, barrier in product(DAMPING_RATIOS, MAP_LEVELS, MAP_BARRIERS):
        point = {"part": "map", "tau0": tau0, "barrier": barrier, "gamma": 1.0, "damping_ratio": ratio}
        exact, estimate = barrier_depth(tau0, barrier, 1.0, ratio), barrier_depth_estimate(tau0, barrier, 1.0)
        rows.append(point | {"exact": exact, "paper": estimate})
    for (row, tau0), (column, barrier), ratio in product(
        enumerate(LEVELS), enumerate(BARRIERS), DAMPING_RATIOS
    ):
        gamma = GAMMAS[(row + column) % len(GAMMAS)]
        exact = barrier_depth(tau0, barrier, gamma, ratio)
        pair = {"tau0": tau0, "barrier": barrier, "gamma": gamma, "damping_ratio": ratio, "exact": exact}
        estimate = barrier_depth_estimate(tau0, barrier, gamma)
        for dx in SPACINGS:
            depth = entered(tau0, gamma, ratio, dx, exact, (0.0, barrier))
            rows.append({"part": "depth", **pair, "dx": dx, "measured": depth, "paper": estimate})
        for length in LENGTHS:
            dx = PASSING_SPACING
            depth = entered(tau0, gamma, ratio, dx, exact, (0.0, barrier), (length * exact, tau0))
            went_past = float(depth > (length + 0.5) * exact)
            passing.append({"part": "passing", **pair, "dx": dx, "length": length, "measured": went_past})
    return pd.DataFrame(rows + passing)


def entered(
    tau0: float, gamma: float, ratio: float, dx: float, exact: float, *steps: tuple[float, float]
) -> float:
    """How far the right front of a lattice enters a barrier, to half a block beyond the last released one.

    The pre-stress has ``steps``, counted from where the barrier begins, on both sides: between two blocks, and farther
    out than the pulse remembers its nucleation. ``exact`` is about how far the front comes.
    """
    speed = float(front_speed(tau0, ratio))
    width = pulse_behind_front(tau0, gamma, 0.0, speed).width
    start = (math.floor((TAIL * WIDTH + width / (speed - 1.0)) / dx) + 0.5) * dx
    both = tuple((sign * (start + position), level) for sign in (1.0, -1.0) for position, level in steps)
    profile, duration = Prestress(tau0, tau0, WIDTH, steps=both), start + CROSSINGS * exact + width
    run = run_scene(Scene("displacement", profile, duration, dx, gamma, ratio * dx, max_step=0.5, order=4))
    return float(run.x[np.isfinite(run.release_time)].max()) + 0.5 * dx - start
