"""T_trans and L_trans of every run over the paper's formulas, with exact theory as lines."""

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .. import style
from ..style import BLACK, GREY, PAGE, Look, entry, few_ticks
from .selection import spread_values

SYMBOLS = {"length": r"L_\text{trans}", "time": r"T_\text{trans}"}


class Coloured(NamedTuple):
    """A quantity of `style.SCALES` that gives runs their colours."""

    quantity: str
    symbol: str


# Each run has the colour of its level, and that of what varies beside the level.
LEVEL = {
    "displacement": Coloured("tau_0", r"$\tau_0$"),
    "stress": Coloured("tau_l", r"$\tau_{0,l}$"),
}
OTHER = {"displacement": Coloured("gamma", r"$\gamma$"), "stress": Coloured("width", r"$W$")}
# Figures 10 and 11 draw this many levels, and values of gamma or W, each with a marker.
DRAWN = 3
MARKERS = "os^Dv"
# Ticks of a ratio that varies little, and of one that varies much.
NEAR = np.arange(0.5, 1.5, 0.05)
FAR = np.array([0.5, 0.7, 1.0, 1.2, 1.4, 1.7, 2.0, 2.5, 3.0, 4.0, 6.0])


def transition_table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """One row a run: parameters, length and time as measured, by the paper, and exact."""
    runs = pd.concat(tables.values(), ignore_index=True)
    kept = [
        "boundary",
        "left",
        "right",
        "width",
        "gamma",
        "damping_ratio",
        "beta",
        "dx",
        "run_flags",
    ]
    for name in SYMBOLS:
        kept += [f"transition_{name}", f"paper_transition_{name}", f"exact_transition_{name}"]
    return runs[kept].rename(columns=lambda column: column.replace("transition_", ""))


def run_colours(runs: pd.DataFrame, column: str) -> np.ndarray:
    """The colour of each run by its level (column left), gamma or width."""
    quantity = LEVEL[runs["boundary"].iloc[0]].quantity if column == "left" else column
    return style.colour_scale(quantity).to_rgba(runs[column].to_numpy())


def draw_ratio(
    axes: Axes, runs: pd.DataFrame, quantity: str, across: str, coloured: str, marker: str
) -> None:
    """Draw length or time over the paper's formula: exact theory as lines, runs as markers.

    ``across`` is the column of the horizontal axis, ``coloured`` that of the colours.
    """
    for _, group in runs.groupby(coloured):
        group = group.sort_values(across)
        exact = group[f"exact_{quantity}"] / group[f"paper_{quantity}"]
        axes.plot(group[across], exact, color=run_colours(group, coloured)[0], linewidth=0.8)
    ratio = runs[quantity] / runs[f"paper_{quantity}"]
    colours = {"c": run_colours(runs, coloured)}
    _scatter(axes, runs, runs[across], ratio, colours, marker=marker)


def draw_collapse(axes: Axes, runs: pd.DataFrame, quantity: str) -> None:
    """Draw measured against predicted; the face shows the level, the rim gamma or W."""
    x, y = runs[f"paper_{quantity}"], runs[quantity]
    rim = OTHER[runs["boundary"].iloc[0]].quantity
    colours = {"c": run_colours(runs, "left"), "edgecolors": run_colours(runs, rim)}
    _scatter(axes, runs, x, y, colours, marker="o", s=15.0, linewidths=1.0)
    ends = [min(x.min(), y.min()) / 1.4, max(x.max(), y.max()) * 1.4]
    axes.plot(ends, ends, color=BLACK, linewidth=0.8, zorder=0, gid="equality")
    axes.set(xscale="log", yscale="log", xlim=ends, ylim=ends)


def _scatter(
    axes: Axes, runs: pd.DataFrame, x: pd.Series, y: pd.Series, colours: Look, **sizes: Any
) -> None:
    """Draw a marker a run: in its colours, or open and grey where the run is flagged."""
    look: Look = {"s": 9.0, "linewidths": 0.0, "edgecolors": "none", "zorder": 3} | sizes
    flagged = runs["run_flags"].notna()
    if flagged.any():
        grey: Look = {"facecolors": "none", "edgecolors": GREY, "linewidths": 0.6}
        axes.scatter(x[flagged], y[flagged], **look | grey)
    shown: Look = {name: values[~flagged.to_numpy()] for name, values in colours.items()}
    axes.scatter(x[~flagged], y[~flagged], gid="runs", **look | shown)


def colour_bar(
    figure: Figure, axes: Iterable[Axes], boundary: str, column: str, **options: Any
) -> None:
    """Add the bar of the colours of a column: the level (left), gamma or W."""
    quantity, symbol = LEVEL[boundary] if column == "left" else OTHER[boundary]
    # The scale of tau_l is stretched, and ticks at equal distances would overlap.
    ticks = [-2.0, -1.0, -0.5, 0.0] if quantity == "tau_l" else None
    bar = figure.colorbar(style.colour_scale(quantity), ax=list(axes), ticks=ticks, **options)
    bar.set_label(symbol)


def damping_figure(table: pd.DataFrame) -> Figure:
    """Draw figures 10 and 11: L_trans and T_trans over the paper's formulas against b."""
    boundary = table["boundary"].iloc[0]
    other, symbol = OTHER[boundary]
    values = spread_values(table[other], DRAWN)
    runs = table[table["left"].isin(spread_values(table["left"], DRAWN))]
    spacing = runs["dx"] / runs["width"]
    spacings = rf"$\Delta x/W$ = {spacing.min():.2g} to {spacing.max():.2g}"
    figure, panels = style.new_panels(PAGE, 2.8, 1, 2)
    for axes, quantity in zip(panels, SYMBOLS, strict=True):
        axes.axhline(1.0, color=BLACK, linewidth=0.8, zorder=0)
        for marker, value in zip(MARKERS, values, strict=False):
            draw_ratio(axes, runs[runs[other] == value], quantity, "damping_ratio", "left", marker)
        _damping_axes(axes, np.sort(table["damping_ratio"].unique()))
        axes.set(xlabel=r"damping ratio $b$", ylabel=f"${SYMBOLS[quantity]}$ / paper's formula")
        axes.set_title(rf"$\Gamma = {int(boundary == 'displacement')}$, {spacings}")
    colour_bar(figure, panels, boundary, "left", pad=0.01, aspect=30)
    handles = [
        entry(f"simulation, {symbol} = {value:g}", marker=marker, color=GREY)
        for marker, value in zip(MARKERS, values, strict=False)
    ]
    handles.append(entry(r"exact, $\Delta x\to0$", color=GREY, linewidth=0.8))
    style.legend_below(figure, handles, len(handles))
    return figure


def _damping_axes(axes: Axes, ratios: np.ndarray) -> None:
    """Scale and tick the axes: damping ratios with 0 across, a ratio upwards."""
    axes.set_xscale("symlog", linthresh=ratios[1], linscale=0.5)
    few_ticks(axes.xaxis, ratios)
    axes.set_xlim(-0.3 * ratios[1], 1.5 * ratios[-1])
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    ticks = NEAR if high < 1.45 * low else FAR
    few_ticks(axes.yaxis, ticks[(low < ticks) & (ticks < high)])
    axes.minorticks_off()
