"""Slip that pulses leave along their path, under friction that recovers as slip slows down."""

import pandas as pd
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
    thickness = positions["thickness"].max()
    for axes, (value, rows) in zip(
        panels, reversed(list(positions.groupby("thickness"))), strict=True
    ):
        for colour, (level, runs) in zip(COLOURS, rows.groupby("tau0"), strict=False):
            case = ["before", "patch_half_length"]
            for marker, (_, run) in zip(MARKERS, runs.groupby(case), strict=False):
                look: Look = {"color": colour, "marker": marker}
                axes.plot(run["sample_position"], run["pulse_slip"], **look)
            last = runs[runs["sample_position"] == runs["sample_position"].max()]
            place = last["sample_position"].iloc[0], last["pulse_slip"].max()
            axes.annotate(rf"$\tau_0 = {level:g}$", place, (4, -3), color=colour, **OFFSET)
        name = rf"height ${thickness:g}\,H$" if value == thickness else "height $H$"
        axes.set(xlabel="position $x/H$", ylabel="slip", title=f"{name}, {conditions(True)}")
        largest = rows["pulse_slip"].max()
        axes.set_ylim(-0.05 * largest, 1.12 * largest)
        axes.set_xlim(None, 1.22 * rows["sample_position"].max())
    return figure
