"""Predicted regime: the one in which a rupture ends after a long time, by the exact solution."""

import numpy as np
import pandas as pd

from ..measurement.regime import UNDECIDED, pulse_regime
from ..model.run import Run
from ..theory.front_speeds import front_speed
from .common import far_level, rounded_damping_ratio

# Friction laws for which these numbers hold.
LAWS = ("coulomb",)


def predictions(runs: list[Run], settings: dict) -> pd.DataFrame:
    """Return the final regime of each run, in the column exact_regime."""
    return pd.DataFrame({"exact_regime": [_regime(run, settings["still"]) for run in runs]})


def _regime(run: Run, still_fraction: float) -> str:
    """Return the final regime of a run; UNDECIDED if its profile has bumps or is a table."""
    profile = run.prestress
    if profile.bumps or profile.points:
        return UNDECIDED
    if profile.steps:
        # A pulse that has formed in pre-stress 0 reaches the steps, which lie ahead of it. Its
        # velocity then grows by half the integral of the pre-stress that it crosses.
        has_pulse_levels = profile.left < 0.0 and profile.right == 0.0
        pulse_forms = run.boundary == "stress" and has_pulse_levels
        steps_are_ahead = all(position > 0.0 for position, _ in profile.steps)
        if not (pulse_forms and steps_are_ahead):
            return UNDECIDED
        return pulse_regime("one-way", change=far_level(run, "right"), tolerance=0.0)
    return final_regime(
        profile.left,
        profile.right,
        gamma=run.gamma,
        damping_ratio=rounded_damping_ratio(run),
        release=run.release,
        still_fraction=still_fraction,
    )


def final_regime(
    left: float,
    right: float,
    gamma: float,
    damping_ratio: float,
    release: str,
    still_fraction: float,
) -> str:
    """Return the final regime in the continuum limit, for one pre-stress level on each side.

    With leaf springs, a front into a negative level stops. A front into a positive level stays
    supersonic; the nucleation point sticks (`theory.trailing_edge`), and the pulse becomes steady
    within a finite distance. A pulse into a level 0 narrows like 1/t and decays. If one level is 0
    and the other is not negative, the regime is UNDECIDED.

    Without leaf springs, du/dt at a point is half the integral of tau between the two positions at
    which the characteristics through this point enter the rupture. If both levels are >= 0, du/dt
    never falls, and the rupture is a crack. If both are < 0, the rupture is arrested when the
    integral of tau over it vanishes, which happens at a finite size.

    There remains a level -n < 0 on one side and p >= 0 on the other. The front into -n moves such
    that the integral of tau over the rupture vanishes (`theory.arrest`): when the front into p is
    at a distance e, it is at the distance (p/n) e. Its speed tends to 1/(1 + (n/p)(1 + 1/v)), where
    v is the front speed into p: it never stops, but is slower than the waves. After a long time,
    du/dt at the nucleation point divided by its largest value in the rupture tends to
    r/(1 + 1/v + 2 r), where r = p/n. The rupture is a pulse if this is less than
    ``still_fraction``.
    """
    low, high = sorted((left, right))
    if high < 0.0:
        return "arrested"
    if gamma > 0.0:
        if low > 0.0:
            return "pulses, two-way"
        if low == 0.0:
            return UNDECIDED
        return "pulse, one-way, steady" if high > 0.0 else "pulse, one-way, decaying"
    if low >= 0.0:
        return "crack-like, two-way"
    if high == 0.0:
        return "pulse, one-way, steady"
    largest_ratio = float(
        largest_pulse_ratio(
            level=high, damping_ratio=damping_ratio, release=release, still_fraction=still_fraction
        )
    )
    becomes_pulse = high / -low < largest_ratio
    return "pulse, one-way, growing" if becomes_pulse else "crack-like, one front slow"


def largest_pulse_ratio(
    level, damping_ratio: float, release: str, still_fraction: float
) -> np.ndarray:
    """Return the ratio p/n of levels below which a rupture without leaf springs becomes a pulse.

    level : the positive level p; the ratio and the other arguments are those of `final_regime`
    """
    speed = front_speed(level, damping_ratio, release)
    return still_fraction * (1.0 + 1.0 / speed) / (1.0 - 2.0 * still_fraction)
