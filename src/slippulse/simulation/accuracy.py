"""Spacing, step and order that keep the numbers of a scene within a largest relative error.

As dx tends to 0 at fixed beta/dx, each measured number tends to a limit. Its relative error is a
constant times dx divided by a length of the scene, or times the square of this ratio. Solving for
dx gives one spacing for each number, and `settings_for` returns the smallest of them.

The constants are defined below. If no derivation is given, a constant is an upper bound that was
measured in runs at two or three spacings. Under a displacement boundary, these runs had tau_0 = 0.1
to 0.9, beta/dx = 0 to 1 and gamma W^2 = 0.001 to 64. Under a stress boundary, they had levels of
-0.1 to -10. `slippulse.measurement.promise` lists the numbers that are covered.
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

# The constants below were measured for damping ratios beta/dx up to 1. At 10, the longest stable
# step alone causes an error of 3e-3 in the front speed at any spacing, and a grid study cannot find
# this error.
MAX_DAMPING_RATIO = 1.0
# Fraction of the promised error that the spacing may use. The step uses a part of the rest. The
# other part is for the scatter of a grid study. On lattices that are 1.5 and 2 times coarser, such
# a study finds up to a third more than the true error.
SPACING_FRACTION = 0.7
# Smallest number of blocks across the narrowest length. A lattice four times coarser still has 8.
MIN_BLOCKS = 32
# The largest step, in units of dx, and the order. The study `accuracy_cost` finds errors of at most
# 4e-6 with them at any spacing, and of 2e-5 with the next cheaper pair.
LARGEST_STEP, TAYLOR_ORDER = 1.0, 8

# Error of the slip and the peak velocity of a pulse. Damping makes a boundary layer of
# (beta/dx) v/(v^2 - 1) blocks, where v is the front speed. It reduces slip and peak velocity by
# pi^2/4 times its fraction of the pulse width (steady pulse to first order in beta).
PULSE_PER_LAYER = 0.25 * math.pi**2
# Error of the pulse width. The front itself covers at most 1/(2 tau_0 v^2) blocks of it.
PULSE_PER_FRONT = 0.5
# Error of the front speed with leaf springs, in proportion to (dx divided by the pulse width)^2.
# The first constant is for a transient. The second is multiplied by v and by the thickness of the
# boundary layer in blocks.
SPEED_ERROR, SPEED_ERROR_PER_LAYER = 7.0, 4.0
# Error of the front speed without leaf springs, in proportion to dx divided by the width of the
# Gaussian.
FREE_SPEED_ERROR = 0.25

# Error of T_trans and L_trans under a displacement boundary. The first constant is for the blocks
# of the nucleation, and the second for a front that is slow at first.
NUCLEATION_ERROR, SLOW_FRONT_ERROR = 0.1, 0.2
# Error of T_trans and of the slip velocity under a stress boundary with level 0 on the right. It is
# proportional to dx divided by the distance to the position on the left where the pre-stress falls
# to 0. The first constant holds without damping, and beta/dx times the second is added.
TRANSITION_ERROR, TRANSITION_ERROR_DAMPED = 2.2, 1.0
VELOCITY_ERROR, VELOCITY_ERROR_DAMPED = 0.6, 0.6

# Number of levels that represent a table of pre-stress.
TABLE_LEVELS = 9
# A table may jump at a point. The pre-stress is therefore evaluated just before and just after each
# point, at this fraction of the length of the table.
JUMP_WIDTH = 1e-9
# Positions, in units of its width, at which a Gaussian on a table is evaluated.
POSITIONS_IN_WIDTHS = np.linspace(-8.0, 8.0, 1601)
# Fronts in lower pre-stress than this are not covered (see `slippulse.measurement.promise`).
LOWEST_PRESTRESS = 0.05

# Each front speed takes milliseconds, and many runs of a sweep have the same one.
cached_front_speed = lru_cache(maxsize=4096)(front_speed)


class Demand(NamedTuple):
    """The error that the spacing may cause, and the properties of the scene that decide it."""

    error: float  # largest relative error
    levels: list[float]  # of the pre-stress
    peak_width: float  # of the narrowest Gaussian, or of the nucleation in a table
    gamma: float
    damping_ratio: float
    release: str
    fields: bool  # width, slip and peak velocity at the end must keep the error, too


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
    """Return the spacing, step and order that keep a scene's numbers within a relative error.

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
        If true, width, slip and peak velocity of the pulse at the end keep the error, too.

    Returns
    -------
    dict
        dx (units of H), beta (units of H), max_step (units of dx) and order, for `Scene`.

    Raises
    ------
    ValueError
        If an argument is outside its range. The message has its name, its value and the range.

    Notes
    -----
    Source: `slippulse.simulation.accuracy`, where each constant is derived or measured. The paper
    makes no statement about errors. `slippulse.measurement.promise` lists the covered numbers.

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
    check_number("damping_ratio", damping_ratio, at_least=0.0, at_most=MAX_DAMPING_RATIO)
    # Convert numbers of other types, such as integers or NumPy scalars.
    gamma, damping_ratio = float(gamma), float(damping_ratio)
    # The smallest width of a Gaussian, or of the nucleation in a table.
    peak_width = prestress.narrowest
    if prestress.points:
        peak_width = min(peak_width, _nucleation_width(prestress))
    # The time step needs the rest of the error, and so does the scatter of the error that a user
    # estimates from runs on several lattices.
    demand = Demand(
        error=SPACING_FRACTION * float(accuracy),
        levels=_levels(prestress),
        peak_width=peak_width,
        gamma=gamma,
        damping_ratio=damping_ratio,
        release=release,
        fields=fields,
    )
    if gamma:
        spacings = _spacings_with_springs(demand)
    else:
        spacings = _spacings_without_springs(demand, prestress)
    # The spacing is at most 1 (one thickness H), and is rounded to three digits.
    dx = float(f"{min(1.0, *spacings):.3g}")
    step = min(LARGEST_STEP, choose_step("localised", TAYLOR_ORDER, damping_ratio, gamma * dx**2))
    settings: dict[str, Any] = {"dx": dx, "beta": damping_ratio * dx, "max_step": step}
    settings["order"] = TAYLOR_ORDER
    # The scene itself refuses a wrong boundary, and a gamma that does not fit the boundary.
    Scene(boundary, prestress, duration=1.0, gamma=gamma, release=release, **settings)
    return settings


def _levels(prestress: Prestress) -> list[float]:
    """Return the levels of a pre-stress on both sides and beyond its steps.

    The levels of a table are some of its values, from the lowest to the highest.
    """
    levels = [prestress.left, prestress.right, *(level for _, level in prestress.steps)]
    if prestress.points:
        levels += _levels_of_table(prestress)
    return levels


def _levels_of_table(prestress: Prestress) -> list[float]:
    """Return some levels, from low to high, of the pre-stress of a table in which fronts run."""
    tau = np.array([tau for _, tau in prestress.points])
    # At lower pre-stress, no accuracy is promised. At 1 or more, all blocks slide from t = 0 on,
    # and there is no front.
    covered = tau[(tau >= LOWEST_PRESTRESS) & (tau < 1.0)]
    if not covered.size:
        return []
    return np.quantile(covered, np.linspace(0.0, 1.0, TABLE_LEVELS)).tolist()


def _nucleation_width(prestress: Prestress) -> float:
    """Return the width of the nucleation in a table, inf if there is none.

    Like the width W of a Gaussian, it is the distance at which the pre-stress above the far level
    has fallen to exp(-1/2) of its maximum.
    """
    x, tau = prestress.point_arrays
    highest_point, far_level = int(np.argmax(tau)), max(prestress.left, prestress.right)
    # Only a pre-stress of 1 starts a rupture.
    if tau[highest_point] < 1.0:
        return math.inf
    has_fallen = tau <= far_level + math.exp(-0.5) * (tau[highest_point] - far_level)
    distances = np.abs(x[has_fallen] - x[highest_point])
    # If the far level is as high as the maximum, the highest point itself is among these points.
    return float(np.min(distances[distances > 0.0], initial=math.inf))


def _spacings_with_springs(demand: Demand) -> list[float]:
    """Return the largest spacing that each requirement allows, in a scene with leaf springs.

    One kind of requirement is that MIN_BLOCKS blocks lie across the nucleation and across each
    pulse. The other is that the error of a measured quantity is at most the error of the demand.
    Each error is a constant times a power of dx, and is solved for dx.
    """
    # The pre-stress varies over the first of these lengths, and leaf springs act over the second.
    nucleation_length = min(demand.peak_width, 1.0 / math.sqrt(demand.gamma))
    # The error of T_trans and L_trans because of the nucleation, divided by dx.
    nucleation_error_per_dx = NUCLEATION_ERROR * (1.0 + demand.damping_ratio) / nucleation_length
    spacings = [nucleation_length / MIN_BLOCKS, demand.error / nucleation_error_per_dx]
    for level in demand.levels:
        if level > 0.0:
            spacings += _spacings_at_level(demand, level, nucleation_error_per_dx)
    return spacings


def _spacings_at_level(demand: Demand, level: float, nucleation_error_per_dx: float) -> list[float]:
    """Return the largest spacing that each requirement on a front and pulse at a level allows.

    Each error is a constant times a power of dx, and is solved for dx.

    nucleation_error_per_dx : error of T_trans and L_trans because of the nucleation, divided by dx
    """
    speed = cached_front_speed(level, demand.damping_ratio, demand.release)
    allowed = "levels of 0, or at which fronts are faster than the waves in spite of rounding"
    check_that(speed > 1.0, "prestress level", level, allowed)
    # In the limit dx -> 0, damping affects the pulse only through the front speed.
    width = pulse_at_speed(level, demand.gamma, 0.0, speed).width
    # The thickness of the boundary layer that damping makes at the front, in blocks:
    # b v/(v^2 - 1), where b is the damping ratio and v the front speed.
    layer = demand.damping_ratio * speed / ((speed - 1.0) * (speed + 1.0))
    # The error of the front speed is this constant times (dx/width)^2.
    speed_error = SPEED_ERROR + SPEED_ERROR_PER_LAYER * layer * speed
    # The errors of T_trans and L_trans, divided by dx.
    transition_error_per_dx = nucleation_error_per_dx + SLOW_FRONT_ERROR / width
    spacings = [
        width / MIN_BLOCKS,
        width * math.sqrt(demand.error / speed_error),
        demand.error / transition_error_per_dx,
    ]
    # With fields, the demand includes the width, the slip and the peak velocity of the pulse at the
    # end.
    if demand.fields:
        # Each of these errors is a constant times dx/width. The front covers up to
        # 1/(2 tau_0 v^2) blocks of the pulse width, where tau_0 is the level.
        width_error = PULSE_PER_FRONT / (level * speed**2)
        slip_and_peak_error = PULSE_PER_LAYER * layer
        spacings.append(demand.error * width / max(width_error, slip_and_peak_error))
    return spacings


def _distances_to_zero(levels: list[float], prestress: Prestress) -> list[float]:
    """Return the distances from the nucleation at which the pre-stress falls to 0, if it does.

    For a table, only the shortest distance is returned.

    levels : levels of the pre-stress, towards which its Gaussian falls
    """
    if prestress.points:
        distances = _distances_to_zeros_of_table(prestress)
        return [float(np.min(distances))] if distances.size else []
    # Without a Gaussian (width None), the pre-stress falls to 0 at no finite distance.
    width, peak = prestress.width or math.inf, prestress.peak
    # Where level + (peak - level) exp(-x^2 / 2 width^2) is 0.
    negative_levels = [level for level in levels if level < 0.0 < peak]
    return [width * math.sqrt(2.0 * math.log1p(-peak / level)) for level in negative_levels]


def _distances_to_zeros_of_table(prestress: Prestress) -> np.ndarray:
    """Return the distances from the nucleation in a table at which the pre-stress changes its sign.

    The nucleation is the Gaussian at x = 0 or, without a Gaussian, the middle of the highest part
    of the table.
    """
    points, values = prestress.point_arrays
    first = last = int(np.argmax(values))
    while last + 1 < points.size and values[last + 1] == values[first]:
        last += 1
    nucleation = 0.5 * (points[first] + points[last])
    # The values just before and just after each point, at which the table may jump.
    offset = JUMP_WIDTH * (points[-1] - points[0])
    positions = [points - offset, points + offset]
    if prestress.width is not None:
        nucleation = 0.0
        positions.append(prestress.width * POSITIONS_IN_WIDTHS)
    x = np.unique(np.concatenate(positions))
    tau = prestress(x)
    # The pre-stress is nearly linear between a position and the next one.
    before = np.flatnonzero(np.diff(tau < 0.0))
    zeros = x[before] + np.diff(x)[before] * tau[before] / (tau[before] - tau[before + 1])
    distances = np.abs(zeros - nucleation)
    # A jump to negative pre-stress at the nucleation itself has no length that could be resolved.
    return distances[distances > 2.0 * offset]


def _spacings_without_springs(demand: Demand, prestress: Prestress) -> list[float]:
    """Return the largest spacing that each requirement allows, under a stress boundary.

    One kind of requirement is that MIN_BLOCKS blocks lie across each length of the pre-stress. The
    other is that the error of a measured quantity is at most the error of the demand. Each error is
    a constant times dx divided by a length, and is solved for dx.
    """
    error, damping_ratio = demand.error, demand.damping_ratio
    # Distances from the nucleation at which the pre-stress falls to 0, if it does.
    distances = _distances_to_zero(demand.levels, prestress)
    spacings = [length / MIN_BLOCKS for length in (demand.peak_width, *distances)]
    # If a front runs into positive pre-stress, the error of its speed limits the spacing.
    if max(demand.levels) > 0.0:
        spacings.append(error * demand.peak_width / FREE_SPEED_ERROR)
    # T_trans and slip velocity tend to a limit only if the left front stops in negative pre-stress
    # and the pulse runs into pre-stress 0.
    stops_on_left = prestress.left < 0.0 and len(distances) > 0
    if stops_on_left and prestress.right == 0.0:
        # The errors of T_trans and of slip velocity are these constants times dx/distance. The
        # first distance is the one on the left or, in a table, the shortest one. In a pre-stress
        # with steps, T_trans is not measured.
        if not prestress.steps:
            transition_error = TRANSITION_ERROR + TRANSITION_ERROR_DAMPED * damping_ratio
            spacings.append(error * distances[0] / transition_error)
        # With fields, the demand includes the slip velocity at the end.
        if demand.fields:
            velocity_error = VELOCITY_ERROR + VELOCITY_ERROR_DAMPED * damping_ratio
            spacings.append(error * distances[0] / velocity_error)
    return spacings
