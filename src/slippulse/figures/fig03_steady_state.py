"""Figure 3: slip velocity of the steady pulses, both boundary conditions, with theory."""

import pandas as pd
from matplotlib.figure import Figure

from .shared.pulses import conditions, draw_prestress, draw_pulses, handles, pulse_table
from .style import COLUMN, new_panels

NEEDS = {
    "data": ["steady_displacement", "steady_stress"],
    "measured": ["steady_displacement", "steady_stress"],
    "predicted": {"steady_displacement": ["pulse"], "steady_stress": ["transition"]},
    "studies": ["pulse_profiles"],
    "settings": ["measure.front_window"],
}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Rows of `pulse_table` for both sweeps, with the slip velocity alone."""
    return pulse_table(data, tables, settings).drop(columns=["slip", "slip_acceleration"])


def plot(table: pd.DataFrame) -> Figure:
    """Draw the displacement boundary on the left and the stress boundary on the right."""
    figure, panels = new_panels(COLUMN, 3.2, 1, 2)
    for axes, name, widths in zip(panels, ("displacement", "stress"), (6.0, 5.0), strict=True):
        rows = table[table["panel"] == name]
        draw_pulses(axes, rows, "slip_velocity")
        draw_prestress(axes, rows, (0.14, 0.7, 0.28, 0.2), widths)
        axes.set_title(conditions(rows), loc="right")
        axes.set_ylim(-0.03, 1.06)
        axes.legend(handles=handles(rows), loc="upper center", bbox_to_anchor=(0.45, -0.2))
    return figure
