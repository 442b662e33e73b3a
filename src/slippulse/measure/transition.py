"""When and where a crack becomes a pulse: definitions that converge, and the paper's own next to them."""

import numpy as np

from ..data.points import AnyRun
from ..model.prestress import prestress_balance_position, prestress_from
from .fronts import arrival, path, position_at

NAN = float("nan")
# A left front that spends more than this fraction of T_trans between two blocks is held up by the lattice, not by the
# pre-stress alone: the error of T_trans is up to one and a half times the fraction (five levels, three damping ratios).
STALL = 0.03


def transition_displacement(run: AnyRun) -> dict[str, float]:
    """Transition under a displacement boundary.

    T_trans is the first stick anywhere (at the nucleation point when the scene is symmetric), L_trans the distance
    between the fronts then: both converge with dx. The paper defines T_trans by slip 2 tau/gamma at the nucleation
    point; it is measured with the level's tau_0 and with the tau = 1 that stands there, and is NaN where slip never
    reaches it.
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
    return (
        float(position_at(run, time, "right") + position_at(run, time, "left"))
        if time == time
        else NAN
    )


def slip_time(run: AnyRun, slip: float) -> float:
    """When slip at the sampled position nearest x = 0 reaches a value; NaN if never or if nothing was sampled."""
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

    T_trans is when the left front has covered ``fraction`` of |x_minus|, which converges with dx; the arrest (the last
    release on the left), which the paper draws, does not: in the continuum it never comes. ``transition_state`` is
    "resolved", "stalled" where the lattice held the left front up on its way, or "not reached".
    """
    distance = abs(prestress_balance_position(prestress_from(run.attrs)))
    time, longest_wait = arrival(run, fraction * distance, "left")
    times, distances = path(run, "left")
    arrest = float(np.max(times)) if times.size else NAN
    waited = longest_wait / time
    state = "not reached" if np.isnan(waited) else "stalled" if waited > STALL else "resolved"
    right = NAN if np.isnan(time) else float(position_at(run, time, "right"))
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
