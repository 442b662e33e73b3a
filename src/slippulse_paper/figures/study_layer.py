"""Pulses of the layer in the plane: their speed, width, slip and stability.

The fracture energy is always divided by the energy G_0 that the layer releases. The width of a
pulse is compared with sqrt(2/gamma - 1) layer thicknesses: at this distance behind the tip of a
rupture, shear waves from the top of the layer reach the fault. (The tip runs at the speed of the
longitudinal wave.)
"""

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
# Parameters that identify a pulse.
PULSE_COLUMNS = ["gamma", "tau0", "fracture_energy"]
FORMULA_COLUMNS = [f"paper_{quantity}" for quantity in QUANTITIES]
MARKERS = ("o", "^", "s", "D")
# Colours end at this fraction of the largest velocity, which only the tip of the pulse has.
BRIGHTEST_FRACTION = 0.6
# Markers of what the pulses of a point of the map do.
OUTCOMES: dict[str, Look] = {
    "steady": {"marker": "o", "color": GREEN, "label": "steady"},
    "lower dies": {"marker": "o", "color": GREEN, "label": "steady; lower level kills it"}
    | OPEN_MARKER,
    "not settled": {"marker": "s", "color": PURPLE, "label": "not settled"} | OPEN_MARKER,
    "growing": {"marker": "^", "color": BLACK, "label": "grows"},
    "dying": {"marker": "x", "color": ORANGE, "label": "dies"},
}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the rows of four parts of the figure, which the column part names.

    field : velocity in the layer at one time
    pulse : one row for each pulse, from `drawn_pulses`
    step : slip of pulses that enter another pre-stress
    map : what a pulse does (column outcome) for each gamma and fracture energy
    """
    study = tables["layer"]
    field = study[study["part"] == "field"].dropna(axis="columns", how="all")
    steps = study[study["part"] == "step"]
    # A grid is named by its number of cells over the height of the layer.
    steps = steps[steps["cells"] == steps["cells"].max()]
    steps = steps[["part", "gamma", "tau0", "before", "sample_position", "pulse_slip"]]
    points = tables["layer_map"][["gamma", "fracture_energy", "outcome"]].assign(part="map")
    pulses = drawn_pulses(study[study["part"] == "pulse"])
    return pd.concat([field, pulses.assign(part="pulse"), steps, points], ignore_index=True)


def drawn_pulses(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the pulses at one level of pre-stress: their quantities on the finest grid.

    The columns change_of_QUANTITY have the absolute changes from the second finest grid.

    rows : rows of the part pulse of the study, for all levels, grids and stations
    """
    rows = rows.sort_values("cells")
    # The level at which most fracture energies have been run.
    level = rows["tau0"].mode().iloc[0]
    rows = rows[rows["tau0"] == level]
    # A station is a position on the fault at which a pulse is measured. The last one is used.
    at_last_station = rows[rows["station"] == rows["station"].max()]
    # The rows of a pulse are in the order of their grids, the finest last.
    by_pulse = at_last_station.groupby(PULSE_COLUMNS)
    finest = by_pulse.nth(-1).set_index(PULSE_COLUMNS)
    second_finest = by_pulse.nth(-2).set_index(PULSE_COLUMNS)
    changes = (finest[QUANTITIES] - second_finest[QUANTITIES]).abs().add_prefix("change_of_")
    return finest[[*QUANTITIES, "cells", *FORMULA_COLUMNS]].join(changes).reset_index()


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a) velocity, (b to d) speed, width and slip, (e) pulses across a step, (f) a map."""
    figure, panels = style.new_panels(
        PAGE_WIDTH, 5.6, "aaaaaa;bbccdd;eeefff", height_ratios=(1.0, 2.3, 2.1)
    )
    _draw_field(figure, panels[0], table[table["part"] == "field"])
    _draw_pulses(panels[1:4], table[table["part"] == "pulse"])
    _draw_steps(panels[4], table[table["part"] == "step"])
    _draw_map(panels[5], table[table["part"] == "map"])
    return figure


def _crossing_width(gamma: float | pd.Series) -> float | pd.Series:
    """Return sqrt(2/gamma - 1), the width with which pulses are compared, in layer thicknesses."""
    return np.sqrt(2.0 / gamma - 1.0)


def _draw_field(figure: Figure, axes: Axes, field: pd.DataFrame) -> None:
    """Draw the velocity in the layer, and as a dashed line the shear front from its top.

    The shear front leads from the top of the layer, above the tip of the rupture, to the fault.
    """
    # One row for each height and one column for each position.
    grid = field.pivot(index="y", columns="x", values="velocity")
    brightest = BRIGHTEST_FRACTION * float(grid.to_numpy().max())
    look: Look = {"cmap": "RdBu_r", "vmin": -brightest, "vmax": brightest, "shading": "gouraud"}
    image = axes.pcolormesh(grid.columns, grid.index, grid, rasterized=True, **look)
    bar = figure.colorbar(image, ax=axes, aspect=6, pad=0.01, extend="max")
    bar.set_label(r"$\dot u_x$")
    axes.set(aspect="equal", xlabel=r"position $x/H$", ylabel=r"$y/H$", yticks=(0.0, 1.0))
    first = field.iloc[0]
    gamma = first["gamma"]
    title = style.conditions(True, tau_0=first["tau0"], gamma=round(gamma, 3), time=first["time"])
    axes.set_title(rf"{title}, $G_\mathrm{{c}}/G_0 = {first['fracture_energy']:.2g}$")
    # The tip is the foremost point of the fault that moves. It runs almost at the speed of the
    # longitudinal wave.
    velocity_on_fault = grid.to_numpy()[0]
    tip = grid.columns[np.flatnonzero(velocity_on_fault > 0.0)[-1]]
    shear_front = [tip, tip - _crossing_width(gamma)]
    axes.plot(shear_front, [1.0, 0.0], "--", color=BLACK, linewidth=0.8)


def _draw_pulses(panels: list[Axes], pulses: pd.DataFrame) -> None:
    """Draw speed, width and slip as functions of the fracture energy.

    Error bars are changes from a coarser grid, and dashed lines are formulas of the paper.
    """
    speed_axes, width_axes, slip_axes = panels
    for marker, (gamma, rows) in zip(MARKERS, pulses.groupby("gamma"), strict=False):
        rows = rows.sort_values("fracture_energy")
        colour = style.colour("gamma", gamma)
        look: Look = {"color": colour, "capsize": 1.5, "linewidth": 0.8}
        look |= {"fmt": f"{marker}-", "label": rf"$\gamma = {gamma:.2g}$"}
        crossing_width = _crossing_width(gamma)
        # In its panel, each quantity is divided by this unit.
        units = {
            "speed": 1.0,
            "pulse_width": crossing_width,
            "pulse_slip": rows["paper_pulse_slip"],
        }
        for axes, (quantity, unit) in zip(panels, units.items(), strict=True):
            value, error = rows[quantity] / unit, rows[f"change_of_{quantity}"] / unit
            axes.errorbar(rows["fracture_energy"], value, error, **look)
        formula_width = rows["paper_pulse_width"].iloc[0] / crossing_width
        width_axes.axhline(formula_width, linestyle="--", color=colour, linewidth=0.8)
    dashed: Look = {"color": BLACK, "linewidth": 0.8, "linestyle": "--"}
    speed_axes.axhline(pulses["paper_speed"].iloc[0], **dashed)
    slip_axes.axhline(1.0, **dashed)
    for axes in (speed_axes, width_axes):
        axes.axhline(1.0, color=GREY, linewidth=0.6)
    for axes in panels:
        axes.set(xlabel=r"fracture energy $G_\mathrm{c}/G_0$", xlim=(0.0, 1.0))
        axes.set_ylim(0.0, None)
    speed_axes.set_ylabel(r"front speed $v$")
    width_axes.set_ylabel(r"$W_\mathrm{p}/H\sqrt{2/\gamma-1}$")
    slip_axes.set_ylabel(r"slip / $(2\tau_0/\gamma)$")
    handles, _ = speed_axes.get_legend_handles_labels()
    formula = entry("formula of the paper", **dashed)
    speed_axes.legend(handles=[*handles, formula], loc="lower left", fontsize=SMALL_TEXT)


def _draw_steps(axes: Axes, steps: pd.DataFrame) -> None:
    """Draw the slip that pulses leave behind, as a function of position.

    A pulse with a solid line runs in the same pre-stress tau_0 all the way. A pulse with a dotted
    line begins in another pre-stress, ``before``.
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
    """Mark what the pulse of each point does: whether it is steady, grows, dies, or neither.

    The axes are the fracture energy and the width sqrt(2/gamma - 1).
    """
    for outcome, rows in points.groupby("outcome"):
        look: Look = {"linestyle": "none", "markersize": 5.0} | OUTCOMES[str(outcome)]
        axes.plot(rows["fracture_energy"], _crossing_width(rows["gamma"]), **look)
    axes.axvline(1.0, color=GREY, linewidth=0.6)
    narrowest = _crossing_width(points["gamma"].max())
    widest = _crossing_width(points["gamma"].min())
    axes.set(yscale="log", ylim=(0.7 * narrowest, 1.9 * widest), xlim=(0.0, None))
    axes.set(xlabel=r"fracture energy $G_\mathrm{c}/G_0$", ylabel=r"width $\sqrt{2/\gamma-1}$")
    style.few_ticks(axes.yaxis, (1.0, 2.0, 5.0))
    axes.legend(loc="upper left", fontsize=SMALL_TEXT, ncols=2)
