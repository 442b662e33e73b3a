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
from .gaussian_transition import time_divided_by_formula
from .outermost_fronts import outermost_fronts

NEEDS = {"sweeps": ["space_time_displacement", "pulses_across_a_step", "scaling_displacement"]}

# Positions of the table of stick times, in units of H.
POSITIONS = np.arange(9.0)
# The numbers are accurate to this many decimals.
DECIMALS = 8
# The left front of a one-way pulse stops within this time.
ONE_WAY_DURATION = 8.0
# At this small gamma the Gaussian at the nucleation is narrow compared with the transition length.
SOFT_GAMMA = 1.0 / 9.0
# A spatial derivative is computed as a difference over this distance.
DIFFERENCE_STEP = 1e-3
# Speeds, damping ratios beta/dx and stiffnesses gamma dx^2 of fronts that are followed block by
# block, at all combinations of these values and of the release rules.
FOLLOWED_SPEEDS = (1.25, 2.0, 4.0)
FOLLOWED_DAMPING_RATIOS = (0.0, 0.2)
FOLLOWED_STIFFNESSES = (0.0, 0.5)

# Functions that compute one number each, by its name. If theory refuses the configured parameters
# of a number, only this number is NaN.
Numbers = dict[str, Callable[[], float]]


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the columns quantity, x and value; the value is NaN if theory has none.

    Only the release time, the stick time and the final slip depend on the position x.
    """
    scenes = {}
    for name, sweep in settings["sweeps"].items():
        scenes[name], _samples = expand(sweep)
    # Most numbers are for the damping ratio and release rule of the published space-time figure.
    published = scenes["space_time_displacement"][0]
    damping_ratio, release = published.damping_ratio, published.release
    # In this simulation pulses enter another pre-stress at a step. Most numbers are for its gamma,
    # and for the level before the step.
    across_a_step = scenes["pulses_across_a_step"][0]
    level, gamma = across_a_step.prestress.left, across_a_step.gamma
    levels = sorted({scene.prestress.left for scene in scenes["scaling_displacement"]})
    # The rupture is computed once, and only when a number needs it.
    rupture = cache(lambda: exact_rupture(published))
    numbers: Numbers = {
        "front_speed_elastic": lambda: front_speed(
            published.prestress.left, damping_ratio, "elastic"
        )
    }
    numbers |= pulse_numbers(level, gamma, damping_ratio, release)
    numbers |= one_way_numbers(level, gamma, damping_ratio, release)
    numbers |= transition_numbers(level, levels)
    # The strain term of the equation of motion at the nucleation point, divided by the pre-stress
    # there, which is 1.
    numbers["strain_term"] = lambda: abs(curvature_at_nucleation(rupture()))
    numbers |= front_numbers()
    rows = [(name, math.nan, value_or_nan(compute)) for name, compute in numbers.items()]
    rows += rows_by_position(rupture)
    return pd.DataFrame(rows, columns=["quantity", "x", "value"])


def rows_by_position(rupture: Callable[[], Rupture]) -> list[tuple[str, float, float]]:
    """Return release time, stick time and final slip at POSITIONS; NaN if theory has no rupture.

    rupture : function that returns the exact rupture, and raises ValueError if there is none
    """
    rows = []
    for quantity in ("release_time", "stick_time", "final_slip"):
        try:
            method = getattr(rupture(), quantity)
            values = np.round(method(POSITIONS), DECIMALS)
        except (ValueError, ArithmeticError):
            values = np.full_like(POSITIONS, math.nan)
        rows += [(quantity, x, value) for x, value in zip(POSITIONS, values, strict=True)]
    return rows


def pulse_numbers(level: float, gamma: float, damping_ratio: float, release: str) -> Numbers:
    """Return numbers of a steady pulse, and the depth to which it enters a barrier.

    The pre-stress is ``level`` before the barrier and -``level`` in it.
    """
    # In the limit dx -> 0 damping acts only through the front speed.
    pulse = cache(lambda: steady_pulse(level, gamma, damping_ratio=damping_ratio, release=release))
    return {
        "pulse_width": lambda: pulse().width,
        # The pulse forgets a perturbation within this distance.
        "memory_distance": lambda: pulse().width / (pulse().speed - 1.0),
        "barrier_depth": lambda: barrier_depth(level, -level, gamma, damping_ratio, release),
        "barrier_depth_undamped": lambda: barrier_depth(level, -level, gamma),
        "barrier_depth_estimate": lambda: barrier_depth_estimate(level, -level, gamma),
    }


def one_way_numbers(level: float, gamma: float, damping_ratio: float, release: str) -> Numbers:
    """Return numbers of a rupture that becomes a single pulse, which runs to the right.

    The left front stops, because the pre-stress is -``level`` on the left.
    """
    prestress = Prestress(-level, level)
    rupture = Rupture(prestress, gamma, damping_ratio, release, ONE_WAY_DURATION)
    left_end = outermost_fronts(rupture).left
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

    transition_point_... : the rupture begins at a single point
    transition_peak_... : the rupture begins at a Gaussian of width W = 1

    The pre-stress is ``level``, or the lowest or the highest of ``levels``.
    """
    lowest, highest = levels[0], levels[-1]
    return {
        "transition_point_lowest": lambda: time_divided_by_formula(lowest),
        "transition_point_highest": lambda: time_divided_by_formula(highest),
        "transition_point_level": lambda: time_divided_by_formula(level),
        "transition_peak_lowest": lambda: time_divided_by_formula(lowest, 1.0),
        "transition_peak_highest": lambda: time_divided_by_formula(highest, 1.0),
        "transition_peak_level": lambda: time_divided_by_formula(level, 1.0),
        "transition_peak_level_soft": lambda: time_divided_by_formula(level, SOFT_GAMMA),
    }


def front_numbers() -> Numbers:
    """Return the number of fronts that were followed block by block, and of admissible ones.

    A steady front is admissible if no block ahead of it reaches the threshold before its release,
    and no block behind it comes to rest at once.
    """
    parameters = product(FOLLOWED_SPEEDS, FOLLOWED_DAMPING_RATIOS, FOLLOWED_STIFFNESSES, RELEASES)
    fronts = [steady_front(*values) for values in parameters]
    return {
        "fronts_block_by_block": lambda: len(fronts),
        "fronts_admissible": lambda: sum(front.admissible for front in fronts),
    }


def curvature_at_nucleation(rupture: Rupture) -> float:
    """Return the second derivative of slip by x, at x = 0 and at half the transition time.

    The strain du/dx is 0 at x = 0 by symmetry. So its derivative there is the strain at a small
    distance, divided by this distance.
    """
    time = 0.5 * rupture.transition.time
    strain = rupture.map([time], [DIFFERENCE_STEP], ("strain",))["strain"].item()
    return strain / DIFFERENCE_STEP
