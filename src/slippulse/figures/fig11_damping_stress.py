"""Figure 11: the transition under a stress boundary for several damping ratios."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from .shared.scaling import collapse_rows, draw_damping, exact_rows, summaries
from .style import PAGE, new_figure

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {"measured": ["damping_stress"], "settings": ["measure.share"]}


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Every run, exact theory at the middle width, and the summary at each damping ratio."""
    sweep = measured["damping_stress"]
    rows = collapse_rows(sweep, "stress")
    middle = sweep[sweep["width"] == sweep["width"].quantile(0.5, interpolation="nearest")]
    exact = exact_rows(middle, "stress", settings["measure"]["share"])
    return pd.concat([rows, exact, summaries(rows, ("panel", "damping_ratio"))], ignore_index=True)


def plot(table: pd.DataFrame) -> Figure:
    """Measured over predicted against the damping ratio: L_trans left, T_trans right."""
    figure = new_figure(PAGE, 2.8)
    draw_damping(figure, table, "stress")
    return figure
