"""The measured table of a sweep, which has one row for each run.

A row has the numbers that `measure_run` measures, and numbers that compare the run with theory: the
state of the leading pulse, its deviation from the paper's shape, and the paper's T_trans and
L_trans.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from ..data.points import AnyRun, runs_in
from ..measurement.front_paths import front_path
from ..measurement.pulses import LeadingPulse, comoving, slip_variation
from ..measurement.table import measure_run
from ..model.prestress import prestress_from
from ..model.recorded_law import read_recorded_law
from ..model.scene import used_extra_terms
from ..theory.closed_pulse import (
    paper_pulse,
    paper_transition_displacement,
    paper_transition_stress,
    pulse_at_speed,
)

# A pulse is unsteady if its width differs from that of the steady pulse at the measured speed, or
# if the slip behind it varies. The allowed relative change is the same for both. The width may
# differ by the thickness of the damped layer and by this number of blocks in addition, because the
# front has this width.
MAX_RELATIVE_CHANGE = 0.05
FRONT_WIDTH_IN_BLOCKS = 3.0
# Largest thickness of the damped layer at the front, divided by the pulse width. The front speed is
# computed without leaf springs. The error of this approximation grows with the square of the ratio,
# and is one per cent at this value.
MAX_LAYER_TO_PULSE_WIDTH = 0.125


def measured_table(sweep: xr.Dataset, settings: Mapping) -> pd.DataFrame:
    """Return the measured table of a sweep, with one `measured_row` for each run."""
    return pd.DataFrame([measured_row(run, settings) for run in runs_in(sweep)])


def measured_row(run: AnyRun, settings: Mapping) -> dict[str, Any]:
    """Return the measured numbers of a run by name, and those that compare it with theory.

    settings : see `measure_run`
    """
    row, pulse = measure_run(run, settings)
    if pulse is not None:
        row["pulse_state"] = pulse_state(run, pulse)
        row["pulse_shape_deviation"] = shape_deviation(run, pulse, row.get("level_ahead_right"))
    if "transition_time" in row:
        time, length = _paper_transition(run)
        row["paper_transition_time"], row["paper_transition_length"] = time, length
    return row


def _paper_transition(run: AnyRun) -> tuple[float, float]:
    """Return T_trans and L_trans by the paper's formulas; NaN where these do not hold."""
    if used_extra_terms(run.attrs):
        return math.nan, math.nan
    if run.attrs["boundary"] == "stress":
        return paper_transition_stress(prestress_from(run.attrs))
    left, right = run.attrs["left"], run.attrs["right"]
    time, length = paper_transition_displacement(left, run.attrs["gamma"])
    # The length depends on the level of pre-stress, but the time does not.
    return time, length if left == right else math.nan


def pulse_state(run: AnyRun, pulse: LeadingPulse) -> str:
    """Return the state of the leading pulse, by the names that config/README.md explains.

    A steady pulse has uniform slip, and the width of the exact pulse, which solves
    beta v U''' + (v^2 - 1) U'' + gamma U = tau_0. The state is "none" if there is no pulse to
    judge, or if no exact pulse is known: under a stress boundary, with another friction law than
    "coulomb", or with an extra term of the equation.
    """
    if run.attrs["boundary"] != "displacement":
        return "none"
    if np.isfinite(pulse.front) and pulse.pulses != 1:
        return "several" if pulse.pulses else "stopped"
    is_coulomb = read_recorded_law(run.attrs)["law"] == "coulomb"
    has_exact_pulse = is_coulomb and not used_extra_terms(run.attrs)
    if not np.isfinite([pulse.width, pulse.speed]).all() or not has_exact_pulse:
        return "none"
    tau = _prestress_at_front(run)
    if not 0.0 < tau < 1.0:
        return "none"
    if pulse.speed <= 1.0:
        return "unsteady"
    return _compare_with_steady_pulse(run, pulse, tau)


def _prestress_at_front(run: AnyRun) -> float:
    """Return the pre-stress of the last block that was released on the right."""
    _, distances = front_path(run)
    block_at_front = np.argmin(np.abs(np.asarray(run["x"]) - distances[-1]))
    return float(np.asarray(run["prestress"])[block_at_front])


def _compare_with_steady_pulse(run: AnyRun, pulse: LeadingPulse, tau: float) -> str:
    """Return "steady", "unsteady" or "thick_front" for a pulse with a front faster than the waves.

    The pulse is compared with the steady one at the pre-stress tau and the measured speed.
    """
    beta, dx = run.attrs["beta"], run.attrs["dx"]
    steady = pulse_at_speed(tau, run.attrs["gamma"], beta, pulse.speed)
    layer = beta * pulse.speed / (pulse.speed**2 - 1.0)
    if layer > MAX_LAYER_TO_PULSE_WIDTH * steady.width:
        return "thick_front"
    allowed = MAX_RELATIVE_CHANGE * steady.width + layer + FRONT_WIDTH_IN_BLOCKS * dx
    has_other_width = abs(pulse.width - steady.width) > allowed
    # The variation is NaN for a young pulse, which has left no slip behind yet. It is then not
    # larger than the limit, and the width alone decides.
    has_other_slip = slip_variation(run, pulse) > MAX_RELATIVE_CHANGE
    return "unsteady" if has_other_width or has_other_slip else "steady"


def shape_deviation(run: AnyRun, pulse: LeadingPulse, level_ahead: float | None = None) -> float:
    """Return the largest deviation of slip velocity from the paper's pulse, relative to its peak.

    The paper's pulse is a cosine, equations (9) and (C10). NaN under a stress boundary, with an
    extra term of the equation, if there is no pulse, or if the pulse has too few blocks.

    level_ahead : pre-stress in front of the pulse; by default the level on the right of the profile
    """
    tau = level_ahead if level_ahead is not None else run.attrs["right"]
    has_cosine = run.attrs["boundary"] == "displacement" and not used_extra_terms(run.attrs)
    if not has_cosine or not np.isfinite(pulse.width) or not 0.0 < tau < 1.0:
        return np.nan
    paper = paper_pulse(tau, run.attrs["gamma"])
    fields = comoving(run, pulse)
    from_peak = fields["xi"] - (pulse.peak_distance - pulse.front)
    # The two outermost blocks are left out, because the lattice rounds the corners of the cosine.
    inside = np.abs(from_peak) < 0.5 * paper.width - 2.0 * run.attrs["dx"]
    if np.count_nonzero(inside) < 4:
        return np.nan
    _, cosine, _ = paper.profile(from_peak[inside] + paper.peak_position)
    return float(np.max(np.abs(fields["slip_velocity"][inside] - cosine)) / paper.peak_velocity)
