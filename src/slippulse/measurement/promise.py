"""The accuracy that a simulation promises: which numbers it covers, and whether it is kept.

A simulation with the setting ``accuracy`` promises a largest relative uncertainty for some of its
measured numbers. `covered_numbers` returns the names of these numbers for a run. `judge_promises`
compares the promise with the uncertainties of a grid study, and `summarise_promises` reports the
result in one line.
"""

import math
from collections.abc import Mapping

import numpy as np
import pandas as pd

from ..model.prestress import prestress_from

SPEED_NUMBERS = {"front_speed_left": ("left",), "front_speed_right": ("right",)}
TRANSITION_NUMBERS = ("transition_time", "transition_length")
PULSE_NUMBERS = ("pulse_width", "pulse_peak_velocity", "pulse_slip", "pulse_stress_drop")
# For each boundary, the numbers that a promise can cover. A number is covered only if the front is
# fast on each of the sides after its name.
REQUIRED_FAST_SIDES: dict[str, dict[str, tuple[str, ...]]] = {
    "displacement": {
        **SPEED_NUMBERS,
        **dict.fromkeys((*TRANSITION_NUMBERS, "first_stick_time"), ("left", "right")),
        **dict.fromkeys(PULSE_NUMBERS, ("right",)),
    },
    "stress": SPEED_NUMBERS | dict.fromkeys((*TRANSITION_NUMBERS, "largest_velocity"), ()),
}
# A front counts as fast if the pre-stress on its path is at least this. In a lower pre-stress the
# front is hardly faster than the waves, and its error falls only with a power of 2/3 to 1 of dx. In
# negative pre-stress, three spacings can agree with each other and still be far from the limit.
MIN_PRESTRESS = 0.05
# If damping is weaker, oscillations of the lattice decide how long the left front stands still.
MIN_DAMPING_RATIO = 0.05
# The left front becomes slower and slower. To measure when it has covered a larger fraction of its
# path, the lattice would have to be finer.
MAX_COVERED_FRACTION = 0.95
# The summary names at most this number of runs that missed their promise.
MAX_REPORTED_MISSES = 5


def covered_numbers(run: Mapping, fraction: float) -> set[str]:
    """Return the names of the measured numbers that a promise covers; none for a flagged run.

    The error of some numbers falls fast enough with the block spacing only if the pre-stress is
    high enough, so that the front on one side, or on both sides, is fast.

    run : the row of a run in the measured table
    fraction : under a stress boundary, the transition is measured when the left front has covered
        this fraction of the balance distance |x_minus|
    """
    if run["run_flags"]:
        return set()
    fast = fast_sides(run)
    required_sides = REQUIRED_FAST_SIDES[run["boundary"]]
    names = {name for name, sides in required_sides.items() if fast.issuperset(sides)}
    names -= _excluded_numbers(run, fraction)
    return {name for name in names if math.isfinite(run.get(name, math.nan))}


def _excluded_numbers(run: Mapping, fraction: float) -> set[str]:
    """Return the names of numbers whose accuracy cannot be promised for this run.

    As the spacing falls, they do not tend to a limit, or their errors fall too slowly.

    run : the row of a run in the measured table
    fraction : the transition is measured when the left front has covered this fraction of its path
    """
    names: set[str] = set()
    if run.get("pulse_state") != "steady":
        names.update(PULSE_NUMBERS)
    # The largest velocity grows without limit between two fronts that continue to run. It tends to
    # a limit only if the left front is arrested and the pulse runs into pre-stress 0. The column
    # "beyond" has the level beyond the outermost step on the right.
    if not (run["left"] < 0.0 and run["right"] == 0.0 and run["beyond"] == 0.0):
        names.add("largest_velocity")
    # The left front becomes slower and slower. Its time converges only if the lattice has not held
    # it up ("resolved"), if it is not yet close to its final position, and if the damping removes
    # the oscillations of the lattice.
    if run["boundary"] == "stress" and (
        run.get("transition_state") != "resolved"
        or fraction > MAX_COVERED_FRACTION
        or run["damping_ratio"] < MIN_DAMPING_RATIO
    ):
        names.update(TRANSITION_NUMBERS)
    return names


def fast_sides(run: Mapping) -> set[str]:
    """Return the sides on which the front was fast: its path has no pre-stress below MIN_PRESTRESS.

    In a lower pre-stress the front is hardly faster than the waves. A side on which no front ran,
    or whose front has an unknown path, is not among the returned sides.

    run : the row of a run in the measured table
    """
    # If the pre-stress is a table of points, its lowest value on the path has been measured.
    if "lowest_prestress_left" in run:
        lowest = {side: run[f"lowest_prestress_{side}"] for side in ("left", "right")}
        # One of them is NaN if no front ran on this side. Both are NaN if the run has no table, but
        # other runs of the sweep have one.
        if any(map(math.isfinite, lowest.values())):
            return {side for side, tau in lowest.items() if tau >= MIN_PRESTRESS}
    # Otherwise the profile is evaluated up to the final position of the front, which follows from
    # the straight line that was fitted to its path.
    sides = set()
    for side, sign in (("left", -1.0), ("right", 1.0)):
        speed, intercept = run[f"front_speed_{side}"], run[f"front_intercept_{side}"]
        front = sign * (intercept + speed * run["end_time"])
        if math.isfinite(front):
            crossed_positions = np.linspace(0.0, front, int(abs(front) / run["dx"]) + 2)
            if np.min(prestress_from(run)(crossed_positions)) >= MIN_PRESTRESS:
                sides.add(side)
    return sides


def judge_promises(
    study: pd.DataFrame, measured: pd.DataFrame, promise: float, fraction: float
) -> pd.DataFrame:
    """Add to a grid study whether each of its numbers keeps the promised uncertainty.

    study : the grid study, with one row for each number (quantity) of each run (point, counted
        from 0)
    measured : the measured table at the finest spacing, with the runs in this order
    promise : largest relative uncertainty; NaN for a user-defined spacing, which promises nothing
    fraction : under a stress boundary, the transition is measured when the left front has covered
        this fraction of the balance distance

    The new column ``promised`` has the promise, and ``kept`` is "true" or "false". If the promise
    does not cover a number, ``promised`` is NaN and ``kept`` is an empty text.
    """
    # A run without flags has an empty cell, which is read as NaN.
    flags = measured["run_flags"].astype(object).fillna("")
    runs = measured.assign(run_flags=flags).to_dict("records")
    covered = [covered_numbers(run, fraction) for run in runs]
    is_promised = []
    for run_number, quantity in zip(study["point"], study["quantity"], strict=True):
        is_promised.append(math.isfinite(promise) and quantity in covered[run_number])
    # The uncertainty is NaN if a coarser lattice does not have the number. Such a number counts as
    # a miss.
    is_within = study["uncertainty"] <= promise * study["value"].abs()
    kept = np.where(is_promised, np.where(is_within, "true", "false"), "")
    return study.assign(promised=np.where(is_promised, promise, np.nan), kept=kept)


def summarise_promises(study: pd.DataFrame, promise: float) -> str:
    """Report in one line how many runs kept their promise, and which runs missed it.

    Of each run that missed it, the worst number is reported with its relative uncertainty.

    study : a grid study with the columns that `judge_promises` adds: one row for each number
        (column quantity) of each run (column point). A row has an empty text in the column kept if
        nothing was promised for this number.
    """
    if not math.isfinite(promise):
        return "the block spacing is user-defined, so no accuracy is promised"
    missed = study[study["kept"] == "false"]
    covered_count = study.loc[study["kept"] != "", "point"].nunique()
    kept_count = covered_count - missed["point"].nunique()
    text = f"accuracy {promise:g}: {kept_count} of {covered_count} runs keep it"
    relative = (missed["uncertainty"] / missed["value"].abs()).fillna(np.inf)
    misses = []
    for point, uncertainties in relative.groupby(missed["point"]):
        quantity = missed.loc[uncertainties.idxmax(), "quantity"]
        misses.append(f"{point} (error of {quantity}: {uncertainties.max():.1e})")
    if misses:
        text += f"; missed by run {', '.join(misses[:MAX_REPORTED_MISSES])}"
    if len(misses) > MAX_REPORTED_MISSES:
        text += " ..."
    uncovered_count = study["point"].nunique() - covered_count
    if uncovered_count:
        text += f"; for {uncovered_count} runs no number has a promised accuracy"
    return text
