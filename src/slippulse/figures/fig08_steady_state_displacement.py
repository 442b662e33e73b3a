"""Figure 8: slip, slip velocity and acceleration of the steady pulses, displacement boundary, with theory."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd
from matplotlib.figure import Figure

from .shared.pulses import FIELDS, conditions, draw_pulses, handles, pulse_rows
from .style import PAGE, legend_below, new_panels

NEEDS = {
    "data": ["steady_displacement"],
    "measured": ["steady_displacement"],
    "predicted": ["steady_displacement"],
    "studies": ["pulse_profiles"],
    "settings": ["measure.front_window"],
}


def table(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Pulses in the frame of their peak, as `pulse_rows` has them."""
    return pulse_rows("steady_displacement", data, tables, settings)


def plot(table: pd.DataFrame) -> Figure:
    """Slip, slip velocity and acceleration in units of the paper's pulse."""
    figure, panels = new_panels(PAGE, 2.8, 1, 3)
    for axes, field in zip(panels, FIELDS, strict=True):
        draw_pulses(axes, table, field)
    # The undamped lattice rings beyond the theory at the front.
    panels[2].set_ylim(-1.3, 1.3)
    panels[1].set_title(conditions(table), fontsize=9)
    legend_below(figure, handles(table), 6)
    return figure
