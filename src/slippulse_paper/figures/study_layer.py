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
THEORY_COLUMNS = [f"paper_{quantity}" for quantity in QUANTITIES]
THEORY_COLUMNS += [f"damped_{quantity}" for quantity in QUANTITIES]
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
    "lower dies": {"marker": "o", "color": GREEN, "label": "steady, not from lower level"}
    | OPEN_MARKER,
    "not settled": {"marker": "s", "color": PURPLE, "label": "not settled"} | OPEN_MARKER,
    "growing": {"marker": "^", "color": BLACK, "label": "grows"},
    "dying": {"marker": "x", "color": ORANGE, "label": "dies"},
}


def table(data: dict, tables: dict[str, pd.DataFrame], settings: dict) -> pd.DataFrame:
    """Return the rows of five parts of the figure, which the column part names.

    field : velocity in the layer at one time
    pulse : one row for each pulse on its finest grid, measured where it passes the last station on
        the fault
    free : the same for pulses in a layer whose top is free to rise
    coupled : width along the path of pulses whose strength depends on the normal stress
    map : what a pulse does (column outcome) for each gamma and fracture energy
    """
    study = tables["layer"]
    # Columns that only other parts use are left out.
    field = study[study["part"] == "field"].dropna(axis="columns", how="all")
    pulses = drawn_pulses(study[study["part"] == "pulse"])
    free_pulses = drawn_pulses(study[study["part"] == "free"])
    coupled = study[study["part"] == "coupled"]
    # A grid is named by its number of cells over the height of the layer.
    on_finest_grid = coupled["cells"] == coupled["cells"].max()
    columns = ["part", "gamma", "tau0", "coupling", "side", "sample_position", "pulse_width"]
    coupled = coupled.loc[on_finest_grid, columns]
    points = tables["layer_map"][["gamma", "fracture_energy", "outcome"]].assign(part="map")
    return pd.concat([field, pulses, free_pulses, coupled, points], ignore_index=True)


def drawn_pulses(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the pulses of one part on their finest grids, with the range over all grids.

    A pulse is measured where it passes stations on the fault. The last station counts. The columns
    least_QUANTITY and largest_QUANTITY have the range. The column crossings has the time during
    which a point of the fault slides, divided by the time from the tip of the rupture to the shear
    front that comes down from the top of the layer behind it.

    rows : rows of the part, for all grids and stations
    """
    at_last_station = rows[rows["station"] == rows["station"].max()]
    by_pulse = at_last_station.sort_values("cells").groupby(PULSE_COLUMNS)
    # The grid with the most cells is the last one.
    finest = by_pulse.nth(-1).set_index(PULSE_COLUMNS, drop=False)
    # A width is a time multiplied by the speed of the tip, so the ratio of two widths is that of
    # the times.
    crossing_width = _crossing_width(finest["gamma"], finest["speed"])
    finest["crossings"] = finest["pulse_width"] / crossing_width
    drawn = finest[["part", *QUANTITIES, "cells", "crossings", *THEORY_COLUMNS]]
    least = by_pulse[QUANTITIES].min().add_prefix("least_")
    largest = by_pulse[QUANTITIES].max().add_prefix("largest_")
    return drawn.join([least, largest]).reset_index()


def draw(table: pd.DataFrame) -> Figure:
    """Draw the velocity in the layer (a), and the measured properties of pulses (b to g).

    b, c, d : speed, width and slip
    e : sliding time of a point, also if the top of the layer is free to rise (part free)
    f : width if the strength depends on the normal stress (part coupled)
    g : what a pulse does, such as "steady", for each gamma and fracture energy (part map)
    """
    figure, panels = style.new_panels(PAGE_WIDTH, 5.7, "aaa;bcd;efg", height_ratios=(0.9, 2.3, 2.3))
    field_axes, *pulse_panels, time_axes, coupled_axes, map_axes = panels
    pulses = table[table["part"] == "pulse"]
    _draw_field(figure, field_axes, table[table["part"] == "field"])
    # The level at which most fracture energies have been run.
    level = pulses["tau0"].mode().iloc[0]
    _draw_pulses(pulse_panels, pulses[pulses["tau0"] == level])
    _draw_sliding_times(time_axes, pulses, table[table["part"] == "free"], level)
    _draw_coupled(coupled_axes, table[table["part"] == "coupled"])
    _draw_map(map_axes, table[table["part"] == "map"])
    return figure


def _crossing_width(
    gamma: float | pd.Series, tip_speed: float | pd.Series = 1.0
) -> float | pd.Series:
    """Return the distance behind the tip at which shear waves from the top reach the fault.

    The distance is in layer thicknesses. By default, the tip runs at the speed 1 of the
    longitudinal wave.
    """
    return np.sqrt(2.0 * tip_speed**2 / gamma - 1.0)


def _draw_field(figure: Figure, axes: Axes, field: pd.DataFrame) -> None:
    """Draw the velocity in the layer, and as a dashed line the shear front from its top.

    The shear front leads from the top of the layer, above the tip of the rupture, to the fault.
    """
    # One row for each height and one column for each position.
    grid = field.pivot(index="y", columns="x", values="velocity")
    # Only the tip is faster than the end of the colour scale.
    brightest = BRIGHTEST_FRACTION * float(grid.to_numpy().max())
    look: Look = {"cmap": "RdBu_r", "vmin": -brightest, "vmax": brightest, "shading": "gouraud"}
    image = axes.pcolormesh(grid.columns, grid.index, grid, rasterized=True, **look)
    bar = figure.colorbar(image, ax=axes, aspect=6, pad=0.01, extend="max")
    bar.set_label(r"$\dot u_x$")
    axes.set(aspect="equal", xlabel=r"position $x/H$", ylabel=r"$y/H$", yticks=(0.0, 1.0))
    first = field.iloc[0]
    gamma = first["gamma"]
    title = style.conditions(
        held=True, tau_0=first["tau0"], gamma=round(gamma, 3), time=first["time"]
    )
    axes.set_title(rf"{title}, $G_\mathrm{{c}}/G_0 = {first['fracture_energy']:.2g}$")
    # The first row is the fault. It moves fastest at the tip, which runs almost at the speed of the
    # longitudinal wave.
    tip = float(grid.iloc[0].idxmax())
    shear_front = [tip, tip - _crossing_width(gamma)]
    axes.plot(shear_front, [1.0, 0.0], "--", color=BLACK, linewidth=0.8)


def _gamma_looks(pulses: pd.DataFrame) -> dict[float, Look]:
    """Return colour and marker for each elasticity ratio gamma."""
    gammas = sorted(pulses["gamma"].unique())
    looks = {}
    for gamma, colour, marker in zip(gammas, GAMMA_COLOURS, MARKERS, strict=False):
        looks[gamma] = {"color": colour, "marker": marker}
    return looks


def _draw_pulses(panels: list[Axes], pulses: pd.DataFrame) -> None:
    """Draw speed, width and slip of pulses as functions of the fracture energy.

    Each quantity is divided by its own unit. There is one colour for each gamma.
    """
    speed_axes, width_axes, slip_axes = panels
    for gamma, look in _gamma_looks(pulses).items():
        rows = pulses[pulses["gamma"] == gamma].sort_values("fracture_energy")
        width_unit, slip_unit = _crossing_width(gamma), rows["paper_pulse_slip"]
        _draw_quantity(speed_axes, rows, "speed", unit=1.0, look=look)
        _draw_quantity(width_axes, rows, "pulse_width", unit=width_unit, look=look)
        _draw_quantity(slip_axes, rows, "pulse_slip", unit=slip_unit, look=look)
    # Grey lines mark the speed of the longitudinal wave, and the width that is the unit.
    for axes in (speed_axes, width_axes):
        axes.axhline(1.0, color=GREY, linewidth=0.6)
    for axes in panels:
        axes.set(xlabel=r"fracture energy $G_\mathrm{c}/G_0$", xlim=(0.0, 1.0))
        axes.set_ylim(0.0, None)
    speed_axes.set_ylabel(r"front speed $v$")
    width_axes.set_ylabel(r"width / $H\sqrt{2/\gamma-1}$")
    slip_axes.set_ylabel(r"slip / $(2\tau_0/\gamma)$")
    speed_axes.legend(loc="lower left", fontsize=SMALL_TEXT)
    lines = [
        entry("formulas of the paper", color=BLACK, linestyle="--", linewidth=0.8),
        entry("1D, same friction", color=BLACK, linestyle=":"),
    ]
    slip_axes.legend(handles=lines, loc="lower left", fontsize=SMALL_TEXT)


def _draw_quantity(
    axes: Axes, rows: pd.DataFrame, quantity: str, unit: float | pd.Series, look: Look
) -> None:
    """Draw a quantity of the pulses at one gamma as a function of the fracture energy.

    Markers are pulses on their finest grids. Error bars are the range over all grids (columns with
    the prefixes least_ and largest_). The dotted line is the pulse in one dimension with the same
    friction (prefix damped_), and the dashed line is the paper's formula.

    unit : number by which the quantity is divided, for all pulses or for each
    """
    energy, value = rows["fracture_energy"], rows[quantity] / unit
    least, largest = rows[f"least_{quantity}"] / unit, rows[f"largest_{quantity}"] / unit
    label = rf"$\gamma = {rows['gamma'].iloc[0]:.2g}$"
    line = look | {"linewidth": 0.8, "capsize": 1.5, "label": label}
    axes.errorbar(energy, value, [value - least, largest - value], **line)
    axes.plot(energy, rows[f"damped_{quantity}"] / unit, ":", color=look["color"])
    # The formula does not depend on the fracture energy.
    formula = (rows[f"paper_{quantity}"] / unit).iloc[0]
    axes.axhline(formula, linestyle="--", color=look["color"], linewidth=0.8)


def _draw_sliding_times(
    axes: Axes, pulses: pd.DataFrame, free_pulses: pd.DataFrame, level: float
) -> None:
    """Draw the sliding time of all pulses, divided by the crossing time (column crossings).

    The crossing time is the time from the tip of a rupture to the shear front that comes down from
    the top of the layer behind it. Crosses are pulses of a layer whose top is free to rise.

    level : the pre-stress at which markers are filled
    """
    for gamma, look in _gamma_looks(pulses).items():
        rows = pulses[pulses["gamma"] == gamma]
        at_level, others = rows[rows["tau0"] == level], rows[rows["tau0"] != level]
        for drawn, marker_look in ((at_level, look), (others, look | OPEN_MARKER)):
            axes.plot(drawn["fracture_energy"], drawn["crossings"], linestyle="none", **marker_look)
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
    """Draw the width of pulses whose strength depends on the normal stress, along their paths.

    There is one colour for each friction coefficient (column coupling). The column side is 1 for
    pulses on the right, and -1 for those on the left, which have open markers.
    """
    handles = []
    groups = coupled.groupby("coupling")
    for colour, (coupling, rows) in zip(COUPLING_COLOURS, groups, strict=False):
        right, left = rows[rows["side"] > 0.0], rows[rows["side"] < 0.0]
        axes.plot(right["sample_position"], right["pulse_width"], "o-", color=colour)
        distance = left["sample_position"].abs()
        axes.plot(distance, left["pulse_width"], "o:", color=colour, **OPEN_MARKER)
        handles.append(entry(rf"$\mu = {coupling:g}$", color=colour))
    handles += [
        entry("right", color=GREY, marker="o"),
        entry("left", color=GREY, marker="o", **OPEN_MARKER),
    ]
    axes.set(xlabel=r"distance $|x|/H$", ylabel=r"pulse width $W_\mathrm{p}/H$")
    axes.set_ylim(0.0, 2.6)
    axes.legend(handles=handles, loc="upper center", fontsize=SMALL_TEXT, ncols=2)


def _draw_map(axes: Axes, points: pd.DataFrame) -> None:
    """Mark for each point what its pulse does (column outcome), such as "steady" or "growing".

    The axes are the fracture energy, and the distance sqrt(2/gamma - 1) at which shear waves from
    the top of the layer reach the fault.
    """
    for outcome, rows in points.groupby("outcome"):
        look: Look = {"linestyle": "none", "markersize": 5.0} | OUTCOMES[str(outcome)]
        axes.plot(rows["fracture_energy"], _crossing_width(rows["gamma"]), **look)
    # To the right of this line, a rupture needs more energy than the layer releases.
    axes.axvline(1.0, color=GREY, linewidth=0.6)
    narrowest = _crossing_width(points["gamma"].max())
    widest = _crossing_width(points["gamma"].min())
    axes.set(yscale="log", ylim=(0.7 * narrowest, 1.9 * widest), xlim=(0.0, None))
    axes.set(xlabel=r"fracture energy $G_\mathrm{c}/G_0$", ylabel=r"width $\sqrt{2/\gamma-1}$")
    style.few_ticks(axes.yaxis, (1.0, 2.0, 5.0))
    axes.legend(loc="upper left", fontsize=SMALL_TEXT)
