"""Friction that is linear in slip rate: which pulses stick, and how they look.

The friction is alpha times the slip rate. The figure shows alpha divided by sqrt(gamma), which is
dimensionless; its column is scaled_rate.
"""

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
    """Draw (a) regimes, (b) pulse width and slip, (c) two pulses in time and space, (d) an arrest.

    Panels a to c have leaf springs (Gamma = 1), and panel d has none (Gamma = 0).
    """
    figure, panels = style.new_panels(PAGE_WIDTH, 5.4, "ab;cd")
    plane_axes, pulse_axes, map_axes, arrest_axes = panels
    # All runs with leaf springs have the same gamma.
    table = table.assign(scaled_rate=table["rate_strengthening"] / np.sqrt(table["gamma"].iloc[0]))
    rows_by_role = style.by_role(table)
    runs = rows_by_role["lattice"]
    _draw_plane(plane_axes, runs, rows_by_role["limit"])
    # Panels b and c show pulses at this level of the pre-stress.
    level = rows_by_role["map"]["level"].iloc[0]
    _draw_pulses(pulse_axes, rows_by_role["steady"], runs[runs["level"] == level])
    pulse_axes.set_title(rf"$\Gamma = 1$, $\tau_0 = {level:g}$; points: lattice")
    _draw_maps(map_axes, rows_by_role["map"])
    map_axes.set_title(rf"$\Gamma = 1$, $\tau_0 = {level:g}$, exact")
    _draw_arrest(arrest_axes, rows_by_role["arrest"], rows_by_role["asymptote"])
    return figure


def _draw_pulses(axes: Axes, steady: pd.DataFrame, runs: pd.DataFrame) -> None:
    """Draw the width and slip of pulses as functions of the rate strengthening.

    Lines are exact steady pulses, and markers are lattice runs.
    """
    width, slip = r"width $W_\text{p}$", r"slip $u$"
    looks = {"pulse_width": (BLACK, "o", width), "pulse_slip": (GREY, "s", slip)}
    for column, (colour, marker, label) in looks.items():
        axes.plot(steady["scaled_rate"], steady[column], color=colour, label=label)
        axes.plot(runs["scaled_rate"], runs[column], marker, color=colour, **OPEN_MARKER)
    axes.set(xlabel=RATE_LABEL, ylabel=f"{width}, {slip}", yscale="log")
    axes.legend(loc="upper center")


def _draw_maps(axes: Axes, rows: pd.DataFrame) -> None:
    """Draw the slip velocity of a creeping pulse (upper half) and a sticking pulse (lower half)."""
    draw_halves(axes, rows, "regime")
    for regime, half in rows.groupby("regime"):
        rate = half["scaled_rate"].iloc[0]
        label = rf"{regime}, $\alpha/\sqrt{{\gamma}} = {rate:.2f}$"
        is_upper_half = half["position"].max() > 0.0
        axes.text(0.04, 0.92 if is_upper_half else 0.04, label, transform=axes.transAxes)


def _draw_arrest(axes: Axes, lattices: pd.DataFrame, asymptotes: pd.DataFrame) -> None:
    """Draw how the largest velocity decays without leaf springs, on the finest lattice.

    The line is the asymptote of this decay at long times. The asymptote is the same for every rate
    strengthening, and is drawn for the weakest one.
    """
    finest = lattices[lattices["dx"] == lattices["dx"].min()]
    groups = finest.groupby("rate_strengthening")
    for marker, (alpha, rows) in zip(MARKERS, groups, strict=False):
        look: Look = OPEN_MARKER | {"label": rf"$\alpha = {alpha:g}$"}
        axes.plot(rows["time"], rows["largest_velocity"], marker, color=GREY, **look)
    weakest = asymptotes["rate_strengthening"].min()
    asymptote = asymptotes[asymptotes["rate_strengthening"] == weakest]
    axes.plot(
        asymptote["time"], asymptote["largest_velocity"], "--", label="diffusion", **THEORY_LOOK
    )
    axes.set(xscale="log", yscale="log", xlabel=r"time $t$", ylabel=r"largest slip velocity")
    axes.set_title(rf"$\Gamma = 0$, lattice, $\Delta x = {finest['dx'].iloc[0]:g}$")
    axes.legend(loc="lower left")


def _draw_plane(axes: Axes, runs: pd.DataFrame, limit: pd.DataFrame) -> None:
    """Draw the regime of each run, in the plane of rate strengthening and level.

    Exact theory has sticking pulses in the shaded region between its two lines. Markers are open if
    a block at rest would slide backwards, which the model does not allow.

    limit : rate strengthening at the right line for each level; the left line is its mirror image
    """
    look: Look = {"color": BLUE, "alpha": 0.12, "linewidth": 0.0}
    axes.fill_betweenx(limit["level"], -limit["scaled_rate"], limit["scaled_rate"], **look)
    axes.plot(limit["scaled_rate"], limit["level"], label="exact", **THEORY_LOOK)
    axes.plot(-limit["scaled_rate"], limit["level"], **THEORY_LOOK)
    slides_back = runs["run_flags"].astype(str).str.contains("reverse_sliding")
    style.draw_regimes(axes, runs[~slides_back], "scaled_rate")
    style.draw_regimes(axes, runs[slides_back], "scaled_rate", label=None, **OPEN_MARKER)
    if slides_back.any():
        axes.plot([], [], "o", color=GREY, label="open: would slide back", **OPEN_MARKER)
    axes.axvline(0.0, color=GREY, linewidth=0.6, linestyle=":")
    axes.set(xlabel=RATE_LABEL, ylabel=r"pre-stress $\tau_0$", ylim=(0.0, 0.95), xlim=(-2.0, 2.7))
    axes.set_title(r"$\Gamma = 1$")
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.09), ncols=2)
