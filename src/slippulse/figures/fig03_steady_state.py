"""Figure 3: slip velocity of the steady pulses, both boundary conditions, with theory."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from .shared.pulses import (
    COLOURS,
    displacement_handles,
    draw_displacement,
    draw_prestress,
    draw_stress,
    prestress_rows,
    pulse_rows,
    stress_handles,
)
from .style import PAGE, new_figure, panel_letter

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {
    "data": ["steady_displacement", "steady_stress"],
    "measured": ["steady_displacement", "steady_stress"],
    "settings": ["measure.front_window"],
}

VELOCITY = ("slip_velocity",)


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Pulses in the frame of their peak, theory beside them, and the pre-stress of the insets."""
    window = settings["measure"]["front_window"]
    parts = []
    for boundary, reach in (("displacement", 6.0), ("stress", 5.0)):
        sweep = data[f"steady_{boundary}"]
        parts.append(pulse_rows(sweep, window, VELOCITY).assign(panel=boundary))
        parts.append(prestress_rows(sweep, reach).assign(panel=boundary))
    return pd.concat(parts, ignore_index=True)


def plot(table: pd.DataFrame) -> Figure:
    """Left: displacement boundary, simulation and theory. Right: stress boundary, simulation and exact peaks."""
    figure = new_figure(PAGE, 3.1)
    left, right = figure.subplots(1, 2)
    rows = table[table["panel"] == "displacement"]
    draw_displacement(left, rows, "slip_velocity")
    left.set_title(r"$\Gamma = 1$", fontsize=8)
    top = float(rows.loc[rows["role"] != "inset", "y"].max())
    left.set_ylim(-0.04 * top, 1.55 * top)
    draw_prestress(left.inset_axes([0.64, 0.7, 0.34, 0.28]), rows[rows["role"] == "inset"], "left")
    left.legend(handles=displacement_handles(rows), loc="upper left", handlelength=2.2, labelspacing=0.25)

    rows = table[table["panel"] == "stress"]
    draw_stress(right, rows, "slip_velocity")
    peaks = rows[rows["role"] == "peak"]
    reach = 0.06 * float(np.ptp(rows.loc[rows["role"] == "simulation", "x"]))
    for colour, (_, peak) in zip(COLOURS, peaks.groupby("run"), strict=False):
        right.plot(
            [-reach, reach], [peak["y"].iloc[0]] * 2, color=colour, linewidth=0.8, linestyle=(0, (2, 1)), gid="peak"
        )  # fmt: skip
    right.set_title(r"$\Gamma = 0$", fontsize=8)
    top = float(rows.loc[rows["role"] != "inset", "y"].max())
    right.set_ylim(-0.04 * top, 1.7 * top)
    draw_prestress(right.inset_axes([0.64, 0.7, 0.34, 0.28]), rows[rows["role"] == "inset"], "run")
    right.legend(handles=stress_handles(rows), loc="upper left", handlelength=1.6, labelspacing=0.25)
    for axes, letter in ((left, "a"), (right, "b")):
        axes.set_xlabel(r"$\bar\chi$")
        axes.set_ylabel(r"slip velocity $\dot{\bar u}$")
        panel_letter(axes, letter)
    return figure
