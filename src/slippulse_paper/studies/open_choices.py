"""Compute the exact transitions of figure 5 at every combination of open choices."""

import numpy as np
import pandas as pd

from slippulse.model.prestress import Prestress
from slippulse.theory.arrest import ArrestingCrack
from slippulse.theory.closed_pulse import paper_transition_displacement
from slippulse.theory.front_speeds import front_speed
from slippulse.theory.part import Part
from slippulse.theory.two_fronts import fast_fronts

from ..configuration.runs import parameters

NEEDS = {
    "lists": ["manuscript/open_choices.yaml"],
    "sweeps": ["scaling_displacement", "scaling_stress"],
}

# Upper bound of the time of the first stick, divided by pi/sqrt(gamma).
LATEST_FIRST_STICK = 1.7
# A Gaussian is 0 to rounding beyond this number of its widths.
GAUSSIAN_REACH = 12.0
# Nodes and weights of the integral for the time that a front takes to cross a tent.
TENT_NODES, TENT_WEIGHTS = np.polynomial.legendre.leggauss(24)
# Columns of the paper's estimates.
PAPER_COLUMNS = ["paper_transition_time", "paper_transition_length"]


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return exact transitions and the paper's estimates, for each run of figure 5 and choice."""
    sweeps = (parameters(settings["sweeps"][name]) for name in NEEDS["sweeps"])
    springs, cracks = map(pd.DataFrame, sweeps)
    springs, cracks = springs.query("left > 0"), cracks.query("left < 0")
    choices = tables["open_choices"].groupby("choice")
    values = choices.get_group("fraction")["value"]
    fractions = [value for value in values if isinstance(value, float)]
    parts = []
    for ratio, release in choices.get_group("damping_ratio")[["value", "release"]].values:
        both = displacement(springs, ratio, release), stress(cracks, ratio, release, fractions)
        parts += [rows.assign(damping_ratio=ratio, release=release) for rows in both]
    return pd.concat(parts, ignore_index=True)


def displacement(grid: pd.DataFrame, ratio: float, release: str) -> pd.DataFrame:
    """Return the first sticks of symmetric scenes at x = 0; all gammas share the same fronts."""
    parts = []
    for (left, width), rows in grid.groupby(["left", "width"]):
        gammas = rows["gamma"].to_numpy()
        latest = LATEST_FIRST_STICK * np.pi / np.sqrt(gammas)
        # The past cone of (0, t) begins at x + T(x) = t, so x < t.
        reach = max(float(latest.max()), 2.0 * GAUSSIAN_REACH * width)
        fronts = fast_fronts(Prestress(left, left, width), ratio, release, reach, gammas.max())
        both = zip(gammas, latest, strict=True)
        times = np.array(
            [float(Part(fronts, *one).find_stick_times(np.zeros(1))[0]) for one in both]
        )
        # The pre-stress is uniform beyond the Gaussian.
        uniform_from = GAUSSIAN_REACH * width
        time_beyond = times - fronts.arrival(uniform_from)
        positions = uniform_from + float(front_speed(left, ratio, release)) * time_beyond
        for i in np.flatnonzero(positions <= uniform_from):
            positions[i] = fronts.front_at(times[i], 0.0, 1.0)
        rows = rows[["boundary"]].assign(nucleation="Gaussian", left=left, width=width)
        rows = rows.assign(gamma=gammas, transition_time=times, transition_length=2.0 * positions)
        rows[PAPER_COLUMNS] = [paper_transition_displacement(left, gamma) for gamma in gammas]
        parts.append(rows)
    return pd.concat(parts)


def stress(grid: pd.DataFrame, ratio: float, release: str, fractions: list[float]) -> pd.DataFrame:
    """Return arrests at each fraction of |x_minus|; for a finite tail also at the whole of it.

    W is the only length without leaf springs: every number of a level is proportional to it.
    """
    # A tent has half-width 1 on both sides of x = 0: the last characteristic enters at its end.
    crossing = (
        float(TENT_WEIGHTS @ (1.0 / front_speed(0.5 + 0.5 * TENT_NODES, ratio, release))) / 2.0
    )
    columns = ["nucleation", "fraction", "transition_time", "transition_length", *PAPER_COLUMNS]
    parts = []
    for left, rows in grid.groupby("left"):
        crack = ArrestingCrack(Prestress(left, 0.0), ratio, release)
        way = -crack.balance_position
        arrests = []
        for part in fractions:
            arrests.append(("Gaussian", part, *crack.transition(part), way, 2.0 * way))
        # The stress of the tent is 1/2 on the right and (1 + left)/2 on the left of x = 0.
        way = 1.0 + (1.0 + 0.5 * left) / -left
        # Beyond x = 1 the right front runs at the wave speed.
        arrests.append(("tent", 1.0, way + 1.0 + crossing, 2.0 * way + 2.0, way, 2.0 * way))
        scenes = rows[["boundary", "left", "width"]]
        rows = scenes.merge(pd.DataFrame(arrests, columns=columns), how="cross")
        rows[columns[2:]] = rows[columns[2:]].mul(rows["width"], axis=0)
        parts.append(rows)
    return pd.concat(parts)
