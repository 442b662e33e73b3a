"""Friction linear in slip rate: which pulses stick, their sizes, maps of both kinds, Gamma = 0."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slippulse.plotting import style
from slippulse.plotting.space_time import draw_halves
from slippulse.plotting.style import BLACK, BLUE, GREY, MARKERS, OPEN_MARKER, PAGE_WIDTH, Look

NEEDS = {"studies": ["rate_dependence"]}
table = style.as_given

LINES: Look = {"color": BLACK, "linewidth": 1.0}
RATE = r"$\alpha/\sqrt{\gamma}$"


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a) regimes, (b) width and slip of pulses, (c) maps of both regimes, (d) Gamma = 0."""
    figure, (plane, pulses, maps, arrest) = style.new_panels(PAGE_WIDTH, 5.4, "ab;cd")
    table = table.assign(over=table["rate_strengthening"] / np.sqrt(table["gamma"].iloc[0]))
    roles = style.by_role(table)
    level, steady = roles["map"]["level"].iloc[0], roles["steady"]
    runs = roles["lattice"][roles["lattice"]["level"] == level]
    _draw_plane(plane, roles["lattice"], roles["limit"])
    width, slip = r"width $W_\text{p}$", r"slip $u$"
    sizes = {"pulse_width": (BLACK, "o", width), "pulse_slip": (GREY, "s", slip)}
    for column, (colour, marker, label) in sizes.items():
        pulses.plot(steady["over"], steady[column], color=colour, label=label)
        pulses.plot(runs["over"], runs[column], marker, color=colour, **OPEN_MARKER)
    pulses.set(xlabel=RATE, ylabel=f"{width}, {slip}", yscale="log")
    pulses.set_title(rf"$\Gamma = 1$, $\tau_0 = {level:g}$; points: lattice")
    pulses.legend(loc="upper center")
    draw_halves(maps, roles["map"], "regime")
    for regime, half in roles["map"].groupby("regime"):
        name = rf"{regime}, {RATE[:-1]} = {half['over'].iloc[0]:.2f}$"
        height = 0.92 if half["position"].max() > 0.0 else 0.04
        maps.text(0.04, height, name, transform=maps.transAxes)
    maps.set_title(rf"$\Gamma = 1$, $\tau_0 = {level:g}$, exact")
    rows = roles["arrest"][roles["arrest"]["dx"] == roles["arrest"]["dx"].min()]
    groups = rows.groupby("rate_strengthening")
    for marker, (alpha, line) in zip(MARKERS, groups, strict=False):
        look: Look = OPEN_MARKER | {"label": rf"$\alpha = {alpha:g}$"}
        arrest.plot(line["time"], line["largest_velocity"], marker, color=GREY, **look)
    theory = roles["asymptote"]
    line = theory[theory["rate_strengthening"] == theory["rate_strengthening"].min()]
    arrest.plot(line["time"], line["largest_velocity"], "--", label="diffusion", **LINES)
    arrest.set(xscale="log", yscale="log", xlabel=r"time $t$", ylabel=r"largest slip velocity")
    arrest.set_title(rf"$\Gamma = 0$, lattice, $\Delta x = {rows['dx'].iloc[0]:g}$")
    arrest.legend(loc="lower left")
    return figure


def _draw_plane(axes: Axes, runs: pd.DataFrame, limit: pd.DataFrame) -> None:
    look: Look = {"color": BLUE, "alpha": 0.12, "linewidth": 0.0}
    axes.fill_betweenx(limit["level"], -limit["over"], limit["over"], **look)
    axes.plot(limit["over"], limit["level"], label="exact", **LINES)
    axes.plot(-limit["over"], limit["level"], **LINES)
    flags = runs["run_flags"].astype(str).str.contains("reverse_sliding")
    style.draw_regimes(axes, runs[~flags], "over")
    style.draw_regimes(axes, runs[flags], "over", label=None, **OPEN_MARKER)
    if flags.any():
        axes.plot([], [], "o", color=GREY, label="open: would slide back", **OPEN_MARKER)
    axes.axvline(0.0, color=GREY, linewidth=0.6, linestyle=":")
    axes.set(xlabel=RATE, ylabel=r"pre-stress $\tau_0$", ylim=(0.0, 0.95), xlim=(-2.0, 2.7))
    axes.set_title(r"$\Gamma = 1$")
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.09), ncols=2)
