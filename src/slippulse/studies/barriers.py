"""Pulses sent into barriers: how deep they come, at several spacings, and past which barriers."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import lru_cache
from itertools import product

import numpy as np
import pandas as pd

from ..model.prestress import Prestress
from ..model.scene import Scene
from ..solver.run import run_scene
from ..theory.barrier import barrier_depth, barrier_depth_estimate
from ..theory.front_law import front_speed
from ..theory.pulse import steady_pulse

# What it is made from besides its own section of `studies`.
NEEDS = {}

# Widths of the Gaussian after which the pre-stress is its level, and a width small enough for every pulse.
TAIL, WIDTH = 5.0, 1.0
# A pulse dies or passes before a wave would have gone so many times as deep.
CROSSINGS = 4.0


def table(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Exact depths, lattice depths at each spacing, and barriers shorter and longer than the depth.

    Parameters
    ----------
    settings : `studies.barriers` of the configuration

    Returns
    -------
    rows of part "map": tau0, barrier, damping_ratio, exact (depth at gamma = 1; it scales like 1/sqrt(gamma));
    "depth": gamma and dx too, measured, exact, paper (the later estimate); "passing": length (of the barrier,
    over the exact depth), measured (1 where the front went past, 0 where it did not)

    Source: `barrier_depth`; lattice runs whose barrier lies where the pulse is steady, by its finite memory.
    """
    rows = [*_map(settings), *_depths(settings), *_passing(settings)]
    return pd.DataFrame(rows)


@lru_cache(maxsize=512)
def _depth(tau0: float, barrier: float, ratio: float) -> float:
    """Exact depth at gamma = 1."""
    return barrier_depth(tau0, barrier, 1.0, ratio)


def _map(settings: Mapping) -> Iterator[dict]:
    rule = settings["map"]
    for ratio, tau0, barrier in product(settings["damping_ratios"], rule["levels"], rule["barriers"]):
        row = {"part": "map", "tau0": tau0, "barrier": barrier, "gamma": 1.0, "damping_ratio": ratio}
        yield row | {"exact": _depth(tau0, barrier, ratio)}


def _pairs(settings: Mapping) -> Iterator[tuple[float, float, float, float]]:
    """tau0, barrier, gamma and damping ratio: every pair of levels, with gammas as in a Latin square."""
    for row, tau0 in enumerate(settings["levels"]):
        for column, barrier in enumerate(settings["barriers"]):
            for ratio in settings["damping_ratios"]:
                yield tau0, barrier, settings["gamma"][(row + column) % len(settings["gamma"])], ratio


def _depths(settings: Mapping) -> Iterator[dict]:
    for tau0, barrier, gamma, ratio in _pairs(settings):
        exact = _depth(tau0, barrier, ratio) / math.sqrt(gamma)
        for dx in settings["dx"]:
            place = edge(tau0, gamma, ratio, dx)
            yield {
                "part": "depth", "tau0": tau0, "barrier": barrier, "gamma": gamma, "damping_ratio": ratio, "dx": dx,
                "measured": reach(tau0, gamma, ratio, dx, ((place, barrier),), exact) - place, "exact": exact,
                "paper": barrier_depth_estimate(tau0, barrier, gamma),
            }  # fmt: skip


def _passing(settings: Mapping) -> Iterator[dict]:
    rule = settings["passing"]
    for tau0, barrier, gamma, ratio in _pairs(settings):
        exact = _depth(tau0, barrier, ratio) / math.sqrt(gamma)
        for share in rule["shares"]:
            place = edge(tau0, gamma, ratio, rule["dx"])
            steps = ((place, barrier), (place + share * exact, tau0))
            far = reach(tau0, gamma, ratio, rule["dx"], steps, exact) - place
            yield {
                "part": "passing", "tau0": tau0, "barrier": barrier, "gamma": gamma, "damping_ratio": ratio,
                "dx": rule["dx"], "length": share, "exact": exact, "measured": float(far > share * exact + 0.5 * exact),
            }  # fmt: skip


def edge(tau0: float, gamma: float, ratio: float, dx: float) -> float:
    """Where the barrier begins: between two blocks, and farther than the pulse remembers its nucleation."""
    speed = float(front_speed(tau0, ratio))
    memory = steady_pulse(tau0, gamma, 0.0, speed).width / (speed - 1.0)
    return (math.floor((TAIL * WIDTH + memory) / dx) + 0.5) * dx


def reach(
    tau0: float, gamma: float, ratio: float, dx: float, steps: tuple[tuple[float, float], ...], beyond: float
) -> float:
    """How far the right front of a lattice comes, half a block beyond the last released one.

    Parameters
    ----------
    tau0, gamma, ratio, dx : the scene, with a Gaussian of width WIDTH
    steps : of the pre-stress on the right; the left has the same
    beyond : about how far it comes beyond the first step
    """
    mirrored = tuple((-place, level) for place, level in steps)
    profile = Prestress(tau0, tau0, WIDTH, steps=steps + mirrored)
    width = steady_pulse(tau0, gamma, 0.0, float(front_speed(tau0, ratio))).width
    duration = steps[0][0] + CROSSINGS * beyond + width
    scene = Scene("displacement", profile, duration, dx, gamma, ratio * dx, max_step=0.5, order=4)
    run = run_scene(scene)
    return float(run.x[np.isfinite(run.release_time)].max()) + 0.5 * dx
