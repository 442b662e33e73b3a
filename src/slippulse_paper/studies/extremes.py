"""Run the solver at the limits of its domain, and compare each case with its expected outcome."""

import math
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from slippulse.measurement.front_paths import front_path
from slippulse.prediction.comparison import measured_row
from slippulse.simulation.sweep import simulate_on_lattice
from slippulse.solver.lattice import UnstableRun
from slippulse.solver.solution import solve_on_lattice

from .extreme_cases import (
    BARRIER_CENTRE,
    CASES,
    COVERED_FRACTION,
    NOT_OFFERED,
    NUCLEATION_DISTANCE,
    Case,
)

NEEDS = {"settings": ["measure.front_window"]}

# Largest relative errors (absolute where 0 is expected), by family or else by quantity. They follow
# from the spacings of the cases, and for drifts and symmetry from rounding. Without an entry the
# values must be equal.
TOLERANCES = {
    "front speed": 0.01, "T_trans": 0.01, "meeting time": 0.01, "velocity error": 0.01, "step": 0.0,
    "final slip": 0.05, "negative level": 0.05, "speed drift": 1e-6, "slip drift": 1e-6,
    "energy residual": 1e-5, "asymmetry": 1e-9,
}  # fmt: skip
# These quantities assume a steady pulse, so any other state of the pulse counts as a flag.
PULSE_QUANTITIES = ("front speed", "final slip", "speed drift", "slip drift", "energy residual")
# These states are not reported as flags.
STATES_WITHOUT_FLAG = ("", "steady", "none", "resolved")
# Quantities that are columns of the measured table; all others are measured here.
MEASURED_COLUMNS = {
    "front speed": "front_speed_right",
    "final slip": "pulse_slip",
    "T_trans": "transition_time",
    "energy residual": "energy_residual",
}


class Outcome(NamedTuple):
    """The value measured in a case, its flags or refusal, and the number of block updates."""

    value: float = math.nan
    message: str = ""
    block_updates: int = 0


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return one row per case, with the verdict; the message has the flags or the refusal."""
    window = settings["measure"]["front_window"]
    return pd.DataFrame([judged(case, window) for case in CASES])


def judged(case: Case, window: float) -> dict[str, Any]:
    """Run a case and judge it by its flags first, then by a missing value, then by the value."""
    tolerance = TOLERANCES.get(case.family, TOLERANCES.get(case.quantity, 0.0))
    expected, error = case.expected(), math.nan
    try:
        outcome = measured(case, window)
        error = abs(outcome.value - expected) / (abs(expected) or 1.0)
        # If theory has no value, a measured number is not within the tolerance.
        verdict = "right" if error <= tolerance else "WRONG WITHOUT A FLAG"
        if outcome.message:
            verdict = NOT_OFFERED if outcome.message == NOT_OFFERED else "flagged"
        elif math.isnan(outcome.value):
            verdict = "no number"
    except UnstableRun as stopped:
        verdict, outcome = "stopped", Outcome(message=str(stopped))
    except ValueError as refusal:
        verdict, outcome = "refused", Outcome(message=str(refusal))
    row: dict[str, Any] = {"family": case.family, "value": case.where, "quantity": case.quantity}
    row |= {"should": case.should, "tolerance": tolerance, "expected": expected}
    row |= {"measured": outcome.value, "error": error, "verdict": verdict}
    return row | {"message": outcome.message, "block_updates": outcome.block_updates}


# The three cases of the longest run share it.
simulated = lru_cache(maxsize=1)(simulate_on_lattice)


def measured(case: Case, window: float) -> Outcome:
    """Run a case and measure it; errors of refused scenes and stopped runs are passed on."""
    if case.quantity == "velocity error":
        return Outcome(single_precision_error(case), NOT_OFFERED)
    scene = case.scene()
    if case.quantity == "slip":
        return Outcome(float(solve_on_lattice(scene, damping_sign=case.damping_sign).slip.max()))
    run = simulated(scene)
    if case.quantity == "releases":
        # A run without a release is flagged, which is the expected outcome here.
        return Outcome(float(run.attrs["releases"]), block_updates=run.attrs["block_updates"])
    settings = {"front_window": window, "fraction": COVERED_FRACTION, "trailing_times": ()}
    numbers = measured_row(run, settings)
    flags = [numbers["run_flags"], numbers.get("transition_state", "")]
    if case.quantity in PULSE_QUANTITIES:
        flags.append(numbers["pulse_state"])
    known = MEASURED_COLUMNS.get(case.quantity)
    value = numbers[known] if known else measured_here(run, case.quantity)
    message = ",".join(flag for flag in flags if flag not in STATES_WITHOUT_FLAG)
    return Outcome(value, message, run.attrs["block_updates"])


def measured_here(run: xr.Dataset, quantity: str) -> float:
    """Return a quantity of a run that is not in the measured table."""
    x, slip = run["x"].values, run["slip"].values
    if quantity == "meeting time":
        middle = np.abs(x - 0.5 * NUCLEATION_DISTANCE) < 1.5 * run.attrs["dx"]
        return float(np.nanmax(run["release_time"].values[middle]))
    if quantity == "asymmetry":
        mirrored = np.interp(NUCLEATION_DISTANCE - x, x, slip, left=0.0, right=0.0)
        return float(np.max(np.abs(slip - mirrored)) / slip.max())
    if quantity == "passes by":
        return max(0.0, float(front_path(run)[1][-1]) - BARRIER_CENTRE)
    return drift(run, quantity)


def drift(run: xr.Dataset, quantity: str) -> float:
    """Return the relative change of the front speed, or of the slip, over most of the path."""
    times, distances = front_path(run)
    x, last = run["x"].values, distances[-1]

    def mean_on_part(start: float, end: float) -> float:
        """Return the mean slip or front speed between two fractions of the path."""
        if quantity == "slip drift":
            # Slip still grows close to the front, which is at the end of the path.
            left_behind = (x > start * last) & (x < (end - 0.01) * last)
            return float(np.mean(run["slip"].values[left_behind]))
        part = (distances > start * last) & (distances < end * last)
        return float(np.polyfit(times[part], distances[part], 1)[0])

    return mean_on_part(0.9, 1.0) / mean_on_part(0.2, 0.3) - 1.0


def single_precision_error(case: Case) -> float:
    """Return the relative error of a crack's slip velocity in float32, compared with float64.

    Symplectic Euler on slip, with the force from second differences of slip; no damping.
    """
    dx, step = case.dx, 0.4 * case.dx
    x = dx * np.arange(int(1.5 * case.duration / dx) + 32)
    tau = case.level + (1.0 - case.level) * np.exp(-0.5 * (x / case.width) ** 2)
    velocities = []
    for dtype in (np.float64, np.float32):
        # A plain number takes the type of the array that it meets.
        stress: np.ndarray = tau.astype(dtype)
        slip, velocity, force = np.zeros((3, x.size), dtype)
        sliding = stress >= 1.0
        for _ in range(round(case.duration / step)):
            force[1:-1] = 1.0 / dx**2 * (slip[2:] - 2.0 * slip[1:-1] + slip[:-2])
            force[0] = 2.0 / dx**2 * (slip[1] - slip[0])
            force[:-1] += stress[:-1] - case.gamma * slip[:-1]
            sliding |= force >= 1.0
            velocity = np.where(sliding, np.maximum(velocity + step * force, 0.0), 0.0)
            slip += step * velocity
        velocities.append(velocity)
    double, single = velocities
    return float(np.max(np.abs(double - single)) / np.max(double))
