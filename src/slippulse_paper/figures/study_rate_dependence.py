"""Friction that is linear in slip rate: which pulses stick, their sizes, and their maps."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slippulse.plotting import style
from slippulse.plotting.space_time import draw_halves
from slippulse.plotting.style import BLACK, BLUE, GREY, MARKERS, OPEN_MARKER, PAGE_WIDTH, Look

NEEDS = {"studies": ["rate_dependence"]}
table = style.as_given

THEORY_LOOK: Look = {"color": BLACK, "linewidth": 1.0}
RATE_LABEL = r"$\alpha/\sqrt{\gamma}$"


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a) regimes, (b) width and slip of pulses, (c) a map of each regime, (d) Gamma = 0."""
    figure, (plane, pulses, maps, arrest) = style.new_panels(PAGE_WIDTH, 5.4, "ab;cd")
    table = table.assign(scaled_rate=table["rate_strengthening"] / np.sqrt(table["gamma"].iloc[0]))
    roles = style.by_role(table)
    level, steady = roles["map"]["level"].iloc[0], roles["steady"]
    runs = roles["lattice"][roles["lattice"]["level"] == level]
    _draw_plane(plane, roles["lattice"], roles["limit"])
    width, slip = r"width $W_\text{p}$", r"slip $u$"
    sizes = {"pulse_width": (BLACK, "o", width), "pulse_slip": (GREY, "s", slip)}
    for column, (colour, marker, label) in sizes.items():
        pulses.plot(steady["scaled_rate"], steady[column], color=colour, label=label)
        pulses.plot(runs["scaled_rate"], runs[column], marker, color=colour, **OPEN_MARKER)
    pulses.set(xlabel=RATE_LABEL, ylabel=f"{width}, {slip}", yscale="log")
    pulses.set_title(rf"$\Gamma = 1$, $\tau_0 = {level:g}$; points: lattice")
    pulses.legend(loc="upper center")
    draw_halves(maps, roles["map"], "regime")
    for regime, half in roles["map"].groupby("regime"):
        name = rf"{regime}, {RATE_LABEL[:-1]} = {half['scaled_rate'].iloc[0]:.2f}$"
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
    arrest.plot(line["time"], line["largest_velocity"], "--", label="diffusion", **THEORY_LOOK)
    arrest.set(xscale="log", yscale="log", xlabel=r"time $t$", ylabel=r"largest slip velocity")
    arrest.set_title(rf"$\Gamma = 0$, lattice, $\Delta x = {rows['dx'].iloc[0]:g}$")
    arrest.legend(loc="lower left")
    return figure


def _draw_plane(axes: Axes, runs: pd.DataFrame, limit: pd.DataFrame) -> None:
    """Draw the regimes of runs, with the exact limit between them."""
    look: Look = {"color": BLUE, "alpha": 0.12, "linewidth": 0.0}
    axes.fill_betweenx(limit["level"], -limit["scaled_rate"], limit["scaled_rate"], **look)
    axes.plot(limit["scaled_rate"], limit["level"], label="exact", **THEORY_LOOK)
    axes.plot(-limit["scaled_rate"], limit["level"], **THEORY_LOOK)
    flags = runs["run_flags"].astype(str).str.contains("reverse_sliding")
    style.draw_regimes(axes, runs[~flags], "scaled_rate")
    style.draw_regimes(axes, runs[flags], "scaled_rate", label=None, **OPEN_MARKER)
    if flags.any():
        axes.plot([], [], "o", color=GREY, label="open: would slide back", **OPEN_MARKER)
    axes.axvline(0.0, color=GREY, linewidth=0.6, linestyle=":")
    axes.set(xlabel=RATE_LABEL, ylabel=r"pre-stress $\tau_0$", ylim=(0.0, 0.95), xlim=(-2.0, 2.7))
    axes.set_title(r"$\Gamma = 1$")
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.09), ncols=2)
