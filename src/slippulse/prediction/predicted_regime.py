"""Predicted regime of each run: crack or pulse, after a long time, by the exact solution."""

import numpy as np
import pandas as pd

from ..measurement.regime import UNDECIDED
from ..model.run import Run
from ..theory.front_speeds import front_speed
from .common import rounded_damping_ratio

# Friction laws for which the regime is valid.
LAWS = ("coulomb",)


def predictions(runs: list[Run], settings: dict) -> pd.DataFrame:
    """Return the final regime of each run, in the column exact_regime.

    The setting ``still`` is the fraction of the largest slip velocity below which a point counts as
    at rest.
    """
    return pd.DataFrame({"exact_regime": [_regime(run, settings["still"]) for run in runs]})


def _regime(run: Run, still_fraction: float) -> str:
    """Return the final regime of a run; UNDECIDED if its profile has bumps or is a table.

    Theory knows most final regimes if each side has a constant level (`final_regime`). If there
    are steps, it knows only that of a single pulse that passes all of them.

    still_fraction : a point is at rest below this fraction of the largest slip velocity
    """
    profile = run.prestress
    if profile.bumps or profile.points:
        return UNDECIDED
    # Without bumps and points, a rupture can only start at x = 0.
    if profile(0.0) < 1.0:
        return "arrested"
    levels = (profile.left, profile.right)
    if profile.steps:
        levels_of_pulse = _levels_around_pulse(run)
        if levels_of_pulse is None:
            return UNDECIDED
        # With two negative levels, `final_regime` would return "arrested", since it assumes that
        # both fronts stop near x = 0. Here a pulse has left x = 0 long before it enters the second
        # negative level, where its velocity falls with the integral of the pre-stress.
        if max(levels_of_pulse) < 0.0:
            return "pulse, one-way, decaying"
        levels = levels_of_pulse
    return final_regime(
        *levels,
        gamma=run.gamma,
        damping_ratio=rounded_damping_ratio(run),
        release=run.release,
        still_fraction=still_fraction,
    )


def _levels_around_pulse(run: Run) -> tuple[float, float] | None:
    """Return the levels behind and ahead of a pulse that has passed all steps of the pre-stress.

    These two levels decide the final regime. Such a pulse is certain only under a stress boundary
    if one side is negative and the other is 0: the pulse then runs away from the negative level,
    into the level 0. Before the last step, only a negative level could stop it. The result is None
    in all other cases.
    """
    profile = run.prestress
    level_behind = min(profile.left, profile.right)
    is_one_way = level_behind < 0.0 and max(profile.left, profile.right) == 0.0
    if run.boundary != "stress" or not is_one_way:
        return None
    # Direction of the pulse, and steps in the order in which it reaches them.
    direction = 1.0 if profile.left < 0.0 else -1.0
    steps = sorted((direction * position, level) for position, level in profile.steps)
    first_position, _ = steps[0]
    *levels_on_the_way, level_beyond = [level for _, level in steps]
    if first_position < 0.0 or min(levels_on_the_way, default=0.0) < 0.0:
        return None
    return level_behind, level_beyond


def final_regime(
    left: float,
    right: float,
    gamma: float,
    damping_ratio: float,
    release: str,
    still_fraction: float,
) -> str:
    """Return the final regime in the continuum limit, for one pre-stress level on each side.

    left and right are the levels. A rupture is a pulse if the slip velocity at the nucleation point
    is less than ``still_fraction`` times the largest slip velocity.
    """
    low, high = sorted((left, right))
    # Both fronts run into a negative level. With leaf springs (gamma > 0), such a front stops.
    # Without them, the rupture stops when the integral of the pre-stress over it is 0.
    if high < 0.0:
        return "arrested"
    if gamma > 0.0:
        # A front into a positive level remains faster than the waves. Behind it the nucleation
        # point sticks, and the pulse becomes steady within a finite distance.
        if low > 0.0:
            return "pulses, two-way"
        # A pulse into the level 0 becomes narrower in proportion to 1/t, and decays. Theory does
        # not decide whether it lasts long enough to count as a second pulse.
        if low == 0.0:
            return UNDECIDED
        return "pulse, one-way, steady" if high > 0.0 else "pulse, one-way, decaying"
    # Without leaf springs, du/dt at a point is half the integral of the pre-stress tau between the
    # two positions where the characteristics through this point enter the rupture. If neither level
    # is negative, du/dt therefore never falls.
    if low >= 0.0:
        return "crack-like, two-way"
    # From here on, low is negative. A pulse into the level 0 keeps its shape.
    if high == 0.0:
        return "pulse, one-way, steady"
    # There remains a level -n < 0 on one side and a level p > 0 on the other. The front into p
    # keeps running, and its waves move the front into -n, which is slower than they are but never
    # stops. The smaller p/n, the slower is this front, and the smaller is the velocity at the
    # nucleation point in comparison with the largest one.
    largest_ratio = float(
        largest_pulse_ratio(
            level=high, damping_ratio=damping_ratio, release=release, still_fraction=still_fraction
        )
    )
    is_pulse = high / -low < largest_ratio
    return "pulse, one-way, growing" if is_pulse else "crack-like, one front slow"


def largest_pulse_ratio(
    level, damping_ratio: float, release: str, still_fraction: float
) -> np.ndarray:
    """Return the ratio p/n of levels below which a rupture without leaf springs becomes a pulse.

    The pre-stress level is p > 0 on one side, and -n < 0 on the other. A wave that started on the
    front into p, at a distance e from the nucleation point, moves the front into -n to the distance
    (p/n) e, where the integral of the pre-stress between the two positions is 0. With r = p/n and
    the speed v of the front into p, the slip velocity at the nucleation point therefore tends to
    r/(1 + 1/v + 2 r) times the largest one. A pulse needs less than ``still_fraction``. The factor
    is always below 1/2, so the result is infinite if ``still_fraction`` is 1/2 or more.

    level : the positive level p, a number or an array
    """
    speed = front_speed(level, damping_ratio, release)
    if still_fraction >= 0.5:
        return np.full_like(speed, np.inf)
    return still_fraction * (1.0 + 1.0 / speed) / (1.0 - 2.0 * still_fraction)
