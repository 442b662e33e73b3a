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
from slippulse.theory.pulse import SteadyPulse, steady_pulse
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

# For each number its name and the function that computes it. The function raises an error if theory
# refuses the configured parameters. The functions are called one by one, so that only the numbers
# of those that fail are NaN.
NumberFunctions = dict[str, Callable[[], float]]


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return one row for each number, with the columns quantity, x and value.

    The value is NaN if theory has none. Only the release time, the stick time and the final slip
    depend on the position x. For all other numbers x is NaN.
    """
    scenes = {}
    for name, sweep in settings["sweeps"].items():
        scenes[name], _samples = expand(sweep)
    # Most numbers are for the damping ratio and release rule of the published space-time figure.
    published_scene = scenes["space_time_displacement"][0]
    damping_ratio, release = published_scene.damping_ratio, published_scene.release
    # In this simulation pulses enter another pre-stress at a step. Most numbers are for its gamma,
    # and for the level before the step.
    scene_with_step = scenes["pulses_across_a_step"][0]
    level, gamma = scene_with_step.prestress.left, scene_with_step.gamma
    # The levels of figure 5, of which the lowest and the highest are quoted.
    scaling_levels = sorted({scene.prestress.left for scene in scenes["scaling_displacement"]})

    @cache
    def published_rupture() -> Rupture:
        """Return the exact rupture of the published figure. The first call computes it."""
        return exact_rupture(published_scene)

    published_level = published_scene.prestress.left
    functions: NumberFunctions = {
        "front_speed_elastic": lambda: front_speed(published_level, damping_ratio, "elastic"),
        **pulse_functions(level, gamma, damping_ratio, release),
        **one_way_functions(level, gamma, damping_ratio, release),
        **transition_functions(level, scaling_levels),
        # The strain term of the equation of motion at the nucleation point, divided by the
        # pre-stress there, which is 1.
        "strain_term": lambda: abs(curvature_at_nucleation(published_rupture())),
        **front_functions(),
    }
    rows = [(name, math.nan, value_or_nan(compute)) for name, compute in functions.items()]
    rows += rows_by_position(published_rupture)
    return pd.DataFrame(rows, columns=["quantity", "x", "value"])


def rows_by_position(compute_rupture: Callable[[], Rupture]) -> list[tuple[str, float, float]]:
    """Return rows (quantity, x, value) of release time, stick time and final slip at POSITIONS.

    The values are NaN if ``compute_rupture`` raises an error, because there is no exact rupture.
    This function returns the same rupture at each call, and computes it only once.
    """
    rows = []
    for quantity in ("release_time", "stick_time", "final_slip"):
        try:
            method = getattr(compute_rupture(), quantity)
            values = np.round(method(POSITIONS), DECIMALS)
        except (ValueError, ArithmeticError):
            values = np.full_like(POSITIONS, math.nan)
        rows += [(quantity, x, value) for x, value in zip(POSITIONS, values, strict=True)]
    return rows


def pulse_functions(
    level: float, gamma: float, damping_ratio: float, release: str
) -> NumberFunctions:
    """Return the numbers of a steady pulse that enters a barrier, each as a function to call.

    Each function may raise an error of the theory. The pre-stress is ``level`` before the barrier
    and -``level`` in it.
    """

    def pulse() -> SteadyPulse:
        """Return the steady pulse before the barrier."""
        # In the limit dx -> 0 damping acts only through the front speed.
        return steady_pulse(level, gamma, damping_ratio=damping_ratio, release=release)

    return {
        "pulse_width": lambda: pulse().width,
        # The pulse forgets a perturbation within this distance.
        "memory_distance": lambda: pulse().width / (pulse().speed - 1.0),
        "barrier_depth": lambda: barrier_depth(level, -level, gamma, damping_ratio, release),
        "barrier_depth_undamped": lambda: barrier_depth(level, -level, gamma),
        "barrier_depth_estimate": lambda: barrier_depth_estimate(level, -level, gamma),
    }


def one_way_functions(
    level: float, gamma: float, damping_ratio: float, release: str
) -> NumberFunctions:
    """Return the numbers of a rupture with one pulse, to the right, each as a function to call.

    The left front stops, because the pre-stress is -``level`` on the left. The position and the
    time of its stop are NaN if it stops after ONE_WAY_DURATION. The functions of the transition
    raise an error if there is none.
    """
    prestress = Prestress(-level, level)
    rupture = Rupture(prestress, gamma, damping_ratio, release, ONE_WAY_DURATION)
    left_end = outermost_fronts(rupture).left
    has_stopped = left_end.reason == "stops"
    stop_position, stop_time = (left_end.x, left_end.time) if has_stopped else (math.nan, math.nan)
    first_stick = rupture.first_stick
    first_stick_position = math.nan if first_stick is None else first_stick.x
    return {
        "one_way_stop_position": lambda: stop_position,
        "one_way_stop_time": lambda: stop_time,
        "one_way_first_stick_position": lambda: first_stick_position,
        "one_way_transition_time": lambda: rupture.transition.time,
        "one_way_transition_length": lambda: rupture.transition.length,
    }


def transition_functions(level: float, levels: Sequence[float]) -> NumberFunctions:
    """Return exact transition times divided by the paper's formula, each as a function to call.

    transition_point_... : the rupture begins at a single point
    transition_peak_... : the rupture begins at a Gaussian of width W = 1

    Each function may raise an error of the theory. The pre-stress is ``level``, or the lowest or
    the highest of ``levels``, which are in ascending order. For a Gaussian, gamma is 1 or
    SOFT_GAMMA.
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


def front_functions() -> NumberFunctions:
    """Return two counts as functions: steady fronts followed block by block, and admissible ones.

    A steady front is admissible if no block ahead of it reaches the threshold before its release,
    and the block released last slides until the next release.
    """
    fronts = [
        steady_front(speed, damping_ratio, stiffness, release)
        for speed, damping_ratio, stiffness, release in product(
            FOLLOWED_SPEEDS, FOLLOWED_DAMPING_RATIOS, FOLLOWED_STIFFNESSES, RELEASES
        )
    ]
    return {
        "fronts_block_by_block": lambda: len(fronts),
        "fronts_admissible": lambda: sum(front.admissible for front in fronts),
    }


def curvature_at_nucleation(rupture: Rupture) -> float:
    """Return the curvature of slip, d2u/dx2, at x = 0 and at half the transition time.

    The strain du/dx is 0 at x = 0 by symmetry. So its derivative there is the strain at a small
    distance, divided by this distance.
    """
    time = 0.5 * rupture.transition.time
    strain = rupture.map([time], [DIFFERENCE_STEP], ("strain",))["strain"].item()
    return strain / DIFFERENCE_STEP
