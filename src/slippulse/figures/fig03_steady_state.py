"""Figure 3: slip velocity of the steady pulses, both boundary conditions, with theory."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from .shared.pulses import (
    displacement_handles,
    draw_displacement,
    draw_prestress,
    draw_stress,
    prestress_rows,
    profile_colours,
    pulse_rows,
    stress_handles,
    tau_colours,
)
from .style import COLUMN, new_figure, panel_letter

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
    """Left: displacement boundary, on axes where undamped pulses are one. Right: stress boundary. Residuals below."""
    figure = new_figure(COLUMN, 4.1)
    grid = figure.subplots(2, 2, height_ratios=(2.6, 1.0), sharex="col")
    pulses = table[table["role"] != "inset"]
    insets = table[table["role"] == "inset"]
    for column, (boundary, title, draw, colours, by) in enumerate(
        (
            ("displacement", r"$\Gamma = 1$", draw_displacement, tau_colours, "left"),
            ("stress", r"$\Gamma = 0$", draw_stress, profile_colours, "run"),
        )
    ):
        above, strip = grid[:, column]
        rows = pulses[pulses["panel"] == boundary]
        draw(above, strip, rows, "slip_velocity")
        above.set_title(title, fontsize=9)
        above.set_ylim(-0.05, 1.75)
        shown = insets[insets["panel"] == boundary]
        draw_prestress(above.inset_axes([0.6, 0.66, 0.38, 0.26]), shown, by, colours(rows))
        panel_letter(above, "ab"[column])
        panel_letter(strip, "cd"[column])
    gamma = table["gamma"].dropna().iloc[0]
    grid[0, 0].set_ylabel(r"slip velocity / largest")
    grid[1, 0].set_ylabel("simulation\n$-$ exact", linespacing=0.9)
    grid[1, 0].set_xlabel(rf"$\chi$ / paper's width ($\gamma = {gamma:g}$)", fontsize=8)
    grid[1, 1].set_xlabel(r"$\chi/W$")
    *left, simulation = displacement_handles(pulses[pulses["panel"] == "displacement"])
    *right, _ = stress_handles(pulses[pulses["panel"] == "stress"])
    # A column a boundary.
    figure.legend(
        handles=[*left, *right, simulation],
        loc="outside lower center",
        ncols=2,
        handlelength=1.4,
    )
    return figure
