"""The accuracy that a simulation promises: the numbers it covers, and a test by a grid study.

A simulation with the setting ``accuracy`` promises a relative uncertainty for some of its measured
numbers. `covered_numbers` finds them for a run. `judge_promises` compares the promise with the
uncertainties of a grid study, and `summarise_promises` reports the result in one line.
"""

import math
from collections.abc import Mapping

import numpy as np
import pandas as pd

from ..model.prestress import prestress_from

SPEED_NUMBERS = {"front_speed_left": ("left",), "front_speed_right": ("right",)}
TRANSITION_NUMBERS = ("transition_time", "transition_length")
PULSE_NUMBERS = ("pulse_width", "pulse_peak_velocity", "pulse_slip", "pulse_stress_drop")
# For each boundary, the numbers that a promise can cover, and the sides whose fronts must be fast
# for it to do so.
REQUIRED_FAST_SIDES: dict[str, dict[str, tuple[str, ...]]] = {
    "displacement": {
        **SPEED_NUMBERS,
        **dict.fromkeys((*TRANSITION_NUMBERS, "first_stick_time"), ("left", "right")),
        **dict.fromkeys(PULSE_NUMBERS, ("right",)),
    },
    "stress": SPEED_NUMBERS | dict.fromkeys((*TRANSITION_NUMBERS, "largest_velocity"), ()),
}
# A front in a lower pre-stress is hardly faster than the waves. Its error falls only with a power
# of 2/3 to 1 of dx, and in negative pre-stress three spacings can agree and still be far from the
# limit.
MIN_PRESTRESS = 0.05
# If damping is weaker, oscillations of the lattice decide how long the left front stands still.
MIN_DAMPING_RATIO = 0.05
# The left front becomes slower and slower. A larger fraction of its path would need a finer
# lattice.
MAX_COVERED_FRACTION = 0.95


def covered_numbers(run: Mapping, fraction: float) -> set[str]:
    """Return the names of the numbers of a measured row that a promise covers.

    fraction : the part of |x_minus| at which the transition under a stress boundary is measured
    """
    if run["run_flags"]:
        return set()
    fast, required = fast_sides(run), REQUIRED_FAST_SIDES[run["boundary"]]
    names = {name for name, sides in required.items() if fast.issuperset(sides)}
    if run.get("pulse_state") != "steady":
        names.difference_update(PULSE_NUMBERS)
    # The largest velocity tends to a limit only where a front is arrested on the left, and the
    # pulse runs into pre-stress 0. Between two fronts that continue to run, it grows without limit.
    if not (run["left"] < 0.0 and run["right"] == 0.0 and run["beyond"] == 0.0):
        names.discard("largest_velocity")
    if run["boundary"] == "stress":
        is_resolved = run.get("transition_state") == "resolved" and fraction <= MAX_COVERED_FRACTION
        if not is_resolved or run["damping_ratio"] < MIN_DAMPING_RATIO:
            names.difference_update(TRANSITION_NUMBERS)
    return {name for name in names if math.isfinite(run.get(name, math.nan))}


def fast_sides(run: Mapping) -> set[str]:
    """Return the sides on which the front has crossed only pre-stress of at least MIN_PRESTRESS.

    If the pre-stress is a table of points, its lowest crossed value is one of the measured numbers.
    Otherwise, the profile is evaluated up to the end of the path. A side whose front has an unknown
    path is not among the returned sides.
    """
    sides = set()
    if "lowest_prestress_left" in run:
        lowest = {side: run[f"lowest_prestress_{side}"] for side in ("left", "right")}
        # A sweep may mix tables and other profiles; the numbers of the others are NaN.
        if all(map(math.isfinite, lowest.values())):
            return {side for side, tau in lowest.items() if tau >= MIN_PRESTRESS}
    for side, sign in (("left", -1.0), ("right", 1.0)):
        # The position of the front at the end, by the straight line that was fitted to its path.
        speed, intercept = run[f"front_speed_{side}"], run[f"front_intercept_{side}"]
        front = sign * (intercept + speed * run["end_time"])
        if math.isfinite(front):
            crossed = np.linspace(0.0, front, int(abs(front) / run["dx"]) + 2)
            if np.min(prestress_from(run)(crossed)) >= MIN_PRESTRESS:
                sides.add(side)
    return sides


def judge_promises(
    study: pd.DataFrame, measured: pd.DataFrame, promise: float, fraction: float
) -> pd.DataFrame:
    """Add the columns ``promised`` and ``kept`` to a grid study.

    measured : the measured table at the finest spacing
    promise : largest relative uncertainty; NaN for a user-defined spacing, which promises nothing
    fraction : see `covered_numbers`

    ``promised`` is NaN if the number is not covered. ``kept`` is "true", "false", or empty text if
    the number is not covered.
    """
    flags = measured["run_flags"].astype(object).fillna("")
    rows = measured.assign(run_flags=flags).to_dict("records")
    covered = [covered_numbers(row, fraction) for row in rows]
    pairs = zip(study["point"], study["quantity"], strict=True)
    is_promised = [math.isfinite(promise) and name in covered[point] for point, name in pairs]
    # The uncertainty is NaN if a coarser lattice does not have the number. This counts as a miss.
    is_within = study["uncertainty"] <= promise * study["value"].abs()
    kept = np.where(is_promised, np.where(is_within, "true", "false"), "")
    return study.assign(promised=np.where(is_promised, promise, np.nan), kept=kept)


def summarise_promises(study: pd.DataFrame, promise: float) -> str:
    """Report in one line how many runs kept their promise, and the largest misses.

    study : a grid study with the columns that `judge_promises` adds
    """
    if not math.isfinite(promise):
        return "its spacing is user-defined and promises nothing"
    missed = study[study["kept"] == "false"]
    covered_runs = study.loc[study["kept"] != "", "point"].nunique()
    kept_runs = covered_runs - missed["point"].nunique()
    text = f"accuracy {promise:g} kept by {kept_runs} of {covered_runs} runs"
    relative = (missed["uncertainty"] / missed["value"].abs()).fillna(np.inf)
    worst = []
    for point, errors in relative.groupby(missed["point"]):
        worst.append(f"{point} ({missed.loc[errors.idxmax(), 'quantity']} {errors.max():.1e})")
    if worst:
        text += f"; missed by {', '.join(worst[:5])}{' ...' if len(worst) > 5 else ''}"
    uncovered_runs = study["point"].nunique() - covered_runs
    return text + (f"; {uncovered_runs} have no number that it covers" if uncovered_runs else "")
