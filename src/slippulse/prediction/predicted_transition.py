"""Predicted transition of each run, its time T_trans and its length L_trans, by the exact theory.

Under a displacement boundary the transition is the first stick. Under a stress boundary it takes
place when the left front has covered a given fraction of its way to the balance position.
"""

import math
from functools import cache, partial

import numpy as np
import pandas as pd

from ..model.balance import integral, prestress_balance_position
from ..model.prestress import Prestress
from ..model.roots import root_between
from ..model.run import Run
from ..theory.arrest import ArrestingCrack
from ..theory.exact_transition import exact_transition_displacement
from ..theory.prestress_pieces import nucleation_intervals
from .common import far_level, rounded_damping_ratio, value_or, value_or_nan

# Friction laws for which these numbers are valid.
LAWS = ("coulomb",)
NO_TRANSITION = dict.fromkeys(("exact_transition_time", "exact_transition_length"), math.nan)


def predictions(runs: list[Run], settings: dict) -> pd.DataFrame:
    """Return the numbers of the transition, one row for each run; NaN if theory has none.

    The columns are exact_transition_time and exact_transition_length. Under a displacement boundary
    there is also exact_first_stick_time. Under a stress boundary there are also
    exact_balance_distance and, for the pulse far from the nucleation, exact_largest_velocity and
    exact_half_width. The setting ``fraction`` is that of the module docstring.
    """
    return pd.DataFrame([_row(run, settings["fraction"]) for run in runs])


def _row(run: Run, fraction: float) -> dict[str, float]:
    """Return the row of `predictions` for one run.

    fraction : under a stress boundary, the transition is the time at which the left front has
        covered this fraction of its way to the balance position
    """
    if run.boundary == "displacement":
        return _row_under_displacement(run)
    return _row_under_stress(run, fraction)


def _gaussian_width(profile: Prestress) -> float | None:
    """Return the width of a profile that is one Gaussian with the peak 1; None for any other."""
    has_other_parts = profile.steps or profile.bumps or profile.points
    return profile.width if profile.peak == 1.0 and not has_other_parts else None


def _row_under_displacement(run: Run) -> dict[str, float]:
    """Return the numbers of the first stick, which theory has for equal levels on both sides.

    The pre-stress must be a single Gaussian between these levels. Otherwise the numbers are NaN.
    """
    profile = run.prestress
    has_equal_levels = profile.left == profile.right and profile.left > 0.0
    if not (_gaussian_width(profile) and has_equal_levels):
        return {**NO_TRANSITION}
    find_stick = partial(
        _numbers_of_first_stick, profile, run.gamma, rounded_damping_ratio(run), run.release
    )
    return NO_TRANSITION | value_or(find_stick, NO_TRANSITION)


def _row_under_stress(run: Run, fraction: float) -> dict[str, float]:
    """Return the row of `predictions` for one run under a stress boundary.

    A number that theory does not have for this pre-stress is NaN, or missing.

    fraction : the transition is when the left front has covered this fraction of its way
    """
    row = {**NO_TRANSITION}
    # A balance position needs a negative level far to the left and the level 0 far to the right.
    if not (far_level(run, "left") < 0.0 and far_level(run, "right") == 0.0):
        return row
    balance_position = value_or_nan(partial(prestress_balance_position, run.prestress))
    row["exact_balance_distance"] = _nucleation_position(run.prestress) - balance_position
    # The other numbers also need a single Gaussian between these levels.
    width = _gaussian_width(run.prestress)
    if width:
        left, damping_ratio = run.prestress.left, rounded_damping_ratio(run)
        find_numbers = partial(_numbers_for_unit_width, left, damping_ratio, run.release, fraction)
        for_unit_width = value_or(find_numbers, NO_TRANSITION)
        # All lengths and times, and the velocity, are proportional to the width.
        row |= {name: value * width for name, value in for_unit_width.items()}
    return row


def _nucleation_position(profile: Prestress) -> float:
    """Return the position of the nucleation; 0 if it contains x = 0, or if there are several.

    It is the position with the highest pre-stress, or the middle of such positions.
    """
    if profile(0.0) >= 1.0:
        return 0.0
    intervals = nucleation_intervals(profile)
    if len(intervals) != 1:
        return 0.0
    ((left, right),) = intervals
    candidates = [centre for centre, _ in profile.gaussians] + [x for x, _ in profile.points]
    inside = np.array([x for x in candidates if left <= x <= right] or [left, right])
    prestress = profile(inside)
    highest = inside[prestress == prestress.max()]
    return float(0.5 * (highest.min() + highest.max()))


@cache
def _numbers_of_first_stick(
    profile: Prestress, gamma: float, damping_ratio: float, release: str
) -> dict[str, float]:
    """Return the numbers of the transition under a displacement boundary, which is the first stick.

    The numbers are named as the columns of `predictions`.
    """
    exact = exact_transition_displacement(profile, gamma, damping_ratio, release)
    return {
        "exact_transition_time": exact.time,
        "exact_first_stick_time": exact.time,
        "exact_transition_length": exact.length,
    }


@cache
def _numbers_for_unit_width(
    left: float, damping_ratio: float, release: str, fraction: float
) -> dict[str, float]:
    """Return the numbers of the transition under a stress boundary, and those of the pulse.

    The pre-stress is a Gaussian of width 1 between the level left and 0. The pulse is measured far
    from the nucleation. The numbers are named as the columns of `predictions`.

    fraction : the transition is when the left front has covered this fraction of its way
    """
    crack = ArrestingCrack(Prestress(left, 0.0), damping_ratio, release)
    # Very close to the balance position, the left front is moved by waves that started where the
    # pre-stress is 0 to all digits. An error is then raised instead of returning a time.
    time, length = value_or(lambda: crack.transition(fraction), (math.nan, math.nan))
    return {
        "exact_largest_velocity": crack.peak_velocity,
        "exact_half_width": value_or_nan(lambda: _half_width(crack)),
        "exact_transition_time": time,
        "exact_transition_length": length,
    }


def _half_width(crack: ArrestingCrack) -> float:
    """Return the width of the pulse far from the nucleation, at half of its peak velocity.

    The pulse consists of waves that run to the right. Each wave starts at a position x when a front
    arrives there. The slip velocity of the wave is half the integral of the pre-stress to the right
    of x. This velocity is largest if the pre-stress is 0 at x, and half as large at one position on
    each side.
    """

    def excess_over_half_peak(x: float) -> float:
        """Return the slip velocity of the wave that started at x, minus half the peak velocity."""
        return 0.5 * integral(crack.prestress, x, crack.end) - 0.5 * crack.peak_velocity

    # The wave with the peak velocity starts where the left front becomes slower than the waves,
    # since the pre-stress is 0 there. To the right of crack.end it is 0 everywhere.
    start_of_peak = crack.slow_start
    ahead = root_between(excess_over_half_peak, start_of_peak, crack.end, xtol=1e-12)
    rear = root_between(excess_over_half_peak, crack.balance_position, start_of_peak, xtol=1e-12)
    # A wave keeps its value of x - t. The width is the difference of these values between the wave
    # ahead, which starts on a fast front, and the wave at the rear, on the slow left front.
    ahead_minus_time = ahead - float(crack.fronts.arrival(ahead))
    rear_minus_time = rear - crack.time_at(rear)
    return float(ahead_minus_time - rear_minus_time)
