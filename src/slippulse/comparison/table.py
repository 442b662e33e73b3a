"""Every number of every run of a sweep, one row a run, with what the paper predicts of its transition."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd
import xarray as xr

from ..data.points import point
from ..measure.table import measure_run
from ..model.scene import prestress_from
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
        if "transition_time" in row:
            row["paper_transition_time"], row["paper_transition_length"] = paper_transition(run.attrs)
        rows.append(row)
    return pd.DataFrame(rows)


def paper_transition(attributes: Mapping) -> tuple[float, float]:
    """The paper's T_trans and L_trans of a run (sections III B and III C)."""
    if attributes["boundary"] == "displacement":
        return paper_transition_displacement(attributes["left"], attributes["gamma"])
    return paper_transition_stress(prestress_from(attributes))
