"""Figure 9: slip, slip velocity and acceleration of the pulses under a stress boundary."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd
from matplotlib.figure import Figure

from .shared.pulses import FIELDS, SIMULATION, draw_prestress, draw_pulses, handles, pulse_rows
from .style import PAGE, legend_below, new_panels

NEEDS = {
    "data": ["steady_stress"],
    "measured": ["steady_stress"],
    "predicted": ["steady_stress"],
    "studies": ["pulse_profiles"],
    "settings": ["measure.front_window"],
}


def table(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Pulses in the frame of their peak, as `pulse_rows` has them."""
    return pulse_rows("steady_stress", data, tables, settings)


def plot(table: pd.DataFrame) -> Figure:
    """Slip with the pre-stress as inset, slip velocity, acceleration near the front."""
    figure, panels = new_panels(PAGE, 3.0, 1, 3)
    for axes, (field, label) in zip(panels, FIELDS.items(), strict=True):
        draw_pulses(axes, table, field)
        axes.set(xlabel=r"$\chi/W$", ylabel=f"{label} / scale")
    panels[0].set_ylim(-0.04, 1.6)
    draw_prestress(panels[0], table, 5.0)
    panels[1].set_title(rf"$\Gamma = 0$, $b = {table['damping_ratio'].max():g}$", fontsize=9)
    # The exact acceleration has no bound at the front.
    panels[2].set(xlim=(-4.0, 4.0), ylim=(-0.3, 3.0))
    legend_below(figure, [*handles(table), SIMULATION], 3)
    return figure
