"""What a promised accuracy covers, and whether a grid study finds it kept."""

import math
from collections.abc import Mapping

import numpy as np
import pandas as pd

# Numbers that `accuracy` promises, where `covers` has nothing against the run.
COVERED = {
    "displacement": (
        "front_speed_left", "front_speed_right", "transition_time", "transition_length", "first_stick_time",
        "pulse_width", "pulse_peak_velocity", "pulse_slip", "pulse_stress_drop",
    ),
    "stress": (
        "front_speed_left", "front_speed_right", "transition_time", "transition_length", "largest_velocity",
    ),
}  # fmt: skip
# Below this pre-stress ahead a front hardly outruns the waves and lags by an order of 2/3 to 1 in the spacing.
LOWEST_LEVEL = 0.05
# With less damping the ringing of the lattice decides how long the left front stands still.
LEAST_DAMPING = 0.05
# The left front slows for ever: the time to cover more of its path takes a finer lattice than the one chosen.
LARGEST_FRACTION = 0.95


def covers(run: Mapping, quantity: str, fraction: float) -> bool:
    """Whether a promise covers one number of a run, a row of the measured table.

    ``fraction`` : of |x_minus| that the left front covers at T_trans under a stress boundary.
    """
    if (
        quantity not in COVERED[run["boundary"]]
        or run["run_flags"]
        or not math.isfinite(run[quantity])
    ):
        return False
    if quantity.startswith("front_speed"):
        ahead = run[quantity.removeprefix("front_speed_")]
        # A step on either side.
        return (
            ahead if run["beyond"] == run["right"] else min(ahead, run["beyond"])
        ) >= LOWEST_LEVEL
    if quantity.startswith("pulse"):
        return run["pulse_state"] == "steady"
    if run["boundary"] == "displacement":
        return min(run["left"], run["right"]) >= LOWEST_LEVEL
    if quantity == "largest_velocity":
        # The far-field pulse, which theory has; between two fronts that run on, velocity grows.
        return run["left"] < 0.0 == run["right"] == run["beyond"]
    return (
        run["transition_state"] == "resolved"
        and run["damping_ratio"] >= LEAST_DAMPING
        and fraction <= LARGEST_FRACTION
    )


def judged(
    study: pd.DataFrame, measured: pd.DataFrame, promise: float, fraction: float
) -> pd.DataFrame:
    """A grid study with two more columns: `promised` (NaN where nothing is) and `kept` ("true", "false" or "").

    study : as `grid_tables` has it
    measured : the table at the finest spacing
    promise : largest relative uncertainty; NaN for a spacing of its own, which promises nothing
    fraction : see `covers`

    A number whose uncertainty is not known, since a coarser lattice does not have it, has not kept its promise.
    """
    rows = measured.assign(run_flags=measured["run_flags"].astype(object).fillna("")).to_dict(
        "records"
    )
    covered = [
        math.isfinite(promise) and covers(rows[row.point], row.quantity, fraction)
        for row in study.itertuples()
    ]
    within = study["uncertainty"] <= promise * study["value"].abs()
    kept = np.where(covered, np.where(within, "true", "false"), "")
    return study.assign(promised=np.where(covered, promise, np.nan), kept=kept)


def summary(study: pd.DataFrame, promise: float) -> str:
    """One line: how many runs of a judged grid study kept their promise, and the worst number of each that did not."""
    if not math.isfinite(promise):
        return "its spacing is its own and promises nothing"
    covered = study[study["kept"] != ""]
    missed = covered[covered["kept"] == "false"]
    runs, broken = covered["point"].nunique(), missed["point"].nunique()
    text = f"accuracy {promise:g} kept by {runs - broken} of {runs} runs"
    relative = (missed["uncertainty"] / missed["value"].abs()).fillna(np.inf)
    worst = [
        f"{point} ({missed.loc[of.idxmax(), 'quantity']} {of.max():.1e})"
        for point, of in relative.groupby(missed["point"])
    ]
    text += (
        f"; missed by {', '.join(worst[:5])}" + (" ..." if len(worst) > 5 else "") if worst else ""
    )
    rest = study["point"].nunique() - runs
    return text + (f"; {rest} have no number that it covers" if rest else "")
