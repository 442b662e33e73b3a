"""Exact numbers that the derivations of the report quote: of the published scene, and of small scenes of their own."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np
import pandas as pd

from ..configuration.expand import expand
from ..model.prestress import Prestress
from ..model.scene import RELEASES
from ..theory.barrier import barrier_depth, barrier_depth_estimate
from ..theory.exact_transition import exact_transition_displacement, uniform_transition_time
from ..theory.front_law import front_speed
from ..theory.front_motion import admissibility_table
from ..theory.pulse import steady_pulse
from ..theory.rupture import Rupture

NEEDS = {"sweeps": ["space_time_displacement", "pulses_across_a_step", "scaling_displacement"]}

# Positions of the table of stick times, in units of H.
POSITIONS = range(9)
# Nothing is known to more decimals than this, the release at a nucleation point among them.
DECIMALS = 8
# Long enough for the left front of a one-way pulse to stop.
ONE_WAY_DURATION = 8.0
# A softer layer, in which the peak at nucleation is narrow.
SOFT = 1.0 / 9.0
# Fronts that are followed block by block: speeds, damping ratios, and gamma dx^2 of the leaf springs.
SPEEDS, RATIOS, SPRINGS = (1.25, 2.0, 4.0), (0.0, 0.2), (0.0, 0.5)


def table(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Evaluate the theory.

    Returns
    -------
    quantity, x (position, for the three that are tabulated over positions), value (NaN where theory has no answer)
    """
    scenes = {name: expand(sweep)[0] for name, sweep in settings["sweeps"].items()}
    published = scenes["space_time_displacement"][0]
    levels = sorted({scene.prestress.left for scene in scenes["scaling_displacement"]})
    step = scenes["pulses_across_a_step"][0]
    level, gamma, ratio = step.prestress.left, step.gamma, published.damping_ratio
    found = {
        "front_speed_elastic": or_nan(lambda: front_speed(published.prestress.left, ratio, "elastic")),
        **memory(level, gamma, ratio, published.release),
        "barrier_depth": or_nan(lambda: barrier_depth(level, -level, gamma, ratio, published.release)),
        "barrier_depth_undamped": or_nan(lambda: barrier_depth(level, -level, gamma)),
        "barrier_depth_estimate": or_nan(lambda: barrier_depth_estimate(level, -level, gamma)),
        **one_way_pulse(level, gamma, ratio, published.release),
        "transition_point_lowest": without_peak(levels[0]),
        "transition_point_highest": without_peak(levels[-1]),
        "transition_point_level": without_peak(level),
        "transition_peak_lowest": with_peak(levels[0], 1.0),
        "transition_peak_highest": with_peak(levels[-1], 1.0),
        "transition_peak_level": with_peak(level, 1.0),
        "transition_peak_level_soft": with_peak(level, SOFT),
        **block_by_block(),
    }
    rows = [{"quantity": name, "x": math.nan, "value": value} for name, value in found.items()]
    return pd.DataFrame(rows + sticking(published))


def or_nan(number: Callable[[], float]) -> float:
    """A number; NaN where the theory says that it has no answer."""
    try:
        return float(number())
    except (ValueError, ArithmeticError):
        return math.nan


def memory(level: float, gamma: float, ratio: float, release: str) -> dict[str, float]:
    """Width of an undamped pulse at the speed with damping, and the distance over which it forgets what was before."""
    speed = or_nan(lambda: front_speed(level, ratio, release))
    width = or_nan(lambda: steady_pulse(level, gamma, 0.0, speed).width)
    return {"pulse_width": width, "memory_distance": width / (speed - 1.0)}


def one_way_pulse(level: float, gamma: float, ratio: float, release: str) -> dict[str, float]:
    """Where the left front stops between a negative level and a positive one, and the transition there."""
    rupture = Rupture(Prestress(-level, level), gamma, ratio, release, ONE_WAY_DURATION)
    stop = rupture.front_ends[0][0]
    return {
        "one_way_stop_position": stop.x,
        "one_way_stop_time": stop.time,
        "one_way_first_stick_position": rupture.first_stick[1] if rupture.first_stick else math.nan,
        "one_way_transition_time": rupture.transition_time,
        "one_way_transition_length": rupture.transition_length,
    }


def without_peak(level: float) -> float:
    """Time of the transition in uniform pre-stress nucleated at a point, in units of pi/sqrt(gamma)."""
    return or_nan(lambda: uniform_transition_time(level, 1.0)) / math.pi


def with_peak(level: float, gamma: float) -> float:
    """The same with the Gaussian at nucleation."""
    time = or_nan(lambda: exact_transition_displacement(Prestress(level, level), gamma).time)
    return time * math.sqrt(gamma) / math.pi


def block_by_block() -> dict[str, float]:
    """How many steady fronts were found block by block, and how many are admissible."""
    fronts = [
        front for release in RELEASES for front in admissibility_table(SPEEDS, RATIOS, SPRINGS, release)
    ]
    return {
        "fronts_block_by_block": len(fronts),
        "fronts_admissible": sum(front["admissible"] for front in fronts),
    }


def sticking(scene) -> list[dict]:
    """Release, sticking and slip at some positions of a scene's exact rupture."""
    x = np.array(POSITIONS, dtype=float)
    names = ("release_time", "stick_time", "final_slip")
    try:
        rupture = Rupture(scene.prestress, scene.gamma, scene.damping_ratio, scene.release, scene.duration)
        columns = [np.round(getattr(rupture, name)(x), DECIMALS) for name in names]
    except (ValueError, ArithmeticError):
        columns = [np.full_like(x, math.nan)] * len(names)
    return [
        {"quantity": name, "x": position, "value": value}
        for name, column in zip(names, columns, strict=True)
        for position, value in zip(x.tolist(), column.tolist(), strict=True)
    ]
