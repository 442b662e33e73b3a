"""T_trans and L_trans of every run over the paper's formulas, with exact theory as lines."""

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
# The column that varies beside the level.
OTHER = {"displacement": "gamma", "stress": "width"}
# An inset draws lines of this many levels, or values of gamma or W.
DRAWN = 3


def transition_table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """One row per run: length and time as measured, with uncertainties, by the paper, and exact."""
    names = [name for name in tables if "/" not in name]
    runs = pd.concat([with_uncertainties(tables, name) for name in names], ignore_index=True)
    kept = ["boundary", "left", "right", "width", "gamma", "damping_ratio", "beta", "dx"]
    kept.append("run_flags")
    for name in QUANTITIES:
        kept += [f"transition_{name}", f"paper_transition_{name}", f"exact_transition_{name}"]
        kept.append(f"uncertainty_transition_{name}")
    return runs[kept].rename(columns=lambda column: column.replace("transition_", ""))


def with_uncertainties(tables: dict[str, pd.DataFrame], name: str) -> pd.DataFrame:
    """The runs of a sweep with the numerical uncertainty of both quantities."""
    study = tables[f"uncertainties/{name}"].set_index(["quantity", "point"])["uncertainty"]
    columns = {
        f"uncertainty_transition_{quantity}": study.xs(f"transition_{quantity}").to_numpy()
        for quantity in QUANTITIES
    }
    return tables[name].assign(**columns)


def draw_collapse(axes: Axes, runs: pd.DataFrame, quantity: str, colours: Look) -> None:
    """Draw measured against predicted; ``colours`` of the runs are c (face) and edgecolors."""
    x, y = runs[f"paper_{quantity}"], runs[quantity]
    symbol = QUANTITIES[quantity]
    axes.set(xlabel=f"paper's formula for ${symbol}$", ylabel=f"measured ${symbol}$")
    if (x.isna() | y.isna()).all():
        axes.text(0.5, 0.5, f"no run reaches ${symbol}$", ha="center", transform=axes.transAxes)
        return
    width = 1.0 if "edgecolors" in colours else 0.3
    _error_bars(axes, x, y, runs[f"uncertainty_{quantity}"])
    _scatter(axes, runs, x, y, colours, s=15.0, linewidths=width)
    ends = [min(x.min(), y.min()) / 1.4, max(x.max(), y.max()) * 1.4]
    axes.plot(ends, ends, color=BLACK, linewidth=0.8, zorder=0, gid="equality")
    axes.set(xscale="log", yscale="log", xlim=ends, ylim=ends)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set(major_formatter="{x:g}", minor_formatter=NullFormatter())


def ratio_inset(
    axes: Axes, box: Box, runs: pd.DataFrame, quantity: str, across: str, line: str
) -> Axes:
    """Draw measured over predicted in a box over ``across``: runs, and exact lines by ``line``."""
    inset = style.small_inset(axes, box, "measured / formula")
    inset.set_in_layout(False)
    draw_ratio(inset, runs, quantity, across, line)
    inset.set_xlabel(f"${SYMBOLS[across]}$", fontsize=SMALL_TEXT, labelpad=0.0)
    look: Look = {"fontsize": SMALL_TEXT, "handlelength": 1.1, "handletextpad": 0.3}
    look["borderaxespad"] = 0.3
    inset.legend(loc="upper left", bbox_to_anchor=(1.0, 1.2), **look)
    return inset


def draw_ratio(axes: Axes, runs: pd.DataFrame, quantity: str, across: str, line: str) -> None:
    """Draw measured over predicted against ``across``: runs with bars, exact lines by ``line``."""
    axes.axhline(1.0, color=BLACK, linewidth=0.6, zorder=0)
    for value, group in runs.groupby(line):
        group = group.sort_values(across)
        exact = group[f"exact_{quantity}"] / group[f"paper_{quantity}"]
        look: Look = {"color": style.colour(line, value), "linewidth": 0.8, "gid": "exact"}
        axes.plot(group[across], exact, label=f"${SYMBOLS[line]}$ = {setting(value)}", **look)
    formula = runs[f"paper_{quantity}"]
    _error_bars(
        axes, runs[across], runs[quantity] / formula, runs[f"uncertainty_{quantity}"] / formula
    )
    colours = {"c": style.colour(line, runs[line])}
    _scatter(axes, runs, runs[across], runs[quantity] / formula, colours)


def _error_bars(axes: Axes, x: pd.Series, y: pd.Series, error: pd.Series) -> None:
    """Draw bars of the numerical uncertainty, which a marker may hide."""
    look: Look = {"fmt": "none", "ecolor": BLACK, "elinewidth": 0.7, "capsize": 1.5, "zorder": 2}
    axes.errorbar(x, y, error, **look)


def _scatter(
    axes: Axes, runs: pd.DataFrame, x: pd.Series, y: pd.Series, colours: Look, **sizes: Any
) -> None:
    """Draw a marker a run: in its colours, or open and grey where the run is flagged."""
    look: Look = {"s": 9.0, "linewidths": 0.0, "edgecolors": "white", "zorder": 3} | sizes
    flagged = runs["run_flags"].notna()
    grey: Look = {"facecolors": "none", "edgecolors": GREY, "linewidths": 0.6}
    axes.scatter(x[flagged], y[flagged], **look | grey)
    shown: Look = {name: values[~flagged.to_numpy()] for name, values in colours.items()}
    axes.scatter(x[~flagged], y[~flagged], gid="runs", **look | shown)


def damping_figure(table: pd.DataFrame) -> Figure:
    """Draw figures 10 and 11: the collapse in colours of b, and in insets the ratio against b."""
    boundary, ratios = table["boundary"].iloc[0], np.sort(table["damping_ratio"].unique())
    level, other = LEVEL_COLUMNS[boundary], OTHER[boundary]
    middle = spread_values(table[other], DRAWN)[1]
    table = table.assign(**{level: table["left"]}).sort_values("damping_ratio")
    few = table[(table[other] == middle) & table["left"].isin(spread_values(table["left"], DRAWN))]
    colours = {"c": style.colour("damping_ratio", table["damping_ratio"])}
    spacing = table["dx"] / table["width"]
    spacings = rf"$\Delta x/W$ = {spacing.min():.2g} to {spacing.max():.2g}"
    figure, panels = style.new_panels(PAGE_WIDTH, 3.5, "ab")
    for axes, quantity in zip(panels, QUANTITIES, strict=True):
        draw_collapse(axes, table, quantity, colours)
        axes.set_title(f"{style.conditions(boundary == 'displacement')}, {spacings}", loc="center")
        # The runs lie above equality, so that the corner below it is free.
        inset = ratio_inset(axes, (0.52, 0.12, 0.26, 0.29), few, quantity, "damping_ratio", level)
        # The axis of the damping ratio has 0.
        inset.set_xscale("symlog", linthresh=ratios[1], linscale=0.5)
        style.few_ticks(inset.xaxis, ratios[:: 2 if len(ratios) > 4 else 1])
        inset.set_xlim(-0.4 * ratios[1], 1.7 * ratios[-1])
    looks = zip(ratios, style.colour("damping_ratio", ratios), strict=True)
    handles = [entry(f"$b = {ratio:g}$", marker="o", color=colour) for ratio, colour in looks]
    name = f"exact, ${SYMBOLS[other]}$ = {middle:g} (insets)"
    handles.append(entry(name, color=BLACK, linewidth=0.8))
    style.legend_below(figure, handles, len(handles))
    return figure
