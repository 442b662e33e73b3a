"""The regime that a rupture ends in, however long it takes: from the exact solution, for the class of a finite run."""

import numpy as np
import pandas as pd

from ..measurement.regime import UNDECIDED
from ..model.checks import check_number
from ..model.scene import Scene
from ..theory.front_speeds import front_speed
from .numbers import level, ratio


def predictions(scenes: list[Scene], settings: dict) -> pd.DataFrame:
    """exact_regime of each run. Settings: still, as `final_regime` takes it."""
    return pd.DataFrame({"exact_regime": [_regime(scene, settings["still"]) for scene in scenes]})


def _regime(scene: Scene, still: float) -> str:
    profile = scene.prestress
    if profile.bumps:
        return UNDECIDED
    if profile.steps:
        # A pulse that formed where the pre-stress is 0 meets another level.
        formed = scene.boundary == "stress" and profile.left < 0.0 == profile.right
        ahead = all(position > 0.0 for position, _ in profile.steps)
        return growth_beyond(level(scene, "right")) if formed and ahead else UNDECIDED
    return final_regime(
        profile.left, profile.right, scene.gamma, ratio(scene), scene.release, still
    )


def final_regime(
    left: float, right: float, gamma: float, damping_ratio: float, release: str, still: float
) -> str:
    """The regime of `measure.regime` that a rupture between two levels comes to in the continuum limit, or UNDECIDED.

    left, right : levels of the pre-stress, below 1, with one nucleation point between them
    gamma : elasticity ratio, or 0 for the stress boundary
    damping_ratio, release : beta/dx and the release rule, which set the front speed
    still : fraction of the largest velocity below which the nucleation point counts as at rest, as in `classify`

    With leaf springs a front into a negative level stops, one into a positive level outruns the waves for good, the
    nucleation point sticks (`trailing`), and a pulse forgets its past in a finite distance. Into a level 0 it gets
    narrower like 1/t and dies away; of a level 0 with no negative one opposite nothing is said.

    Without them du/dt at a point is half the integral of tau between the two entry points of its characteristics. With
    both levels >= 0 it never falls: a crack. With both < 0 the integral over all that slipped vanishes at a finite
    size: arrest. With -n on one side and p >= 0 on the other the front into -n follows Int tau = 0 (`arrest`), so that
    x = (p/n) e behind the other front at e. For large times du/dt at the nucleation point, over its largest value, is
    then r/(1 + 1/v + 2 r), r = p/n, with the front speed v into p.

    Source: sections 5 and 6 of the theory of this project (`theory.rupture`), which the tests follow to these ends.
    """
    for name, side in (("left", left), ("right", right)):
        check_number(name, side, below=1.0)
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
    return "pulse, one-way, growing" if pulse else "crack-like, one-way"


def largest_pulse_ratio(level, damping_ratio: float, release: str, still: float) -> np.ndarray:
    """The ratio r = p/n of `final_regime` below which the nucleation point comes to rest, by the level p > 0."""
    return still * (1.0 + 1.0 / front_speed(level, damping_ratio, release)) / (1.0 - 2.0 * still)


def growth_beyond(level: float) -> str:
    """Regime of a pulse of a stress boundary in a level: the velocity on its characteristics grows by half Int tau."""
    change = "growing" if level > 0.0 else "decaying" if level < 0.0 else "steady"
    return f"pulse, one-way, {change}"
