"""Figure 3: slip velocity of the steady pulses, both boundary conditions, with theory."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd
from matplotlib.figure import Figure

from .shared.pulses import SIMULATION, draw_prestress, draw_pulses, handles, pulse_rows
from .style import COLUMN, legend_below, new_panels

NEEDS = {
    "data": ["steady_displacement", "steady_stress"],
    "measured": ["steady_displacement", "steady_stress"],
    "predicted": ["steady_displacement", "steady_stress"],
    "studies": ["pulse_profiles"],
    "settings": ["measure.front_window"],
}


def table(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Slip velocity of the pulses of both sweeps in the frame of its largest value, as `pulse_rows` has it."""
    names = NEEDS["data"]
    parts = [pulse_rows(name, data, tables, settings, ("slip_velocity",)) for name in names]
    return pd.concat(parts, ignore_index=True)


def plot(table: pd.DataFrame) -> Figure:
    """Left: displacement boundary, on axes where undamped pulses are one. Right: stress boundary."""
    figure, panels = new_panels(COLUMN, 3.2, 1, 2)
    left, right = (table[table["panel"] == name] for name in ("displacement", "stress"))
    titles = (r"$\Gamma = 1$", r"$\Gamma = 0$")
    for axes, rows, title, widths in zip(panels, (left, right), titles, (6.0, 5.0), strict=True):
        draw_pulses(axes, rows, "slip_velocity")
        draw_prestress(axes, rows, widths)
        axes.set_title(title, fontsize=9)
        axes.set_ylim(-0.05, 1.75)
    panels[0].set_ylabel("slip velocity / largest")
    panels[0].set_xlabel(rf"$\chi$ / paper's width ($\gamma = {left['gamma'].max():g}$)", fontsize=8)
    panels[1].set_xlabel(r"$\chi/W$")
    # A column a boundary.
    legend_below(figure, [*handles(left), *handles(right), SIMULATION], 2)
    return figure
