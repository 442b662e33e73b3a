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
    """Slip, slip velocity and acceleration in units of the paper's pulse; simulation less theory below."""
    figure = new_figure(PAGE, 3.9)
    grid = figure.subplots(2, 3, height_ratios=(2.6, 1.0), sharex=True)
    gamma = table["gamma"].iloc[0]
    for (above, strip), (field, label), letter in zip(grid.T, FIELDS.items(), "abc", strict=True):
        draw_displacement(above, strip, table, field)
        above.set_ylabel(f"{label} / paper's largest")
        strip.set_xlabel(r"$\chi$ / paper's width")
        panel_letter(above, letter)
    grid[1, 0].set_ylabel("simulation\n$-$ exact", linespacing=0.9)
    theory = table[(table["role"] == "theory") & (table["field"] == "slip_acceleration")]
    scaled = theory["y"] / theory["y_scale"]
    # The undamped lattice rings beyond the theory at the front; the axes leave room for some of it.
    grid[0, 2].set_ylim(1.5 * float(scaled.min()), 1.5 * float(scaled.max()))
    grid[1, 2].set_ylim(-0.5, 0.5)
    grid[0, 1].set_title(rf"$\Gamma = 1$, $\gamma = {gamma:g}$", fontsize=9)
    figure.legend(handles=displacement_handles(table), loc="outside lower center", ncols=4)
    return figure
