"""Other laws of friction: where pulses stick or creep, and the front speed at fixed damping."""

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PAGE,
    SKY,
    Look,
    as_given,
    entry,
    few_ticks,
    legend_below,
    new_panels,
)

NEEDS = {"studies": ["friction_laws"]}
table = as_given

REGIMES = {
    "sticking pulse": ("sticking pulse", BLUE, "o"),
    "creeping pulse": ("creeping pulse", GREEN, "^"),
    "crack": ("crack", ORANGE, "s"),
    "no rupture": ("no rupture", GREY, "x"),
}
PLANES = {
    ("rate_weakening", "bounded_rate"): (
        r"$F/\tau_0$",
        r"$-\min(a\dot u,F)$, $F\dot u/(\dot u+v_0)$",
    ),
    ("slip_weakening",): (r"$\gamma d_c/\tau_0^2$", r"$1-u/d_c$"),
    ("exponential_weakening",): (r"$\gamma d_c/\tau_0^2$", r"$\mathrm{e}^{-u/d_c}$"),
}
MARKERS, COLOURS = ("o", "s", "^"), (SKY, BLUE)


def draw(table: pd.DataFrame) -> Figure:
    """Draw regimes (a) of bounded laws of slip rate, (b, c) of slip weakening; (d) front speeds."""
    figure, (*planes, speeds) = new_panels(PAGE, 5.2, 2, 2)
    runs = table[table["role"] == "plane"]
    for axes, (laws, (label, title)) in zip(planes, PLANES.items(), strict=True):
        _draw_plane(axes, runs[runs["law"].isin(laws)])
        axes.set(xlabel=label, ylabel=r"pre-stress $\tau_0$", ylim=(0.1, 0.9))
        axes.set_title(title, loc="right")
    planes[0].axvline(0.0, color=GREY, linewidth=0.6, linestyle=":")
    _draw_speeds(speeds, table[table["role"] == "selection"])
    looks = REGIMES.values()
    legend_below(figure, [entry(name, marker=mark, color=tint) for name, tint, mark in looks], 4)
    return figure


def _draw_plane(axes: Axes, runs: pd.DataFrame) -> None:
    for regime, rows in runs.groupby("regime"):
        _, colour, marker = REGIMES[str(regime)]
        axes.plot(rows["strength"], rows["level"], marker, color=colour, markersize=4.0)


def _draw_speeds(axes: Axes, runs: pd.DataFrame) -> None:
    """Draw front speeds on lattices, and exact ones at their distances as lines."""
    for colour, (_, rows) in zip(COLOURS, runs.groupby("level"), strict=True):
        for marker, (dx, points) in zip(MARKERS, rows.groupby("dx"), strict=True):
            resolution = points["d_c"] / dx
            axes.plot(resolution, points["exact_speed"], color=colour, linewidth=0.8)
            look: Look = {"color": colour, "markerfacecolor": "white", "markersize": 4.0}
            axes.plot(resolution, points["speed"], marker, **look)
    for marker, dx in zip(MARKERS, sorted(runs["dx"].unique()), strict=True):
        axes.plot([], [], marker, color=GREY, label=rf"$\Delta x = {dx:g}$")
    for colour, level in zip(COLOURS, sorted(runs["level"].unique()), strict=True):
        axes.plot([], [], color=colour, label=rf"exact, $\tau_0 = {level:g}$")
    axes.axhline(1.0, color=BLACK, linewidth=0.6, linestyle=":")
    axes.set(xscale="log", xlabel=r"$d_c/\Delta x$", ylabel=r"front speed $v$")
    few_ticks(axes.xaxis, (1, 2, 4, 8))
    axes.set_title(rf"$1-u/d_c$, $\beta = {runs['beta'].iloc[0]:g}$", loc="right")
    axes.legend(loc="best", ncols=2, columnspacing=0.8)
