"""Figure 9: slip, slip velocity and acceleration of the pulses under a stress boundary."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from .shared.pulses import (
    FIELDS,
    draw_prestress,
    draw_stress,
    prestress_rows,
    profile_colours,
    pulse_rows,
    stress_handles,
)
from .style import PAGE, new_figure, panel_letter

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {"data": ["steady_stress"], "measured": ["steady_stress"], "settings": ["measure.front_window"]}

# Drawn of the acceleration, in widths of the Gaussian.
NEAR_THE_FRONT = (-4.0, 4.0)


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Pulses in the frame of their peak, the exact peak velocities, and the pre-stress of the inset."""
    sweep = data["steady_stress"]
    rows = pulse_rows(sweep, settings["measure"]["front_window"], tuple(FIELDS))
    return pd.concat([rows, prestress_rows(sweep, 5.0)], ignore_index=True)


def plot(table: pd.DataFrame) -> Figure:
    """Slip with the pre-stress as inset, slip velocity, acceleration near the front; below, simulation less theory."""
    figure = new_figure(PAGE, 3.9)
    grid = figure.subplots(2, 3, height_ratios=(2.6, 1.0), sharex="col")
    pulses = table[table["role"] != "inset"]
    for (above, strip), (field, label), letter in zip(grid.T, FIELDS.items(), "abc", strict=True):
        draw_stress(above, strip, pulses, field)
        above.set_ylabel(f"{label} / scale")
        strip.set_xlabel(r"$\chi/W$")
        panel_letter(above, letter)
    grid[1, 0].set_ylabel("simulation\n$-$ exact", linespacing=0.9)
    grid[0, 0].set_ylim(-0.04, 1.5)
    colours = profile_colours(pulses)
    draw_prestress(
        grid[0, 0].inset_axes([0.56, 0.66, 0.42, 0.26]), table[table["role"] == "inset"], "run", colours
    )
    # The exact acceleration has no bound at the front.
    for axes in grid[:, 2]:
        axes.set_xlim(*NEAR_THE_FRONT)
    grid[0, 2].set_ylim(-0.3, 3.0)
    grid[1, 2].set_ylim(-0.5, 0.5)
    figure.legend(handles=stress_handles(pulses), loc="outside lower center", ncols=3)
    return figure
