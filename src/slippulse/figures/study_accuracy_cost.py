"""Error against cost for every scheme, order, step and spacing, and how the textbook front locks on its step."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from .style import BLACK, BLUE, GREY, ORDER_COLOURS, PAGE, new_figure, panel_letter

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {"studies": ["accuracy_cost"]}

PANELS = {
    "front_speed": "front speed",
    "peak_velocity": "peak velocity",
    "width": "pulse width",
    "transition_time": r"$T_\mathrm{trans}$, $\Gamma = 1$",
    "arrest_position": r"$x_-$, $\Gamma = 0$",
    "energy": "energy balance",
}
# Marker sizes of steps of 1, 1/2 and 1/4 of the spacing.
SIZES = {1.0: 5.0, 0.5: 3.6, 0.25: 2.2}
# Colour of the exact solution, as no order has it.
EXACT = "#a00000"
# How far below the exact speed a plateau may lie and still be named.
REACH = 0.3


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """The rows of the study as they are drawn."""
    return measured["accuracy_cost"]


def plot(table: pd.DataFrame) -> Figure:
    """Six quantities against the seconds, seconds against the work, and the speed of the front against the step."""
    figure = new_figure(PAGE, 6.8)
    grid = figure.add_gridspec(3, 3, height_ratios=[1.0, 1.0, 1.05])
    trade = table[table["part"] == "trade"]
    for number, (name, title) in enumerate(PANELS.items()):
        axes = figure.add_subplot(grid[number // 3, number % 3])
        draw_trade(axes, trade, name)
        axes.set_title(title, fontsize=9)
        panel_letter(axes, "abcdef"[number])
        if number % 3 == 0:
            axes.set_ylabel("relative error")
        if number >= 3:
            axes.set_xlabel("seconds on one core")
    figure.legend(
        handles=handles(trade), loc="outside upper center", ncols=6, columnspacing=1.0, handletextpad=0.3
    )
    cost = figure.add_subplot(grid[2, 0])
    draw_marks(cost, trade[trade["scheme"] != "continuum"], "work", "seconds")
    cost.set_xlabel("stencil passes over a block")
    cost.set_ylabel("seconds on one core")
    panel_letter(cost, "g")
    below = figure.add_subplot(grid[2, 1:])
    draw_locking(below, table[table["part"] == "locking"])
    panel_letter(below, "h")
    return figure


def draw_trade(axes, rows: pd.DataFrame, name: str) -> None:
    """One quantity against the seconds; the exact solution at the floor where its error is below it."""
    lattices = rows[rows["scheme"] != "continuum"]
    draw_marks(axes, lattices, "seconds", name)
    exact = rows[rows["scheme"] == "continuum"]
    low = axes.get_ylim()[0]
    for row in exact[exact[name].notna()].itertuples():
        error = getattr(row, name)
        axes.plot(
            row.seconds, max(error, low), "*" if error >= low else "v", color=EXACT, markersize=6.0,
            clip_on=False, zorder=4, gid="continuum",
        )  # fmt: skip
    axes.set_ylim(bottom=low)
    axes.set_xlim(right=6.0 * rows["seconds"].max())


def draw_marks(axes, rows: pd.DataFrame, across: str, name: str) -> None:
    """One mark a setting; the textbook scheme joined over its steps, presets ringed."""
    textbook = rows[rows["scheme"] == "fixed_step"]
    axes.plot(
        textbook[across], textbook[name], "x-", color=BLACK, markersize=3.5, linewidth=0.6, gid="textbook"
    )
    local = rows[rows["scheme"] == "localised"]
    for order, of_order in local.groupby("order"):
        for step, marks in of_order.groupby("step"):
            axes.plot(
                marks[across], marks[name], "o", color=ORDER_COLOURS[order], markersize=SIZES.get(step, 3.0), alpha=0.8,
                markeredgewidth=0.0, gid="localised",
            )  # fmt: skip
    presets = rows[rows["preset"].notna()]
    axes.plot(
        presets[across], presets[name], "o", color=BLACK, markersize=8.0, fillstyle="none", gid="preset"
    )
    for preset in presets.itertuples():
        axes.annotate(
            preset.preset,
            (getattr(preset, across), getattr(preset, name)),
            # On the side that is empty.
            xytext=(-4, 6) if name == "seconds" else (4, 6),
            textcoords="offset points",
            ha="right" if name == "seconds" else "left",
            fontsize=7,
        )
    axes.set_xscale("log")
    axes.set_yscale("log")


def handles(rows: pd.DataFrame) -> list[Line2D]:
    """Legend: colours are orders, sizes steps."""
    orders = np.sort(rows.loc[rows["scheme"] == "localised", "order"].unique())
    spacings = ", ".join(f"{dx:g}" for dx in rows.loc[rows["scheme"] == "fixed_step", "dx"].unique())
    out = [Line2D([], [], color=BLACK, marker="x", linewidth=0.6, label=f"textbook, dx = {spacings}")]
    out += [
        Line2D([], [], color=ORDER_COLOURS[order], marker="o", linestyle="none", label=f"order {order:g}")
        for order in orders
    ]
    out += [
        Line2D(
            [],
            [],
            color=EXACT,
            marker=marker,
            linestyle="none",
            markersize=6.0,
            label=f"exact solution{where}",
        )
        for marker, where in (("*", ""), ("v", ", below axis"))
    ]
    return out + [
        Line2D([], [], color=GREY, marker="o", linestyle="none", markersize=size, label=f"step {step:g} dx")
        for step, size in SIZES.items()
    ]


def draw_locking(axes, rows: pd.DataFrame) -> None:
    """Front speed of both schemes, the exact one, and the speeds dx/(n dt) that the textbook scheme locks on."""
    exact = float(rows["exact"].iloc[0])
    fixed = rows[rows["scheme"] == "fixed_step"]
    steps = np.linspace(fixed["step"].min(), fixed["step"].max(), 400)
    low, high = float(fixed["front_speed"].min()) - 0.03, float(fixed["front_speed"].max()) + 0.03
    for n in range(1, 12):
        locked = 1.0 / (n * steps)
        shown = np.where((locked > low) & (locked < high), locked, np.nan)
        axes.plot(steps, shown, color="0.75", linewidth=0.8, gid="locked")
    axes.axhline(exact, color=BLUE, linewidth=0.9)
    axes.plot(fixed["step"], fixed["front_speed"], "x", color=BLACK, markersize=3.5, gid="fixed_step")
    local = rows[rows["scheme"] == "localised"]
    axes.plot(
        local["step"],
        local["front_speed"],
        "o",
        color=BLUE,
        fillstyle="none",
        markersize=4.0,
        gid="localised",
    )
    axes.set_ylim(low, high)
    axes.set_xlabel(r"time step $\Delta t\,/\,\Delta x$")
    axes.set_ylabel("front speed")
    marks = [
        Line2D([], [], color=BLACK, marker="x", linestyle="none", label="textbook scheme"),
        Line2D([], [], color=BLUE, marker="o", fillstyle="none", linestyle="none", label="localised scheme"),
        Line2D([], [], color=BLUE, linewidth=0.9, label="exact"),
        Line2D([], [], color="0.75", linewidth=0.8, label=r"$\Delta x/(n\,\Delta t)$, $n = 1, 2, \dots$"),
    ]
    axes.legend(handles=marks, loc="upper left", ncols=2, frameon=True, framealpha=1.0, edgecolor="none")
