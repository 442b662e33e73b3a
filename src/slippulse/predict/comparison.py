"""All numbers of every run of a sweep, with those that need theory: one row a run."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from ..data.points import AnyRun, runs_in
from ..measurement.fronts import path
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
    """Numbers of `measure_run`, the state of the leading pulse, and the paper's transition.

    The paper's T_trans and L_trans (sections III B and III C) are in the row if measured ones are.
    """
    row, pulse = measure_run(run, settings)
    if pulse is not None:
        row["pulse_state"] = pulse_state(run, pulse)
        row["pulse_shape_deviation"] = shape_deviation(run, pulse)
    if "transition_time" in row:
        if run.attrs["boundary"] == "displacement":
            paper = paper_transition_displacement(run.attrs["left"], run.attrs["gamma"])
        else:
            paper = paper_transition_stress(prestress_from(run.attrs))
        row["paper_transition_time"], row["paper_transition_length"] = paper
    return row


def pulse_state(run: AnyRun, pulse: LeadingPulse) -> str:
    """State of the leading pulse, which says if the numbers of a steady pulse apply to it.

    steady : the width is that of the steady pulse at the measured speed, and the slip is uniform
    unsteady : one of them is not so, or the pulse is slower than the waves
    thick_front : the damped layer is not thin compared with the pulse
    several : it is one of several on the right
    stopped : the right front has stopped
    none : no pulse, or a stress boundary

    Source: width and layer of the steady pulse, beta v U''' + (v^2 - 1) U'' + gamma U = tau_0.
    """
    if run.attrs["boundary"] != "displacement":
        return "none"
    if np.isfinite(pulse.front) and pulse.pulses != 1:
        return "several" if pulse.pulses else "stopped"
    if not np.isfinite([pulse.width, pulse.speed]).all():
        return "none"
    if law_of(run.attrs)["law"] != "coulomb":
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


def shape_deviation(run: AnyRun, pulse: LeadingPulse) -> float:
    """Largest deviation of the right pulse's slip velocity from the paper's cosine, over its peak.

    The peaks are aligned. Two blocks at each end of the cosine are left out, where the lattice
    rounds its corner. NaN without such a pulse. Source: equations (9) and (C10) of the paper.
    """
    tau = run.attrs["right"]
    if (
        run.attrs["boundary"] != "displacement"
        or not np.isfinite(pulse.width)
        or not 0.0 < tau < 1.0
    ):
        return float("nan")
    paper = paper_pulse(tau, run.attrs["gamma"])
    fields = comoving(run, pulse)
    distance = fields["xi"] - (pulse.peak_distance - pulse.front)
    inside = np.abs(distance) < 0.5 * paper.width - 2.0 * run.attrs["dx"]
    if np.count_nonzero(inside) < 4:
        return float("nan")
    _, cosine, _ = paper.profile(distance[inside] + paper.peak_position)
    return float(np.max(np.abs(fields["slip_velocity"][inside] - cosine)) / paper.peak_velocity)
