"""Ruptures from beginning to end, exact and on lattices, and how the difference falls."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..data.numerals import setting
from . import style
from .shared.space_time import draw_halves
from .style import BLACK, BLUE, GREEN, GREY, OPEN, ORANGE, PAGE, SMALL, Look

NEEDS = {"studies": ["exact_rupture"]}
table = style.as_given

SCENES = {"exact_displacement": BLUE, "exact_asymmetric": ORANGE, "exact_stress": GREEN}
MARKERS = {"release": "o", "stick": "s", "slip": "^", "velocity": "D"}


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a) the map, (b) both edges, (c) the slip, (d) the difference over the spacing."""
    figure, (map_axes, edge_axes, slip_axes, difference_axes) = style.new_panels(PAGE, 5.4, "ab;cd")
    _draw_map(figure, map_axes, table[table["scene"] == next(iter(SCENES))])
    scenes = table[table["role"] == "scene"]
    for scene, colour in SCENES.items():
        rows = table[table["scene"] == scene]
        for axes, quantity in ((edge_axes, "release"), (edge_axes, "stick"), (slip_axes, "slip")):
            _draw_edge(axes, rows, quantity, colour)
    _draw_key(edge_axes, scenes["dx"].iloc[0])
    edge_axes.set(xlabel=r"time $t$", ylabel=r"position $x$", xlim=(0.0, None))
    slip_axes.set(xlabel=r"position $x$", ylabel=r"slip $u$", ylim=(0.0, None))
    # A scene without an exact solution is named in the panel of the differences.
    names = {row.scene: _scene_name(row) for row in scenes.itertuples()}
    solved = set(table.loc[table["role"] == "exact", "scene"])
    others = {names[scene]: SCENES[scene] for scene in SCENES.keys() - solved}
    _draw_differences(difference_axes, table[table["role"] == "difference"], others)
    named = [scene for scene in SCENES if scene in solved]
    lines = [style.entry(names[scene], color=SCENES[scene]) for scene in named]
    figure.legend(handles=lines, loc="outside upper center", ncols=3)
    return figure


def _scene_name(scene: Any) -> str:
    """Boundary condition and pre-stress of a row of role scene."""
    gamma = {"gamma": scene.gamma} if scene.gamma > 0.0 else {}
    levels = dict.fromkeys([setting(scene.left), setting(scene.right)])
    return rf"{style.conditions(bool(gamma), **gamma)}, $\tau_0$ = {', '.join(levels)}"


def _draw_key(axes: Axes, dx: float) -> None:
    """Name lines and marks of the edges in a legend."""
    looks = {"-": "front, exact", "--": "trailing edge, exact"}
    looks |= {"o": rf"front, lattice, $\Delta x = {dx:g}$", "s": "trailing edge, lattice"}
    for look, label in looks.items():
        axes.plot([], [], look, color=GREY, markersize=2.5, label=label, **OPEN)
    axes.legend(loc="upper left", fontsize=SMALL)


def _draw_map(figure: Figure, axes: Axes, rows: pd.DataFrame) -> None:
    samples = rows[rows["role"].isin(["map_exact", "map_lattice"])]
    draw_halves(figure, axes, samples, "role")
    exact = rows[rows["role"] == "exact"]
    for quantity, dashes in (("release", "-"), ("stick", "--")):
        axes.plot(exact[quantity], exact["position"], dashes, color=BLACK, linewidth=0.9)
    for height, half in ((0.05, "exact"), (0.91, "lattice")):
        axes.text(0.03, height, half, transform=axes.transAxes)
    axes.set_xlim(0.0, None)


def _draw_edge(axes: Axes, rows: pd.DataFrame, quantity: str, colour: str) -> None:
    """Draw the exact line and the marks of the lattice."""
    look: Look = {"linewidth": 0.9, "markersize": 2.2, "markeredgewidth": 0.6} | OPEN
    # Edges have time on the horizontal axis, as in every figure.
    x, y = ("position", "slip") if quantity == "slip" else (quantity, "position")
    marks = ("--", "s") if quantity == "stick" else ("-", "o")
    for role, mark in zip(("exact", "lattice"), marks, strict=True):
        line = rows[rows["role"] == role]
        axes.plot(line[x], line[y], mark, color=colour, **look)


def _draw_differences(axes: Axes, rows: pd.DataFrame, others: dict[str, str]) -> None:
    """Draw the largest and the smallest difference of each scene; the others lie between them."""
    drawn = []
    for scene, colour in SCENES.items():
        scene_rows = rows[rows["scene"] == scene]
        lines = scene_rows.pivot(index="dx", columns="quantity", values="difference")
        finest = lines.iloc[0].dropna().sort_values()
        for quantity in finest.index[[0, -1]]:
            axes.plot(lines[quantity], MARKERS[quantity] + "-", color=colour, linewidth=0.7)
            drawn.append(quantity)
    for quantity in dict.fromkeys(drawn):
        label = "slip velocity" if quantity == "velocity" else quantity
        axes.plot([], [], MARKERS[quantity], color=GREY, label=label)
    for label, colour in others.items():
        axes.plot([], [], color=colour, label=label)
    ends = rows["dx"].agg(["min", "max"]).to_numpy()
    axes.plot(ends, 1.5 * ends, color=GREY, linewidth=0.8, linestyle=":", label="first order")
    axes.set(xscale="log", yscale="log", xlabel=r"spacing $\Delta x$")
    axes.set_ylabel("mean |lattice $-$ exact| / mean")
    style.few_ticks(axes.xaxis, np.unique(rows["dx"]))
    axes.set_ylim(0.35 * axes.get_ylim()[0], None)
    axes.legend(loc="lower right", ncols=2, columnspacing=0.8)
