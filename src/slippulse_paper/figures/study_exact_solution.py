"""Whole ruptures, exact and on lattices, and how their difference falls with the spacing."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slippulse.plotting import style
from slippulse.plotting.space_time import draw_halves
from slippulse.plotting.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    OPEN_MARKER,
    ORANGE,
    PAGE_WIDTH,
    SMALL_TEXT,
    Look,
)

from ..text.numerals import setting

NEEDS = {"studies": ["exact_rupture"]}
table = style.as_given

SCENE_COLOURS = {"exact_displacement": BLUE, "exact_asymmetric": ORANGE, "exact_stress": GREEN}
QUANTITY_MARKERS = {"release": "o", "stick": "s", "slip": "^", "velocity": "D"}


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a) the map, (b) fronts and trailing edges, (c) slip, (d) the difference by spacing."""
    figure, (map_axes, edge_axes, slip_axes, difference_axes) = style.new_panels(
        PAGE_WIDTH, 5.4, "ab;cd"
    )
    rows = table[table["scene"] == next(iter(SCENE_COLOURS))]
    draw_halves(map_axes, rows[rows["role"].isin(["map_exact", "map_lattice"])], "role")
    exact = rows[rows["role"] == "exact"]
    for quantity, dashes in (("release", "-"), ("stick", "--")):
        map_axes.plot(exact[quantity], exact["position"], dashes, color=BLACK, linewidth=0.9)
    for height, half in ((0.05, "exact"), (0.91, "lattice")):
        map_axes.text(0.03, height, half, transform=map_axes.transAxes)
    map_axes.set_xlim(0.0, None)
    look: Look = {"markersize": 2.2} | OPEN_MARKER
    for scene, colour in SCENE_COLOURS.items():
        rows = table[table["scene"] == scene]
        for role, front, trailing in (("exact", "-", "--"), ("lattice", "o", "s")):
            line = rows[rows["role"] == role]
            edge_axes.plot(line["release"], line["position"], front, color=colour, **look)
            edge_axes.plot(line["stick"], line["position"], trailing, color=colour, **look)
            slip_axes.plot(line["position"], line["slip"], front, color=colour, **look)
    scenes = table[table["role"] == "scene"]
    looks = {"-": "front, exact", "--": "trailing edge, exact"}
    looks["o"] = rf"front, lattice, $\Delta x = {scenes['dx'].iloc[0]:g}$"
    looks["s"] = "trailing edge, lattice"
    for mark, label in looks.items():
        edge_axes.plot([], [], mark, color=GREY, label=label, **OPEN_MARKER)
    edge_axes.legend(loc="upper left", fontsize=SMALL_TEXT)
    # Time is on the horizontal axis, as in every figure with fronts.
    edge_axes.set(xlabel=r"time $t$", ylabel=r"position $x$", xlim=(0.0, None))
    slip_axes.set(xlabel=r"position $x$", ylabel=r"slip $u$", ylim=(0.0, None))
    lines = []
    for row in scenes.itertuples():
        gamma = {"gamma": row.gamma} if row.gamma > 0.0 else {}
        levels = ", ".join(dict.fromkeys([setting(row.left), setting(row.right)]))
        name = rf"{style.conditions(bool(gamma), **gamma)}, $\tau_0$ = {levels}"
        lines.append(style.entry(name, color=SCENE_COLOURS[str(row.scene)]))
    figure.legend(handles=lines, loc="outside upper center", ncols=3)
    _draw_differences(difference_axes, table[table["role"] == "difference"].sort_values("dx"))
    return figure


def _draw_differences(axes: Axes, rows: pd.DataFrame) -> None:
    """Draw the difference of each quantity as a function of spacing, with a line for each scene."""
    for quantity, marker in QUANTITY_MARKERS.items():
        for scene, line in rows[rows["quantity"] == quantity].groupby("scene"):
            look: Look = {"color": SCENE_COLOURS[str(scene)], "linewidth": 0.7}
            axes.plot(line["dx"], line["difference"], marker + "-", **look)
        label = "slip velocity" if quantity == "velocity" else quantity
        axes.plot([], [], marker, color=GREY, label=label)
    style.draw_first_order(axes, rows["dx"], 1.5, GREY)
    axes.set_ylabel("mean |lattice $-$ exact| / mean")
    style.few_ticks(axes.xaxis, np.unique(rows["dx"]))
    axes.set_ylim(0.35 * axes.get_ylim()[0], None)
    axes.legend(loc="lower right", ncols=2)
