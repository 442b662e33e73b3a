"""Figure 5: measured L_trans and T_trans as functions of the paper's formulas for them.

There is one marker for each run of one sweep for each boundary condition.
"""

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slippulse.plotting.selection import spread_values
from slippulse.plotting.style import (
    LEVEL_COLUMNS,
    PAGE_WIDTH,
    SMALL_TEXT,
    SYMBOLS,
    Look,
    colour,
    colour_scale,
    new_panels,
)

from .shared import scaling
from .shared.pulse_panels import draw_prestress
from .shared.scaling import LINE_COUNT, QUANTITIES, SECOND_COLUMN, transition_table

NEEDS = {
    "measured": {"scaling_displacement": ["transition"], "scaling_stress": ["transition"]},
    "uncertainties": ["scaling_displacement", "scaling_stress"],
}
# Runs of each simulation that the figure can draw, in the words of configuration/drawn.py.
DRAWS = {
    "scaling_displacement": "`boundary: displacement` and equal levels > 0",
    "scaling_stress": "`boundary: stress`, left level < 0, right level 0, no steps",
}
table = transition_table
BOUNDARIES = {"displacement": r"$\Gamma = 1$", "stress": r"$\Gamma = 0$"}


def draw(table: pd.DataFrame) -> Figure:
    """Draw one column of panels for each boundary condition.

    The first two rows show the measured length and time as functions of the paper's formulas, with
    the ratio of both in insets. The third row shows the ratio of the lengths at full size.
    """
    figure, panels = new_panels(PAGE_WIDTH, 6.7, "ab;cd;ef", height_ratios=(1.0, 1.0, 0.65))
    for column, boundary in enumerate(BOUNDARIES):
        runs = table[table["boundary"] == boundary]
        draw_boundary(figure, panels[column::2], runs, boundary)
    return figure


def draw_boundary(figure: Figure, panels: list[Axes], runs: pd.DataFrame, boundary: str) -> None:
    """Draw one column of panels: measured length, measured time, and ratio of the length.

    The face of a marker has the colour of the pre-stress level, and its rim that of gamma or W.
    """
    length_axes, time_axes, ratio_axes = panels
    # The level is called tau_0 if it is the same on both sides, and left otherwise. The second
    # varying parameter is gamma or width.
    level_column, second_column = LEVEL_COLUMNS[boundary], SECOND_COLUMN[boundary]
    runs = runs.assign(**{level_column: runs["left"]})
    colours = {
        "c": colour(level_column, runs[level_column]),
        "edgecolors": colour(second_column, runs[second_column]),
    }
    # Ratios are drawn as functions of the level, for a few values of the second parameter.
    drawn_values = spread_values(runs[second_column], LINE_COUNT)
    few_runs = runs[runs[second_column].isin(drawn_values)]
    box = (0.1, 0.6, 0.34, 0.31)
    columns = {"x_column": level_column, "line_column": second_column}
    for axes, quantity in ((length_axes, "length"), (time_axes, "time")):
        scaling.draw_collapse(axes, runs, quantity, colours)
        scaling.ratio_inset(axes, box, few_runs, quantity, **columns)
    scaling.draw_ratio(ratio_axes, few_runs, "length", **columns)
    length = QUANTITIES["length"]
    ratio_axes.set(xlabel=f"${SYMBOLS[level_column]}$", ylabel=f"${length}$ / formula")
    # The lines rise with the level under a displacement boundary, and fall under a stress boundary.
    are_rising = boundary == "displacement"
    add_legend_above_lines(ratio_axes, on_left=are_rising)
    draw_prestress_inset(length_axes, runs, level_column)
    length_axes.set_title(BOUNDARIES[boundary], loc="center")
    for parameter in (level_column, second_column):
        add_colour_bar(figure, panels, parameter)


def add_legend_above_lines(axes: Axes, *, on_left: bool) -> None:
    """Add a legend of one row at the top of a panel, and room for it above the lines."""
    look: Look = {"ncols": LINE_COUNT, "columnspacing": 1.0, "handlelength": 1.2}
    axes.legend(loc="upper left" if on_left else "upper right", fontsize=SMALL_TEXT, **look)
    bottom, top = axes.get_ylim()
    axes.set_ylim(bottom, top + 0.15 * (top - bottom))


def add_colour_bar(figure: Figure, panels: list[Axes], parameter: str) -> None:
    """Add the colour bar of a parameter below a column of panels."""
    look: Look = {"location": "bottom", "aspect": 35, "pad": 0.02}
    # The colour scale of the pre-stress on the left is not linear, so that ticks at equal distances
    # would overlap.
    look["ticks"] = [-2.0, -1.0, -0.5, 0.0] if parameter == "left" else None
    bar = figure.colorbar(colour_scale(parameter), ax=panels, **look)
    bar.set_label(f"${SYMBOLS[parameter]}$")


def draw_prestress_inset(axes: Axes, runs: pd.DataFrame, level_column: str) -> None:
    """Add an inset with the pre-stress of a few runs: some levels, with the narrowest Gaussian.

    The pre-stress with another width has the same shape.

    level_column : name of the level, tau_0 or left, which has a colour scale
    """
    has_drawn_level = runs["left"].isin(spread_values(runs["left"], LINE_COUNT))
    narrow = runs[has_drawn_level & (runs["width"] == runs["width"].min())]
    narrow = narrow.assign(colour=list(colour(level_column, narrow["left"])))
    box = (0.68, 0.17, 0.28, 0.22)
    draw_prestress(axes, box, narrow, half_length_in_widths=6.0)
