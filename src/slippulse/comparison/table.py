"""Every number of every run of a sweep, one row a run, with what the paper predicts of its transition."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr

from ..data.points import point
from ..measure.pulses import LeadingPulse, comoving
from ..measure.table import measure_run
from ..model.scene import prestress_from
from ..theory.pulse import paper_pulse
from ..theory.transition import paper_transition_displacement, paper_transition_stress
from .steadiness import pulse_state


def measured_table(sweep: xr.Dataset, settings: Mapping) -> pd.DataFrame:
    """Measure every run of a sweep.

    Parameters
    ----------
    sweep : data of a sweep
    settings : share, front_window, steady_tolerance, still, trailing_times (see config/README.md)

    Returns
    -------
    one row a run: `measure_run`, the state of its leading pulse, and the paper's T_trans and L_trans where the
    transition is measured
    """
    rows = []
    for index in range(sweep.sizes["point"]):
        run = point(sweep, index)
        row, pulse = measure_run(run, settings)
        if pulse is not None:
            row["pulse_state"] = pulse_state(run, pulse)
            row["pulse_shape_deviation"] = shape_deviation(run, pulse)
        if "transition_time" in row:
            row["paper_transition_time"], row["paper_transition_length"] = paper_transition(run.attrs)
        rows.append(row)
    return pd.DataFrame(rows)


def shape_deviation(run: xr.Dataset, pulse: LeadingPulse) -> float:
    """Largest distance of the right pulse's slip velocity from the paper's cosine, over its peak, the peaks aligned.

    Two blocks at each end of the cosine are left out, where the lattice rounds its corner. NaN without a pulse, or
    where the paper has none.

    Source: equations (9) and (C10) of the paper.
    """
    tau = run.attrs["right"]
    if run.attrs["boundary"] != "displacement" or not np.isfinite(pulse.width) or not 0.0 < tau < 1.0:
        return float("nan")
    paper = paper_pulse(tau, run.attrs["gamma"])
    fields = comoving(run, pulse)
    away = fields["xi"] - (pulse.peak_distance - pulse.front)
    inside = np.abs(away) < 0.5 * paper.width - 2.0 * run.attrs["dx"]
    if np.count_nonzero(inside) < 4:
        return float("nan")
    _, cosine, _ = paper.profile(away[inside] + paper.peak_position)
    return float(np.max(np.abs(fields["slip_velocity"][inside] - cosine)) / paper.peak_velocity)


def paper_transition(attributes: Mapping) -> tuple[float, float]:
    """The paper's T_trans and L_trans of a run (sections III B and III C)."""
    if attributes["boundary"] == "displacement":
        return paper_transition_displacement(attributes["left"], attributes["gamma"])
    return paper_transition_stress(prestress_from(attributes))
