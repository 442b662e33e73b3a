"""Figure 9: slip, slip velocity and acceleration of the pulses under a stress boundary."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from .shared.pulses import (
    COLOURS,
    FIELDS,
    draw_prestress,
    draw_stress,
    prestress_rows,
    pulse_rows,
    stress_handles,
)
from .style import PAGE, new_figure, panel_letter

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {"data": ["steady_stress"], "measured": ["steady_stress"], "settings": ["measure.front_window"]}


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Pulses in the frame of their peak, the exact peak velocities, and the pre-stress of the inset."""
    sweep = data["steady_stress"]
    rows = pulse_rows(sweep, settings["measure"]["front_window"], tuple(FIELDS))
    return pd.concat([rows, prestress_rows(sweep, 5.0)], ignore_index=True)


def plot(table: pd.DataFrame) -> Figure:
    """Three panels: slip with the pre-stress as inset, slip velocity with the exact peaks, slip acceleration."""
    figure = new_figure(PAGE, 2.8)
    panels = figure.subplots(1, 3)
    for axes, (field, label), letter in zip(panels, FIELDS.items(), "abc", strict=True):
        draw_stress(axes, table, field)
        axes.set_xlabel(r"$\bar\chi$")
        axes.set_ylabel(label)
        panel_letter(axes, letter)
    for colour, (_, peak) in zip(COLOURS, table[table["role"] == "peak"].groupby("run"), strict=False):
        panels[1].axhline(peak["y"].iloc[0], color=colour, linewidth=0.7, linestyle=(0, (2, 1)), gid="peak")
    slip = table[(table["role"] == "simulation") & (table["field"] == "slip")]["y"]
    panels[0].set_ylim(-0.04 * slip.max(), 1.5 * slip.max())
    draw_prestress(panels[0].inset_axes([0.56, 0.64, 0.42, 0.33]), table[table["role"] == "inset"], "run")
    # The exact acceleration has no bound at the front; the axis is that of the simulation.
    simulated = table[(table["role"] == "simulation") & (table["field"] == "slip_acceleration")]["y"]
    panels[2].set_ylim(1.3 * simulated.min() - 0.05, 1.05 * simulated.max())
    figure.legend(handles=stress_handles(table), loc="outside lower center", ncols=4)
    return figure
