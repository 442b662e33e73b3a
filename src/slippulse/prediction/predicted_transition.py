"""Predicted T_trans and L_trans of each run, by the exact theory.

Under a displacement boundary the transition is the first stick. Under a stress boundary the left
front has then covered a given fraction of its way to the balance position.
"""

import math
from functools import cache, partial

import pandas as pd

from ..model.balance import integral, prestress_balance_position
from ..model.prestress import Prestress
from ..model.roots import root_between
from ..model.run import Run
from ..theory.arrest import ArrestingCrack
from ..theory.exact_transition import exact_transition_displacement
from .common import far_level, rounded_damping_ratio, value_or, value_or_nan

# Friction laws for which these numbers hold.
LAWS = ("coulomb",)
NO_TRANSITION = dict.fromkeys(("exact_transition_time", "exact_transition_length"), math.nan)


def predictions(runs: list[Run], settings: dict) -> pd.DataFrame:
    """Return the numbers of the transition, one row for each run; NaN if theory has none.

    The columns are exact_transition_time and exact_transition_length. Under a displacement boundary
    there is also exact_first_stick_time. Under a stress boundary there are also
    exact_balance_distance and, for the pulse far from the nucleation, exact_largest_velocity and
    exact_half_width.
    """
    return pd.DataFrame([_row(run, settings["fraction"]) for run in runs])


def _row(run: Run, fraction: float) -> dict[str, float]:
    """Return one row of `predictions`."""
    if run.boundary == "displacement":
        return _row_under_displacement(run)
    return _row_under_stress(run, fraction)


def _gaussian_width(profile: Prestress) -> float | None:
    """Return the width of a profile that is a single Gaussian; None for any other profile."""
    has_parts = profile.steps or profile.bumps or profile.points
    return profile.width if profile.peak == 1.0 and not has_parts else None


def _row_under_displacement(run: Run) -> dict[str, float]:
    """Return the numbers of the first stick of a single Gaussian between equal levels."""
    profile = run.prestress
    if not (_gaussian_width(profile) and profile.left == profile.right > 0.0):
        return {**NO_TRANSITION}
    find_stick = partial(_first_stick, profile, run.gamma, rounded_damping_ratio(run), run.release)
    return NO_TRANSITION | value_or(find_stick, NO_TRANSITION)


def _row_under_stress(run: Run, fraction: float) -> dict[str, float]:
    """Return the balance distance and, for a single Gaussian, the numbers of the arrest."""
    row = {**NO_TRANSITION}
    profile, ratio = run.prestress, rounded_damping_ratio(run)
    if far_level(run, "left") < 0.0 and far_level(run, "right") == 0.0:
        balance_position = value_or_nan(partial(prestress_balance_position, profile))
        row["exact_balance_distance"] = -balance_position
    width = _gaussian_width(profile)
    if width and profile.left < 0.0 and profile.right == 0.0:
        find_arrest = partial(_arrest, profile.left, ratio, run.release, fraction)
        for_unit_width = value_or(find_arrest, NO_TRANSITION)
        # All lengths and times, and the velocity, are proportional to the width.
        row |= {name: value * width for name, value in for_unit_width.items()}
    return row


@cache
def _first_stick(profile: Prestress, gamma: float, ratio: float, release: str) -> dict[str, float]:
    """Return the transition under a displacement boundary, which is the first stick."""
    exact = exact_transition_displacement(profile, gamma, ratio, release)
    times = dict.fromkeys(("exact_transition_time", "exact_first_stick_time"), exact.time)
    return times | {"exact_transition_length": exact.length}


@cache
def _arrest(left: float, ratio: float, release: str, fraction: float) -> dict[str, float]:
    """Return the transition under a stress boundary, and numbers of the pulse, for width 1."""
    crack = ArrestingCrack(Prestress(left, 0.0), ratio, release)
    # Very close to the balance position, forces that the theory neglects hold the front, and the
    # theory refuses to give a time.
    time, length = value_or(lambda: crack.transition(fraction), (math.nan, math.nan))
    return {
        "exact_largest_velocity": crack.peak_velocity,
        "exact_half_width": value_or_nan(lambda: _half_width(crack)),
        "exact_transition_time": time,
        "exact_transition_length": length,
    }


def _half_width(crack: ArrestingCrack) -> float:
    """Return the full width, at half of its peak velocity, of the pulse far from the nucleation.

    In the pulse, slip velocity at the characteristic from x is half the integral of tau from x to
    the end. It is half of its peak once on each side of the zero of tau.
    """

    def above_half(x: float) -> float:
        """Return twice the slip velocity at the characteristic from x, less the peak velocity."""
        return integral(crack.prestress, x, crack.end) - crack.peak_velocity

    ahead = root_between(above_half, crack.slow_start, crack.end, xtol=1e-12)
    rear = root_between(above_half, crack.balance_position, crack.slow_start, xtol=1e-12)
    # The width is the distance of the two characteristics x - t = const.
    return float((ahead - float(crack.fronts.arrival(ahead))) - (rear - crack.time_at(rear)))
