"""Figure 5: L_trans and T_trans of every run against the paper's formulas, both boundaries."""

import pandas as pd
from matplotlib.figure import Figure

from .shared import scaling
from .shared.pulses import prestress_inset
from .shared.scaling import OTHER, SYMBOLS, transition_table
from .shared.selection import spread_values
from .style import BLACK, PAGE, Look, new_panels

NEEDS = {
    "measured": ["scaling_displacement", "scaling_stress"],
    "predicted": {"scaling_displacement": ["transition"], "scaling_stress": ["transition"]},
}
table = transition_table
BOUNDARIES = {"displacement": r"$\Gamma = 1$", "stress": r"$\Gamma = 0$"}


def plot(table: pd.DataFrame) -> Figure:
    """Draw the collapse, a row a quantity and a column a boundary; insets have the ratio."""
    figure, panels = new_panels(PAGE, 4.8, 2, 2)
    for column, (boundary, title) in enumerate(BOUNDARIES.items()):
        runs, other = table[table["boundary"] == boundary], OTHER[boundary].quantity
        for axes, (quantity, symbol) in zip(panels[column::2], SYMBOLS.items(), strict=True):
            scaling.draw_collapse(axes, runs, quantity)
            axes.set(xlabel=f"paper's formula for ${symbol}$", ylabel=f"measured ${symbol}$")
            inset = axes.inset_axes((0.09, 0.58, 0.36, 0.33))
            inset.set_in_layout(False)
            inset.axhline(1.0, color=BLACK, linewidth=0.6, zorder=0)
            few = runs[runs[other].isin(spread_values(runs[other], 3))]
            scaling.draw_ratio(inset, few, quantity, "left", other, "o")
            inset.tick_params(labelsize=7.0, length=1.5, pad=1.0)
            inset.set_xlabel(scaling.LEVEL[boundary].symbol, fontsize=7.0, labelpad=0.0)
            inset.set_title("measured / formula", fontsize=7.0, pad=2.0)
        narrow = runs[runs["width"] == runs["width"].min()].drop_duplicates("left")
        narrow = narrow[narrow["left"].isin(spread_values(runs["left"], 3))]
        levels = list(scaling.run_colours(narrow, "left"))
        prestress_inset(panels[column], (0.7, 0.13, 0.26, 0.22), narrow, levels, 6.0)
        panels[column].set_title(title, fontsize=9)
        for kind in ("left", other):
            look: Look = {"location": "bottom", "aspect": 35, "pad": 0.02}
            scaling.colour_bar(figure, panels[column::2], boundary, kind, **look)
    return figure
