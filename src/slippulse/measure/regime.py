"""Crack-like or pulse-like, one-way or two-way, growing, steady, decaying or arrested: the rule, as code."""

import numpy as np

from ..data.points import AnyRun
from .fronts import position_at

REGIMES = (
    "arrested",
    "crack-like, two-way",
    "crack-like, one-way",
    "pulses, two-way",
    "pulse, one-way, growing",
    "pulse, one-way, steady",
    "pulse, one-way, decaying",
)
# In place of one of them, where theory does not say which a rupture ends in.
UNDECIDED = "undecided"


def classify(run: AnyRun, still: float, steady_tolerance: float) -> dict[str, float | str]:
    """Classify a run by its slip velocity at the end, and at two thirds of its duration.

    run : with samples of slip velocity over time and position; how it ends is taken from the blocks themselves where
        their slip velocity at the end is there, since samples may miss what is narrow or far
    still : a velocity below this fraction of the largest one now (or, for arrest, of the largest one sampled) is rest
    steady_tolerance : a largest velocity that changes less than this fraction over the last third is steady; a front
        this fraction slower than the waves still keeps up with them

    Returns `regime`, one of REGIMES, and the numbers it is decided by. *Arrested*: no release in the last tenth of the
    duration, or what still slides has less than ``still`` of the largest velocity sampled. Otherwise a side *runs* if
    its front keeps up with the waves over the last third, or, where neither does, if blocks on it slide at ``still`` or
    more of the largest velocity now. *Two-way*: both sides run; *one-way*: one. *Crack-like*: the nucleation point
    slides at ``still`` or more of the largest velocity; *pulse*: it does not. A one-way pulse is *growing*, *steady* or
    *decaying* by the change of its largest velocity over the last third.
    """
    times, velocity = np.asarray(run["sample_time"]), np.asarray(run["sample_velocity"])
    before = velocity[int(np.argmin(np.abs(times - 2.0 / 3.0 * times[-1])))]
    change = float(np.max(velocity[-1]) / np.max(before)) - 1.0 if np.max(before) > 0.0 else -1.0
    if "slip_velocity" in run:
        x, now = np.asarray(run["x"]), np.asarray(run["slip_velocity"])
    else:
        x, now = np.asarray(run["sample_position"]), velocity[-1]
    largest_now = float(np.max(now))
    largest_ever = max(largest_now, float(np.max(velocity)))
    centre = float(now[int(np.argmin(np.abs(x)))])
    latest = float(np.nan_to_num(np.asarray(run["release_time"])).max())

    window = np.array([2.0 / 3.0, 1.0]) * run.attrs["end_time"]
    speeds = {}
    for side in ("left", "right"):
        covered = position_at(run, window, side)
        speeds[side] = (
            float(np.diff(covered)[0] / np.diff(window)[0]) if np.isfinite(covered).all() else 0.0
        )
    keeps_up = {side: speed >= 1.0 - steady_tolerance for side, speed in speeds.items()}
    slides = {
        side: bool(np.max(now[sign * x > 0.0], initial=0.0) >= still * largest_now)
        for side, sign in (("left", -1.0), ("right", 1.0))
    }
    running = sum((keeps_up if any(keeps_up.values()) else slides).values())

    if largest_now <= still * largest_ever or latest < 0.9 * run.attrs["duration"]:
        regime = "arrested"
    elif centre >= still * largest_now:
        regime = "crack-like, two-way" if running == 2 else "crack-like, one-way"
    elif running == 2:
        regime = "pulses, two-way"
    elif change > steady_tolerance:
        regime = "pulse, one-way, growing"
    elif change < -steady_tolerance:
        regime = "pulse, one-way, decaying"
    else:
        regime = "pulse, one-way, steady"
    return {
        "regime": regime,
        "centre_velocity_share": centre / largest_now if largest_now > 0.0 else float("nan"),
        "largest_velocity_change": change,
        "late_front_speed_left": speeds["left"],
        "late_front_speed_right": speeds["right"],
    }
