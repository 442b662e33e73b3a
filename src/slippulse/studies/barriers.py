"""Pulses sent into barriers: how deep they come, at several spacings, and past which barriers."""

import math
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from ..model.prestress import Prestress
from ..model.scene import Scene
from ..solver.run import run_scene
from ..theory.front_speeds import steady_pulse
from ..theory.pulse import SteadyPulse
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
    """Rows of part "map": tau0, barrier, damping_ratio, exact (depth at gamma = 1; it scales like 1/sqrt(gamma)) and
    paper (the later estimate; it scales like 1/gamma); "depth": gamma and dx too, measured, exact, paper; "passing":
    length (of the barrier, over the exact depth), measured (1 where the front went past, 0 where it did not). Lattices
    have the barrier where the pulse is steady, by its finite memory.
    """
    rows, passing = [], []
    for ratio, tau0, barrier in product(DAMPING_RATIOS, MAP_LEVELS, MAP_BARRIERS):
        rows.append(depths(tau0, barrier, 1.0, ratio))
    for (row, tau0), (column, barrier), ratio in product(
        enumerate(LEVELS), enumerate(BARRIERS), DAMPING_RATIOS
    ):
        found = depths(tau0, barrier, GAMMAS[(row + column) % len(GAMMAS)], ratio)
        pulse = steady_pulse(tau0, found["gamma"], damping_ratio=ratio)
        for dx in SPACINGS:
            depth = entered(found, pulse, dx, (0.0, barrier))
            rows.append(found | {"part": "depth", "dx": dx, "measured": depth})
        for length in LENGTHS:
            depth = entered(
                found, pulse, PASSING_SPACING, (0.0, barrier), (length * found["exact"], tau0)
            )
            past = {"length": length, "measured": float(depth > (length + 0.5) * found["exact"])}
            passing.append(
                found | {"part": "passing", "paper": math.nan, "dx": PASSING_SPACING} | past
            )
    return pd.DataFrame(rows + passing)


def depths(tau0: float, barrier: float, gamma: float, ratio: float) -> dict[str, Any]:
    """A row of the map, or the beginning of another."""
    point = {
        "part": "map",
        "tau0": tau0,
        "barrier": barrier,
        "gamma": gamma,
        "damping_ratio": ratio,
    }
    estimate = barrier_depth_estimate(tau0, barrier, gamma)
    return point | {"exact": barrier_depth(tau0, barrier, gamma, ratio), "paper": estimate}


def entered(
    scene: dict[str, Any], pulse: SteadyPulse, dx: float, *steps: tuple[float, float]
) -> float:
    """How far the right front of a pulse enters a barrier on a lattice, to half a block beyond the last released one.

    The pre-stress has ``steps``, counted from where the barrier begins, on both sides: between two blocks, and farther
    out than the pulse remembers its nucleation.
    """
    tau0, gamma, ratio = (scene[name] for name in ("tau0", "gamma", "damping_ratio"))
    start = (math.floor((TAIL * WIDTH + pulse.width / (pulse.speed - 1.0)) / dx) + 0.5) * dx
    both = tuple(
        (sign * (start + position), level) for sign in (1.0, -1.0) for position, level in steps
    )
    profile = Prestress(tau0, tau0, WIDTH, steps=both)
    duration = start + CROSSINGS * scene["exact"] + pulse.width
    run = run_scene(
        Scene("displacement", profile, duration, dx, gamma, ratio * dx, max_step=0.5, order=4)
    )
    return float(run.x[np.isfinite(run.release_time)].max()) + 0.5 * dx - start
