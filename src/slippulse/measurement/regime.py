"""Regime of a run: crack or pulse, one-way or two-way, growing, steady, decaying or arrested."""

import numpy as np

from ..data.points import AnyRun
from .front_paths import position_at

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
# In place of one of them, where theory does not say which a rupture ends in, or an exact solution
# does not know all of its end.
UNDECIDED = "undecided"


def classify(run: AnyRun, still: float, steady_tolerance: float) -> dict[str, float | str]:
    """Regime, one of REGIMES, of a run with samples, and the numbers that it is decided by.

    A side *runs* if its front keeps up with the waves over the last third, to within the tolerance,
    or, where neither does, if blocks on it slide at ``still`` or more of the largest velocity now.
    A crack that runs on one side alone has one front slow if the other front moves on, too.
    A one-way pulse grows, decays or is steady by the change of its largest velocity over that time.
    """
    times, velocity = np.asarray(run["sample_time"]), np.asarray(run["sample_velocity"])
    before = np.max(velocity[int(np.argmin(np.abs(times - 2.0 / 3.0 * times[-1])))])
    change = float(np.max(velocity[-1]) / before) - 1.0 if before > 0.0 else -1.0
    # Samples may miss a narrow or distant pulse.
    if "slip_velocity" in run:
        x, now = np.asarray(run["x"]), np.asarray(run["slip_velocity"])
    else:
        x, now = np.asarray(run["sample_position"]), velocity[-1]
    largest = float(np.max(now))
    centre = float(now[int(np.argmin(np.abs(x)))])
    speeds = [_late_speed(run, side) for side in ("left", "right")]
    keeping_up = sum(speed >= 1.0 - steady_tolerance for speed in speeds)
    sliding = now >= still * largest
    running = keeping_up or int(np.any(sliding[x < 0.0])) + int(np.any(sliding[x > 0.0]))
    latest = float(np.nan_to_num(np.asarray(run["release_time"])).max())
    ways = "two-way" if running == 2 else "one-way"
    slow = running == 1 and min(speeds) > steady_tolerance
    # Arrest is no release in the last tenth of the duration, or rest beside any earlier sample.
    at_rest = largest <= still * max(largest, float(np.max(velocity)))
    if np.isnan(now).any() or np.isnan(velocity[-1]).any():
        regime = UNDECIDED
    elif at_rest or latest < 0.9 * run.attrs["duration"]:
        regime = "arrested"
    elif not is_pulse(centre, largest, still):
        regime = f"crack-like, {'one front slow' if slow else ways}"
    else:
        regime = pulse_regime(ways, change, steady_tolerance)
    return {
        "regime": regime,
        "centre_velocity_share": centre / largest if largest > 0.0 else np.nan,
        "largest_velocity_change": change,
        "late_front_speed_left": speeds[0],
        "late_front_speed_right": speeds[1],
    }


def is_pulse(centre: float, largest: float, still: float) -> bool:
    """The one definition of a pulse: its nucleation point is at rest, or nearly, while it runs."""
    return centre < still * largest


def _late_speed(run: AnyRun, side: str) -> float:
    """Mean speed of a front over the last third of a run; 0 where it has not begun by then."""
    window = np.array([2.0 / 3.0, 1.0]) * run.attrs["end_time"]
    covered = position_at(run, window, side)
    known = np.isfinite(covered).all()
    return float(np.diff(covered)[0] / np.diff(window)[0]) if known else 0.0


def pulse_regime(ways: str, change: float, tolerance: float) -> str:
    """Regime of one or two pulses, by the relative change of the largest velocity."""
    if ways == "two-way":
        return "pulses, two-way"
    if change > tolerance:
        return "pulse, one-way, growing"
    return f"pulse, one-way, {'decaying' if change < -tolerance else 'steady'}"
