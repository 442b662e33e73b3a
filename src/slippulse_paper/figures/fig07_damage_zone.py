"""Figure 7: a fault with a damage zone, and its stress drop as a function of the stiffness ratio.

The damage zone is a layer of thickness H and shear modulus G between the fault and stiffer host
rock, which has the thickness H_r and the shear modulus G_r.
"""

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from slippulse.plotting.style import (
    BLACK,
    BLUE,
    COLUMN_WIDTH,
    GREY,
    ORANGE,
    Look,
    as_given,
    new_panels,
)

from .shared.sketch import MUTED_GREY, TWO_HEADS, arrow, label

NEEDS = {"studies": ["damage_zone"]}
table = as_given

# Width of the sketch and horizontal position of zero displacement, in thicknesses of the damage
# zone.
SKETCH_WIDTH, ZERO_DISPLACEMENT = 4.2, 1.95


def draw(table: pd.DataFrame) -> Figure:
    """Draw the sketch of the fault, and below it the stress drop as a function of G/G_r."""
    figure, (sketch_axes, curve_axes) = new_panels(
        COLUMN_WIDTH, 4.1, "a;b", height_ratios=[1.0, 1.1]
    )
    draw_sketch(sketch_axes, table[table["role"] == "before"], table[table["role"] == "after"])
    draw_curves(curve_axes, table[table["role"] == "curve"])
    return figure


def draw_curves(axes: Axes, curves: pd.DataFrame) -> None:
    """Draw the stress drop for each thickness of the host rock, with a label at the right end.

    A dashed line shows the limit of rigid host rock, with which the displacement is imposed at the
    top of the damage zone (y = H).
    """
    groups = curves.groupby("thickness_ratio")
    colours = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.64, groups.ngroups))
    for colour, (thickness, curve) in zip(colours, groups, strict=True):
        name = rf"$H_r/H = {thickness:g}$"
        x, y = curve["stiffness_ratio"], curve["stress_drop"]
        axes.plot(x, y, color=colour, label=name, gid="curve")
        axes.text(1.1 * x.iloc[-1], y.iloc[-1], name, color=colour, va="center")
    limit = r"$G \ll G_r$: imposed at $y = H$"
    line = axes.axhline(1.0, color=BLACK, linestyle="--", linewidth=0.8, label=limit, gid="limit")
    ends = curves["stiffness_ratio"].agg(["min", "max"])
    axes.set(xscale="log", xlim=tuple(ends), xlabel="ratio of shear moduli $G/G_r$")
    axes.set(ylim=(0.0, 1.08), ylabel=r"stress drop $\Delta\tau\,/\,(G\delta/H)$")
    axes.legend(handles=[line], loc="lower left")


def draw_sketch(axes: Axes, before: pd.DataFrame, after: pd.DataFrame) -> None:
    """Draw the damage zone under host rock, and the displacement as a function of height.

    before, after : displacement before and after slip, from the fault (y = 0) upwards
    """
    top = float(after["y"].max())
    draw_layers(axes, top)
    x_before = ZERO_DISPLACEMENT + before["displacement"]
    x_after = ZERO_DISPLACEMENT + after["displacement"]
    axes.plot(x_before, before["y"], color=GREY, linewidth=1.2, linestyle="--", gid="before")
    axes.plot(x_after, after["y"], color=BLUE, linewidth=1.6, gid="after")
    axes.fill_betweenx(after["y"], x_before, x_after, color=BLUE, alpha=0.18, linewidth=0.0)
    slip = float(after["displacement"].iloc[0] - before["displacement"].iloc[0])
    imposed = float(after["displacement"].iloc[-1])
    # An arrow below the layers shows the slip, and one above them the imposed displacement.
    arrow(axes, (ZERO_DISPLACEMENT, -0.14), (ZERO_DISPLACEMENT + slip, -0.14), ORANGE)
    arrow(axes, (ZERO_DISPLACEMENT, top + 0.14), (ZERO_DISPLACEMENT + imposed, top + 0.14), BLACK)
    draw_dimensions(axes, top)
    label_displacements(axes, top, slip, imposed)
    axes.set(xlim=(-1.0, SKETCH_WIDTH + 0.65), ylim=(-0.55, top + 0.55), aspect="equal")
    axes.set_axis_off()


def draw_layers(axes: Axes, top: float) -> None:
    """Draw the damage zone, the host rock above it, and the line of zero displacement.

    top : height of the upper end of the host rock
    """
    axes.add_patch(Rectangle((0.0, 0.0), SKETCH_WIDTH, 1.0, facecolor="#f6d9b8"))
    axes.add_patch(Rectangle((0.0, 1.0), SKETCH_WIDTH, top - 1.0, facecolor="#d7dde4"))
    for y, linewidth in ((0.0, 1.8), (1.0, 0.7), (top, 1.0)):
        axes.plot([0.0, SKETCH_WIDTH], [y, y], color=BLACK, linewidth=linewidth)
    look: Look = {"color": MUTED_GREY, "linewidth": 0.7, "linestyle": ":"}
    axes.plot([ZERO_DISPLACEMENT, ZERO_DISPLACEMENT], [0.0, top], **look)
    label(axes, 0.12, 0.5, "damage zone\n$G$", ha="left")
    label(axes, 0.12, 0.5 + 0.5 * top, "host rock\n$G_r > G$", ha="left")


def draw_dimensions(axes: Axes, top: float) -> None:
    """Draw the thicknesses of both layers on the right, and the axis of heights y on the left."""
    right = SKETCH_WIDTH + 0.16
    arrow(axes, (right, 0.0), (right, 1.0), MUTED_GREY, **TWO_HEADS)
    arrow(axes, (right, 1.0), (right, top), MUTED_GREY, **TWO_HEADS)
    label(axes, SKETCH_WIDTH + 0.26, 0.5, "$H$", MUTED_GREY, ha="left")
    label(axes, SKETCH_WIDTH + 0.26, 0.5 + 0.5 * top, "$H_r$", MUTED_GREY, ha="left")
    arrow(axes, (-0.12, 0.0), (-0.12, top + 0.35), MUTED_GREY)
    for y, text in ((0.0, "fault  $0$"), (1.0, "$H$"), (top, "$H + H_r$")):
        label(axes, -0.2, y, text, MUTED_GREY, ha="right")
    label(axes, -0.04, top + 0.32, "$y$", MUTED_GREY, ha="left")


def label_displacements(axes: Axes, top: float, slip: float, imposed: float) -> None:
    """Write names beside the arrows of slip and imposed displacement, and beside the curves.

    The curves are the displacement before and after slip. Lengths are in thicknesses of the damage
    zone.

    top : height of the upper end of the host rock
    slip, imposed : lengths of the arrows below the damage zone and above the host rock
    """
    zero = ZERO_DISPLACEMENT
    label(axes, zero + 0.5 * slip, -0.22, r"slip $\delta$", ORANGE, va="top")
    label(axes, zero + 0.5 * imposed, top + 0.2, r"imposed $\hat u$", va="bottom")
    label(axes, zero + 1.45, 1.5, "before", "0.35", ha="right")
    label(axes, zero + 1.45, 0.4, "after", BLUE, ha="left")
    # The shaded area between both curves is the change of the displacement.
    label(axes, zero + 0.61 * slip, 0.15, "change", BLUE, fontsize=7.0)
