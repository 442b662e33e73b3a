"""T_trans and L_trans of every run over the paper's predictions, with exact theory as lines."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..style import (
    BLACK,
    GREY,
    PAGE,
    Look,
    colour_scale,
    entry,
    few_ticks,
    legend_below,
    new_panels,
)

SYMBOLS = {"length": r"L_\text{trans}", "time": r"T_\text{trans}"}
# What varies beside the level: column, and its symbol.
OTHER = {"displacement": ("gamma", r"$\gamma$"), "stress": ("width", r"$W$")}
LEVEL = {"displacement": ("tau_0", r"$\tau_0$"), "stress": ("tau_l", r"$\tau_{0,l}$")}
# Of figures 10 and 11: how many levels, and values of gamma or W, are drawn.
MARKERS, DRAWN = "os^Dv", 3
NEAR, FAR = (
    np.arange(0.5, 1.5, 0.05),
    np.array([0.5, 0.7, 1.0, 1.2, 1.4, 1.7, 2.0, 2.5, 3.0, 4.0, 6.0]),
)


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
    kept += [
        f"{source}transition_{name}" for name in SYMBOLS for source in ("", "paper_", "exact_")
    ]
    return runs[kept].rename(columns=lambda column: column.replace("transition_", ""))


def chosen(values: pd.Series, count: int) -> np.ndarray:
    """Some of the values of a column, evenly from the smallest to the largest."""
    every = np.sort(values.unique())
    return every[np.unique(np.linspace(0, every.size - 1, count).round().astype(int))]


def colours(runs: pd.DataFrame, column: str) -> np.ndarray:
    """The colour of each run by its level (column left), gamma or width."""
    quantity = LEVEL[runs["boundary"].iloc[0]][0] if column == "left" else column
    return colour_scale(quantity).to_rgba(runs[column].to_numpy())


def draw_ratio(
    axes: Axes, runs: pd.DataFrame, quantity: str, across: str, colour: str, marker: str
) -> None:
    """Length or time over the predicted one across a column: exact theory as lines, runs as markers."""
    for _, group in runs.groupby(colour):
        group = group.sort_values(across)
        exact = group[f"exact_{quantity}"] / group[f"paper_{quantity}"]
        axes.plot(group[across], exact, color=colours(group, colour)[0], linewidth=0.8)
    _scatter(
        axes,
        runs,
        runs[across],
        runs[quantity] / runs[f"paper_{quantity}"],
        marker,
        colour,
        zorder=3,
    )


def draw_collapse(axes: Axes, runs: pd.DataFrame, quantity: str) -> None:
    """Measured against predicted, the level as face, gamma or W as rim."""
    rim = OTHER[runs["boundary"].iloc[0]][0]
    x, y = runs[f"paper_{quantity}"], runs[quantity]
    _scatter(axes, runs, x, y, "o", "left", rim, s=15.0, linewidths=1.0, zorder=3)
    ends = [min(x.min(), y.min()) / 1.4, max(x.max(), y.max()) * 1.4]
    axes.plot(ends, ends, color=BLACK, linewidth=0.8, zorder=0, gid="equality")
    axes.set(xscale="log", yscale="log", xlim=ends, ylim=ends)


def _scatter(
    axes: Axes,
    runs: pd.DataFrame,
    x: pd.Series,
    y: pd.Series,
    marker: str,
    face: str,
    rim: str = "",
    **look,
) -> None:
    """Runs with their colours, flagged ones open and grey."""
    flagged = runs["run_flags"].notna()
    sound = runs[~flagged]
    own: Look = {"s": 9.0, "linewidths": 0.0, "marker": marker} | look
    if flagged.any():
        grey = own | {"facecolors": "none", "edgecolors": GREY, "linewidths": 0.6}
        axes.scatter(x[flagged], y[flagged], **grey)
    own |= {"c": colours(sound, face), "edgecolors": colours(sound, rim) if rim else "none"}
    axes.scatter(x[~flagged], y[~flagged], gid="runs", **own)


def colour_bar(
    figure: Figure, axes: Iterable[Axes], boundary: str, column: str, **options: Any
) -> None:
    """The colours of the levels, or of gamma or W, as a column of runs."""
    quantity, label = LEVEL[boundary] if column == "left" else OTHER[boundary]
    # Its scale is stretched, and ticks at equal distances would overlap.
    ticks = [-2.0, -1.0, -0.5, 0.0] if quantity == "tau_l" else None
    figure.colorbar(colour_scale(quantity), ax=list(axes), ticks=ticks, **options).set_label(label)


def damping_figure(runs: pd.DataFrame) -> Figure:
    """Figures 10 and 11: L_trans and T_trans over the paper's predictions against the damping ratio."""
    boundary = runs["boundary"].iloc[0]
    other, symbol = OTHER[boundary]
    ratios, values = np.sort(runs["damping_ratio"].unique()), chosen(runs[other], DRAWN)
    runs = runs[runs["left"].isin(chosen(runs["left"], DRAWN))]
    spacing = runs["dx"] / runs["width"]
    spacings = rf"$\Delta x/W$ = {spacing.min():.2g} to {spacing.max():.2g}"
    figure, panels = new_panels(PAGE, 2.8, 1, 2)
    for axes, quantity in zip(panels, SYMBOLS, strict=True):
        axes.axhline(1.0, color=BLACK, linewidth=0.8, zorder=0)
        for marker, value in zip(MARKERS, values, strict=False):
            draw_ratio(axes, runs[runs[other] == value], quantity, "damping_ratio", "left", marker)
        axes.set_xscale("symlog", linthresh=ratios[1], linscale=0.5)
        few_ticks(axes.xaxis, ratios)
        axes.set_xlim(-0.3 * ratios[1], 1.5 * ratios[-1])
        axes.set_yscale("log")
        low, high = axes.get_ylim()
        ticks = NEAR if high < 1.45 * low else FAR
        few_ticks(axes.yaxis, ticks[(low < ticks) & (ticks < high)])
        axes.minorticks_off()
        axes.set(xlabel=r"damping ratio $b$", ylabel=f"${SYMBOLS[quantity]}$ / paper's formula")
        axes.set_title(rf"$\Gamma = {int(boundary == 'displacement')}$, {spacings}")
    colour_bar(figure, panels, boundary, "left", pad=0.01, aspect=30)
    looks = zip(MARKERS, values, strict=False)
    handles = [
        entry(f"simulation, {symbol} = {value:g}", marker=mark, color=GREY) for mark, value in looks
    ]
    handles.append(entry(r"exact, $\Delta x\to0$", color=GREY, linewidth=0.8))
    legend_below(figure, handles, len(handles))
    return figure
