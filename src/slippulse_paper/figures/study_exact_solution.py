"""Compare whole ruptures on lattices with the exact solution.

The difference between both falls with the block spacing.
"""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

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
    """Draw (a) a map, (b) fronts and trailing edges, (c) slip, (d) differences by spacing."""
    figure, panels = style.new_panels(PAGE_WIDTH, 5.4, "ab;cd")
    map_axes, edge_axes, slip_axes, difference_axes = panels
    # The map shows only one of the scenes.
    _draw_map(map_axes, table[table["scene"] == "exact_displacement"])
    for scene, colour in SCENE_COLOURS.items():
        rows = table[table["scene"] == scene]
        look: Look = {"color": colour, "markersize": 2.2} | OPEN_MARKER
        # The exact solution is drawn as lines, and the lattice as markers. The columns release and
        # stick have the times at which the front and the trailing edge reach a position.
        for role, front_style, trailing_style in (("exact", "-", "--"), ("lattice", "o", "s")):
            curve = rows[rows["role"] == role]
            edge_axes.plot(curve["release"], curve["position"], front_style, **look)
            edge_axes.plot(curve["stick"], curve["position"], trailing_style, **look)
            slip_axes.plot(curve["position"], curve["slip"], front_style, **look)
    scenes = table[table["role"] == "scene"]
    _add_edge_legend(edge_axes, dx=scenes["dx"].iloc[0])
    # Time is on the horizontal axis, as in every figure with fronts.
    edge_axes.set(xlabel=r"time $t$", ylabel=r"position $x$", xlim=(0.0, None))
    slip_axes.set(xlabel=r"position $x$", ylabel=r"slip $u$", ylim=(0.0, None))
    figure.legend(handles=_scene_entries(scenes), loc="outside upper center", ncols=3)
    _draw_differences(difference_axes, table[table["role"] == "difference"].sort_values("dx"))
    return figure


def _draw_map(axes: Axes, rows: pd.DataFrame) -> None:
    """Draw the slip velocity in time and space, with the exact front and trailing edge as lines.

    The lower half is exact, and the upper half is from a lattice.
    """
    draw_halves(axes, rows[rows["role"].isin(["map_exact", "map_lattice"])], "role")
    exact = rows[rows["role"] == "exact"]
    for quantity, dashes in (("release", "-"), ("stick", "--")):
        axes.plot(exact[quantity], exact["position"], dashes, color=BLACK, linewidth=0.9)
    axes.text(0.03, 0.05, "exact", transform=axes.transAxes)
    axes.text(0.03, 0.91, "lattice", transform=axes.transAxes)
    axes.set_xlim(0.0, None)


def _add_edge_legend(axes: Axes, dx: float) -> None:
    """Add a legend for fronts and trailing edges, exact and on lattices of the spacing dx."""
    label_of_style = {
        "-": "front, exact",
        "--": "trailing edge, exact",
        "o": rf"front, lattice, $\Delta x = {dx:g}$",
        "s": "trailing edge, lattice",
    }
    # Curves without points only give entries of the legend.
    for line_style, label in label_of_style.items():
        axes.plot([], [], line_style, color=GREY, label=label, **OPEN_MARKER)
    axes.legend(loc="upper left", fontsize=SMALL_TEXT)


def _scene_entries(scenes: pd.DataFrame) -> list[Line2D]:
    """Return one legend entry for each scene, with its boundary condition and its levels."""
    entries = []
    for scene in scenes.itertuples():
        # If the stress is held, gamma is 0.
        is_held = scene.gamma > 0.0
        parameters = {"gamma": scene.gamma} if is_held else {}
        left, right = setting(scene.left), setting(scene.right)
        levels = left if left == right else f"{left}, {right}"
        label = rf"{style.conditions(held=is_held, **parameters)}, $\tau_0$ = {levels}"
        entries.append(style.entry(label, color=SCENE_COLOURS[str(scene.scene)]))
    return entries


def _draw_differences(axes: Axes, rows: pd.DataFrame) -> None:
    """Draw the difference between lattice and exact solution as a function of the spacing.

    There is one marker for each quantity, and one colour for each scene.
    """
    for quantity, marker in QUANTITY_MARKERS.items():
        for scene, line in rows[rows["quantity"] == quantity].groupby("scene"):
            look: Look = {"color": SCENE_COLOURS[str(scene)], "linewidth": 0.7}
            axes.plot(line["dx"], line["difference"], marker + "-", **look)
        label = "slip velocity" if quantity == "velocity" else quantity
        axes.plot([], [], marker, color=GREY, label=label)
    # A dotted guide: the difference 1.5 dx, which falls with first order.
    style.draw_first_order(axes, rows["dx"], slope=1.5, colour=GREY)
    axes.set_ylabel("mean |lattice $-$ exact| / mean")
    style.few_ticks(axes.xaxis, np.unique(rows["dx"]))
    # The legend stands below the lines.
    axes.set_ylim(0.35 * axes.get_ylim()[0], None)
    axes.legend(loc="lower right", ncols=2)
