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
    FLAGGED,
    NOT_OFFERED,
    NUCLEATION_DISTANCE,
    REFUSED,
    RIGHT,
    STOPPED,
    Case,
)

NEEDS = {"settings": ["measure.front_window"]}

# Largest relative errors (absolute where 0 is expected), by family or else by quantity. They follow
# from the spacings of the cases, and for drifts and symmetry from rounding. Without an entry the
# values must be equal.
TOLERANCES = {
    "front speed": 0.01,
    "T_trans": 0.01,
    "meeting time": 0.01,
    "velocity error": 0.01,
    "step": 0.0,
    "final slip": 0.05,
    "negative level": 0.05,
    "speed drift": 1e-6,
    "slip drift": 1e-6,
    "energy residual": 1e-5,
    "asymmetry": 1e-9,
}
# Verdicts of cases that give no reliable number, or no number at all, without saying so.
WRONG_WITHOUT_FLAG, NO_NUMBER = "WRONG WITHOUT A FLAG", "no number"
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
    """Run a case and return its row of the table, with the verdict.

    A run that is flagged gets the verdict "flagged", whatever its value. Otherwise the value is
    compared with the expected one.

    window : last fraction of its path over which the front speed is measured
    """
    tolerance = tolerance_of(case)
    expected = case.expected()
    error = math.nan
    try:
        outcome = measured(case, window)
        scale = abs(expected) if expected != 0.0 else 1.0
        error = abs(outcome.value - expected) / scale
        verdict = verdict_on_outcome(outcome, error, tolerance)
    except UnstableRun as stopped:
        verdict, outcome = STOPPED, Outcome(message=str(stopped))
    except ValueError as refusal:
        verdict, outcome = REFUSED, Outcome(message=str(refusal))
    return {
        "family": case.family,
        "value": case.label,
        "quantity": case.quantity,
        "should": case.expected_verdict,
        "tolerance": tolerance,
        "expected": expected,
        "measured": outcome.value,
        "error": error,
        "verdict": verdict,
        "message": outcome.message,
        "block_updates": outcome.block_updates,
    }


def tolerance_of(case: Case) -> float:
    """Return the tolerance of the family of a case, or else that of its quantity, or else 0."""
    if case.family in TOLERANCES:
        return TOLERANCES[case.family]
    return TOLERANCES.get(case.quantity, 0.0)


def verdict_on_outcome(outcome: Outcome, error: float, tolerance: float) -> str:
    """Return the verdict on a case that was run to its end.

    If theory has no value, the error is NaN. A measured number then counts as wrong.
    """
    if outcome.message == NOT_OFFERED:
        return NOT_OFFERED
    if outcome.message:
        return FLAGGED
    if math.isnan(outcome.value):
        return NO_NUMBER
    return RIGHT if error <= tolerance else WRONG_WITHOUT_FLAG


# The three cases of the longest run share it.
simulated = lru_cache(maxsize=1)(simulate_on_lattice)


def measured(case: Case, window: float) -> Outcome:
    """Run a case and return its measured value, with the flags of the run as the message.

    Raises ValueError if the scene is refused, and UnstableRun if the run is stopped.
    """
    if case.quantity == "velocity error":
        # The library does not offer single precision; the error shows why.
        return Outcome(single_precision_error(case), NOT_OFFERED)
    scene = case.scene()
    if case.quantity == "slip":
        solution = solve_on_lattice(scene, damping_sign=case.damping_sign)
        return Outcome(float(solution.slip.max()))
    run = simulated(scene)
    if case.quantity == "releases":
        # A run without a release is flagged, which is the expected outcome here.
        return Outcome(float(run.attrs["releases"]), block_updates=run.attrs["block_updates"])
    settings = {"front_window": window, "fraction": COVERED_FRACTION, "trailing_times": ()}
    row = measured_row(run, settings)
    if case.quantity in MEASURED_COLUMNS:
        value = row[MEASURED_COLUMNS[case.quantity]]
    else:
        value = measured_here(run, case.quantity)
    flags = [row["run_flags"], row.get("transition_state", "")]
    if case.quantity in PULSE_QUANTITIES:
        flags.append(row["pulse_state"])
    message = ",".join(flag for flag in flags if flag not in STATES_WITHOUT_FLAG)
    return Outcome(value, message, run.attrs["block_updates"])


def measured_here(run: xr.Dataset, quantity: str) -> float:
    """Return a quantity of a run that is not in the measured table.

    meeting time : time at which fronts from two nucleations meet halfway between them
    asymmetry : largest difference between the slip and its mirror image about that point, divided
        by the largest slip
    passes by : distance that the right front has run beyond the centre of a barrier, at least 0
    speed drift, slip drift : see `drift`
    """
    x, slip = run["x"].values, run["slip"].values
    if quantity == "meeting time":
        distance_from_middle = np.abs(x - 0.5 * NUCLEATION_DISTANCE)
        middle_blocks = distance_from_middle < 1.5 * run.attrs["dx"]
        return float(np.nanmax(run["release_time"].values[middle_blocks]))
    if quantity == "asymmetry":
        mirrored_slip = np.interp(NUCLEATION_DISTANCE - x, x, slip, left=0.0, right=0.0)
        return float(np.max(np.abs(slip - mirrored_slip)) / slip.max())
    if quantity == "passes by":
        _, distances = front_path(run)
        return max(0.0, float(distances[-1]) - BARRIER_CENTRE)
    return drift(run, quantity)


def drift(run: xr.Dataset, quantity: str) -> float:
    """Return the relative change of the front speed, or of the slip, over most of the path.

    The mean over the last tenth of the path is compared with the mean between two and three tenths.
    """
    times, distances = front_path(run)
    x, path_length = run["x"].values, distances[-1]

    def mean_slip(start: float, end: float) -> float:
        """Return the mean slip between two fractions of the path."""
        # Slip still grows close to the front, which is at the end of the path.
        is_inside = (x > start * path_length) & (x < (end - 0.01) * path_length)
        return float(np.mean(run["slip"].values[is_inside]))

    def mean_speed(start: float, end: float) -> float:
        """Return the mean front speed between two fractions of the path."""
        is_inside = (distances > start * path_length) & (distances < end * path_length)
        speed, _ = np.polyfit(times[is_inside], distances[is_inside], 1)
        return float(speed)

    mean_between = mean_slip if quantity == "slip drift" else mean_speed
    return mean_between(0.9, 1.0) / mean_between(0.2, 0.3) - 1.0


def single_precision_error(case: Case) -> float:
    """Return the relative error of the slip velocity if a crack is computed in single precision.

    It is the largest difference from the same computation in double precision, divided by the
    largest velocity.
    """
    in_double = crack_velocity(case, np.float64)
    in_single = crack_velocity(case, np.float32)
    return float(np.max(np.abs(in_double - in_single)) / np.max(in_double))


def crack_velocity(case: Case, dtype: type[np.floating]) -> np.ndarray:
    """Compute the slip velocity at the end of an undamped, symmetric crack on x >= 0.

    This is the symplectic Euler method, with all fields in one floating-point type.
    """
    dx = case.dx
    time_step = 0.4 * dx
    x = dx * np.arange(int(1.5 * case.duration / dx) + 32)
    gaussian = np.exp(-0.5 * (x / case.width) ** 2)
    prestress = case.level + (1.0 - case.level) * gaussian
    # A plain number takes the type of the array that it meets.
    stress: np.ndarray = prestress.astype(dtype)
    slip, velocity, force = np.zeros((3, x.size), dtype)
    sliding = stress >= 1.0
    for _ in range(round(case.duration / time_step)):
        force[1:-1] = 1.0 / dx**2 * (slip[2:] - 2.0 * slip[1:-1] + slip[:-2])
        # The block at x = 0 has mirror images on both sides.
        force[0] = 2.0 / dx**2 * (slip[1] - slip[0])
        force[:-1] += stress[:-1] - case.gamma * slip[:-1]
        sliding |= force >= 1.0
        velocity = np.where(sliding, np.maximum(velocity + time_step * force, 0.0), 0.0)
        slip += time_step * velocity
    return velocity
