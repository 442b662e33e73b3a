"""Slip that pulses leave along their path, under friction that recovers as slip slows down."""

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slippulse.plotting.style import (
    BLUE,
    GREEN,
    ORANGE,
    PAGE_WIDTH,
    SMALL_TEXT,
    Look,
    as_given,
    conditions,
    new_panels,
)

NEEDS = {"studies": ["layer_healing"]}

COLOURS = (BLUE, GREEN, ORANGE)
MARKERS = ("o", "s", "^")
OFFSET: Look = {"textcoords": "offset points", "fontsize": SMALL_TEXT}

table = as_given


def draw(table: pd.DataFrame) -> Figure:
    """Draw the slip by position in the thick layer, and beside it in the thin one."""
    figure, panels = new_panels(PAGE_WIDTH, 2.6, "ab")
    positions = table[table["part"] == "position"]
    thick, thin = positions["thickness"].max(), positions["thickness"].min()
    for axes, thickness in zip(panels, (thick, thin), strict=True):
        rows = positions[positions["thickness"] == thickness]
        draw_layer(axes, rows)
        name = rf"height ${thickness:g}\,H$" if thickness == thick else "height $H$"
        axes.set(xlabel="position $x/H$", ylabel="slip $u/U$", title=f"{name}, {conditions(True)}")
    return figure


def draw_layer(axes: Axes, rows: pd.DataFrame) -> None:
    """Draw a line for each pulse of one layer, with the change from the coarser grid as bars."""
    for colour, (level, runs) in zip(COLOURS, rows.groupby("tau0"), strict=False):
        case = ["before", "patch_half_length"]
        for marker, (_, run) in zip(MARKERS, runs.groupby(case), strict=False):
            changes = (run["pulse_slip"] - run["coarse_slip"]).abs()
            look: Look = {"color": colour, "marker": marker, "capsize": 1.5}
            axes.errorbar(run["sample_position"], run["pulse_slip"], changes, **look)
        last = runs[runs["sample_position"] == runs["sample_position"].max()]
        place = last["sample_position"].iloc[0], last["pulse_slip"].max()
        axes.annotate(rf"$\tau_0 = {level:g}$", place, (5, -3), color=colour, **OFFSET)
    axes.set_ylim(0.0, 1.15 * rows["pulse_slip"].max())
    axes.set_xlim(None, 1.25 * rows["sample_position"].max())
