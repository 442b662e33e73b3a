"""Numbers that a promised accuracy covers, and whether a grid study finds it kept."""

import math
from collections.abc import Mapping
from functools import lru_cache

import numpy as np
import pandas as pd

from ..model.prestress import Prestress, prestress_from

PULSE = ("pulse_width", "pulse_peak_velocity", "pulse_slip", "pulse_stress_drop")
# Numbers that belong to one front; the others belong to both.
FRONTS = dict.fromkeys((*PULSE, "front_speed_right"), ("right",)) | {"front_speed_left": ("left",)}
ALWAYS = ("front_speed_left", "front_speed_right", "transition_time", "transition_length")
# Numbers that `accuracy` promises, where `covers` has nothing against the run.
COVERED = {
    "displacement": (*ALWAYS, "first_stick_time", *PULSE),
    "stress": (*ALWAYS, "largest_velocity"),
}
# A front that crosses less pre-stress hardly outruns the waves, and lags by an order of 2/3 to 1 in
# dx; where the pre-stress is negative, three spacings can agree far from the limit.
LOWEST_PRESTRESS = 0.05
# With less damping the ringing of the lattice decides how long the left front stands still.
LEAST_DAMPING = 0.05
# The left front slows for ever: the time to cover more of its path needs a finer lattice.
LARGEST_FRACTION = 0.95


def covers(run: Mapping, quantity: str, fraction: float) -> bool:
    """Return True if a promise covers a number of a measured row; fraction: see `transition`."""
    known = quantity in COVERED[run["boundary"]] and math.isfinite(run[quantity])
    unsteady = quantity in PULSE and run["pulse_state"] != "steady"
    if not known or run["run_flags"] or unsteady:
        return False
    if run["boundary"] == "stress" and not quantity.startswith("front_speed"):
        return _covers_stress(run, quantity, fraction)
    sides = FRONTS.get(quantity, ("left", "right"))
    return all(lowest_crossed(run, side) >= LOWEST_PRESTRESS for side in sides)


def lowest_crossed(run: Mapping, side: str) -> float:
    """Lowest pre-stress that a front has crossed; NaN where its path is not known."""
    reach = run[f"front_intercept_{side}"] + run[f"front_speed_{side}"] * run["end_time"]
    if not math.isfinite(reach):
        return math.nan
    return _lowest(prestress_from(run), -reach if side == "left" else reach, run["dx"])


@lru_cache(maxsize=64)
def _lowest(prestress: Prestress, end: float, dx: float) -> float:
    """Lowest pre-stress from x = 0 to an end, looked at where blocks of a spacing are."""
    return float(np.min(prestress(np.linspace(0.0, end, int(abs(end) / dx) + 2))))


def _covers_stress(run: Mapping, quantity: str, fraction: float) -> bool:
    if quantity == "largest_velocity":
        # Theory has the far-field pulse; between two fronts that run on, velocity grows.
        return run["left"] < 0.0 == run["right"] == run["beyond"]
    resolved = run["transition_state"] == "resolved" and run["damping_ratio"] >= LEAST_DAMPING
    return resolved and fraction <= LARGEST_FRACTION


def judged(
    study: pd.DataFrame, measured: pd.DataFrame, promise: float, fraction: float
) -> pd.DataFrame:
    """A grid study with columns `promised` (NaN where nothing is) and `kept` ("true", "false", "").

    measured : the table at the finest spacing
    promise : largest relative uncertainty; NaN for a user-defined spacing, which promises nothing
    """
    flags = measured["run_flags"].astype(object).fillna("")
    rows = measured.assign(run_flags=flags).to_dict("records")
    pairs = zip(study["point"], study["quantity"], strict=True)
    known = math.isfinite(promise)
    covered = [known and covers(rows[point], name, fraction) for point, name in pairs]
    # An uncertainty is NaN where a coarser lattice does not have the number: that is a miss.
    within = study["uncertainty"] <= promise * study["value"].abs()
    kept = np.where(covered, np.where(within, "true", "false"), "")
    return study.assign(promised=np.where(covered, promise, np.nan), kept=kept)


def summary(study: pd.DataFrame, promise: float) -> str:
    """One line: how many runs of a judged study kept their promise, and the worst misses."""
    if not math.isfinite(promise):
        return "its spacing is user-defined and promises nothing"
    covered = study[study["kept"] != ""]
    missed = covered[covered["kept"] == "false"]
    runs, broken = covered["point"].nunique(), missed["point"].nunique()
    text = f"accuracy {promise:g} kept by {runs - broken} of {runs} runs"
    relative = (missed["uncertainty"] / missed["value"].abs()).fillna(np.inf)
    worst = []
    for point, errors in relative.groupby(missed["point"]):
        worst.append(f"{point} ({missed.loc[errors.idxmax(), 'quantity']} {errors.max():.1e})")
    if worst:
        text += f"; missed by {', '.join(worst[:5])}{' ...' if len(worst) > 5 else ''}"
    rest = study["point"].nunique() - runs
    return text + (f"; {rest} have no number that it covers" if rest else "")
