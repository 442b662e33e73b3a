"""Compute the exact numbers that the derivations in the supplement quote."""

import math
from collections.abc import Callable, Sequence
from functools import cache
from itertools import product

import numpy as np
import pandas as pd

from slippulse.model.prestress import Prestress
from slippulse.model.release import RELEASES
from slippulse.prediction.common import value_or_nan
from slippulse.simulation.exact_rupture import exact_rupture
from slippulse.theory.barrier import barrier_depth, barrier_depth_estimate
from slippulse.theory.front_motion import steady_front
from slippulse.theory.front_speeds import front_speed
from slippulse.theory.pulse import steady_pulse
from slippulse.theory.rupture import Rupture

from ..configuration.expand import expand
from .gaussian_transition import over_paper

NEEDS = {"sweeps": ["space_time_displacement", "pulses_across_a_step", "scaling_displacement"]}

# Positions of the table of stick times, in units of H.
POSITIONS = np.arange(9.0)
# The numbers are accurate to this many decimals.
DECIMALS = 8
# The left front of a one-way pulse stops within this time.
ONE_WAY_DURATION = 8.0
# At this small gamma the peak at nucleation is narrow compared with the transition length.
SOFT_GAMMA = 1.0 / 9.0
# A spatial derivative is computed as a difference over this distance.
DIFFERENCE_STEP = 1e-3
# Fronts that are followed block by block, at all combinations of these values.
FOLLOWED_SPEEDS = (1.25, 2.0, 4.0)
FOLLOWED_RATIOS = (0.0, 0.2)
FOLLOWED_STIFFNESSES = (0.0, 0.5)  # gamma dx^2

# Each number is computed by a function of its own, so that one is NaN if theory refuses its
# configuration.
Numbers = dict[str, Callable[[], float]]


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the columns quantity, x and value; the value is NaN if theory has none.

    Only the release time, the stick time and the final slip depend on the position x.
    """
    scenes = {name: expand(sweep)[0] for name, sweep in settings["sweeps"].items()}
    # The scene of the published space-time figure; its damping and release rule are used for all.
    published = scenes["space_time_displacement"][0]
    ratio, release = published.damping_ratio, published.release
    # The pulse of the texts has the level and gamma in which pulses across a step begin.
    step = scenes["pulses_across_a_step"][0]
    level, gamma = step.prestress.left, step.gamma
    levels = sorted({scene.prestress.left for scene in scenes["scaling_displacement"]})
    # The rupture is computed once, and only when a number needs it.
    rupture = cache(lambda: exact_rupture(published))
    numbers: Numbers = {
        "front_speed_elastic": lambda: front_speed(published.prestress.left, ratio, "elastic")
    }
    numbers |= pulse_numbers(level, gamma, ratio, release)
    numbers |= one_way_numbers(level, gamma, ratio, release)
    numbers |= transition_numbers(level, levels)
    # The pre-stress at the nucleation point is 1.
    numbers["strain_term"] = lambda: abs(curvature(rupture()))
    numbers |= front_numbers()
    rows = [(name, math.nan, value_or_nan(compute)) for name, compute in numbers.items()]
    for quantity in ("release_time", "stick_time", "final_slip"):
        try:
            values = np.round(getattr(rupture(), quantity)(POSITIONS), DECIMALS)
        except (ValueError, ArithmeticError):
            values = np.full_like(POSITIONS, math.nan)
        rows += [(quantity, x, value) for x, value in zip(POSITIONS, values, strict=True)]
    return pd.DataFrame(rows, columns=["quantity", "x", "value"])


def pulse_numbers(level: float, gamma: float, ratio: float, release: str) -> Numbers:
    """Return numbers of a steady pulse, and the depth to which it enters a barrier.

    The barrier has the negative of the level before it.
    """
    # The continuum pulse is undamped; damping enters through the front speed.
    pulse = cache(lambda: steady_pulse(level, gamma, damping_ratio=ratio, release=release))
    return {
        "pulse_width": lambda: pulse().width,
        # The pulse forgets a perturbation within this distance.
        "memory_distance": lambda: pulse().width / (pulse().speed - 1.0),
        "barrier_depth": lambda: barrier_depth(level, -level, gamma, ratio, release),
        "barrier_depth_undamped": lambda: barrier_depth(level, -level, gamma),
        "barrier_depth_estimate": lambda: barrier_depth_estimate(level, -level, gamma),
    }


def one_way_numbers(level: float, gamma: float, ratio: float, release: str) -> Numbers:
    """Return numbers of a rupture that becomes a pulse to the right.

    The level on the left is negative, so the left front stops.
    """
    rupture = Rupture(Prestress(-level, level), gamma, ratio, release, ONE_WAY_DURATION)
    left_end = rupture.front_ends[0][0]
    first_stick = rupture.first_stick
    first_stick_position = math.nan if first_stick is None else first_stick.x
    return {
        "one_way_stop_position": lambda: left_end.x,
        "one_way_stop_time": lambda: left_end.time,
        "one_way_first_stick_position": lambda: first_stick_position,
        "one_way_transition_time": lambda: rupture.transition.time,
        "one_way_transition_length": lambda: rupture.transition.length,
    }


def transition_numbers(level: float, levels: Sequence[float]) -> Numbers:
    """Return exact transition times divided by the paper's formula.

    Rupture begins at a point, or at a peak with W = 1, where gamma is 1 or SOFT_GAMMA. The times
    are those at the lowest and the highest of some levels, and at one level.
    """
    lowest, highest = levels[0], levels[-1]
    return {
        "transition_point_lowest": lambda: over_paper(lowest),
        "transition_point_highest": lambda: over_paper(highest),
        "transition_point_level": lambda: over_paper(level),
        "transition_peak_lowest": lambda: over_paper(lowest, 1.0),
        "transition_peak_highest": lambda: over_paper(highest, 1.0),
        "transition_peak_level": lambda: over_paper(level, 1.0),
        "transition_peak_level_soft": lambda: over_paper(level, SOFT_GAMMA),
    }


def front_numbers() -> Numbers:
    """Return how many fronts were followed block by block, and how many are admissible."""
    parameters = product(FOLLOWED_SPEEDS, FOLLOWED_RATIOS, FOLLOWED_STIFFNESSES, RELEASES)
    fronts = [steady_front(*values) for values in parameters]
    return {
        "fronts_block_by_block": lambda: len(fronts),
        "fronts_admissible": lambda: sum(front.admissible for front in fronts),
    }


def curvature(rupture: Rupture) -> float:
    """Return the curvature of slip at the nucleation point, halfway to the transition.

    The strain is 0 at this point by symmetry, so the curvature is the strain at a small distance
    divided by the distance.
    """
    halfway = 0.5 * rupture.transition.time
    strain = rupture.map([halfway], [DIFFERENCE_STEP], ("strain",))["strain"].item()
    return strain / DIFFERENCE_STEP
