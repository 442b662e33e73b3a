"""When and where the rupture of each run turns into pulses: the first stick, or the arrest of the left front."""

from functools import cache, partial

import pandas as pd

from ..model.prestress import Prestress, prestress_balance_position
from ..model.roots import root_between
from ..model.scene import Scene
from ..theory.arrest import ArrestingCrack
from ..theory.exact_transition import exact_transition_displacement
from .numbers import NAN, known, level, or_nan, ratio


def predictions(scenes: list[Scene], settings: dict) -> pd.DataFrame:
    """exact_transition_time and _length; of a displacement boundary exact_first_stick_time; of a stress boundary
    exact_balance_distance, and exact_largest_velocity and exact_half_width of the far pulse. Settings: share, of
    |x_minus| that the left front has covered at T_trans under a stress boundary. Source: `theory`; but for the balance,
    for a Gaussian of peak 1 without steps and bumps.
    """
    rows = []
    for scene in scenes:
        profile, held = scene.prestress, scene.boundary == "displacement"
        row = {"exact_transition_time": NAN, "exact_transition_length": NAN}
        if not held and level(scene, "left") < 0.0 == level(scene, "right"):
            row["exact_balance_distance"] = -or_nan(partial(prestress_balance_position, profile))
        if not profile.steps and not profile.bumps and profile.peak == 1.0:
            if held and profile.left == profile.right > 0.0:
                row |= _first_stick(
                    profile.left, profile.width, scene.gamma, ratio(scene), scene.release
                )
            elif not held and profile.left < 0.0 == profile.right:
                unit = _arrest(profile.left, ratio(scene), scene.release, settings["share"])
                # All lengths and times go with the width.
                row |= {name: value * profile.width for name, value in unit.items()}
        rows.append(row)
    return pd.DataFrame(rows)


@cache
def _first_stick(
    level: float, width: float, gamma: float, ratio: float, release: str
) -> dict[str, float]:
    profile = Prestress(level, level, width)
    # None with more panels than theory allows, or more damping.
    if exact := known(lambda: exact_transition_displacement(profile, gamma, ratio, release)):
        names = ("exact_transition_time", "exact_first_stick_time", "exact_transition_length")
        return dict(zip(names, (exact.time, exact.time, exact.length), strict=True))
    return {}


@cache
def _arrest(left: float, ratio: float, release: str, fraction: float) -> dict[str, float]:
    """Numbers of the left front and of the far pulse behind a Gaussian of width 1."""
    crack = known(lambda: ArrestingCrack(Prestress(left, 0.0), ratio, release))
    if crack is None:
        return {}
    # Very near x_minus the front is held by what theory leaves out.
    return {
        "exact_largest_velocity": crack.peak_velocity,
        "exact_half_width": or_nan(lambda: _half_width(crack)),
        "exact_transition_time": or_nan(lambda: crack.time_at_fraction(fraction)),
        "exact_transition_length": or_nan(lambda: crack.length_at_fraction(fraction)),
    }


def _half_width(crack: ArrestingCrack) -> float:
    """Width of the far pulse at half of its peak: du/dt is half the integral of tau from the entry point on, on each
    side of its zero (`ArrestingCrack`).
    """
    far = crack.end

    def above_half(x: float) -> float:
        return crack.prestress.integral(x, far) - crack.peak_velocity

    ahead = root_between(above_half, crack.zero, far, xtol=1e-12)
    behind = root_between(above_half, crack.balance_position, crack.zero, xtol=1e-12)
    return float((ahead - float(crack.fronts.arrival(ahead))) - (behind - crack.time_at(behind)))
