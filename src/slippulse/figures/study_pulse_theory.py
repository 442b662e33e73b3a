"""The steady pulse against damping: the paper's formulas, the damped theory, simulations, and their limit dx -> 0."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from .style import CYCLE, GREY, PAGE, colour_scale, new_figure, panel_letter

# What is drawn: data, measured numbers, predictions and studies by name, and keys of the configuration.
NEEDS = {
    "measured": ["pulse_damping", "continuum_fixed_ratio"],
    "predicted": ["pulse_damping"],
    "studies": ["damped_pulse"],
}

QUANTITIES = {"peak_velocity": "largest velocity", "width": "width", "slip": "final slip"}
REFINED = {f"pulse_{name}": label for name, label in QUANTITIES.items()} | {
    "front_speed_right": "front speed"
}
MARKERS = ("o", "s", "^", "D")


def table(
    data: Mapping[str, xr.Dataset], tables: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Peak velocity, width and slip of each simulated pulse with theory, and theory over the damping ratio.

    Parameters
    ----------
    data, settings : not used
    tables : the simulations and the study in NEEDS

    Returns
    -------
    DataFrame of quantity, left (the level), damping_ratio: role simulation (value, theory, paper), theory (over_paper)
    and refined (value over dx, theory: the limit)
    """
    runs, study = tables["pulse_damping"], tables["damped_pulse"]
    lines = study[study["role"] == "curve"].rename(columns={"value": "over_paper"})
    parts = [lines.assign(role="theory")]
    for quantity in QUANTITIES:
        values = {"value": runs[f"pulse_{quantity}"], "theory": runs[f"exact_pulse_{quantity}"]}
        values |= {"paper": runs[f"paper_pulse_{quantity}"], "role": "simulation", "quantity": quantity}
        parts.append(runs[["left", "damping_ratio", "run_flags"]].assign(**values))
    runs, limits = (
        tables["continuum_fixed_ratio"],
        study[study["role"] == "limit"].set_index("quantity")["value"],
    )
    for column in REFINED:
        quantity = column.removeprefix("pulse_").removesuffix("_right")
        values = {"value": runs[column], "theory": limits[quantity], "quantity": quantity, "role": "refined"}
        parts.append(runs[["left", "damping_ratio", "dx"]].assign(**values))
    return pd.concat(parts, ignore_index=True)


def plot(table: pd.DataFrame) -> Figure:
    """(a to c) each quantity in units of the paper's formula; (d) the distance from the limit on refined lattices."""
    figure = new_figure(PAGE, 4.6)
    *grid, refined_axes = figure.subplots(2, 2).ravel()
    for axes, (quantity, label), letter in zip(grid, QUANTITIES.items(), "abc", strict=True):
        axes.axhline(1.0, color=GREY, linewidth=0.8, linestyle="--", label="paper's formula")
        for left, rows in table[table["quantity"] == quantity].groupby("left"):
            colour = colour_scale("tau_0").to_rgba(left)
            line, runs = rows[rows["role"] == "theory"], rows[rows["role"] == "simulation"]
            axes.plot(
                line["damping_ratio"],
                line["over_paper"],
                color=colour,
                gid=f"theory {left:g}",
                label=rf"theory, $\tau_0 = {left:g}$" if len(line) else None,
            )
            for flagged, group in runs.groupby(runs["run_flags"].notna()):
                look = {"markerfacecolor": "white"} if flagged else {}
                over = group["value"] / group["paper"]
                axes.plot(group["damping_ratio"], over, "o", color=colour, gid=f"simulation {left:g}", **look)
        axes.set(xlabel=r"damping ratio $b$", ylabel=f"{label} / paper's formula", xlim=(-0.02, None))
        panel_letter(axes, letter)
    grid[0].plot([], [], "o", color=GREY, label="simulation")
    _draw_refined(refined_axes, table[table["role"] == "refined"])
    handles, labels = grid[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=len(labels), columnspacing=1.0)
    return figure


def _draw_refined(axes, rows: pd.DataFrame) -> None:
    kinds = [column.removeprefix("pulse_").removesuffix("_right") for column in REFINED]
    for quantity, label, colour, marker in zip(kinds, REFINED.values(), CYCLE, MARKERS, strict=False):
        line = rows[rows["quantity"] == quantity].sort_values("dx")
        error = np.abs(line["value"] / line["theory"] - 1.0)
        axes.plot(line["dx"], error, marker=marker, color=colour, label=label, gid=quantity)
    ends = rows["dx"].agg(["min", "max"]).to_numpy()
    axes.plot(ends, 0.4 * ends, color=GREY, linestyle=":", linewidth=0.8, label="first order")
    axes.set(xscale="log", yscale="log", xlabel=r"spacing $\Delta x$", ylabel=r"|simulation / limit $-$ 1|")
    axes.set_title(
        rf"refining, $\tau_0 = {rows['left'].iloc[0]:g}$, $b = {rows['damping_ratio'].iloc[0]:g}$",
        loc="right",
    )
    axes.legend(loc="lower right")
    axes.set_ylim(1e-7, None)
    panel_letter(axes, "d")
