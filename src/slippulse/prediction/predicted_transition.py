"""T_trans and L_trans of each run: at the first stick, or at the arrest of the left front."""

import math
from functools import cache, partial

import pandas as pd

from ..model.balance import integral, prestress_balance_position
from ..model.prestress import Prestress
from ..model.roots import root_between
from ..model.run import Run
from ..theory.arrest import ArrestingCrack
from ..theory.exact_transition import exact_transition_displacement
from .common import known, level, or_nan, ratio

# Laws of friction that these numbers hold for.
LAWS = ("coulomb",)
UNKNOWN = dict.fromkeys(("exact_transition_time", "exact_transition_length"), math.nan)


def predictions(runs: list[Run], settings: dict) -> pd.DataFrame:
    """Columns exact_NUMBER of a transition and its first stick, or its balance and far pulse."""
    return pd.DataFrame([_row(run, settings["share"]) for run in runs])


def _row(run: Run, fraction: float) -> dict[str, float]:
    row = {**UNKNOWN}
    profile = run.prestress
    # Except for the balance, theory needs one Gaussian.
    parts = profile.steps or profile.bumps or profile.points
    width = profile.width if profile.peak == 1.0 and not parts else None
    if run.boundary == "displacement":
        if width and profile.left == profile.right > 0.0:
            physics = run.gamma, ratio(run), run.release
            row |= known(lambda: _first_stick(profile, *physics), UNKNOWN)
        return row
    if level(run, "left") < 0.0 == level(run, "right"):
        row["exact_balance_distance"] = -or_nan(partial(prestress_balance_position, profile))
    if width and profile.left < 0.0 == profile.right:
        unit = known(lambda: _arrest(profile.left, ratio(run), run.release, fraction), UNKNOWN)
        # All lengths and times are proportional to the width.
        row |= {name: value * width for name, value in unit.items()}
    return row


@cache
def _first_stick(profile: Prestress, gamma: float, ratio: float, release: str) -> dict[str, float]:
    exact = exact_transition_displacement(profile, gamma, ratio, release)
    times = dict.fromkeys(("exact_transition_time", "exact_first_stick_time"), exact.time)
    return times | {"exact_transition_length": exact.length}


@cache
def _arrest(left: float, ratio: float, release: str, fraction: float) -> dict[str, float]:
    """Numbers of the left front and of the far pulse behind a Gaussian of width 1."""
    crack = ArrestingCrack(Prestress(left, 0.0), ratio, release)
    # Very near x_minus the front is held by forces that the theory leaves out.
    time, length = known(lambda: crack.transition(fraction), (math.nan, math.nan))
    return {
        "exact_largest_velocity": crack.peak_velocity,
        "exact_half_width": or_nan(lambda: _half_width(crack)),
        "exact_transition_time": time,
        "exact_transition_length": length,
    }


def _half_width(crack: ArrestingCrack) -> float:
    """Width of the far pulse at half of its peak, which is once on each side of the zero of tau."""

    def above_half(x: float) -> float:
        return integral(crack.prestress, x, crack.end) - crack.peak_velocity

    ahead = root_between(above_half, crack.zero, crack.end, xtol=1e-12)
    rear = root_between(above_half, crack.balance_position, crack.zero, xtol=1e-12)
    return float((ahead - float(crack.fronts.arrival(ahead))) - (rear - crack.time_at(rear)))
