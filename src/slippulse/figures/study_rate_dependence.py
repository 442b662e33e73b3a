"""Friction linear in slip rate: which pulses stick, their sizes, maps of both kinds, Gamma = 0."""

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .style import BLACK, BLUE, GREY, ORANGE, PAGE, VELOCITY_MAP, Look, as_given, new_panels

NEEDS = {"studies": ["rate_dependence"]}
table = as_given

REGIMES = {"sticking pulse": (BLUE, "o"), "creeping pulse": (ORANGE, "s"), "crack": (GREY, "D")}
LINES: Look = {"color": BLACK, "linewidth": 1.0}
SMALL: Look = {"markersize": 4.0}
OPEN: Look = SMALL | {"markerfacecolor": "white"}
RATE = r"$\alpha/\sqrt{\gamma}$"


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a) regimes, (b) width and slip of pulses, (c) maps of both regimes, (d) Gamma = 0."""
    figure, (plane, pulses, maps, arrest) = new_panels(PAGE, 5.4, 2, 2)
    table = table.assign(over=table["rate_strengthening"] / np.sqrt(table["gamma"].iloc[0]))
    parts = dict(list(table.groupby("role")))
    _draw_plane(plane, parts["lattice"], parts["limit"])
    shown = parts["lattice"]["level"] == parts["map"]["level"].iloc[0]
    runs, steady = parts["lattice"][shown], parts["steady"]
    _draw_sizes(pulses, runs, steady)
    _draw_maps(figure, maps, parts["map"])
    _draw_arrest(arrest, parts["arrest"], parts["asymptote"])
    return figure


def _draw_sizes(axes: Axes, runs: pd.DataFrame, steady: pd.DataFrame) -> None:
    """Draw width and slip of pulses against the rate dependence."""
    width, slip = r"width $W_\text{p}$", r"slip $u$"
    sizes = {"pulse_width": (BLACK, "o", width), "pulse_slip": (GREY, "s", slip)}
    for column, (colour, marker, label) in sizes.items():
        axes.plot(steady["over"], steady[column], color=colour, label=label)
        axes.plot(runs["over"], runs[column], marker, color=colour, **OPEN)
    axes.set(xlabel=RATE, ylabel=f"{width}, {slip}", yscale="log")
    level = runs["level"].iloc[0]
    axes.set_title(rf"$\Gamma = 1$, $\tau_0 = {level:g}$; points: lattice", loc="right")
    axes.legend(loc="upper center")


def _draw_plane(axes: Axes, runs: pd.DataFrame, limit: pd.DataFrame) -> None:
    look: Look = {"color": BLUE, "alpha": 0.12, "linewidth": 0.0}
    axes.fill_betweenx(limit["level"], -limit["over"], limit["over"], **look)
    for sign, label in ((1.0, "exact"), (-1.0, None)):
        axes.plot(sign * limit["over"], limit["level"], label=label, **LINES)
    flags = runs["run_flags"].astype(str).str.contains("reverse_sliding")
    for (regime, flagged), rows in runs.groupby(["regime", flags]):
        colour, marker = REGIMES[str(regime)]
        axes.plot(rows["over"], rows["level"], marker, color=colour, **OPEN if flagged else SMALL)
    for regime, (colour, marker) in REGIMES.items():
        if (runs["regime"] == regime).any():
            axes.plot([], [], marker, color=colour, label=f"{regime}, lattice", **SMALL)
    if flags.any():
        axes.plot([], [], "o", color=GREY, label="open: would slide back", **OPEN)
    axes.axvline(0.0, color=GREY, linewidth=0.6, linestyle=":")
    axes.set(xlabel=RATE, ylabel=r"pre-stress $\tau_0$", ylim=(0.0, 0.95), xlim=(-2.0, 2.7))
    axes.set_title(r"$\Gamma = 1$", loc="right")
    look = {"ncols": 2, "columnspacing": 0.8, "handletextpad": 0.4}
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.09), **look)


def _draw_maps(figure: Figure, axes: Axes, rows: pd.DataFrame) -> None:
    look: Look = {"cmap": VELOCITY_MAP, "shading": "nearest", "rasterized": True}
    look |= {"vmin": 0.0, "vmax": rows["slip_velocity"].max()}
    for regime, half in rows.groupby("regime"):
        grid = half.pivot(index="position", columns="time", values="slip_velocity")
        image = axes.pcolormesh(grid.columns, grid.index, grid.where(grid > 0.0), **look)
        name = rf"{regime}, {RATE[:-1]} = {half['over'].iloc[0]:.2f}$"
        axes.text(
            0.04, 0.92 if regime == "creeping pulse" else 0.04, name, transform=axes.transAxes
        )
    axes.axhline(0.0, color=BLACK, linewidth=0.6, linestyle=":")
    figure.colorbar(image, ax=axes, pad=0.02).set_label(r"slip velocity $\dot u$")
    axes.set(xlabel=r"time $t$", ylabel=r"position $x$")
    axes.set_title(rf"$\Gamma = 1$, $\tau_0 = {rows['level'].iloc[0]:g}$, exact", loc="right")


def _draw_arrest(axes: Axes, rows: pd.DataFrame, theory: pd.DataFrame) -> None:
    rows = rows[rows["dx"] == rows["dx"].min()]
    groups = rows.groupby("rate_strengthening")
    colours = matplotlib.colormaps["plasma"](np.linspace(0.0, 0.7, groups.ngroups))
    for colour, marker, (alpha, line) in zip(colours, "os^Dv", groups, strict=False):
        look: Look = OPEN | {"markersize": 3.0, "label": rf"$\alpha = {alpha:g}$"}
        axes.plot(line["time"], line["largest_velocity"], marker, color=colour, **look)
    line = theory[theory["rate_strengthening"] == theory["rate_strengthening"].min()]
    axes.plot(line["time"], line["largest_velocity"], "--", label="diffusion", **LINES)
    axes.set(xscale="log", yscale="log", xlabel=r"time $t$", ylabel=r"largest slip velocity")
    axes.set_title(rf"$\Gamma = 0$, lattice, $\Delta x = {rows['dx'].iloc[0]:g}$", loc="right")
    axes.legend(loc="lower left")
