"""Slip that pulses leave along their path, if friction recovers as slip slows down.

The layer is simulated in the plane, with two heights.
"""

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

# Colours of the levels tau_0, and markers of runs at the same level.
COLOURS = (BLUE, GREEN, ORANGE)
MARKERS = ("o", "s", "^")
# Look of the name of a level beside its curve.
OFFSET: Look = {"textcoords": "offset points", "fontsize": SMALL_TEXT}

table = as_given


def draw(table: pd.DataFrame) -> Figure:
    """Draw the slip as a function of position, in (a) the thick layer and (b) the thin layer."""
    figure, (thick_axes, thin_axes) = new_panels(PAGE_WIDTH, 2.6, "ab")
    positions = table[table["part"] == "position"]
    largest_thickness = positions["thickness"].max()
    is_thick = positions["thickness"] == largest_thickness
    draw_slips(thick_axes, positions[is_thick])
    thick_axes.set_title(rf"height ${largest_thickness:g}\,H$, {conditions(held=True)}")
    draw_slips(thin_axes, positions[~is_thick])
    thin_axes.set_title(f"height $H$, {conditions(held=True)}")
    return figure


def draw_slips(axes: Axes, positions: pd.DataFrame) -> None:
    """Draw the slip that each pulse of one layer leaves, with the change from a coarser grid.

    A line has the colour of its level of pre-stress. The changes are drawn as error bars.
    """
    for colour, (level, runs) in zip(COLOURS, positions.groupby("tau0"), strict=False):
        # Runs at the same level differ in how the pulse starts.
        runs_by_start = runs.groupby(["before", "patch_half_length"])
        for marker, (_, run) in zip(MARKERS, runs_by_start, strict=False):
            changes = (run["pulse_slip"] - run["coarse_slip"]).abs()
            look: Look = {"color": colour, "marker": marker, "capsize": 1.5}
            axes.errorbar(run["sample_position"], run["pulse_slip"], changes, **look)
        # The level is written beside the end of its highest line.
        end = runs["sample_position"].max()
        largest_at_end = runs.loc[runs["sample_position"] == end, "pulse_slip"].max()
        label = rf"$\tau_0 = {level:g}$"
        axes.annotate(label, (end, largest_at_end), (5, -3), color=colour, **OFFSET)
    axes.set(xlabel="position $x/H$", ylabel="slip $u/U$")
    axes.set_ylim(0.0, 1.15 * positions["pulse_slip"].max())
    axes.set_xlim(None, 1.25 * positions["sample_position"].max())
