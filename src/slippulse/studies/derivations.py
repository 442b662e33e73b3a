"""Exact numbers that the derivations of the report quote: of the published scene, and of small scenes of their own."""

import math
from collections.abc import Callable
from functools import cache

import numpy as np
import pandas as pd

from ..configuration.expand import expand
from ..model.prestress import Prestress
from ..model.scene import RELEASES
from ..predict.exact_rupture import exact_rupture
from ..predict.numbers import or_nan
from ..theory.front_motion import admissibility_table
from ..theory.front_speeds import front_speed, steady_pulse
from ..theory.rupture import Rupture
from ..theory.slow_front import barrier_depth, barrier_depth_estimate
from .gaussian_transition import over_paper

NEEDS = {"sweeps": ["space_time_displacement", "pulses_across_a_step", "scaling_displacement"]}

# Positions of the table of stick times, in units of H; nothing is known to more decimals than this, the release at a
# nucleation point among them.
POSITIONS, DECIMALS = np.arange(9.0), 8
# Long enough for the left front of a one-way pulse to stop.
ONE_WAY_DURATION = 8.0
# A softer layer, in which the peak at nucleation is narrow.
SOFT = 1.0 / 9.0
# A derivative in space by a difference over this.
STEP = 1e-3
# Fronts that are followed block by block: speeds, damping ratios, and gamma dx^2 of the leaf springs.
FOLLOWED = (1.25, 2.0, 4.0), (0.0, 0.2), (0.0, 0.5)


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Returns quantity, x (position, of the three that depend on it), value (NaN where theory has no answer)."""
    scenes = {name: expand(sweep)[0] for name, sweep in settings["sweeps"].items()}
    published, step = scenes["space_time_displacement"][0], scenes["pulses_across_a_step"][0]
    levels = sorted({scene.prestress.left for scene in scenes["scaling_displacement"]})
    level, gamma = step.prestress.left, step.gamma
    ratio, release = published.damping_ratio, published.release
    rupture = cache(lambda: exact_rupture(published.attributes()))
    one_way = Rupture(Prestress(-level, level), gamma, ratio, release, ONE_WAY_DURATION)
    stop = one_way.front_ends[0][0]
    # An undamped one at the speed with damping.
    pulse = cache(lambda: steady_pulse(level, gamma, damping_ratio=ratio, release=release))
    admissible = [
        front["admissible"] for rule in RELEASES for front in admissibility_table(*FOLLOWED, rule)
    ]
    numbers: dict[str, Callable[[], float]] = {
        "front_speed_elastic": lambda: front_speed(published.prestress.left, ratio, "elastic"),
        "pulse_width": lambda: pulse().width,
        # Over which it forgets what was before.
        "memory_distance": lambda: pulse().width / (pulse().speed - 1.0),
        "barrier_depth": lambda: barrier_depth(level, -level, gamma, ratio, release),
        "barrier_depth_undamped": lambda: barrier_depth(level, -level, gamma),
        "barrier_depth_estimate": lambda: barrier_depth_estimate(level, -level, gamma),
        # Where the left front stops between a negative level and a positive one, and the transition there.
        "one_way_stop_position": lambda: stop.x,
        "one_way_stop_time": lambda: stop.time,
        "one_way_first_stick_position": lambda: (
            one_way.first_stick[1] if one_way.first_stick else math.nan
        ),
        "one_way_transition_time": lambda: one_way.transition_time,
        "one_way_transition_length": lambda: one_way.transition_length,
        "transition_point_lowest": lambda: over_paper(levels[0]),
        "transition_point_highest": lambda: over_paper(levels[-1]),
        "transition_point_level": lambda: over_paper(level),
        "transition_peak_lowest": lambda: over_paper(levels[0], 1.0),
        "transition_peak_highest": lambda: over_paper(levels[-1], 1.0),
        "transition_peak_level": lambda: over_paper(level, 1.0),
        "transition_peak_level_soft": lambda: over_paper(level, SOFT),
        # The curvature of slip at the nucleation point halfway to the transition, where the pre-stress is 1.
        "strain_term": lambda: abs(
            float(rupture().strain(STEP, 0.5 * rupture().transition_time)) / STEP
        ),
        # Steady fronts found block by block, and those of them that are admissible.
        "fronts_block_by_block": lambda: len(admissible),
        "fronts_admissible": lambda: sum(admissible),
    }
    rows = [(name, math.nan, or_nan(find)) for name, find in numbers.items()]
    # Release, sticking and slip at some positions of the published scene.
    for name in ("release_time", "stick_time", "final_slip"):
        try:
            found = np.round(getattr(rupture(), name)(POSITIONS), DECIMALS)
        except (ValueError, ArithmeticError):
            found = np.full_like(POSITIONS, math.nan)
        rows += zip([name] * POSITIONS.size, POSITIONS, found, strict=True)
    return pd.DataFrame(rows, columns=["quantity", "x", "value"])
