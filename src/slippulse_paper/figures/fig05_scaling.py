"""Figure 5: L_trans and T_trans of every run against the paper's formulas, both boundaries."""

import numpy as np
import pandas as pd
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
from .shared.scaling import DRAWN, OTHER, QUANTITIES, transition_table

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
    """Draw the collapse, one row per quantity and one column per boundary; insets have the ratio.

    The last row has the ratio of the length at full size, with a line and a colour for each level.
    """
    figure, panels = new_panels(PAGE_WIDTH, 7.4, "ab;cd;ef", height_ratios=(1.0, 1.0, 0.6))
    for column, (boundary, title) in enumerate(BOUNDARIES.items()):
        level, other = LEVEL_COLUMNS[boundary], OTHER[boundary]
        runs = table[table["boundary"] == boundary]
        runs = runs.assign(**{level: runs["left"]})
        few = runs[runs[other].isin(spread_values(runs[other], DRAWN))]
        faces, rims = (colour(name, runs[name]) for name in (level, other))
        for axes, quantity in zip(panels[column:4:2], QUANTITIES, strict=True):
            scaling.draw_collapse(axes, runs, quantity, {"c": faces, "edgecolors": rims})
            scaling.ratio_inset(axes, (0.1, 0.6, 0.34, 0.31), few, quantity, level, other)
        ratio = panels[4 + column]
        scaling.draw_ratio(ratio, few, "length", level, other)
        ratio.set(xlabel=f"${SYMBOLS[level]}$", ylabel=f"${QUANTITIES['length']}$ / formula")
        ratio.set_xlim(runs[level].min() - 0.05, runs[level].max() + 0.35 * np.ptp(runs[level]))
        ratio.legend(loc="center right", fontsize=SMALL_TEXT)
        levels = runs["left"].isin(spread_values(runs["left"], DRAWN))
        narrow = runs[levels & (runs["width"] == runs["width"].min())]
        narrow = narrow.assign(colour=[*colour(level, narrow[level])])
        draw_prestress(panels[column], (0.68, 0.17, 0.28, 0.22), narrow, 6.0)
        panels[column].set_title(title, loc="center")
        for quantity in (level, other):
            look: Look = {"location": "bottom", "aspect": 35, "pad": 0.02}
            # The scale of left is stretched, and ticks at equal distances would overlap.
            look["ticks"] = [-2.0, -1.0, -0.5, 0.0] if quantity == "left" else None
            bar = figure.colorbar(colour_scale(quantity), ax=panels[column::2], **look)
            bar.set_label(f"${SYMBOLS[quantity]}$")
    return figure
