"""Compute the exact transitions of figure 5 at every combination of open choices.

The paper leaves open the damping ratio and the release rule. Under a stress boundary it also leaves
open how the rupture starts (nucleation), and which fraction of its path the left front must have
covered to count as arrested.
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
# Beyond this number of its widths a Gaussian is smaller than rounding errors.
GAUSSIAN_END_IN_WIDTHS = 12.0
# Nodes and weights of Gauss-Legendre integration from -1 to 1.
GAUSS_NODES, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(24)
# Columns of the paper's estimates.
PAPER_COLUMNS = ["paper_transition_time", "paper_transition_length"]
# Columns of an arrest that are times or lengths.
ARREST_SIZES = ["transition_time", "transition_length", *PAPER_COLUMNS]


class Arrest(NamedTuple):
    """The arrest of the left front for a nucleation of width W = 1, exact and by the estimates.

    The transition length is the distance between the fronts at the transition time. By the paper's
    estimates, both fronts cover the distance |x_minus| at the wave speed, 1.

    nucleation : "Gaussian" or "tent"
    fraction : fraction of |x_minus| that the left front has covered
    """

    nucleation: str
    fraction: float
    transition_time: float
    transition_length: float
    paper_transition_time: float
    paper_transition_length: float


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return exact transitions and the paper's estimates.

    There is one row for each run of figure 5 and each combination of choices. The table
    ``open_choices`` lists the values of the damping ratio, with the release rule of each, and of
    the fraction. Both kinds of nucleation are added by `stress_arrests`.
    """
    with_springs = pd.DataFrame(parameters(settings["sweeps"]["scaling_displacement"]))
    # The exact transition is known if the level, the same on both sides, is positive.
    with_springs = with_springs.query("left > 0")
    without_springs = pd.DataFrame(parameters(settings["sweeps"]["scaling_stress"]))
    # The left front arrests only in negative pre-stress.
    without_springs = without_springs.query("left < 0")
    choices = tables["open_choices"]
    fraction_values = choices.loc[choices["choice"] == "fraction", "value"]
    # The value "last release" is a text. It exists for lattices only, so it is left out.
    fractions = [value for value in fraction_values if isinstance(value, float)]
    # Each damping ratio has its release rule.
    damping_choices = choices.loc[choices["choice"] == "damping_ratio", ["value", "release"]]
    parts = []
    for damping_ratio, release in damping_choices.values:
        transitions = displacement_transitions(with_springs, damping_ratio, release)
        arrests = stress_arrests(without_springs, damping_ratio, release, fractions)
        for rows in (transitions, arrests):
            parts.append(rows.assign(damping_ratio=damping_ratio, release=release))
    return pd.concat(parts, ignore_index=True)


def displacement_transitions(
    runs: pd.DataFrame, damping_ratio: float, release: str
) -> pd.DataFrame:
    """Return the transitions under a displacement boundary, and the paper's estimates of them.

    The transition is at the first stick, which is at x = 0. Its length is the distance between the
    fronts at that time.

    runs : left (the level on both sides), width of the Gaussian, and gamma of each run
    """
    parts = []
    # Leaf springs do not change the fronts, so all runs of a level and width share them.
    for (level, width), group in runs.groupby(["left", "width"]):
        gammas = group["gamma"].to_numpy()
        latest_sticks = LATEST_FIRST_STICK * np.pi / np.sqrt(gammas)
        # Beyond this position the pre-stress is uniform, and the front has a constant speed.
        uniform_from = GAUSSIAN_END_IN_WIDTHS * width
        speed = float(front_speed(level, damping_ratio, release))
        # Waves run at speed 1, so up to the time t only the fronts at |x| < t influence x = 0.
        # Where the pre-stress is uniform, the curve of the fronts is continued as a straight line,
        # so it must reach beyond ``uniform_from``.
        reach = max(float(latest_sticks.max()), 2.0 * uniform_from)
        # The front curve is divided so finely that it resolves the waves at the largest gamma.
        prestress = Prestress(level, level, width)
        fronts = fast_fronts(prestress, damping_ratio, release, reach=reach, gamma=gammas.max())
        times = stick_times_of_centre(fronts, gammas, latest_sticks)
        right_fronts = right_front_positions(fronts, times, speed=speed, uniform_from=uniform_from)
        rows = group[["boundary"]].assign(nucleation="Gaussian", left=level, width=width)
        rows["gamma"] = gammas
        rows["transition_time"] = times
        rows["transition_length"] = 2.0 * right_fronts
        rows[PAPER_COLUMNS] = [paper_transition_displacement(level, gamma) for gamma in gammas]
        parts.append(rows)
    return pd.concat(parts)


def stick_times_of_centre(
    fronts: Curve, gammas: np.ndarray, latest_sticks: np.ndarray
) -> np.ndarray:
    """Return the stick time of x = 0 in ruptures that differ only in gamma.

    fronts : the curve t(x) of both fronts, which the ruptures have in common
    latest_sticks : times until which a stick is searched, one for each gamma
    """
    times = []
    for gamma, latest_stick in zip(gammas, latest_sticks, strict=True):
        # The motion behind given fronts, which are one connected part of a rupture.
        part = Part(fronts, gamma, until=latest_stick)
        (stick_time,) = part.find_stick_times(np.array([0.0]))
        times.append(float(stick_time))
    return np.array(times)


def right_front_positions(
    fronts: Curve, times: np.ndarray, speed: float, uniform_from: float
) -> np.ndarray:
    """Return the position of the right front at each of some times.

    fronts : the curve t(x) of both fronts, which reaches beyond ``uniform_from``
    speed : constant speed of the front in uniform pre-stress
    uniform_from : position beyond which the pre-stress is uniform
    """
    positions = uniform_from + speed * (times - fronts.arrival(uniform_from))
    # Where the front is not yet beyond ``uniform_from``, its position comes from the curve.
    for index in np.flatnonzero(positions <= uniform_from):
        positions[index] = fronts.front_at(times[index], x=0.0, side=1.0)
    return positions


def stress_arrests(
    runs: pd.DataFrame, damping_ratio: float, release: str, fractions: list[float]
) -> pd.DataFrame:
    """Return arrests under a stress boundary, for nucleation by a Gaussian and by a tent.

    For the Gaussian there is one row for each fraction of |x_minus|, because the left front never
    arrives at x_minus. A tent is a pre-stress that falls linearly from 1 at x = 0 to its level at a
    distance W. Its left front arrives at x_minus, so there is only one row, with the fraction 1.

    runs : boundary, left (level on the left) and width W of each run
    """
    parts = []
    for left, group in runs.groupby("left"):
        crack = ArrestingCrack(Prestress(left, 0.0, width=1.0), damping_ratio, release)
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
        arrests.append(tent_arrest(left, damping_ratio, release))
        at_width_1 = pd.DataFrame(arrests)
        rows = group[["boundary", "left", "width"]].merge(at_width_1, how="cross")
        # Without leaf springs W is the only length, so all times and lengths are proportional to W.
        rows[ARREST_SIZES] = rows[ARREST_SIZES].mul(rows["width"], axis=0)
        parts.append(rows)
    return pd.concat(parts)


def tent_arrest(left: float, damping_ratio: float, release: str) -> Arrest:
    """Return the arrest of the left front for nucleation by a tent, exactly.

    The pre-stress of a tent falls linearly from 1 at x = 0 to 0 at x = 1 and to ``left`` < 0 at
    x = -1. Beyond the tent it is constant.
    """
    # The right front crosses the tent from x = 0 to x = 1 in a time that is the mean of 1/speed
    # over the levels from 0 to 1, because the tent falls evenly over the distance 1.
    # The nodes and weights of Gauss-Legendre integration from -1 to 1 are converted to 0 to 1.
    levels = 0.5 + 0.5 * GAUSS_NODES
    slownesses = 1.0 / front_speed(levels, damping_ratio, release)
    crossing_time = float(GAUSS_WEIGHTS @ slownesses) / 2.0
    # At x_minus the integral of the pre-stress to infinity is 0. Over the tent, the integral is 1/2
    # on the right of x = 0 and (1 + left)/2 on the left. The negative level between x_minus and the
    # tent balances it.
    tent_integral = 1.0 + 0.5 * left
    distance_to_x_minus = 1.0 + tent_integral / -left
    # The last wave that drives the left front starts at x = 1 when the right front arrives there,
    # and runs to x_minus. In the same time the right front runs as far. Both have speed 1.
    return Arrest(
        nucleation="tent",
        fraction=1.0,
        transition_time=distance_to_x_minus + 1.0 + crossing_time,
        transition_length=2.0 * distance_to_x_minus + 2.0,
        paper_transition_time=distance_to_x_minus,
        paper_transition_length=2.0 * distance_to_x_minus,
    )
