"""A user-defined sweep: its main numbers against what varies in it, with exact theory where there is any."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from .shared.numbers import main_numbers, with_symbols
from .style import CYCLE, GREY, PAGE, entry, legend_below, new_panels

# What may vary in a sweep, with its symbol.
AXES = {
    "tau_0": r"$\tau_0$",
    "left": r"$\tau_{0,l}$",
    "right": r"$\tau_{0,r}$",
    "gamma": r"$\gamma$",
    "damping_ratio": r"$\beta/\Delta x$",
    "width": r"$W$",
    "beyond": "level beyond the step",
    "release": "release rule",
    "dx": r"$\Delta x$",
}
PANELS, ROWS = 6, 2


def table(data: dict, tables: dict[str, pd.DataFrame], settings: dict) -> pd.DataFrame:
    """`main_numbers` of each run of one sweep, measured and predicted, with its flags, the axis that takes most values
    (tau_0 for a level on both sides), x (its value) and the series by all others that vary, empty where none does; a
    number that equals another one in every run is left out.
    """
    (runs,) = tables.values()
    varying: list[str] = []
    alike = (runs["left"] == runs["right"]).all()
    runs = runs.assign(tau_0=runs["left"] if alike else 0.0)
    for name in AXES:
        # A level that follows another one is no axis of its own.
        if runs[name].nunique() > 1 and not any(
            (runs[name] == runs[other]).all() for other in varying
        ):
            varying.append(name)
    varying.sort(key=lambda name: (runs[name].dtype.kind != "f", -runs[name].nunique()))
    axis, *others = varying or ["left"]
    parts = []
    for _, run in runs.iterrows():
        values = {
            name: run[name] if isinstance(run[name], str) else f"{run[name]:g}" for name in others
        }
        series = ", ".join(f"{AXES[name]} = {value}" for name, value in values.items())
        numbers = main_numbers(run).assign(run_flags=run["run_flags"])
        parts.append(numbers.assign(axis=axis, x=run[axis], series=series))
    new: list[pd.DataFrame] = []
    for _, group in pd.concat(parts).groupby("quantity", sort=False):
        if not any(np.array_equal(group["value"], other["value"]) for other in new):
            new.append(group)
    return pd.concat(new, ignore_index=True)


def plot(table: pd.DataFrame) -> Figure:
    """One panel a quantity; markers are runs (open: flagged), lines exact theory."""
    table = table.assign(series=table["series"].astype(object).fillna(""))
    quantities = list(dict.fromkeys(table["quantity"]))[:PANELS]
    figure, grid = new_panels(PAGE, 4.2, ROWS, PANELS // ROWS)
    for axes, quantity in zip(grid, quantities, strict=False):
        rows = table[table["quantity"] == quantity]
        groups = rows.groupby("series", sort=False)
        colours = CYCLE if 1 < groups.ngroups <= len(CYCLE) else [GREY] * groups.ngroups
        for colour, (series, group) in zip(colours, groups, strict=False):
            group = group.sort_values("x")
            flagged = group["run_flags"].notna()
            axes.plot(group["x"], group["theory"], color=colour, linewidth=0.8)
            sound, hollow = group[~flagged], group[flagged]
            axes.plot(sound["x"], sound["value"], "o", color=colour, label=series or None)
            axes.plot(hollow["x"], hollow["value"], "o", color=colour, markerfacecolor="none")
        axes.set(xlabel=AXES[rows["axis"].iloc[0]], ylabel=with_symbols(rows["label"].iloc[0]))
    for axes in grid[len(quantities) :]:
        axes.set_visible(False)
    handles = [
        entry("simulation", marker="o", color=GREY),
        entry("exact theory", color=GREY, linewidth=0.8),
    ]
    if table["run_flags"].notna().any():
        handles.append(entry("flagged", marker="o", color=GREY, markerfacecolor="none"))
    legend_below(figure, [*grid[0].get_legend_handles_labels()[0], *handles], 5)
    return figure
