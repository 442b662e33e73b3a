"""Compute the exact numbers that the derivations in the supplement quote."""

import math
from collections.abc import Callable
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
# Fronts that are followed block by block: speeds, damping ratios, and gamma dx^2.
FOLLOWED = (1.25, 2.0, 4.0), (0.0, 0.2), (0.0, 0.5)


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the columns quantity, x and value; the value is NaN if theory has none.

    Only three quantities depend on the position x.
    """
    scenes = {name: expand(sweep)[0] for name, sweep in settings["sweeps"].items()}
    published, step = scenes["space_time_displacement"][0], scenes["pulses_across_a_step"][0]
    levels = sorted({scene.prestress.left for scene in scenes["scaling_displacement"]})
    level, gamma = step.prestress.left, step.gamma
    ratio, release = published.damping_ratio, published.release
    rupture = cache(lambda: exact_rupture(published))
    one_way = Rupture(Prestress(-level, level), gamma, ratio, release, ONE_WAY_DURATION)
    stop, first_stick = one_way.front_ends[0][0], one_way.first_stick or (math.nan, math.nan)
    # The continuum pulse is undamped; damping enters through the front speed.
    pulse = cache(lambda: steady_pulse(level, gamma, damping_ratio=ratio, release=release))
    fronts = [steady_front(*keys) for keys in product(*FOLLOWED, RELEASES)]
    # Each number is computed separately, so that one is NaN if theory refuses its configuration.
    numbers: dict[str, Callable[[], float]] = {
        "front_speed_elastic": lambda: front_speed(published.prestress.left, ratio, "elastic"),
        "pulse_width": lambda: pulse().width,
        # The pulse forgets a perturbation within this distance.
        "memory_distance": lambda: pulse().width / (pulse().speed - 1.0),
        "barrier_depth": lambda: barrier_depth(level, -level, gamma, ratio, release),
        "barrier_depth_undamped": lambda: barrier_depth(level, -level, gamma),
        "barrier_depth_estimate": lambda: barrier_depth_estimate(level, -level, gamma),
        # The left level is negative, so the left front stops.
        "one_way_stop_position": lambda: stop.x,
        "one_way_stop_time": lambda: stop.time,
        "one_way_first_stick_position": lambda: first_stick[1],
        "one_way_transition_time": lambda: one_way.transition.time,
        "one_way_transition_length": lambda: one_way.transition.length,
        "transition_point_lowest": lambda: over_paper(levels[0]),
        "transition_point_highest": lambda: over_paper(levels[-1]),
        "transition_point_level": lambda: over_paper(level),
        "transition_peak_lowest": lambda: over_paper(levels[0], 1.0),
        "transition_peak_highest": lambda: over_paper(levels[-1], 1.0),
        "transition_peak_level": lambda: over_paper(level, 1.0),
        "transition_peak_level_soft": lambda: over_paper(level, SOFT_GAMMA),
        # The pre-stress at the nucleation point is 1.
        "strain_term": lambda: abs(curvature(rupture())),
        "fronts_block_by_block": lambda: len(fronts),
        "fronts_admissible": lambda: sum(front.admissible for front in fronts),
    }
    rows = [(name, math.nan, value_or_nan(find)) for name, find in numbers.items()]
    for name in ("release_time", "stick_time", "final_slip"):
        try:
            values = np.round(getattr(rupture(), name)(POSITIONS), DECIMALS)
        except (ValueError, ArithmeticError):
            values = np.full_like(POSITIONS, math.nan)
        rows += zip([name] * POSITIONS.size, POSITIONS, values, strict=True)
    return pd.DataFrame(rows, columns=["quantity", "x", "value"])


def curvature(rupture: Rupture) -> float:
    """Return the curvature of slip at the nucleation point, halfway to the transition."""
    halfway = 0.5 * rupture.transition.time
    return rupture.map([halfway], [DIFFERENCE_STEP], ("strain",))["strain"].item() / DIFFERENCE_STEP
