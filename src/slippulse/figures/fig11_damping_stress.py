"""Figure 11: the transition under a stress boundary for several damping ratios."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from .shared.scaling import damping_figure, transition_rows
from .style import PAGE, new_figure

# What is drawn: data, tables and studies by name, and keys of the configuration.
NEEDS = {"measured": ["damping_stress"], "predicted": ["damping_stress"]}


def table(
    data: Mapping[str, xr.Dataset], tables: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Every run, as `transition_rows` has it."""
    return transition_rows(tables["damping_stress"], "stress")


def plot(table: pd.DataFrame) -> Figure:
    """Measured over predicted against the damping ratio: L_trans left, T_trans right."""
    figure = new_figure(PAGE, 2.8)
    damping_figure(figure, table)
    return figure
