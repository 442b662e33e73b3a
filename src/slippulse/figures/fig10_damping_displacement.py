"""Figure 10: the collapse under a displacement boundary for several damping ratios."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from ..theory.front_law import front_speed
from .shared.scaling import PREDICTIONS, damping_rows, draw_damping
from .style import ORANGE, PAGE, new_figure

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {"measured": ["damping_displacement"]}


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Every run by damping ratio, and L_trans predicted with the exact damped front speed beside the paper's."""
    sweep = measured["damping_displacement"]
    rows = damping_rows(sweep, "displacement")
    corrected = rows[(rows["role"] == "marker") & rows["panel"].str.startswith("displacement_length")].copy()
    speeds = {
        (tau0, ratio): float(front_speed(tau0, ratio, sweep["release"].iloc[0]))
        for tau0, ratio in {(row.left, row.damping_ratio) for row in corrected.itertuples()}
    }
    corrected["role"] = "corrected"
    corrected["y"] = [
        2.0 * np.pi / np.sqrt(row.gamma) * speeds[row.left, row.damping_ratio]
        for row in corrected.itertuples()
    ]
    return pd.concat([rows, corrected], ignore_index=True)


def plot(table: pd.DataFrame) -> Figure:
    """One column a damping ratio; the prediction with the exact damped speed as a short bar."""
    figure = new_figure(PAGE, 4.1)
    grid = draw_damping(figure, table, "displacement", PREDICTIONS)
    corrected = table[table["role"] == "corrected"]
    for axes, (_, rows) in zip(grid[0], corrected.groupby("damping_ratio"), strict=True):
        axes.scatter(
            rows["x"],
            rows["y"],
            marker="_",
            s=14,
            linewidths=0.8,
            color=ORANGE,
            zorder=4,
            gid="corrected",
            label=r"$2\pi v/\sqrt{\bar\gamma}$, exact damped front speed $v(\bar\tau_0, \bar\beta/\mathrm{d}\bar x)$",
        )
    handles, labels = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=2)
    return figure
