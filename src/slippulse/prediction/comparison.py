"""All numbers of every run of a sweep, with those that need theory: one row a run."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from ..data.points import AnyRun, runs_in
from ..measurement.front_paths import path
from ..measurement.pulses import LeadingPulse, comoving, slip_variation
from ..measurement.table import measure_run
from ..model.prestress import prestress_from
from ..model.recorded_law import law_of
from ..theory.closed_pulse import (
    paper_pulse,
    paper_transition_displacement,
    paper_transition_stress,
    pulse_at_speed,
)

# A pulse is unsteady if its width differs from that of the steady pulse at the measured speed by
# more than CHANGE of it, the damped layer and WIDTH_BLOCKS blocks (the front is that wide), or if
# the slip behind it varies by more than CHANGE.
CHANGE, WIDTH_BLOCKS = 0.05, 3.0
# Largest thickness of the damped layer at the front over the width of the pulse. The front speed is
# computed without leaf springs; its error grows as the square of this, and is one per cent here.
THICKEST_LAYER = 0.125


def measured_table(sweep: xr.Dataset, settings: Mapping) -> pd.DataFrame:
    """Table of the `measured_row` of every run of a sweep."""
    return pd.DataFrame([measured_row(run, settings) for run in runs_in(sweep)])


def measured_row(run: AnyRun, settings: Mapping) -> dict[str, Any]:
    """Numbers of `measure_run`, the leading pulse's state, and the paper's T_trans and L_trans."""
    row, pulse = measure_run(run, settings)
    if pulse is not None:
        row["pulse_state"] = pulse_state(run, pulse)
        row["pulse_shape_deviation"] = shape_deviation(run, pulse, row.get("level_ahead_right"))
    if "transition_time" in row:
        if run.attrs["boundary"] == "displacement":
            left, right = run.attrs["left"], run.attrs["right"]
            paper = paper_transition_displacement(left, run.attrs["gamma"])
            if left != right:
                # The time does not depend on the level, the length does.
                paper = paper[0], math.nan
        else:
            paper = paper_transition_stress(prestress_from(run.attrs))
        row["paper_transition_time"], row["paper_transition_length"] = paper
    return row


def pulse_state(run: AnyRun, pulse: LeadingPulse) -> str:
    """State of the leading pulse, by its flags in config/README.md; "none" without a known pulse.

    A steady one has the width of beta v U''' + (v^2 - 1) U'' + gamma U = tau_0 and uniform slip.
    """
    if run.attrs["boundary"] != "displacement":
        return "none"
    if np.isfinite(pulse.front) and pulse.pulses != 1:
        return "several" if pulse.pulses else "stopped"
    coulomb = law_of(run.attrs)["law"] == "coulomb"
    if not np.isfinite([pulse.width, pulse.speed]).all() or not coulomb:
        return "none"
    ahead = np.argmin(np.abs(np.asarray(run["x"]) - path(run)[1][-1]))
    tau = float(np.asarray(run["prestress"])[ahead])
    if not 0.0 < tau < 1.0:
        return "none"
    if pulse.speed <= 1.0:
        return "unsteady"
    beta, dx = run.attrs["beta"], run.attrs["dx"]
    steady = pulse_at_speed(tau, run.attrs["gamma"], beta, pulse.speed)
    layer = beta * pulse.speed / (pulse.speed**2 - 1.0)
    if layer > THICKEST_LAYER * steady.width:
        return "thick_front"
    allowed = CHANGE * steady.width + layer + WIDTH_BLOCKS * dx
    # A young pulse, which has left no slip behind yet, is judged by its width alone.
    changes = abs(pulse.width - steady.width) > allowed or slip_variation(run, pulse) > CHANGE
    return "unsteady" if changes else "steady"


def shape_deviation(run: AnyRun, pulse: LeadingPulse, level_ahead: float | None = None) -> float:
    """Largest deviation of slip velocity from the paper's cosine, (9) and (C10), over its peak.

    level_ahead : the level in front of the pulse, if it is not that on the right of the profile
    """
    tau = level_ahead if level_ahead is not None else run.attrs["right"]
    held = run.attrs["boundary"] == "displacement"
    if not held or not np.isfinite(pulse.width) or not 0.0 < tau < 1.0:
        return np.nan
    paper = paper_pulse(tau, run.attrs["gamma"])
    fields = comoving(run, pulse)
    distance = fields["xi"] - (pulse.peak_distance - pulse.front)
    # The lattice rounds the corners of the cosine.
    inside = np.abs(distance) < 0.5 * paper.width - 2.0 * run.attrs["dx"]
    if np.count_nonzero(inside) < 4:
        return np.nan
    _, cosine, _ = paper.profile(distance[inside] + paper.peak_position)
    return float(np.max(np.abs(fields["slip_velocity"][inside] - cosine)) / paper.peak_velocity)
