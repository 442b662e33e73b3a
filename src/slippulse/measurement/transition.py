"""Time and length of the transition from a crack to a pulse.

Under a displacement boundary the transition is the first stick. Under a stress boundary it is the
moment at which the left front has covered a given fraction of its way to the balance position. By
both definitions, time and length converge as the block spacing falls. The numbers by the paper's
own definitions are measured as well.
"""

import numpy as np

from ..data.points import AnyRun
from ..model.balance import prestress_balance_position
from ..model.prestress import prestress_from
from ..model.scene import gamma_without_extra_terms
from .front_paths import arrival, front_path, front_position, is_known_to_end
from .nucleation import position_of_nucleation

# The lattice holds up the left front if the front waits between two blocks for more than this
# fraction of T_trans. The relative error of T_trans is up to 1.5 times the fraction that the front
# waits (tested with five levels and three damping ratios).
STALLED_WAIT_FRACTION = 0.03


def transition_displacement(run: AnyRun) -> dict[str, float]:
    """Return time and length of the transition under a displacement boundary, by two definitions.

    The first definition is the first stick. The second definition is printed in the paper: the slip
    at x = 0 reaches 2 tau/gamma. The paper leaves open which pre-stress tau this is. Names that end
    in "background" use the level far from the nucleation, and are NaN if the levels on the left and
    on the right differ. Names that end in "nucleation" use the peak of the Gaussian at x = 0. All
    numbers of the second definition are NaN if the equation of motion has an extra term.
    """
    transition = first_stick(run)
    has_one_level = run.attrs["left"] == run.attrs["right"]
    background = run.attrs["left"] if has_one_level else np.nan
    for name, tau in (("background", background), ("nucleation", run.attrs["peak"])):
        time = slip_time(run, 2.0 * tau / gamma_without_extra_terms(run.attrs))
        transition[f"slip_time_{name}"] = time
        transition[f"slip_length_{name}"] = between_fronts(run, time)
    return transition


def first_stick(run: AnyRun) -> dict[str, float]:
    """Return the time and position of the first stick, and the rupture length at that time."""
    time, position = run.attrs["first_stick_time"], run.attrs["first_stick_position"]
    length = between_fronts(run, time)
    return {"transition_time": time, "transition_length": length, "first_stick_position": position}


def between_fronts(run: AnyRun, time: float) -> float:
    """Return the distance between the two fronts at a time; NaN if the time is NaN."""
    if np.isnan(time):
        return np.nan
    # The function front_position returns the distance of a front from x = 0, on either side.
    return float(front_position(run, time, "right") + front_position(run, time, "left"))


def slip_time(run: AnyRun, slip: float) -> float:
    """Return the time at which the sampled position nearest to x = 0 reaches a slip.

    NaN if it never does, or already at the first sample, or if the run has no samples.
    """
    if "sample_slip" not in run or np.size(run["sample_slip"]) == 0:
        return np.nan
    centre = int(np.argmin(np.abs(np.asarray(run["sample_position"]))))
    slips, times = np.asarray(run["sample_slip"])[:, centre], np.asarray(run["sample_time"])
    # The first sample at which the slip is reached. The result of argmax is 0 if there is none.
    after = int(np.argmax(slips >= slip))
    if after == 0:
        return np.nan
    # The slip is interpolated between the samples before and after.
    before = after - 1
    fraction = (slip - slips[before]) / (slips[after] - slips[before])
    return float(times[before] + fraction * (times[after] - times[before]))


def transition_stress(run: AnyRun, fraction: float) -> dict[str, float | str]:
    """Return the numbers of the transition under a stress boundary.

    Names that begin with "transition" belong to the moment at which the left front has covered a
    fraction of the balance distance |x_minus|. These numbers converge as dx falls. Names that begin
    with "last_release" belong to the last release on the left, which the paper draws as the arrest.
    They do not converge, because in the continuum the front never stops.

    The transition state is "resolved", "stalled" (the lattice held up the front), or "not reached"
    (time and length are NaN). transition_longest_wait is the longest time between two successive
    releases on the way there, as a fraction of the transition time.
    """
    balance_position = prestress_balance_position(prestress_from(run.attrs))
    balance_distance = abs(balance_position - position_of_nucleation(run))
    time, longest_wait = arrival(run, fraction * balance_distance, "left")
    wait_fraction = longest_wait / time
    state, right_distance = "not reached", np.nan
    if not np.isnan(time):
        state = "stalled" if wait_fraction > STALLED_WAIT_FRACTION else "resolved"
        right_distance = float(front_position(run, time, "right"))
    # An exact solution may not know the front until the end. Then the last release is not known.
    release_times, distances = front_path(run, "left")
    last_time, last_distance = np.nan, np.nan
    if release_times.size and is_known_to_end(run, "left"):
        last_time, last_distance = float(np.max(release_times)), float(distances[-1])
    return {
        "transition_time": time,
        "transition_longest_wait": wait_fraction,
        "transition_state": state,
        "transition_length": fraction * balance_distance + right_distance,
        "balance_distance": balance_distance,
        "last_release_time": last_time,
        "last_release_distance": last_distance,
        "last_release_length": between_fronts(run, last_time),
    }
