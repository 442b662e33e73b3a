"""The measured table of a sweep, which has one row for each run.

A row has the numbers that `measure_run` measures, and numbers that compare the run with theory. The
latter are the state of the leading pulse (steady, unsteady, ...) and its deviation from the paper's
pulse. The time and the length of the transition by the paper's formulas are added to them.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from ..data.points import AnyRun, runs_in
from ..measurement.front_paths import front_path
from ..measurement.nucleation import (
    position_of_nucleation,
    positions_from_zero,
    seen_from_nucleation,
)
from ..measurement.pulses import LeadingPulse, comoving, slip_variation
from ..measurement.table import measure_run
from ..model.balance import prestress_balance_position
from ..model.prestress import prestress_from
from ..model.recorded_law import read_recorded_law
from ..model.scene import used_extra_terms
from ..theory.closed_pulse import paper_pulse, paper_transition_displacement, pulse_at_speed
from .common import value_or

# A pulse is unsteady if its width differs by more than this fraction from that of the steady pulse
# at the measured speed, or if the slip behind it varies by more.
MAX_RELATIVE_CHANGE = 0.05
# The measured width may differ further by the width of the front: the thickness of the damped layer
# and this number of blocks.
FRONT_WIDTH_IN_BLOCKS = 3.0
# Largest thickness of the damped layer at the front, divided by the pulse width. The theory of the
# front speed neglects leaf springs. Its error grows with the square of this ratio, and is one per
# cent at this value.
MAX_LAYER_TO_PULSE_WIDTH = 0.125


def measured_table(sweep: xr.Dataset, settings: Mapping) -> pd.DataFrame:
    """Return the measured table of a sweep, with one `measured_row` for each run."""
    return pd.DataFrame([measured_row(run, settings) for run in runs_in(sweep)])


def measured_row(run: AnyRun, settings: Mapping) -> dict[str, Any]:
    """Return the measured numbers of a run by name, and numbers that compare the run with theory.

    settings : the settings of `measure_run`, which the configuration has under ``measure``
    """
    run = seen_from_nucleation(run)
    row, pulse = measure_run(run, settings)
    if pulse is not None:
        row["pulse_state"] = pulse_state(run, pulse)
        row["pulse_shape_deviation"] = shape_deviation(run, pulse, row.get("level_ahead_right"))
    if "transition_time" in row:
        time, length = _paper_transition(run)
        row["paper_transition_time"], row["paper_transition_length"] = time, length
    return positions_from_zero(row, run)


def _paper_transition(run: AnyRun) -> tuple[float, float]:
    """Return the time and the length of the transition by the paper's formulas.

    Both are NaN with an extra term of the equation, where the formulas are not valid. If the
    pre-stress levels on the two sides differ, only the length is NaN.
    """
    if used_extra_terms(run.attrs):
        return math.nan, math.nan
    if run.attrs["boundary"] == "stress":
        # The fronts of the paper start at x = 0. Those of this run may start elsewhere.
        balance_position = prestress_balance_position(prestress_from(run.attrs))
        distance = abs(balance_position - position_of_nucleation(run))
        return distance, 2.0 * distance
    left, right = run.attrs["left"], run.attrs["right"]
    time, length = paper_transition_displacement(left, run.attrs["gamma"])
    # The length depends on the level of pre-stress, but the time does not.
    return time, length if left == right else math.nan


def pulse_state(run: AnyRun, pulse: LeadingPulse) -> str:
    """Return the state of the leading pulse, which compares it with the exact steady pulse.

    - "several": there is more than one pulse on the right.
    - "stopped": the right front has stopped.
    - "steady": the pulse leaves uniform slip behind, and has the width of `theory.steady_pulse`.
    - "unsteady": it does not, or its front is slower than the waves.
    - "thick_front": damping acts in a layer at the front that is not thin compared with the pulse.
    - "none": there is no pulse, or no exact steady pulse is known. None is known under a stress
      boundary, with another friction law than "coulomb", with an extra term of the equation, and if
      the pre-stress at the front is not between 0 and 1.
    """
    if run.attrs["boundary"] != "displacement":
        return "none"
    number_of_pulses = pulse.pulses
    if np.isfinite(pulse.front) and number_of_pulses != 1:
        return "several" if number_of_pulses > 1 else "stopped"
    is_measured = np.isfinite([pulse.width, pulse.speed]).all()
    is_coulomb = read_recorded_law(run.attrs)["law"] == "coulomb"
    has_exact_pulse = is_coulomb and not used_extra_terms(run.attrs)
    if not is_measured or not has_exact_pulse:
        return "none"
    tau = _prestress_at_front(run)
    if not 0.0 < tau < 1.0:
        return "none"
    if pulse.speed <= 1.0:
        return "unsteady"
    return _compare_with_steady_pulse(run, pulse, tau)


def _prestress_at_front(run: AnyRun) -> float:
    """Return the pre-stress of the block that was released last on the right."""
    _, distances = front_path(run)
    block_at_front = np.argmin(np.abs(np.asarray(run["x"]) - distances[-1]))
    return float(np.asarray(run["prestress"])[block_at_front])


def _compare_with_steady_pulse(run: AnyRun, pulse: LeadingPulse, tau: float) -> str:
    """Return "steady", "unsteady" or "thick_front" for a pulse with a front faster than the waves.

    The pulse is compared with the steady one at the pre-stress tau and the measured speed. The two
    cannot be compared ("thick_front") if the layer at the front in which damping acts is too thick,
    since the theory of the front speed neglects leaf springs within this layer.
    """
    beta, dx = run.attrs["beta"], run.attrs["dx"]
    steady = pulse_at_speed(tau, run.attrs["gamma"], beta, pulse.speed)
    # In the damped layer, beta v U''' = -(v^2 - 1) U'' for the slip U and the speed v.
    layer_thickness = beta * pulse.speed / (pulse.speed**2 - 1.0)
    if layer_thickness > MAX_LAYER_TO_PULSE_WIDTH * steady.width:
        return "thick_front"
    # The measured width may also differ by the width of the front, which is not sharp.
    front_width = layer_thickness + FRONT_WIDTH_IN_BLOCKS * dx
    largest_difference = MAX_RELATIVE_CHANGE * steady.width + front_width
    has_other_width = abs(pulse.width - steady.width) > largest_difference
    # A young pulse has left no slip behind yet. The variation is then NaN, which is not larger than
    # any number, so that the width alone decides.
    slip_varies = slip_variation(run, pulse) > MAX_RELATIVE_CHANGE
    return "unsteady" if has_other_width or slip_varies else "steady"


def shape_deviation(run: AnyRun, pulse: LeadingPulse, level_ahead: float | None = None) -> float:
    """Return the largest deviation of slip velocity from the paper's pulse, divided by its peak.

    The velocity of the paper's pulse is a half wave of a cosine, equations (9) and (C10). The peak
    of the half wave is put at the measured peak. NaN under a stress boundary, with an extra term of
    the equation, if the level ahead is not between 0 and 1, if there is no pulse, or if the pulse
    has too few blocks.

    level_ahead : pre-stress in front of the pulse; by default the level on the right of the profile
    """
    tau = level_ahead if level_ahead is not None else run.attrs["right"]
    has_paper_pulse = run.attrs["boundary"] == "displacement" and not used_extra_terms(run.attrs)
    if not has_paper_pulse or not np.isfinite(pulse.width) or not 0.0 < tau < 1.0:
        return np.nan
    # At levels below about 1e-8, fronts are as fast as the waves, to rounding. Theory then has no
    # pulse.
    paper = value_or(lambda: paper_pulse(tau, run.attrs["gamma"]), None)
    if paper is None:
        return np.nan
    # Fields as functions of xi, the position relative to the measured front.
    fields = comoving(run, pulse)
    xi_of_peak = pulse.peak_distance - pulse.front
    distance_to_peak = fields["xi"] - xi_of_peak
    # The two outermost blocks are left out, because the lattice rounds the corners of the cosine.
    is_compared = np.abs(distance_to_peak) < 0.5 * paper.width - 2.0 * run.attrs["dx"]
    if np.count_nonzero(is_compared) < 4:
        return np.nan
    # In the paper's pulse, the same distances are measured from its own peak.
    paper_fields = paper.profile(distance_to_peak[is_compared] + paper.peak_position)
    deviation = fields["slip_velocity"][is_compared] - paper_fields.velocity
    return float(np.max(np.abs(deviation)) / paper.peak_velocity)
