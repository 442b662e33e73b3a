"""Time and place at which a crack becomes a pulse, by definitions that converge and the paper's."""

import numpy as np

from ..data.points import AnyRun
from ..model.balance import prestress_balance_position
from ..model.prestress import prestress_from
from .fronts import arrival, path, position_at

NAN = float("nan")
# A left front that spends more than this fraction of T_trans between two blocks is held up by the
# lattice. The error of T_trans is up to 1.5 times the fraction (five levels, three damping ratios).
STALL = 0.03


def transition_displacement(run: AnyRun) -> dict[str, float]:
    """Transition under a displacement boundary.

    T_trans is the first stick anywhere (at the nucleation point when the scene is symmetric), and
    L_trans the distance between the fronts then: both converge. The paper defines T_trans by slip
    2 tau/gamma at the nucleation point; that is measured with the tau_0 of the level and with the
    tau = 1 of the point, and is NaN where slip never reaches it.
    """
    time, position = run.attrs["first_stick_time"], run.attrs["first_stick_position"]
    length = between_fronts(run, time)
    out = {"transition_time": time, "transition_length": length, "first_stick_position": position}
    for name, tau in (("background", run.attrs["left"]), ("nucleation", run.attrs["peak"])):
        reached = slip_time(run, 2.0 * tau / run.attrs["gamma"])
        out |= {f"slip_time_{name}": reached, f"slip_length_{name}": between_fronts(run, reached)}
    return out


def between_fronts(run: AnyRun, time: float) -> float:
    """Distance between both fronts at a time; NaN for NaN."""
    if np.isnan(time):
        return NAN
    return float(position_at(run, time, "right") + position_at(run, time, "left"))


def slip_time(run: AnyRun, slip: float) -> float:
    """Time at which sampled slip nearest x = 0 reaches a value; NaN if never or not sampled."""
    if "sample_slip" not in run:
        return NAN
    centre = int(np.argmin(np.abs(np.asarray(run["sample_position"]))))
    history, times = np.asarray(run["sample_slip"])[:, centre], np.asarray(run["sample_time"])
    i = int(np.argmax(history >= slip))
    if i == 0:
        return float(times[0]) if history[0] >= slip else NAN
    fraction = (slip - history[i - 1]) / (history[i] - history[i - 1])
    return float(times[i - 1] + fraction * (times[i] - times[i - 1]))


def transition_stress(run: AnyRun, fraction: float) -> dict[str, float | str]:
    """Transition under a stress boundary, pre-stress 0 on the right and negative on the left.

    At T_trans the left front has covered ``fraction`` of |x_minus|, which converges with dx. The
    arrest (the last release on the left), which the paper draws, does not: the continuum has none.
    ``transition_state`` is "resolved", "stalled" where the lattice held the left front up on its
    way, or "not reached".
    """
    distance = abs(prestress_balance_position(prestress_from(run.attrs)))
    time, longest_wait = arrival(run, fraction * distance, "left")
    times, distances = path(run, "left")
    arrest = float(np.max(times)) if times.size else NAN
    waited = longest_wait / time
    state, right = "not reached", NAN
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
        "last_release_distance": float(distances[-1]) if distances.size else NAN,
        "last_release_length": between_fronts(run, arrest),
    }
