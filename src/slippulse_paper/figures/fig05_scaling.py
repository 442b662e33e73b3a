"""Figure 5: L_trans and T_trans of every run against the paper's formulas, both boundaries."""

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
# A run of each simulation that the figure can draw, in words of configuration/drawn.py.
DRAWS = {
    "scaling_displacement": "boundary displacement and equal levels above 0",
    "scaling_stress": "boundary stress, left level below 0, right level 0 and no steps",
}
table = transition_table
BOUNDARIES = {"displacement": r"$\Gamma = 1$", "stress": r"$\Gamma = 0$"}


def draw(table: pd.DataFrame) -> Figure:
    """Draw the collapse, with one column of panels for each boundary condition.

    Rows: the length and the time, with the ratio to the formula in insets, and the ratio of the
    length at full size.
    """
    figure, panels = new_panels(PAGE_WIDTH, 6.7, "ab;cd;ef", height_ratios=(1.0, 1.0, 0.65))
    for column, boundary in enumerate(BOUNDARIES):
        runs = table[table["boundary"] == boundary]
        draw_boundary(figure, panels[column::2], runs, boundary)
    return figure


def draw_boundary(figure: Figure, panels: list[Axes], runs: pd.DataFrame, boundary: str) -> None:
    """Draw one column of panels: length, time, and ratio of the length.

    Faces of markers have the colour of the level, and rims that of gamma or W.
    """
    *collapse_panels, ratio_axes = panels
    level, second = LEVEL_COLUMNS[boundary], SECOND_COLUMN[boundary]
    runs = runs.assign(**{level: runs["left"]})
    few = runs[runs[second].isin(spread_values(runs[second], LINE_COUNT))]
    colours = {"c": colour(level, runs[level]), "edgecolors": colour(second, runs[second])}
    for axes, quantity in zip(collapse_panels, QUANTITIES, strict=True):
        scaling.draw_collapse(axes, runs, quantity, colours)
        scaling.ratio_inset(axes, (0.1, 0.6, 0.34, 0.31), few, quantity, level, second)
    scaling.draw_ratio(ratio_axes, few, "length", level, second)
    ratio_axes.set(xlabel=f"${SYMBOLS[level]}$", ylabel=f"${QUANTITIES['length']}$ / formula")
    # The lines rise with the level under a displacement boundary, and fall under a stress boundary.
    are_rising = boundary == "displacement"
    ratio_axes.legend(loc="upper left" if are_rising else "upper right", fontsize=SMALL_TEXT)
    # The inset has the pre-stress of a few levels with the narrowest Gaussian.
    has_drawn_level = runs["left"].isin(spread_values(runs["left"], LINE_COUNT))
    narrow = runs[has_drawn_level & (runs["width"] == runs["width"].min())]
    narrow = narrow.assign(colour=[*colour(level, narrow[level])])
    draw_prestress(panels[0], (0.68, 0.17, 0.28, 0.22), narrow, 6.0)
    panels[0].set_title(BOUNDARIES[boundary], loc="center")
    for quantity in (level, second):
        look: Look = {"location": "bottom", "aspect": 35, "pad": 0.02}
        # The scale of left is stretched, and ticks at equal distances would overlap.
        look["ticks"] = [-2.0, -1.0, -0.5, 0.0] if quantity == "left" else None
        bar = figure.colorbar(colour_scale(quantity), ax=panels, **look)
        bar.set_label(f"${SYMBOLS[quantity]}$")
