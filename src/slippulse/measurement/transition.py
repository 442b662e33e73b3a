"""Time and place at which a crack becomes a pulse, by definitions that converge and the paper's."""

import numpy as np

from ..data.points import AnyRun
from ..model.balance import prestress_balance_position
from ..model.prestress import prestress_from
from .front_paths import arrival, known_until, path, position_at

# A left front that spends more than this fraction of T_trans between two blocks is held up by the
# lattice. The error of T_trans is up to 1.5 times the fraction (five levels, three damping ratios).
STALL = 0.03


def transition_displacement(run: AnyRun) -> dict[str, float]:
    """First stick, and the distance between both fronts then."""
    out = first_stick(run)
    # The paper's T_trans is at slip 2 tau/gamma, with the tau of the level or the nucleation point.
    same = run.attrs["left"] == run.attrs["right"]
    background = run.attrs["left"] if same else np.nan
    for name, tau in (("background", background), ("nucleation", run.attrs["peak"])):
        reached = slip_time(run, 2.0 * tau / run.attrs["gamma"])
        out |= {f"slip_time_{name}": reached, f"slip_length_{name}": between_fronts(run, reached)}
    return out


def first_stick(run: AnyRun) -> dict[str, float]:
    """Time and position of the first stick, and the distance between both fronts then."""
    time, position = run.attrs["first_stick_time"], run.attrs["first_stick_position"]
    length = between_fronts(run, time)
    return {"transition_time": time, "transition_length": length, "first_stick_position": position}


def between_fronts(run: AnyRun, time: float) -> float:
    """Distance between both fronts at a time; NaN for NaN."""
    if np.isnan(time):
        return np.nan
    return float(position_at(run, time, "right") + position_at(run, time, "left"))


def slip_time(run: AnyRun, slip: float) -> float:
    """Time at which sampled slip nearest x = 0 reaches a value; NaN if never or not sampled."""
    if "sample_slip" not in run:
        return np.nan
    centre = int(np.argmin(np.abs(np.asarray(run["sample_position"]))))
    history, times = np.asarray(run["sample_slip"])[:, centre], np.asarray(run["sample_time"])
    i = int(np.argmax(history >= slip))
    # The slip of the first sample is 0.
    if i == 0:
        return np.nan
    fraction = (slip - history[i - 1]) / (history[i] - history[i - 1])
    return float(times[i - 1] + fraction * (times[i] - times[i - 1]))


def transition_stress(run: AnyRun, fraction: float) -> dict[str, float | str]:
    """Time and length at which the left front has covered a fraction of |x_minus|, without springs.

    They converge with dx. The arrest (the last release on the left), which the paper draws, does
    not: the continuum has none. The lattice held up a front that is "stalled".
    """
    distance = abs(prestress_balance_position(prestress_from(run.attrs)))
    time, longest_wait = arrival(run, fraction * distance, "left")
    times, distances = path(run, "left")
    known = times.size and np.isinf(known_until(run, "left"))
    arrest, end = (float(np.max(times)), float(distances[-1])) if known else (np.nan, np.nan)
    waited = longest_wait / time
    state, right = "not reached", np.nan
    if not np.isnan(time):
        state = "stalled" if waited > STALL else "resolved"
        right = float(position_at(run, time, "right"))
    return {
        "transition_time": time,
        "transition_longest_wait": waited,
        "transition_state": state,
        "transition_length": fraction * distance + right,
        "balance_distance": distance,
        "last_release_time": arrest,
        "last_release_distance": end,
        "last_release_length": between_fronts(run, arrest),
    }
