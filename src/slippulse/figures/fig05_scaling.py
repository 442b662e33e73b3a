"""Figure 5: L_trans and T_trans of every run against the paper's prediction, both boundary conditions."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd
from matplotlib.figure import Figure

from .shared.scaling import (
    LEVEL,
    OTHER,
    chosen,
    colour_bar,
    colours,
    draw_collapse,
    draw_ratio,
    transition_rows,
)
from .style import BLACK, COLUMN, GREY, entry, legend_below, new_panels, prestress_inset

NEEDS = {
    "measured": ["scaling_displacement", "scaling_stress"],
    "predicted": ["scaling_displacement", "scaling_stress"],
}
BOUNDARIES = {"displacement": r"$\Gamma = 1$", "stress": r"$\Gamma = 0$"}


def table(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Every run of both sweeps, as `transition_rows` has it."""
    parts = [transition_rows(tables[f"scaling_{boundary}"], boundary) for boundary in BOUNDARIES]
    return pd.concat(parts, ignore_index=True)


def plot(table: pd.DataFrame) -> Figure:
    """A column a boundary: the collapse, and below it measured over predicted against the level."""
    figure, panels = new_panels(COLUMN, 5.0, 2, 2, height_ratios=(1.2, 1.0))
    for above, below, (boundary, title) in zip(panels, panels[2:], BOUNDARIES.items(), strict=False):
        runs = table[table["boundary"] == boundary]
        draw_collapse(above, runs)
        above.set_title(title, fontsize=9)
        above.set_xlabel("predicted $L$, $T$")
        narrow = runs[runs["width"] == runs["width"].min()].drop_duplicates("left")
        narrow = narrow[narrow["left"].isin(chosen(runs["left"], 3))]
        prestress_inset(above, (0.14, 0.68, 0.3, 0.2), narrow, list(colours(narrow, "left")), 6.0)
        below.axhline(1.0, color=BLACK, linewidth=0.8, zorder=0)
        other = OTHER[boundary][0]
        some = runs[runs[other].isin(chosen(runs[other], 3))]
        draw_ratio(below, some, "length", "left", other, "o", "-")
        draw_ratio(below, some, "time", "left", other, "^", "--")
        below.set_xlabel(LEVEL[boundary][1])
        bars = {"location": "bottom", "aspect": 25, "pad": 0.02}
        colour_bar(figure, (above, below), boundary, "left", **bars)
        colour_bar(figure, (above, below), boundary, other, **bars)
    panels[0].set_ylabel("measured $L$, $T$")
    panels[2].set_ylabel("measured over predicted")
    marks = [("length", "o"), ("time", "^"), ("literal definition", "x")]
    handles = [entry(label, marker=marker, color=GREY) for label, marker in marks]
    for label, style in (("exact length", "-"), ("exact time", "--")):
        handles.append(entry(label, color=GREY, linewidth=0.8, linestyle=style))
    legend_below(figure, [*handles, entry("equality", color=BLACK, linewidth=0.8)], 3)
    return figure
