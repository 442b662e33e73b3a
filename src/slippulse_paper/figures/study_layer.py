"""Pulses of the layer in the plane: what sets speed, width and slip, and which are stable."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slippulse.plotting import style
from slippulse.plotting.style import (
    BLACK,
    GREEN,
    GREY,
    OPEN_MARKER,
    ORANGE,
    PAGE_WIDTH,
    PURPLE,
    SMALL_TEXT,
    Look,
    entry,
)

NEEDS = {"studies": ["layer", "layer_map"]}

QUANTITIES = ["speed", "pulse_width", "pulse_slip"]
CASE = ["gamma", "tau0", "fracture_energy"]
PAPER = [f"paper_{quantity}" for quantity in QUANTITIES]
MARKERS = ("o", "^", "s", "D")
# Colours end at this fraction of the largest velocity, which is that of the tip alone.
BRIGHT = 0.6
OUTCOMES: dict[str, Look] = {
    "steady": {"marker": "o", "color": GREEN, "label": "steady"},
    "lower dies": {"marker": "o", "color": GREEN, "label": "steady; lower level kills it"}
    | OPEN_MARKER,
    "not settled": {"marker": "s", "color": PURPLE, "label": "not settled"} | OPEN_MARKER,
    "growing": {"marker": "^", "color": BLACK, "label": "grows"},
    "dying": {"marker": "x", "color": ORANGE, "label": "dies"},
}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Parts field, pulse (finest grid, with its change from the grid before), step, and map."""
    study = tables["layer"]
    field = study[study["part"] == "field"].dropna(axis="columns", how="all")
    pulses = study[study["part"] == "pulse"].sort_values("cells")
    # The level at which most fracture energies have been run.
    pulses = pulses[pulses["tau0"] == pulses["tau0"].mode().iloc[0]]
    pulses = pulses[pulses["station"] == pulses["station"].max()].groupby(CASE)
    finest, before = (pulses.nth(-1 - step).set_index(CASE) for step in (0, 1))
    changes = (finest[QUANTITIES] - before[QUANTITIES]).abs().add_prefix("change_of_")
    drawn = finest[[*QUANTITIES, "cells", *PAPER]].join(changes).reset_index()
    steps = study[study["part"] == "step"]
    steps = steps[steps["cells"] == steps["cells"].max()]
    steps = steps[["part", "gamma", "tau0", "before", "sample_position", "pulse_slip"]]
    points = tables["layer_map"][["gamma", "fracture_energy", "outcome"]].assign(part="map")
    return pd.concat([field, drawn.assign(part="pulse"), steps, points], ignore_index=True)


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a) velocity, (b-d) speed, width and slip, (e) pulses across a step, (f) the map."""
    figure, panels = style.new_panels(
        PAGE_WIDTH, 5.6, "aaaaaa;bbccdd;eeefff", height_ratios=(1.0, 2.3, 2.1)
    )
    _draw_field(figure, panels[0], table[table["part"] == "field"])
    _draw_pulses(panels[1:4], table[table["part"] == "pulse"])
    _draw_steps(panels[4], table[table["part"] == "step"])
    _draw_map(panels[5], table[table["part"] == "map"])
    return figure


def _draw_field(figure: Figure, axes: Axes, field: pd.DataFrame) -> None:
    """Draw the velocity over the layer, and the shear front from the top of the layer."""
    grid = field.pivot(index="y", columns="x", values="velocity")
    brightest = BRIGHT * float(grid.to_numpy().max())
    look: Look = {"cmap": "RdBu_r", "vmin": -brightest, "vmax": brightest, "shading": "gouraud"}
    image = axes.pcolormesh(grid.columns, grid.index, grid, rasterized=True, **look)
    bar = figure.colorbar(image, ax=axes, aspect=6, pad=0.01, extend="max")
    bar.set_label(r"$\dot u_x$")
    axes.set(aspect="equal", xlabel=r"position $x/H$", ylabel=r"$y/H$", yticks=(0.0, 1.0))
    time, tau0, gamma, energy = field[["time", "tau0", "gamma", "fracture_energy"]].iloc[0]
    title = style.conditions(True, tau_0=tau0, gamma=round(gamma, 3), time=time)
    axes.set_title(rf"{title}, $G_\mathrm{{c}}/G_0 = {energy:.2g}$")
    # The tip moves at the speed of the longitudinal wave, almost.
    tip = grid.columns[np.flatnonzero(grid.to_numpy()[0] > 0.0)[-1]]
    axes.plot([tip, tip - np.sqrt(2.0 / gamma - 1.0)], [1.0, 0.0], "--", color=BLACK, linewidth=0.8)


def _draw_pulses(panels: list[Axes], pulses: pd.DataFrame) -> None:
    """Draw speed, width and slip over the fracture energy, with the formulas of the paper."""
    for marker, (gamma, rows) in zip(MARKERS, pulses.groupby("gamma"), strict=False):
        rows, colour = rows.sort_values("fracture_energy"), style.colour("gamma", gamma)
        crossing = np.sqrt(2.0 / gamma - 1.0)
        scales = 1.0, crossing, rows["paper_pulse_slip"]
        for axes, quantity, scale in zip(panels, QUANTITIES, scales, strict=True):
            error = rows[f"change_of_{quantity}"] / scale
            look: Look = {"color": colour, "capsize": 1.5, "label": rf"$\gamma = {gamma:.2g}$"}
            x, y = rows["fracture_energy"], rows[quantity] / scale
            axes.errorbar(x, y, error, fmt=f"{marker}-", linewidth=0.8, **look)
        line: Look = {"color": colour, "linewidth": 0.8}
        panels[1].axhline(rows["paper_pulse_width"].iloc[0] / crossing, linestyle="--", **line)
    dashed: Look = {"color": BLACK, "linewidth": 0.8, "linestyle": "--"}
    panels[0].axhline(pulses["paper_speed"].iloc[0], **dashed)
    panels[2].axhline(1.0, **dashed)
    for axes in panels[:2]:
        axes.axhline(1.0, color=GREY, linewidth=0.6)
    for axes in panels:
        axes.set(xlabel=r"fracture energy $G_\mathrm{c}/G_0$", xlim=(0.0, 1.0))
        axes.set_ylim(0.0, None)
    panels[0].set_ylabel(r"front speed $v$")
    panels[1].set_ylabel(r"$W_\mathrm{p}/H\sqrt{2/\gamma-1}$")
    panels[2].set_ylabel(r"slip / $(2\tau_0/\gamma)$")
    handles = panels[0].get_legend_handles_labels()[0]
    formula = entry("formula of the paper", **dashed)
    panels[0].legend(handles=[*handles, formula], loc="lower left", fontsize=SMALL_TEXT)


def _draw_steps(axes: Axes, steps: pd.DataFrame) -> None:
    """Draw the slip that pulses leave behind, as a function of position.

    A pulse with a dotted line passes from the pre-stress ``before`` to tau_0 on its way. A pulse
    with a solid line has the same pre-stress all the way.
    """
    for (tau0, before), rows in steps.groupby(["tau0", "before"]):
        rows = rows.sort_values("sample_position")
        look: Look = {"color": style.colour("tau_0", tau0), "marker": "o"}
        if tau0 == before:
            look |= {"linestyle": "-", "label": rf"$\tau_0 = {tau0:g}$"}
        else:
            look |= {"linestyle": ":", "label": rf"${before:g}$, then ${tau0:g}$"} | OPEN_MARKER
        axes.plot(rows["sample_position"], rows["pulse_slip"], **look)
    axes.set(xlabel=r"position $x/H$", ylabel=r"slip left behind")
    axes.set_title(style.conditions(held=True, gamma=round(float(steps["gamma"].iloc[0]), 3)))
    axes.set_ylim(0.8 * steps["pulse_slip"].min(), 1.02 * steps["pulse_slip"].max())
    axes.legend(loc="lower right", fontsize=SMALL_TEXT, ncols=2)


def _draw_map(axes: Axes, points: pd.DataFrame) -> None:
    """Mark what the pulses of each point do, over the fracture energy and the width they have."""
    for outcome, rows in points.groupby("outcome"):
        width = np.sqrt(2.0 / rows["gamma"] - 1.0)
        look: Look = {"linestyle": "none", "markersize": 5.0} | OUTCOMES[str(outcome)]
        axes.plot(rows["fracture_energy"], width, **look)
    axes.axvline(1.0, color=GREY, linewidth=0.6)
    low, high = (np.sqrt(2.0 / points["gamma"].agg(end) - 1.0) for end in ("max", "min"))
    axes.set(
        yscale="log", xlabel=r"fracture energy $G_\mathrm{c}/G_0$", ylim=(0.7 * low, 1.9 * high)
    )
    axes.set(ylabel=r"width $\sqrt{2/\gamma-1}$", xlim=(0.0, None))
    style.few_ticks(axes.yaxis, (1.0, 2.0, 5.0))
    axes.legend(loc="upper left", fontsize=SMALL_TEXT, ncols=2)
