"""Figure 11: the collapse under a stress boundary for several damping ratios."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from .shared.scaling import PREDICTIONS, damping_rows, draw_damping
from .style import PAGE, new_figure

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {"measured": ["damping_stress"]}


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Every run by damping ratio."""
    return damping_rows(measured["damping_stress"], "stress")


def plot(table: pd.DataFrame) -> Figure:
    """One column a damping ratio."""
    figure = new_figure(PAGE, 4.1)
    grid = draw_damping(figure, table, "stress", PREDICTIONS)
    figure.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside lower center")
    return figure
