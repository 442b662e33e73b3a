"""Figure 10: the transition under a displacement boundary for several damping ratios."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from .shared.scaling import collapse_rows, draw_damping, exact_rows, summaries
from .style import PAGE, new_figure

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {"measured": ["damping_displacement"]}


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Every run, exact theory at the middle gamma, and the summary at each damping ratio."""
    sweep = measured["damping_displacement"]
    rows = collapse_rows(sweep, "displacement")
    middle = sweep[sweep["gamma"] == sweep["gamma"].quantile(0.5, interpolation="nearest")]
    exact = exact_rows(middle, "displacement")
    return pd.concat([rows, exact, summaries(rows, ("panel", "damping_ratio"))], ignore_index=True)


def plot(table: pd.DataFrame) -> Figure:
    """Measured over predicted against the damping ratio: L_trans left, T_trans right."""
    figure = new_figure(PAGE, 2.8)
    draw_damping(figure, table, "displacement")
    return figure
