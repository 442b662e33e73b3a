"""Figure 8: slip, slip velocity and acceleration of the steady pulses, displacement boundary, with theory."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from .shared.pulses import FIELDS, displacement_handles, draw_displacement, pulse_rows
from .style import PAGE, new_figure, panel_letter

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {
    "data": ["steady_displacement"],
    "measured": ["steady_displacement"],
    "settings": ["measure.front_window"],
}


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Pulses in the frame of their peak, theory beside them."""
    return pulse_rows(data["steady_displacement"], settings["measure"]["front_window"], tuple(FIELDS))


def plot(table: pd.DataFrame) -> Figure:
    """Three panels: slip, slip velocity, slip acceleration."""
    figure = new_figure(PAGE, 2.9)
    panels = figure.subplots(1, 3)
    for axes, (field, label), letter in zip(panels, FIELDS.items(), "abc", strict=True):
        draw_displacement(axes, table, field)
        axes.set_xlabel(r"$\bar\chi$")
        axes.set_ylabel(label)
        panel_letter(axes, letter)
    theory = table[(table["role"] == "theory") & (table["field"] == "slip_acceleration")]["y"]
    # The undamped lattice rings beyond the theory at the front; the axis leaves room for half as much again.
    panels[2].set_ylim(1.5 * float(theory.min()), 1.5 * float(theory.max()))
    figure.legend(handles=displacement_handles(table), loc="outside lower center", ncols=4)
    return figure
