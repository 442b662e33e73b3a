"""Figure 9: slip, slip velocity and acceleration of the pulses under a stress boundary."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd
from matplotlib.figure import Figure

from .shared.pulses import FIELDS, conditions, draw_prestress, draw_pulses, handles, pulse_rows
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
    figure, panels = new_panels(PAGE, 2.8, 1, 3)
    for axes, field in zip(panels, FIELDS, strict=True):
        draw_pulses(axes, table, field)
    # Where slip and velocity are small.
    draw_prestress(panels[1], table, (0.09, 0.66, 0.33, 0.22), 5.0)
    panels[1].set_title(conditions(table), fontsize=9)
    # The exact acceleration has no bound at the front.
    panels[2].set(xlim=(-4.0, 4.0), ylim=(-0.3, 3.0))
    legend_below(figure, handles(table), 6)
    return figure
