"""Regime in which a rupture ends, however long that takes, from the exact solution."""

import numpy as np
import pandas as pd

from ..measurement.regime import UNDECIDED, pulse_regime
from ..model.run import Run
from ..theory.front_speeds import front_speed
from .common import level, ratio

# Laws of friction that these numbers hold for.
LAWS = ("coulomb",)


def predictions(runs: list[Run], settings: dict) -> pd.DataFrame:
    """Column exact_regime."""
    return pd.DataFrame({"exact_regime": [_regime(run, settings["still"]) for run in runs]})


def _regime(run: Run, still: float) -> str:
    profile = run.prestress
    if profile.bumps or profile.points:
        return UNDECIDED
    if profile.steps:
        # A pulse that formed where the pre-stress is 0 meets another level, and grows by half the
        # integral of tau.
        forms = run.boundary == "stress" and profile.left < 0.0 == profile.right
        ahead = all(position > 0.0 for position, _ in profile.steps)
        return pulse_regime("one-way", level(run, "right"), 0.0) if forms and ahead else UNDECIDED
    physics = run.gamma, ratio(run), run.release
    return final_regime(profile.left, profile.right, *physics, still)


def final_regime(
    left: float, right: float, gamma: float, damping_ratio: float, release: str, still: float
) -> str:
    """Regime in the continuum limit between two levels on both sides of a nucleation point.

    With leaf springs, a front into a negative level stops. A front into a positive level stays
    supersonic, the nucleation point sticks (`theory.trailing_edge`), and a pulse forgets its past
    in a finite distance. Into a level 0 a pulse narrows like 1/t and decays. UNDECIDED: a level 0
    without a negative one on the other side.

    Without leaf springs, du/dt at a point is half the integral of tau between the two points where
    its characteristics enter the rupture. With both levels >= 0 it never falls: a crack. With both
    < 0 the integral over all blocks that slipped vanishes at a finite size: arrest. Between -n and
    p >= 0 the front into -n moves so that the integral of tau over the rupture vanishes
    (`theory.arrest`): the point x = (p/n) e behind the other front, at e. It runs for ever, at a
    speed that tends to 1/(1 + (n/p)(1 + 1/v)), slower than the waves. For long times du/dt at the
    nucleation point, over its largest value, tends to r/(1 + 1/v + 2 r), where r = p/n and v is
    the front speed into p.
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
    pulse = high / -low < float(largest_pulse_ratio(high, damping_ratio, release, still))
    return "pulse, one-way, growing" if pulse else "crack-like, one front slow"


def largest_pulse_ratio(level, damping_ratio: float, release: str, still: float) -> np.ndarray:
    """Ratio p/n of `final_regime` below which the nucleation point comes to rest; level is p."""
    return still * (1.0 + 1.0 / front_speed(level, damping_ratio, release)) / (1.0 - 2.0 * still)
