"""Numbers that a promised accuracy covers, and whether a grid study finds it kept."""

import math
from collections.abc import Mapping

import numpy as np
import pandas as pd

from ..model.prestress import prestress_from

SPEEDS = {"front_speed_left": ("left",), "front_speed_right": ("right",)}
TRANSITION = ("transition_time", "transition_length")
PULSE = ("pulse_width", "pulse_peak_velocity", "pulse_slip", "pulse_stress_drop")
# Numbers that `accuracy` promises, where `covered` has nothing against the run, and the fronts that
# they depend on.
COVERED: dict[str, dict[str, tuple[str, ...]]] = {
    "displacement": {
        **SPEEDS,
        **dict.fromkeys((*TRANSITION, "first_stick_time"), ("left", "right")),
        **dict.fromkeys(PULSE, ("right",)),
    },
    "stress": SPEEDS | dict.fromkeys((*TRANSITION, "largest_velocity"), ()),
}
# A front that crosses less pre-stress hardly outruns the waves, and lags by an order of 2/3 to 1 in
# dx; where the pre-stress is negative, three spacings can agree far from the limit.
LOWEST_PRESTRESS = 0.05
# With less damping the ringing of the lattice decides how long the left front stands still.
LEAST_DAMPING = 0.05
# The left front slows for ever: the time to cover more of its path needs a finer lattice.
LARGEST_FRACTION = 0.95


def covered(run: Mapping, fraction: float) -> set[str]:
    """Names of the numbers of a measured row that a promise covers; fraction: see `transition`."""
    if run["run_flags"]:
        return set()
    fast = fast_sides(run)
    names = {name for name, sides in COVERED[run["boundary"]].items() if fast.issuperset(sides)}
    if run.get("pulse_state") != "steady":
        names.difference_update(PULSE)
    # Theory has the far-field pulse; between two fronts that run on, velocity grows.
    if not run["left"] < 0.0 == run["right"] == run["beyond"]:
        names.discard("largest_velocity")
    if run["boundary"] == "stress":
        resolved = run.get("transition_state") == "resolved" and fraction <= LARGEST_FRACTION
        if not resolved or run["damping_ratio"] < LEAST_DAMPING:
            names.difference_update(TRANSITION)
    return {name for name in names if math.isfinite(run.get(name, math.nan))}


def fast_sides(run: Mapping) -> set[str]:
    """Sides whose front has crossed no less than LOWEST_PRESTRESS; not if its path is unknown."""
    sides = set()
    if "lowest_prestress_left" in run:
        lowest = {side: run[f"lowest_prestress_{side}"] for side in ("left", "right")}
        # A sweep may have tables and other profiles.
        if all(map(math.isfinite, lowest.values())):
            return {side for side, tau in lowest.items() if tau >= LOWEST_PRESTRESS}
    for side, sign in (("left", -1.0), ("right", 1.0)):
        speed, start = run[f"front_speed_{side}"], run[f"front_intercept_{side}"]
        reach = sign * (start + speed * run["end_time"])
        if math.isfinite(reach):
            x = np.linspace(0.0, reach, int(abs(reach) / run["dx"]) + 2)
            if np.min(prestress_from(run)(x)) >= LOWEST_PRESTRESS:
                sides.add(side)
    return sides


def judged(
    study: pd.DataFrame, measured: pd.DataFrame, promise: float, fraction: float
) -> pd.DataFrame:
    """A grid study with columns `promised` (NaN where nothing is) and `kept` ("true", "false", "").

    measured : the table at the finest spacing
    promise : largest relative uncertainty; NaN for a user-defined spacing, which promises nothing
    """
    flags = measured["run_flags"].astype(object).fillna("")
    rows = measured.assign(run_flags=flags).to_dict("records")
    names = [covered(row, fraction) for row in rows]
    pairs = zip(study["point"], study["quantity"], strict=True)
    promised = [math.isfinite(promise) and name in names[point] for point, name in pairs]
    # An uncertainty is NaN where a coarser lattice does not have the number: that is a miss.
    within = study["uncertainty"] <= promise * study["value"].abs()
    kept = np.where(promised, np.where(within, "true", "false"), "")
    return study.assign(promised=np.where(promised, promise, np.nan), kept=kept)


def summary(study: pd.DataFrame, promise: float) -> str:
    """One line: how many runs of a judged study kept their promise, and the worst misses."""
    if not math.isfinite(promise):
        return "its spacing is user-defined and promises nothing"
    missed = study[study["kept"] == "false"]
    runs, broken = study.loc[study["kept"] != "", "point"].nunique(), missed["point"].nunique()
    text = f"accuracy {promise:g} kept by {runs - broken} of {runs} runs"
    relative = (missed["uncertainty"] / missed["value"].abs()).fillna(np.inf)
    worst = []
    for point, errors in relative.groupby(missed["point"]):
        worst.append(f"{point} ({missed.loc[errors.idxmax(), 'quantity']} {errors.max():.1e})")
    if worst:
        text += f"; missed by {', '.join(worst[:5])}{' ...' if len(worst) > 5 else ''}"
    rest = study["point"].nunique() - runs
    return text + (f"; {rest} have no number that it covers" if rest else "")
