"""Spacing, step and order of a scene for a largest relative error of its numbers.

The error of each number is a constant times dx over a length of the scene, in the continuum limit
at fixed beta/dx. Each constant stands below once. Where no derivation is given, a constant is an
upper bound over runs at two or three spacings: tau_0 = 0.1 to 0.9, beta/dx = 0 to 1 and
gamma W^2 = 0.001 to 64 under a displacement boundary; levels -0.1 to -10 under a stress boundary.
`slippulse.measurement.promise` says which numbers are promised.
"""

import math
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from ..model.checks import check_choice, check_kind, check_number, check_that
from ..model.prestress import Prestress
from ..model.release import RELEASES
from ..model.scene import Scene
from ..model.stability import choose_step
from ..theory.closed_pulse import pulse_at_speed
from ..theory.front_speeds import front_speed

# The constants below were found for beta/dx up to 1. At 10 the longest stable step alone errs by
# 3e-3 in the front speed at any spacing, and a grid study does not see that.
STRONGEST_DAMPING = 1.0
# The spacing may take this fraction of the promise. The step takes a part of the rest, and so does
# the scatter of a grid study: with factors of 1.5 and 2 it finds up to a third more than the error.
SPACING_FRACTION = 0.7
# Blocks across the narrowest length, at least: a lattice four times coarser still has 8.
BLOCKS = 32
# The largest step in units of dx, and the order. `studies.accuracy_cost` finds errors of 4e-6 with
# them at any spacing, in the worst of its numbers, and 2e-5 with the next cheaper pair.
STEP, ORDER = 1.0, 8

# Pulse: the damped layer, (beta/dx) v/(v^2 - 1) blocks, takes pi^2/4 times its fraction of the
# width from slip and peak velocity (steady pulse to first order in beta). The front takes blocks
# from the width: at most 1/(2 tau_0 v^2).
LAYER, FRONT_BLOCKS = 0.25 * math.pi**2, 0.5
# Front speed with leaf springs, second order in dx over the pulse width: transient, layer times v.
SPEED, SPEED_LAYER = 7.0, 4.0
# T_trans and L_trans under a displacement boundary: blocks of the nucleation, a slow first front.
NUCLEATION, SLOW_FRONT = 0.1, 0.2
# T_trans and slip velocity under a stress boundary with level 0 on the right, over the distance to
# where the pre-stress falls to 0 on the left: without damping, and what beta/dx adds.
TRANSITION, TRANSITION_DAMPED = 2.2, 1.0
VELOCITY, VELOCITY_DAMPED = 0.6, 0.6
# Front speed without leaf springs, over the width of the Gaussian.
FREE_SPEED = 0.25

# A table is looked at in this number of levels. A front that crosses less pre-stress than this is
# not covered by a promise (`slippulse.measurement.promise`).
LEVELS, LOWEST_PRESTRESS = 9, 0.05

# The runs of a sweep share their speeds, and one speed takes milliseconds.
cached_front_speed = lru_cache(maxsize=4096)(front_speed)


class Demand(NamedTuple):
    """A largest relative error, and what it takes of a scene; its narrowest Gaussian."""

    error: float
    levels: list[float]
    peak_width: float
    gamma: float
    damping_ratio: float
    release: str
    fields: bool


def settings_for(
    accuracy: float,
    *,
    boundary: str,
    prestress: Prestress,
    gamma: float = 0.0,
    damping_ratio: float = 0.0,
    release: str = "total",
    fields: bool = True,
) -> dict[str, Any]:
    """Spacing, step and order that keep a scene's numbers within a largest relative error.

    Parameters
    ----------
    accuracy : float
        Largest relative numerical error, from 1e-4 to 0.1.
    boundary : {"displacement", "stress"}
        Condition at the top of the layer.
    prestress : Prestress
        Pre-stress of the scene.
    gamma : float
        Elasticity ratio 2G/(lambda + 2G): > 0 under "displacement", 0 under "stress".
    damping_ratio : float
        beta/dx, from 0 to 1; it stays the same when the spacing changes.
    release : {"total", "elastic"}
        Release rule, as in `Scene`.
    fields : bool
        Whether width, slip and peak velocity of the pulse at the end must keep the error, too.

    Returns
    -------
    dict
        dx (units of H), beta (units of H), max_step (units of dx) and order, for `Scene`.

    Raises
    ------
    ValueError
        If an argument is outside of its range: one line with its name, its value and the range.

    Notes
    -----
    Source: `slippulse.simulation.accuracy`, where each constant is derived or measured; the
    paper promises no error. `slippulse.measurement.promise` lists the numbers that are covered.

    Examples
    --------
    >>> scene = {"boundary": "displacement", "prestress": Prestress(0.5, 0.5), "gamma": 0.65}
    >>> settings_for(1e-2, **scene)["order"]
    8
    """
    check_number("accuracy", accuracy, at_least=1e-4, at_most=0.1)
    check_choice("release", release, RELEASES)
    check_kind("prestress", prestress, Prestress)
    check_that(isinstance(fields, bool), "fields", fields, "true or false")
    check_number("gamma", gamma, at_least=0.0)
    check_number("damping_ratio", damping_ratio, at_least=0.0, at_most=STRONGEST_DAMPING)
    # Numbers of other types would be computed with as such.
    gamma, damping_ratio = float(gamma), float(damping_ratio)
    levels = [prestress.left, prestress.right, *(level for _, level in prestress.steps)]
    peak_width = prestress.narrowest
    if prestress.points:
        levels += _levels_of_table(prestress)
        peak_width = min(peak_width, _nucleation_width(prestress))
    error = SPACING_FRACTION * float(accuracy)
    demand = Demand(error, levels, peak_width, gamma, damping_ratio, release, fields)
    if gamma:
        spacings = _spacings_with_springs(demand)
    else:
        spacings = _spacings_without_springs(demand, prestress)
    dx = float(f"{min(1.0, *spacings):.3g}")
    step = min(STEP, choose_step("localised", ORDER, damping_ratio, gamma * dx**2))
    settings: dict[str, Any] = {"dx": dx, "beta": damping_ratio * dx, "max_step": step}
    settings["order"] = ORDER
    # The scene refuses a wrong boundary, and a gamma that does not go with it.
    Scene(boundary, prestress, duration=1.0, gamma=gamma, release=release, **settings)
    return settings


def _levels_of_table(prestress: Prestress) -> list[float]:
    """Levels from the lowest to the highest of a table that the promise covers."""
    tau = np.array([tau for _, tau in prestress.points])
    # Less pre-stress is not promised, and at 1 there is no front.
    covered = tau[(tau >= LOWEST_PRESTRESS) & (tau < 1.0)]
    return np.quantile(covered, np.linspace(0.0, 1.0, LEVELS)).tolist() if covered.size else []


def _nucleation_width(prestress: Prestress) -> float:
    """Distance from the nucleation in a table to where as much of it is left as at W of a peak."""
    x, tau = np.array(prestress.points).T
    start, outside = int(np.argmax(tau)), max(prestress.left, prestress.right)
    if tau[start] < 1.0:
        return math.inf
    fallen = x[tau <= outside + math.exp(-0.5) * (tau[start] - outside)]
    ahead = np.abs(fallen - x[start])
    return float(np.min(ahead[ahead > 0.0], initial=math.inf))


def _spacings_with_springs(demand: Demand) -> list[float]:
    """Spacings that the numbers of a scene with leaf springs allow, one for each number."""
    nucleation = min(demand.peak_width, 1.0 / math.sqrt(demand.gamma))
    start = NUCLEATION * (1.0 + demand.damping_ratio) / nucleation
    spacings = [nucleation / BLOCKS, demand.error / start]
    for level in demand.levels:
        if level <= 0.0:
            continue
        speed = cached_front_speed(level, demand.damping_ratio, demand.release)
        # In the limit dx -> 0 damping acts through the speed alone.
        width = pulse_at_speed(level, demand.gamma, 0.0, speed).width
        layer = demand.damping_ratio * speed / ((speed - 1.0) * (speed + 1.0))
        speed_error = math.sqrt(demand.error / (SPEED + SPEED_LAYER * layer * speed))
        spacings += [width / BLOCKS, width * speed_error]
        spacings.append(demand.error / (start + SLOW_FRONT / width))
        if demand.fields:
            loss = max(FRONT_BLOCKS / (level * speed**2), LAYER * layer)
            spacings.append(demand.error * width / loss)
    return spacings


def _distances_to_zero(levels: list[float], prestress: Prestress) -> list[float]:
    """Distances from the nucleation to where the pre-stress falls to 0, if it does."""
    if prestress.points:
        x, tau = np.array(prestress.points).T
        start = 0.0 if prestress.width is not None else x[np.argmax(tau)]
        negative = np.abs(x[tau < 0.0] - start)
        return [float(np.min(negative))] if negative.size else []
    width, peak = prestress.width or math.inf, prestress.peak
    # The Gaussian falls to 0 towards each negative level.
    below_zero = [level for level in levels if level < 0.0 < peak]
    return [width * math.sqrt(2.0 * math.log1p(-peak / level)) for level in below_zero]


def _spacings_without_springs(demand: Demand, prestress: Prestress) -> list[float]:
    """Spacings that the numbers of a scene under a stress boundary allow, one for each number."""
    error, ratio = demand.error, demand.damping_ratio
    distances = _distances_to_zero(demand.levels, prestress)
    spacings = [length / BLOCKS for length in (demand.peak_width, *distances)]
    if max(demand.levels) > 0.0:
        spacings.append(error * demand.peak_width / FREE_SPEED)
    if prestress.left < 0.0 == prestress.right and distances:
        if not prestress.steps:
            spacings.append(error * distances[0] / (TRANSITION + TRANSITION_DAMPED * ratio))
        if demand.fields:
            spacings.append(error * distances[0] / (VELOCITY + VELOCITY_DAMPED * ratio))
    return spacings
