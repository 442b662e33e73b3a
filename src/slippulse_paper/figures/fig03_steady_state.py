"""Figure 3: slip velocity of steady pulses under both boundary conditions, compared with theory."""

import pandas as pd
from matplotlib.figure import Figure

from slippulse.plotting.style import PAGE_WIDTH, new_panels

from .shared.pulse_panels import (
    draw_prestress,
    draw_pulses,
    legend_entries,
    pulse_table,
    styled_runs,
    title,
)

NEEDS = {
    "data": ["steady_displacement", "steady_stress"],
    "measured": {"steady_displacement": ["pulse"], "steady_stress": ["transition"]},
    "studies": ["pulse_profiles"],
    "settings": ["measure.front_window"],
}
# Runs of each simulation that the figure can draw, in the words of configuration/drawn.py.
DRAWS = {
    "steady_displacement": "`boundary: displacement` and a level > 0",
    "steady_stress": "`boundary: stress`, left level < 0, right level 0, no steps",
}


def table(data: dict, tables: dict[str, pd.DataFrame], settings: dict) -> pd.DataFrame:
    """Return `pulse_table` for both sweeps, without slip and acceleration."""
    return pulse_table(data, tables, settings).drop(columns=["slip", "slip_acceleration"])


def draw(table: pd.DataFrame) -> Figure:
    """Draw the displacement boundary on the left and the stress boundary on the right."""
    figure, panels = new_panels(PAGE_WIDTH, 3.3, "ab")
    # Half of the length that the inset with the pre-stress shows, in widths of the widest Gaussian.
    half_lengths_in_widths = {"displacement": 6.0, "stress": 5.0}
    inset_box = (0.08, 0.6, 0.26, 0.29)
    for axes, (boundary, half_length) in zip(panels, half_lengths_in_widths.items(), strict=True):
        rows = table[table["panel"] == boundary]
        draw_pulses(axes, rows, "slip_velocity")
        draw_prestress(axes, inset_box, styled_runs(rows), half_length)
        axes.set(title=title(rows), ylim=(-0.03, 1.06))
        below_panel = (0.5, -0.17)
        entries = legend_entries(rows)
        axes.legend(handles=entries, loc="upper center", bbox_to_anchor=below_panel, ncols=3)
    return figure
