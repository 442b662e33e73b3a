"""Regime of a run: crack or pulse, one-way or two-way, growing, steady, decaying or arrested.

`classify_regime` finds the regime of a run. `is_pulse` defines the difference between a crack and a
pulse, and `pulse_regime` names the regime of one or two pulses. Predictions and studies use both
functions, too.
"""

import numpy as np

from ..data.points import AnyRun
from .front_paths import front_position

REGIMES = (
    "arrested",
    "crack-like, two-way",
    "crack-like, one front slow",
    "crack-like, one-way",
    "pulses, two-way",
    "pulse, one-way, growing",
    "pulse, one-way, steady",
    "pulse, one-way, decaying",
)
# Regime of a prediction if theory does not decide it, and of an exact solution if its slip velocity
# at the end is not known everywhere.
UNDECIDED = "undecided"


def classify_regime(
    run: AnyRun, still_fraction: float, steady_tolerance: float
) -> dict[str, float | str]:
    """Return the regime of a run with samples (one of REGIMES), and the numbers that decide it.

    - Arrested: at the end nearly nothing slides, or the last release was long before the end.
    - Crack or pulse: in a pulse, the nucleation point (x = 0) is at rest at the end.
    - Two-way: the rupture runs on both sides of x = 0. It runs on a side if the front there is as
      fast as the waves over the last third of the run. If neither front is, the rupture runs on the
      sides on which a block slides at the end.
    - One front slow: a crack runs on one side only, and the other front still moves.
    - Growing, steady or decaying: the change of the largest velocity of a one-way pulse over the
      last third of the run.

    still_fraction : a block counts as at rest below this fraction of the largest velocity
    steady_tolerance : largest change of a steady pulse. A front still counts as fast as the waves
        if it is slower than their speed 1 by this much, and as moving if it is faster than this
    """
    change = _change_of_largest_velocity(run)
    x, final_velocity = _final_velocity(run)
    largest = float(np.max(final_velocity))
    centre = float(final_velocity[int(np.argmin(np.abs(x)))])
    # The number of sides on which the rupture runs: those with a fast front or, if there is none,
    # those with a sliding block.
    left_speed, right_speed = _late_speed(run, "left"), _late_speed(run, "right")
    lowest_fast_speed = 1.0 - steady_tolerance
    running_sides = int(left_speed >= lowest_fast_speed) + int(right_speed >= lowest_fast_speed)
    if running_sides == 0:
        is_sliding = final_velocity >= still_fraction * largest
        running_sides = int(np.any(is_sliding[x < 0.0])) + int(np.any(is_sliding[x > 0.0]))
    ways = "two-way" if running_sides == 2 else "one-way"
    # If the rupture runs on one side, the slower front still moves unless its speed is nearly 0.
    has_slow_front = running_sides == 1 and min(left_speed, right_speed) > steady_tolerance
    # An exact solution may not know all velocities. Then they are NaN, and the regime is undecided.
    final_samples = np.asarray(run["sample_velocity"])[-1]
    if np.isnan(np.append(final_velocity, final_samples)).any():
        regime = UNDECIDED
    elif _is_arrested(run, largest, still_fraction):
        regime = "arrested"
    elif not is_pulse(centre, largest, still_fraction):
        regime = f"crack-like, {'one front slow' if has_slow_front else ways}"
    else:
        regime = pulse_regime(ways, change, steady_tolerance)
    return {
        "regime": regime,
        "centre_velocity_share": centre / largest if largest > 0.0 else np.nan,
        "largest_velocity_change": change,
        "late_front_speed_left": left_speed,
        "late_front_speed_right": right_speed,
    }


def _change_of_largest_velocity(run: AnyRun) -> float:
    """Return the relative change of the largest velocity over the last third of a run.

    The change is -1 if nothing slid at the start of this third.
    """
    times, velocity = np.asarray(run["sample_time"]), np.asarray(run["sample_velocity"])
    start = int(np.argmin(np.abs(times - 2.0 / 3.0 * times[-1])))
    largest_before, largest_after = np.max(velocity[start]), np.max(velocity[-1])
    return float(largest_after / largest_before) - 1.0 if largest_before > 0.0 else -1.0


def _final_velocity(run: AnyRun) -> tuple[np.ndarray, np.ndarray]:
    """Return positions and slip velocities at the end of a run.

    The velocities of all blocks are returned if they were recorded. Otherwise those of the samples
    are returned, which may miss a narrow or distant pulse.
    """
    if "slip_velocity" in run:
        return np.asarray(run["x"]), np.asarray(run["slip_velocity"])
    return np.asarray(run["sample_position"]), np.asarray(run["sample_velocity"])[-1]


def _is_arrested(run: AnyRun, largest: float, still_fraction: float) -> bool:
    """Return True if the rupture is nearly at rest at the end, or released its last block early.

    Early means before the last tenth of the duration: no front has moved since then. Nearly at rest
    means that the largest velocity at the end is at most ``still_fraction`` times the largest one
    of the whole run.

    largest : the largest velocity at the end
    """
    # The release time is NaN for blocks that were never released.
    last_release = float(np.nan_to_num(np.asarray(run["release_time"])).max())
    largest_ever = max(largest, float(np.max(np.asarray(run["sample_velocity"]))))
    at_rest = largest <= still_fraction * largest_ever
    return at_rest or last_release < 0.9 * run.attrs["duration"]


def is_pulse(centre: float, largest: float, still_fraction: float) -> bool:
    """Return True for a pulse: the nucleation point is (nearly) at rest while the rupture runs.

    centre : slip velocity at the nucleation point
    largest : largest slip velocity anywhere
    still_fraction : the nucleation point counts as at rest below this fraction of ``largest``
    """
    return centre < still_fraction * largest


def _late_speed(run: AnyRun, side: str) -> float:
    """Return the mean front speed over the last third of a run.

    The speed is 0 if the front starts later, or if its position is not known at the end.
    """
    start, end = 2.0 / 3.0 * run.attrs["end_time"], run.attrs["end_time"]
    start_distance, end_distance = front_position(run, [start, end], side)
    if np.isnan(start_distance) or np.isnan(end_distance):
        return 0.0
    return float((end_distance - start_distance) / (end - start))


def pulse_regime(ways: str, change: float, tolerance: float) -> str:
    """Return the regime of one or two pulses.

    ways : "one-way" or "two-way"
    change : relative change of the largest velocity of a one-way pulse
    tolerance : largest change of a steady pulse
    """
    if ways == "two-way":
        return "pulses, two-way"
    if change > tolerance:
        return "pulse, one-way, growing"
    if change < -tolerance:
        return "pulse, one-way, decaying"
    return "pulse, one-way, steady"
