"""A whole rupture, exact and on lattices: velocity, fronts, trailing edge and slip, and how their difference falls."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..data.numerals import setting
from . import style
from .style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PAGE,
    VELOCITY_MAP,
    Look,
    entry,
    few_ticks,
    new_panels,
)

NEEDS = {"studies": ["exact_rupture"]}
table = style.as_given

SCENES = {"exact_displacement": BLUE, "exact_asymmetric": ORANGE, "exact_stress": GREEN}
MARKERS = {"release": "o", "stick": "s", "slip": "^", "velocity": "D"}


def plot(table: pd.DataFrame) -> Figure:
    """(a) the map, (b) both edges, (c) the slip, (d) the difference over the spacing."""
    figure, (map_axes, edge_axes, slip_axes, difference_axes) = new_panels(PAGE, 5.4, 2, 2)
    _draw_map(figure, map_axes, table[table["scene"] == next(iter(SCENES))])
    scenes, names = table[table["role"] == "scene"], {}
    for row in scenes.itertuples():
        springs = rf"$\Gamma = 1$, $\gamma = {row.gamma:g}$" if row.gamma > 0.0 else r"$\Gamma = 0$"
        levels = dict.fromkeys([setting(row.left), setting(row.right)])
        names[row.scene] = rf"{springs}, $\tau_0$ = {', '.join(levels)}"
    for scene, colour in SCENES.items():
        rows = table[table["scene"] == scene]
        for axes, quantity in ((edge_axes, "release"), (edge_axes, "stick"), (slip_axes, "slip")):
            _draw_edge(axes, rows, quantity, colour)
    dx = scenes["dx"].iloc[0]
    drawn = table.loc[table["role"] == "exact", "scene"].unique()
    looks = {
        "-": "front, exact",
        "--": "trailing edge, exact",
        "o": rf"front, lattice, $\Delta x = {dx:g}$",
    }
    for look, label in (looks | {"s": "trailing edge, lattice"}).items():
        edge_axes.plot(
            [], [], look, color=GREY, markersize=2.5, markerfacecolor="white", label=label
        )
    edge_axes.set(xlabel=r"time $t$", ylabel=r"position $x$", xlim=(0.0, None))
    edge_axes.legend(loc="upper left", fontsize=7.0)
    slip_axes.set(xlabel=r"position $x$", ylabel=r"slip $u$", ylim=(0.0, None))
    others = {names[scene]: SCENES[scene] for scene in SCENES.keys() - set(drawn)}
    _draw_differences(difference_axes, table[table["role"] == "difference"], others)
    lines = [
        entry(names[scene], color=colour) for scene, colour in SCENES.items() if scene in drawn
    ]
    figure.legend(handles=lines, loc="outside upper center", ncols=3)
    return figure


def _draw_map(figure: Figure, axes: Axes, rows: pd.DataFrame) -> None:
    samples = rows[rows["role"].isin(["map_exact", "map_lattice"])]
    look: Look = {"cmap": VELOCITY_MAP, "vmin": 0.0, "vmax": samples["slip_velocity"].max()}
    for _, half in samples.groupby("role"):
        # What does not slide stays white.
        grid = half.pivot(index="position", columns="time", values="slip_velocity")
        image = axes.pcolormesh(
            grid.columns, grid.index, grid, shading="nearest", rasterized=True, **look
        )
    exact = rows[rows["role"] == "exact"]
    for quantity, dashes in (("release", "-"), ("stick", "--")):
        axes.plot(exact[quantity], exact["position"], dashes, color=BLACK, linewidth=0.9)
    axes.axhline(0.0, color=BLACK, linewidth=0.6, linestyle=":")
    for height, half in ((0.05, "exact"), (0.91, "lattice")):
        axes.text(0.03, height, half, transform=axes.transAxes)
    figure.colorbar(image, ax=axes, pad=0.02).set_label(r"slip velocity $\dot u$")
    axes.set(xlabel=r"time $t$", ylabel=r"position $x$", xlim=(0.0, None))


def _draw_edge(axes: Axes, rows: pd.DataFrame, quantity: str, colour: str) -> None:
    """The exact line and the lattice's marks."""
    look: Look = {
        "linewidth": 0.9,
        "markersize": 2.2,
        "markerfacecolor": "white",
        "markeredgewidth": 0.6,
    }
    # Space-time has time on the horizontal axis, as in every figure.
    x, y = ("position", "slip") if quantity == "slip" else (quantity, "position")
    marks = ("--", "s") if quantity == "stick" else ("-", "o")
    for role, mark in zip(("exact", "lattice"), marks, strict=True):
        line = rows[rows["role"] == role]
        axes.plot(line[x], line[y], mark, color=colour, **look)


def _draw_differences(axes: Axes, rows: pd.DataFrame, others: dict[str, str]) -> None:
    """The largest and the smallest difference of each scene; its others lie between them."""
    drawn = []
    for scene, colour in SCENES.items():
        lines = rows[rows["scene"] == scene].pivot(
            index="dx", columns="quantity", values="difference"
        )
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
    few_ticks(axes.xaxis, np.unique(rows["dx"]))
    axes.set_ylim(0.35 * axes.get_ylim()[0], None)
    axes.legend(loc="lower right", ncols=2, columnspacing=0.8)
