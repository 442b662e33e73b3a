"""Compute the exact transitions of figure 5 at every combination of open choices.

The choices are those that the paper leaves open: damping ratio, release rule, and, under a stress
boundary, the nucleation and the fraction of its path at which the left front counts as arrested.
"""

from typing import NamedTuple

import numpy as np
import pandas as pd

from slippulse.model.prestress import Prestress
from slippulse.theory.arrest import ArrestingCrack
from slippulse.theory.closed_pulse import paper_transition_displacement
from slippulse.theory.curve import Curve
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


class Arrest(NamedTuple):
    """The arrest of the left front at W = 1, exact and by the paper's estimates.

    The paper estimates that both fronts cover the distance |x_minus| at speed 1.
    """

    nucleation: str
    fraction: float
    transition_time: float
    transition_length: float
    paper_transition_time: float
    paper_transition_length: float


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return exact transitions and the paper's estimates.

    There is one row for each run of figure 5 and each combination of choices.
    """
    with_springs, without_springs = (
        pd.DataFrame(parameters(settings["sweeps"][name])) for name in NEEDS["sweeps"]
    )
    with_springs = with_springs.query("left > 0")
    # Only in negative pre-stress does the left front arrest.
    without_springs = without_springs.query("left < 0")
    values_by_choice = tables["open_choices"].groupby("choice")
    fraction_choices = values_by_choice.get_group("fraction")["value"]
    # The choice "last release" is a text; it belongs to lattices.
    fractions = [value for value in fraction_choices if isinstance(value, float)]
    damping_choices = values_by_choice.get_group("damping_ratio")[["value", "release"]]
    parts = []
    for ratio, release in damping_choices.values:
        for rows in (
            displacement(with_springs, ratio, release),
            stress(without_springs, ratio, release, fractions),
        ):
            parts.append(rows.assign(damping_ratio=ratio, release=release))
    return pd.concat(parts, ignore_index=True)


def displacement(runs: pd.DataFrame, ratio: float, release: str) -> pd.DataFrame:
    """Return the transitions under a displacement boundary, which are first sticks at x = 0.

    runs : left (the level on both sides), width and gamma of each run
    """
    parts = []
    # Leaf springs do not change the fronts, so all runs of a level and width share them.
    for (level, width), group in runs.groupby(["left", "width"]):
        gammas = group["gamma"].to_numpy()
        latest_sticks = LATEST_FIRST_STICK * np.pi / np.sqrt(gammas)
        # The velocity at (0, t) depends on |x| with |x| + T(x) < t, where T is the release time,
        # so only on |x| < t.
        reach = max(float(latest_sticks.max()), 2.0 * GAUSSIAN_REACH * width)
        fronts = fast_fronts(Prestress(level, level, width), ratio, release, reach, gammas.max())
        times = []
        for gamma, until in zip(gammas, latest_sticks, strict=True):
            (stick_time,) = Part(fronts, gamma, until).find_stick_times(np.zeros(1))
            times.append(float(stick_time))
        positions = front_positions(fronts, np.array(times), level, width, ratio, release)
        rows = group[["boundary"]].assign(nucleation="Gaussian", left=level, width=width)
        rows["gamma"] = gammas
        rows["transition_time"] = times
        rows["transition_length"] = 2.0 * positions
        rows[PAPER_COLUMNS] = [paper_transition_displacement(level, gamma) for gamma in gammas]
        parts.append(rows)
    return pd.concat(parts)


def front_positions(
    fronts: Curve, times: np.ndarray, level: float, width: float, ratio: float, release: str
) -> np.ndarray:
    """Return the positions of the right front at some times.

    Beyond the Gaussian the pre-stress is uniform, and the front runs at a constant speed.
    """
    uniform_from = GAUSSIAN_REACH * width
    speed = float(front_speed(level, ratio, release))
    positions = uniform_from + speed * (times - fronts.arrival(uniform_from))
    for index in np.flatnonzero(positions <= uniform_from):
        positions[index] = fronts.front_at(times[index], 0.0, 1.0)
    return positions


def stress(runs: pd.DataFrame, ratio: float, release: str, fractions: list[float]) -> pd.DataFrame:
    """Return arrests under a stress boundary, for nucleation by a Gaussian and by a tent.

    For the Gaussian there is one row for each fraction of |x_minus|. A tent is a pre-stress that
    falls linearly from 1 at x = 0 to its level at a distance W. Its left front arrives at x_minus,
    so there is one row, with the fraction 1.

    runs : boundary, left (level on the left) and width W of each run. W is the only length without
        leaf springs, so all times and lengths of a level are proportional to it.
    """
    # All columns except the nucleation and the fraction are times and lengths.
    times_and_lengths = list(Arrest._fields[2:])
    parts = []
    for left, group in runs.groupby("left"):
        crack = ArrestingCrack(Prestress(left, 0.0), ratio, release)
        distance = -crack.balance_position
        arrests = []
        for fraction in fractions:
            time, length = crack.transition(fraction)
            arrest = Arrest(
                nucleation="Gaussian",
                fraction=fraction,
                transition_time=time,
                transition_length=length,
                paper_transition_time=distance,
                paper_transition_length=2.0 * distance,
            )
            arrests.append(arrest)
        arrests.append(tent_arrest(left, ratio, release))
        at_width_1 = pd.DataFrame(arrests)
        rows = group[["boundary", "left", "width"]].merge(at_width_1, how="cross")
        rows[times_and_lengths] = rows[times_and_lengths].mul(rows["width"], axis=0)
        parts.append(rows)
    return pd.concat(parts)


def tent_arrest(left: float, ratio: float, release: str) -> Arrest:
    """Return the arrest for nucleation by a tent with W = 1."""
    # On the right the pre-stress falls evenly from 1 to 0 over the distance 1, so the time in which
    # the right front crosses the tent is the mean slowness (1/speed) over these levels. The nodes
    # of the integration lie between -1 and 1.
    levels = 0.5 + 0.5 * TENT_NODES
    slownesses = 1.0 / front_speed(levels, ratio, release)
    crossing_time = float(TENT_WEIGHTS @ slownesses) / 2.0
    # The integral of the pre-stress is 1/2 on the right and (1 + left)/2 on the left of x = 0. The
    # negative level beyond the tent balances it at x_minus.
    tent_integral = 1.0 + 0.5 * left
    distance = 1.0 + tent_integral / -left
    # The last wave that drives the left front enters at the end of the tent on the right. Beyond
    # it the right front runs at the wave speed.
    return Arrest(
        nucleation="tent",
        fraction=1.0,
        transition_time=distance + 1.0 + crossing_time,
        transition_length=2.0 * distance + 2.0,
        paper_transition_time=distance,
        paper_transition_length=2.0 * distance,
    )
