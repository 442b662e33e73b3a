"""A sweep of one's own: its main numbers against what varies in it, with exact theory where there is any."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from ..comparison.scene_numbers import LABELS, theories
from .style import CYCLE, GREY, PAGE, new_figure, panel_letter

# What may vary in a sweep, with its symbol.
AXES = {
    "left": r"$\tau_{0,l}$",
    "right": r"$\tau_{0,r}$",
    "gamma": r"$\gamma$",
    "damping_ratio": r"$\beta/\Delta x$",
    "width": r"$W$",
    "beyond": r"level beyond the step",
    "release": "release rule",
    "dx": r"$\Delta x$",
}
PANELS, ROWS = 6, 2


def table(measured: pd.DataFrame, share: float) -> pd.DataFrame:
    """Every main number of every run.

    Parameters
    ----------
    measured : measured numbers of the sweep, one row a run
    share : share of |x_minus| that the left front covers at T_trans under a stress boundary

    Returns
    -------
    rows of quantity, label, value, theory (NaN where there is none), flags, the axis that takes most values, and the
    series by all others that vary, empty where none does
    """
    varying: list[str] = []
    for name in AXES:
        # A level that follows another one is no axis of its own.
        follows = any((measured[name] == measured[other]).all() for other in varying)
        if measured[name].nunique() > 1 and not follows:
            varying.append(name)
    varying.sort(key=lambda name: (measured[name].dtype.kind != "f", -measured[name].nunique()))
    axis, *others = varying or ["left"]
    rows = []
    for run in measured.to_dict("records"):
        exact = theories(run, share)
        series = ", ".join(f"{AXES[name]} = {_text(run[name])}" for name in others)
        for quantity, label in LABELS[run["boundary"]].items():
            if np.isfinite(run.get(quantity, np.nan)):
                rows.append(
                    {
                        "quantity": quantity,
                        "label": label,
                        "value": run[quantity],
                        "run_flags": run["run_flags"],
                    }
                    | {"theory": exact.get(quantity, np.nan), "axis": axis, "x": run[axis], "series": series}
                )
    columns = ["quantity", "label", "value", "theory", "run_flags", "axis", "x", "series"]
    return pd.DataFrame(rows, columns=columns)


def _text(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def plot(table: pd.DataFrame) -> Figure:
    """One panel a quantity; markers are runs (open: flagged), lines exact theory."""
    quantities = list(dict.fromkeys(table["quantity"]))[:PANELS]
    figure = new_figure(PAGE, 4.2)
    grid = figure.subplots(ROWS, PANELS // ROWS).ravel()
    for axes, letter, quantity in zip(grid, "abcdef", quantities, strict=False):
        rows = table[table["quantity"] == quantity]
        groups = rows.groupby("series", dropna=False, sort=False)
        colours = CYCLE if 1 < groups.ngroups <= len(CYCLE) else [GREY] * groups.ngroups
        for colour, (series, group) in zip(colours, groups, strict=False):
            group = group.sort_values("x")
            label = series if isinstance(series, str) and series else None
            axes.plot(group["x"], group["theory"], color=colour, linewidth=0.8)
            for sound, face in ((True, colour), (False, "none")):
                some = group[(group["run_flags"].isna() | (group["run_flags"] == "")) == sound]
                axes.plot(
                    some["x"],
                    some["value"],
                    "o",
                    color=colour,
                    markerfacecolor=face,
                    label=label if sound else None,
                )
        axes.set(xlabel=AXES[rows["axis"].iloc[0]], ylabel=rows["label"].iloc[0])
        panel_letter(axes, letter)
    for axes in grid[len(quantities) :]:
        axes.set_visible(False)
    if quantities and grid[0].get_legend_handles_labels()[0]:
        figure.legend(*grid[0].get_legend_handles_labels(), loc="outside lower center", ncols=5)
    return figure
