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
    BLUE,
    GREEN,
    GREY,
    OPEN_MARKER,
    ORANGE,
    PAGE_WIDTH,
    PURPLE,
    SMALL_TEXT,
    YELLOW,
    Look,
    entry,
)

NEEDS = {"studies": ["layer", "layer_map"]}

QUANTITIES = ["speed", "pulse_width", "pulse_slip"]
# Parameters that identify a pulse.
PULSE_COLUMNS = ["gamma", "tau0", "fracture_energy"]
# The paper's formulas, and the pulse in one dimension with the same friction.
THEORY_COLUMNS = [
    f"{theory}_{quantity}" for theory in ("paper", "damped") for quantity in QUANTITIES
]
# Markers and colours of the elasticity ratios, from the smallest on.
MARKERS = ("o", "^", "s", "D")
GAMMA_COLOURS = (BLUE, YELLOW, GREEN, PURPLE)
# Colours of the friction coefficients, from the smallest on.
COUPLING_COLOURS = (BLUE, ORANGE, BLACK)
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
    """Return the rows of five parts of the figure, which the column part names.

    field : velocity in the layer at one time
    pulse : one row for each pulse on its finest grid, measured at the last station (see
        `drawn_pulses`)
    free : the same for pulses in a layer whose top is free to rise
    coupled : width along the path of pulses whose strength depends on the normal stress
    map : what a pulse does (column outcome) for each gamma and fracture energy
    """
    study = tables["layer"]
    field = study[study["part"] == "field"].dropna(axis="columns", how="all")
    coupled = study[study["part"] == "coupled"]
    # A grid is named by its number of cells over the height of the layer.
    coupled = coupled[coupled["cells"] == coupled["cells"].max()]
    numbers = ["coupling", "side", "sample_position", "pulse_width"]
    coupled = coupled[["part", "gamma", "tau0", *numbers]]
    points = tables["layer_map"][["gamma", "fracture_energy", "outcome"]].assign(part="map")
    pulses = [drawn_pulses(study[study["part"] == part]) for part in ("pulse", "free")]
    return pd.concat([field, *pulses, coupled, points], ignore_index=True)


def drawn_pulses(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the pulses of one part on their finest grids, with the range over all grids.

    A station is a position on the fault at which a pulse is measured. The last one counts. Columns
    least_QUANTITY and largest_QUANTITY have the range. The column crossings has the sliding time in
    units of the time that the shear front of the tip needs to come down from the top.

    rows : rows of the part, for all grids and stations
    """
    at_last_station = rows[rows["station"] == rows["station"].max()].sort_values("cells")
    by_pulse = at_last_station.groupby(PULSE_COLUMNS)
    finest = by_pulse.nth(-1).set_index(PULSE_COLUMNS)
    crossing_width = np.sqrt(
        2.0 * finest["speed"] ** 2 / finest.index.get_level_values("gamma") - 1.0
    )
    finest["crossings"] = finest["pulse_width"] / crossing_width
    drawn = finest[["part", *QUANTITIES, "cells", "crossings", *THEORY_COLUMNS]]
    least = by_pulse[QUANTITIES].min().add_prefix("least_")
    largest = by_pulse[QUANTITIES].max().add_prefix("largest_")
    return drawn.join([least, largest]).reset_index()


def draw(table: pd.DataFrame) -> Figure:
    """Draw velocity (a), speed, width, slip (b-d), sliding times (e), widths (f) and a map (g)."""
    figure, panels = style.new_panels(PAGE_WIDTH, 5.7, "aaa;bcd;efg", height_ratios=(0.9, 2.3, 2.3))
    pulses = table[table["part"] == "pulse"]
    _draw_field(figure, panels[0], table[table["part"] == "field"])
    # The level at which most fracture energies have been run.
    level = pulses["tau0"].mode().iloc[0]
    _draw_pulses(panels[1:4], pulses[pulses["tau0"] == level])
    _draw_sliding_times(panels[4], pulses, table[table["part"] == "free"], level)
    _draw_coupled(panels[5], table[table["part"] == "coupled"])
    _draw_map(panels[6], table[table["part"] == "map"])
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
    # The fault moves fastest at the tip, which runs almost at the speed of the longitudinal wave.
    tip = grid.columns[np.argmax(grid.to_numpy()[0])]
    shear_front = [tip, tip - _crossing_width(gamma)]
    axes.plot(shear_front, [1.0, 0.0], "--", color=BLACK, linewidth=0.8)


def _gamma_looks(pulses: pd.DataFrame) -> dict[float, Look]:
    """Return colour and marker for each elasticity ratio."""
    looks = zip(GAMMA_COLOURS, MARKERS, strict=True)
    ratios = sorted(pulses["gamma"].unique())
    return {
        gamma: {"color": colour, "marker": marker}
        for gamma, (colour, marker) in zip(ratios, looks, strict=False)
    }


def _draw_pulses(panels: list[Axes], pulses: pd.DataFrame) -> None:
    """Draw speed, width and slip as functions of the fracture energy.

    Dotted lines are the pulse in one dimension with the same friction, and dashed lines the paper's
    formulas.
    """
    speed_axes, width_axes, slip_axes = panels
    for gamma, look in _gamma_looks(pulses).items():
        rows = pulses[pulses["gamma"] == gamma].sort_values("fracture_energy")
        # Each quantity is divided by a unit of its own.
        units = {
            "speed": 1.0,
            "pulse_width": _crossing_width(gamma),
            "pulse_slip": rows["paper_pulse_slip"],
        }
        for axes, (quantity, unit) in zip(panels, units.items(), strict=True):
            value = rows[quantity] / unit
            range_ends = [rows[f"{end}_{quantity}"] / unit for end in ("least", "largest")]
            error = [value - range_ends[0], range_ends[1] - value]
            line: Look = {"linewidth": 0.8, "capsize": 1.5, "label": rf"$\gamma = {gamma:.2g}$"}
            axes.errorbar(rows["fracture_energy"], value, error, **look, **line)
            in_one_dimension = rows[f"damped_{quantity}"] / unit
            axes.plot(rows["fracture_energy"], in_one_dimension, ":", color=look["color"])
            formula = (rows[f"paper_{quantity}"] / unit).iloc[0]
            axes.axhline(formula, linestyle="--", color=look["color"], linewidth=0.8)
    for axes in (speed_axes, width_axes):
        axes.axhline(1.0, color=GREY, linewidth=0.6)
    for axes in panels:
        axes.set(xlabel=r"fracture energy $G_\mathrm{c}/G_0$", xlim=(0.0, 1.0))
        axes.set_ylim(0.0, None)
    speed_axes.set_ylabel(r"front speed $v$")
    width_axes.set_ylabel(r"width / $H\sqrt{2/\gamma-1}$")
    slip_axes.set_ylabel(r"slip / $(2\tau_0/\gamma)$")
    handles, _ = speed_axes.get_legend_handles_labels()
    speed_axes.legend(handles=handles, loc="lower left", fontsize=SMALL_TEXT)
    lines = [
        entry("formulas of the paper", color=BLACK, linestyle="--", linewidth=0.8),
        entry("1D, same friction", color=BLACK, linestyle=":"),
    ]
    slip_axes.legend(handles=lines, loc="lower left", fontsize=SMALL_TEXT)


def _draw_sliding_times(
    axes: Axes, pulses: pd.DataFrame, free_pulses: pd.DataFrame, level: float
) -> None:
    """Draw the sliding time of all pulses in units of one crossing of the layer.

    Markers are filled at one level of pre-stress. Crosses are pulses whose top is free to rise.
    """
    for gamma, look in _gamma_looks(pulses).items():
        rows = pulses[pulses["gamma"] == gamma]
        at_level = rows["tau0"] == level
        axes.plot(
            rows["fracture_energy"][at_level], rows["crossings"][at_level], linestyle="none", **look
        )
        others = rows[~at_level]
        axes.plot(
            others["fracture_energy"], others["crossings"], linestyle="none", **look | OPEN_MARKER
        )
    axes.plot(free_pulses["fracture_energy"], free_pulses["crossings"], "x", color=BLACK)
    axes.axhline(1.0, color=GREY, linewidth=0.6)
    axes.set(xlabel=r"fracture energy $G_\mathrm{c}/G_0$", ylabel="sliding time / crossing time")
    axes.set(xlim=(0.0, 1.0), ylim=(0.9, None))
    entries = [
        entry(rf"$\tau_0 = {level:g}$", color=GREY, marker="o"),
        entry(r"other $\tau_0$", color=GREY, marker="o", **OPEN_MARKER),
        entry("top free to rise", color=BLACK, marker="x"),
    ]
    axes.legend(handles=entries, loc="center left", fontsize=SMALL_TEXT)


def _draw_coupled(axes: Axes, coupled: pd.DataFrame) -> None:
    """Draw the width of pulses whose strength depends on the normal stress, on both sides."""
    for colour, (coupling, rows) in zip(
        COUPLING_COLOURS, coupled.groupby("coupling"), strict=False
    ):
        for side, line in ((1.0, "o-"), (-1.0, "o:")):
            on_side = rows[rows["side"] == side]
            look: Look = {"color": colour} | (OPEN_MARKER if side < 0.0 else {})
            axes.plot(on_side["sample_position"].abs(), on_side["pulse_width"], line, **look)
        axes.plot([], [], color=colour, label=rf"$\mu = {coupling:g}$")
    handles, _ = axes.get_legend_handles_labels()
    handles += [
        entry("right", color=GREY, marker="o"),
        entry("left", color=GREY, marker="o", **OPEN_MARKER),
    ]
    axes.set(xlabel=r"distance $|x|/H$", ylabel=r"pulse width $W_\mathrm{p}/H$")
    axes.set_ylim(0.0, 2.6)
    axes.legend(handles=handles, loc="upper center", fontsize=SMALL_TEXT, ncols=2)


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
    axes.legend(loc="upper left", fontsize=SMALL_TEXT)
