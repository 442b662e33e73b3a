"""Regime of a run: crack or pulse, one-way or two-way, growing, steady, decaying or arrested.

`classify_regime` finds the regime of a run. `is_pulse` is the only definition of a pulse, and
`pulse_regime` names the regime of one or two pulses; theory uses both as well.
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
# Regime of a prediction that theory does not decide, and of an exact solution whose end is not
# completely known.
UNDECIDED = "undecided"


def classify_regime(
    run: AnyRun, still_fraction: float, steady_tolerance: float
) -> dict[str, float | str]:
    """Return the regime of a run with samples (one of REGIMES), and the numbers that decide it.

    A rupture is two-way if it runs on both sides of x = 0. It runs on a side if the front there is
    as fast as the waves over the last third of the run, to within ``steady_tolerance``. If neither
    front is, the rupture runs where, at the end, a block slides at least at ``still_fraction``
    times the largest velocity. A crack that runs on one side only has "one front slow" if the other
    front still moves. A rupture is arrested if no block was released in the last tenth of the
    duration, or if the velocity at the end is at most ``still_fraction`` times an earlier one. A
    one-way pulse grows, decays or is steady according to the change of its largest velocity over
    the last third of the run.
    """
    change = _change_of_largest_velocity(run)
    x, final_velocity = _final_velocity(run)
    largest = float(np.max(final_velocity))
    centre = float(final_velocity[int(np.argmin(np.abs(x)))])
    left_speed, right_speed = (_late_speed(run, side) for side in ("left", "right"))
    slowest_fast = 1.0 - steady_tolerance
    fast_sides = int(left_speed >= slowest_fast) + int(right_speed >= slowest_fast)
    slides = final_velocity >= still_fraction * largest
    sliding_sides = int(np.any(slides[x < 0.0])) + int(np.any(slides[x > 0.0]))
    running_sides = fast_sides if fast_sides > 0 else sliding_sides
    ways = "two-way" if running_sides == 2 else "one-way"
    # On a crack that runs on one side, the slower front still moves if its speed is not nearly 0.
    has_slow_front = running_sides == 1 and min(left_speed, right_speed) > steady_tolerance
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

    It is -1 if nothing slid at the start of this third.
    """
    times, velocity = np.asarray(run["sample_time"]), np.asarray(run["sample_velocity"])
    start = int(np.argmin(np.abs(times - 2.0 / 3.0 * times[-1])))
    largest_before, largest_after = np.max(velocity[start]), np.max(velocity[-1])
    return float(largest_after / largest_before) - 1.0 if largest_before > 0.0 else -1.0


def _final_velocity(run: AnyRun) -> tuple[np.ndarray, np.ndarray]:
    """Return positions and slip velocities at the end of a run.

    They are those of all blocks if recorded, else those of the samples, which may miss a narrow or
    distant pulse.
    """
    if "slip_velocity" in run:
        return np.asarray(run["x"]), np.asarray(run["slip_velocity"])
    return np.asarray(run["sample_position"]), np.asarray(run["sample_velocity"])[-1]


def _is_arrested(run: AnyRun, largest: float, still_fraction: float) -> bool:
    """Return True if the rupture is nearly at rest at the end, or was released last long before."""
    last_release = float(np.nan_to_num(np.asarray(run["release_time"])).max())
    largest_ever = max(largest, float(np.max(np.asarray(run["sample_velocity"]))))
    at_rest = largest <= still_fraction * largest_ever
    return at_rest or last_release < 0.9 * run.attrs["duration"]


def is_pulse(centre: float, largest: float, still_fraction: float) -> bool:
    """Return True for a pulse: the nucleation point is (nearly) at rest while the rupture runs.

    centre, largest : slip velocity at the nucleation point, and the largest one anywhere
    still_fraction : fraction of the largest velocity below which the nucleation point counts as at
        rest
    """
    return centre < still_fraction * largest


def _late_speed(run: AnyRun, side: str) -> float:
    """Return the mean front speed over the last third of a run; 0 if the front starts later."""
    window = np.array([2.0 / 3.0, 1.0]) * run.attrs["end_time"]
    distances = front_position(run, window, side)
    if not np.isfinite(distances).all():
        return 0.0
    return float(np.diff(distances)[0] / np.diff(window)[0])


def pulse_regime(ways: str, change: float, tolerance: float) -> str:
    """Return the regime of one or two pulses.

    ways : "one-way" or "two-way"
    change : relative change of the largest velocity; a pulse is steady up to the tolerance
    """
    if ways == "two-way":
        return "pulses, two-way"
    if change > tolerance:
        return "pulse, one-way, growing"
    return f"pulse, one-way, {'decaying' if change < -tolerance else 'steady'}"
