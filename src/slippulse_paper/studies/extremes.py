"""Run ruptures with extreme parameters, and compare the verdict on each with the expected one."""

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

# Largest relative errors, by the family of a case or else by its quantity; absolute errors where 0
# is expected. They follow from the spacings of the cases. For drifts and for the asymmetry they
# follow from rounding. Without an entry the values must be equal.
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
# Verdicts that no case should get: on a wrong number or a missing one, without any flag.
WRONG_WITHOUT_FLAG, NO_NUMBER = "WRONG WITHOUT A FLAG", "no number"
# These quantities assume a steady pulse, so the state of the pulse is also a flag.
PULSE_QUANTITIES = ("front speed", "final slip", "speed drift", "slip drift", "energy residual")
# Flags and states of a run without any problem.
STATES_WITHOUT_FLAG = ("", "steady", "none", "resolved")
# Quantities that are columns of the table of measured numbers. All others are measured by
# `additional_quantity`.
MEASURED_COLUMNS = {
    "front speed": "front_speed_right",
    "final slip": "pulse_slip",
    "T_trans": "transition_time",
    "energy residual": "energy_residual",
}


class Outcome(NamedTuple):
    """The result of a case.

    value : the measured value; NaN if there is none
    message : flags of the run, or the text of a refusal; empty if there is no problem
    block_updates : number of sliding blocks, summed over all time steps
    """

    value: float = math.nan
    message: str = ""
    block_updates: int = 0


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return one row per case, with its value, its flags or refusal, and its verdict."""
    front_window = settings["measure"]["front_window"]
    return pd.DataFrame([judged_row(case, front_window) for case in CASES])


def judged_row(case: Case, front_window: float) -> dict[str, Any]:
    """Run a case and return its row of the table, with the verdict.

    A run that is flagged gets the verdict "flagged", whatever its value. Otherwise the value is
    compared with the expected one.

    front_window : last fraction of its path over which the front speed is measured
    """
    tolerance = tolerance_of(case)
    expected = case.expected()
    error = math.nan
    try:
        outcome = measured_outcome(case, front_window)
        scale = abs(expected) if expected != 0.0 else 1.0
        error = abs(outcome.value - expected) / scale
        verdict = verdict_on_outcome(outcome, error, tolerance)
    except UnstableRun as why_stopped:
        verdict, outcome = STOPPED, Outcome(message=str(why_stopped))
    except ValueError as why_refused:
        verdict, outcome = REFUSED, Outcome(message=str(why_refused))
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

    error : deviation from the expected value; NaN if theory has no value, and then any number
        without a flag is wrong
    """
    if outcome.message == NOT_OFFERED:
        return NOT_OFFERED
    if outcome.message:
        return FLAGGED
    if math.isnan(outcome.value):
        return NO_NUMBER
    # A comparison with NaN is False.
    return RIGHT if error <= tolerance else WRONG_WITHOUT_FLAG


# Three cases share the longest run, so the last run is kept.
simulated = lru_cache(maxsize=1)(simulate_on_lattice)


def measured_outcome(case: Case, front_window: float) -> Outcome:
    """Run a case, and return the measured value and the flags of the run.

    Raises ValueError if the scene is refused, and UnstableRun if the run is stopped.

    front_window : last fraction of the path over which the front speed is measured
    """
    if case.quantity == "velocity error":
        # The solver does not offer single precision, and the message says so. The value is the
        # error of a simple program.
        return Outcome(single_precision_error(case), message=NOT_OFFERED)
    scene = case.scene()
    if case.quantity == "slip":
        # Only this function can change the sign of the damping. Its solution has no flags.
        solution = solve_on_lattice(scene, damping_sign=case.damping_sign)
        return Outcome(float(solution.slip.max()))
    run = simulated(scene)
    if case.quantity == "releases":
        # A run without any release has a flag, but this is right here, so the flag is left out.
        return Outcome(float(run.attrs["releases"]), block_updates=run.attrs["block_updates"])
    settings = {"front_window": front_window, "fraction": COVERED_FRACTION, "trailing_times": ()}
    # The row that this run would have in the table of measured numbers, with its states.
    row = measured_row(run, settings)
    if case.quantity in MEASURED_COLUMNS:
        value = row[MEASURED_COLUMNS[case.quantity]]
    else:
        value = additional_quantity(run, case.quantity)
    flags = [row["run_flags"], row.get("transition_state", "")]
    if case.quantity in PULSE_QUANTITIES:
        flags.append(row["pulse_state"])
    message = ",".join(flag for flag in flags if flag not in STATES_WITHOUT_FLAG)
    return Outcome(value, message, run.attrs["block_updates"])


def additional_quantity(run: xr.Dataset, quantity: str) -> float:
    """Return a quantity of a run that is not in the table of measured numbers.

    The quantities are:

    meeting time : time at which fronts from two nucleations meet, halfway between these
    asymmetry : largest difference between the slip and its mirror image about the meeting point,
        divided by the largest slip
    passes by : distance that the right front has run beyond the centre of a barrier; 0 if it has
        not reached the centre
    speed drift, slip drift : relative change of the front speed or slip over most of the path
    """
    x, slip = run["x"].values, run["slip"].values
    if quantity == "meeting time":
        distance_from_middle = np.abs(x - 0.5 * NUCLEATION_DISTANCE)
        # The middle may lie between two blocks. The last release there is when the fronts meet.
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

    The mean over the last tenth of the path is compared with the mean over the third tenth.
    """
    mean_between = mean_slip if quantity == "slip drift" else mean_front_speed
    return mean_between(run, 0.9, 1.0) / mean_between(run, 0.2, 0.3) - 1.0


def mean_slip(run: xr.Dataset, start: float, end: float) -> float:
    """Return the mean slip between two fractions of the path of the right front."""
    _, distances = front_path(run)
    x, path_length = run["x"].values, distances[-1]
    # Slip still grows close to the front, so the last hundredth of the path is left out.
    in_stretch = (x > start * path_length) & (x < (end - 0.01) * path_length)
    return float(np.mean(run["slip"].values[in_stretch]))


def mean_front_speed(run: xr.Dataset, start: float, end: float) -> float:
    """Return the mean speed of the right front between two fractions of its path."""
    times, distances = front_path(run)
    path_length = distances[-1]
    in_stretch = (distances > start * path_length) & (distances < end * path_length)
    speed, _ = np.polyfit(times[in_stretch], distances[in_stretch], 1)
    return float(speed)


def single_precision_error(case: Case) -> float:
    """Return the relative error of the slip velocity of a crack in single precision.

    The error is the largest difference from the same computation in double precision, divided by
    the largest velocity.
    """
    in_double = crack_velocity(case, np.float64)
    in_single = crack_velocity(case, np.float32)
    return float(np.max(np.abs(in_double - in_single)) / np.max(in_double))


def crack_velocity(case: Case, dtype: type[np.floating]) -> np.ndarray:
    """Compute the slip velocities on x >= 0 at the end of an undamped, symmetric crack.

    The method is symplectic Euler. Slip, velocity and stress have the floating-point type
    ``dtype``.
    """
    dx = case.dx
    time_step = 0.4 * dx
    # The fronts of these cases are slower than 1.5, so they do not reach the last block.
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
