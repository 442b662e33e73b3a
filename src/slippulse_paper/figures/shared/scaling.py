"""Draw measured T_trans and L_trans of runs as functions of the paper's formulas for them.

In insets, the ratio of measured and predicted values is drawn, with exact theory as lines.
"""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from slippulse.plotting import style
from slippulse.plotting.selection import spread_values
from slippulse.plotting.style import (
    BLACK,
    GREY,
    LEVEL_COLUMNS,
    PAGE_WIDTH,
    SMALL_TEXT,
    SYMBOLS,
    Box,
    Look,
    entry,
)

from ...text.numerals import setting

QUANTITIES = {"length": r"L_\text{trans}", "time": r"T_\text{trans}"}
# The parameter that varies in addition to the level of the pre-stress, for each boundary condition.
SECOND_COLUMN = {"displacement": "gamma", "stress": "width"}
# An inset draws lines of this many levels, or values of gamma or W.
LINE_COUNT = 3


def transition_table(data: dict, tables: dict[str, pd.DataFrame], settings: dict) -> pd.DataFrame:
    """Return one row for each run of all sweeps, with its transition length and time.

    The columns length and time have the measured values. With a prefix, they have the numerical
    uncertainty (uncertainty_length), the value by the paper's formula (paper_length), and the exact
    value (exact_length).
    """
    # The tables of grid studies have names such as "uncertainties/NAME".
    sweeps = [name for name in tables if "/" not in name]
    runs = pd.concat([with_uncertainties(tables, name) for name in sweeps], ignore_index=True)
    columns = ["boundary", "left", "right", "width", "gamma", "damping_ratio", "beta", "dx"]
    columns.append("run_flags")
    for quantity in QUANTITIES:
        for prefix in ("", "paper_", "exact_", "uncertainty_"):
            columns.append(f"{prefix}transition_{quantity}")
    return runs[columns].rename(columns=lambda column: column.replace("transition_", ""))


def with_uncertainties(tables: dict[str, pd.DataFrame], name: str) -> pd.DataFrame:
    """Return the runs of a sweep, with the numerical uncertainty of transition length and time.

    tables : measured tables by name, and grid studies as "uncertainties/NAME"
    name : name of the sweep
    """
    grid_study = tables[f"uncertainties/{name}"]
    runs = tables[name].copy()
    for quantity in QUANTITIES:
        # A grid study has one row for each run and measured number, in the order of the runs.
        rows = grid_study[grid_study["quantity"] == f"transition_{quantity}"]
        runs[f"uncertainty_transition_{quantity}"] = rows["uncertainty"].to_numpy()
    return runs


def draw_collapse(axes: Axes, runs: pd.DataFrame, quantity: str, colours: Look) -> None:
    """Draw the measured length or time of the transition as a function of the paper's formula.

    quantity : "length" or "time"
    colours : colours of the markers, one for each run: "c" for faces, and "edgecolors" for rims
    """
    predicted, measured = runs[f"paper_{quantity}"], runs[quantity]
    symbol = QUANTITIES[quantity]
    axes.set(xlabel=f"paper's formula for ${symbol}$", ylabel=f"measured ${symbol}$")
    if (predicted.isna() | measured.isna()).all():
        axes.text(0.5, 0.5, f"no run reaches ${symbol}$", ha="center", transform=axes.transAxes)
        return
    # Rims are wide if their colour has a meaning.
    edge_width = 1.0 if "edgecolors" in colours else 0.3
    _error_bars(axes, predicted, measured, runs[f"uncertainty_{quantity}"])
    _scatter(axes, runs, predicted, measured, colours, s=15.0, linewidths=edge_width)
    smallest = min(predicted.min(), measured.min())
    largest = max(predicted.max(), measured.max())
    ends = [smallest / 1.4, largest * 1.4]
    axes.plot(ends, ends, color=BLACK, linewidth=0.8, zorder=0, gid="equality")
    axes.set(xscale="log", yscale="log", xlim=ends, ylim=ends)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set(major_formatter="{x:g}", minor_formatter=NullFormatter())


def ratio_inset(
    axes: Axes, box: Box, runs: pd.DataFrame, quantity: str, x_column: str, line_column: str
) -> Axes:
    """Add an inset to a panel that shows measured values divided by the formula, with a legend.

    Return the axes of the inset.

    box : place of the inset in the panel
    quantity : "length" or "time"
    x_column : column on the horizontal axis
    line_column : there is one line, with its own colour, for each value of this column
    """
    inset = style.small_inset(axes, box, "measured / formula")
    # The layout reserves no room for the inset, because it and its legend lie within the panel.
    inset.set_in_layout(False)
    draw_ratio(inset, runs, quantity, x_column, line_column)
    inset.set_xlabel(f"${SYMBOLS[x_column]}$", fontsize=SMALL_TEXT, labelpad=0.0)
    look: Look = {"fontsize": SMALL_TEXT, "handlelength": 1.1, "handletextpad": 0.3}
    look["borderaxespad"] = 0.3
    inset.legend(loc="upper left", bbox_to_anchor=(1.0, 1.2), **look)
    return inset


def draw_ratio(
    axes: Axes, runs: pd.DataFrame, quantity: str, x_column: str, line_column: str
) -> None:
    """Draw the measured length or time divided by the paper's formula.

    Runs are markers with error bars, and exact theory is drawn as lines.

    quantity : "length" or "time"
    x_column : column on the horizontal axis
    line_column : there is one line, with its own colour, for each value of this column
    """
    axes.axhline(1.0, color=BLACK, linewidth=0.6, zorder=0)
    for value, group in runs.groupby(line_column):
        group = group.sort_values(x_column)
        exact_ratio = group[f"exact_{quantity}"] / group[f"paper_{quantity}"]
        look: Look = {"color": style.colour(line_column, value), "linewidth": 0.8, "gid": "exact"}
        look["label"] = f"${SYMBOLS[line_column]}$ = {setting(value)}"
        axes.plot(group[x_column], exact_ratio, **look)
    formula = runs[f"paper_{quantity}"]
    ratio, error = runs[quantity] / formula, runs[f"uncertainty_{quantity}"] / formula
    _error_bars(axes, runs[x_column], ratio, error)
    _scatter(axes, runs, runs[x_column], ratio, {"c": style.colour(line_column, runs[line_column])})


def _error_bars(axes: Axes, x: pd.Series, y: pd.Series, error: pd.Series) -> None:
    """Draw bars of the numerical uncertainty. A marker may hide a short bar."""
    look: Look = {"fmt": "none", "ecolor": BLACK, "elinewidth": 0.7, "capsize": 1.5, "zorder": 2}
    axes.errorbar(x, y, error, **look)


def _scatter(
    axes: Axes, runs: pd.DataFrame, x: pd.Series, y: pd.Series, colours: Look, **sizes: Any
) -> None:
    """Draw one marker for each run: in its colours, or open and grey if the run is flagged.

    colours, sizes : arguments of `Axes.scatter`. The colours have one value for each run: "c" for
        the face of its marker, and "edgecolors" for the rim
    """
    look: Look = {"s": 9.0, "linewidths": 0.0, "edgecolors": "white", "zorder": 3} | sizes
    is_flagged = runs["run_flags"].notna().to_numpy()
    grey: Look = {"facecolors": "none", "edgecolors": GREY, "linewidths": 0.6}
    axes.scatter(x[is_flagged], y[is_flagged], **look | grey)
    unflagged_colours = {argument: values[~is_flagged] for argument, values in colours.items()}
    axes.scatter(x[~is_flagged], y[~is_flagged], gid="runs", **look | unflagged_colours)


def damping_figure(table: pd.DataFrame) -> Figure:
    """Draw figure 10 or 11: measured and predicted transitions, in the colours of damping ratios.

    Insets show the ratio of measured and predicted values as a function of the damping ratio b, for
    a few levels of the pre-stress.
    """
    boundary = table["boundary"].iloc[0]
    # The level is called tau_0 if it is the same on both sides, and left otherwise. The second
    # varying parameter is gamma or width.
    level_column, second_column = LEVEL_COLUMNS[boundary], SECOND_COLUMN[boundary]
    table = table.assign(**{level_column: table["left"]}).sort_values("damping_ratio")
    # The insets show a few levels, at a middle value of the second parameter.
    few_values = spread_values(table[second_column], LINE_COUNT)
    middle = few_values[few_values.size // 2]
    drawn_levels = spread_values(table["left"], LINE_COUNT)
    runs_of_insets = table[(table[second_column] == middle) & table["left"].isin(drawn_levels)]
    colours = {"c": style.colour("damping_ratio", table["damping_ratio"])}
    spacing = table["dx"] / table["width"]
    title = style.conditions(held=boundary == "displacement")
    title += rf", $\Delta x/W$ = {spacing.min():.2g} to {spacing.max():.2g}"
    ratios = np.sort(table["damping_ratio"].unique())
    figure, panels = style.new_panels(PAGE_WIDTH, 3.5, "ab")
    for axes, quantity in zip(panels, QUANTITIES, strict=True):
        draw_collapse(axes, table, quantity, colours)
        axes.set_title(title, loc="center")
        # The runs lie above the line of equality, so that the lower right corner is free.
        box = (0.52, 0.12, 0.26, 0.29)
        columns = {"x_column": "damping_ratio", "line_column": level_column}
        inset = ratio_inset(axes, box, runs_of_insets, quantity, **columns)
        _set_axis_of_damping_ratios(inset, ratios)
    handles = []
    for ratio, colour in zip(ratios, style.colour("damping_ratio", ratios), strict=True):
        handles.append(entry(f"$b = {ratio:g}$", marker="o", color=colour))
    label = f"exact, ${SYMBOLS[second_column]}$ = {middle:g} (insets)"
    handles.append(entry(label, color=BLACK, linewidth=0.8))
    style.legend_below(figure, handles, columns=len(handles))
    return figure


def _set_axis_of_damping_ratios(axes: Axes, ratios: np.ndarray) -> None:
    """Set scale, ticks and range of a horizontal axis for these damping ratios, in rising order.

    A logarithmic scale has no place for 0, so the scale is linear near 0.
    """
    positive_ratios = ratios[ratios > 0.0]
    # If all runs are undamped, any range will do.
    smallest_positive = positive_ratios[0] if positive_ratios.size else 1.0
    axes.set_xscale("symlog", linthresh=smallest_positive, linscale=0.5)
    # There is room for about four ticks.
    style.few_ticks(axes.xaxis, ratios[::2] if len(ratios) > 4 else ratios)
    axes.set_xlim(-0.4 * smallest_positive, 1.7 * max(ratios[-1], smallest_positive))
