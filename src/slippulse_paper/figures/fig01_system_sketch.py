"""Figure 1: the layer on a rigid substrate, under both boundary conditions.

The sketch also shows a vertical strip of the layer, over which the model integrates.
"""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from slippulse.plotting.style import BLACK, BLUE, COLUMN_WIDTH, ORANGE, Look, new_panels

from .shared.sketch import MUTED_GREY, TWO_HEADS, arrow, label

NEEDS = {"data": ()}

TITLES = {
    "stress": r"$\Gamma = 0$: stress imposed",
    "displacement": r"$\Gamma = 1$: displacement held",
}
# Length of the layer, depth of the rigid parts and largest displacement, in layer thicknesses.
LAYER_LENGTH, RIGID_DEPTH = 3.5, 0.2
MAX_DISPLACEMENT = 0.5
# Horizontal positions of the strip and of zero displacement, in layer thicknesses.
STRIP_CENTRE, ZERO_DISPLACEMENT = 1.68, 2.38
RED = "#c00000"
HATCHED_LOOK: Look = {"facecolor": "0.87", "edgecolor": "0.45", "hatch": "////", "linewidth": 0.0}


def table(data: dict, tables: dict[str, pd.DataFrame], settings: dict) -> pd.DataFrame:
    """Return the displacement u_x as a function of the height y, and the width of the strip.

    The heights are in layer thicknesses: 0 at the bottom of the layer and 1 at its top.

    Source: section II and appendix A of the paper.
    """
    # If the stress is imposed, the model has only the mean displacement over the height, which is
    # drawn at all heights. If the top is held, the displacement falls linearly from the slip at the
    # bottom to 0 at the top.
    panels = ["stress", "stress", "displacement", "displacement"]
    displacement = [MAX_DISPLACEMENT, MAX_DISPLACEMENT, MAX_DISPLACEMENT, 0.0]
    rows = pd.DataFrame({"panel": panels, "y": [0.0, 1.0] * 2, "displacement": displacement})
    return rows.assign(strip_width=settings["strip_width"])


def draw(table: pd.DataFrame) -> Figure:
    """Draw one panel for each boundary condition: layer, substrate, strip, friction and axes."""
    figure, panels = new_panels(COLUMN_WIDTH, 3.4, "a;b")
    zero_line: Look = {"color": BLUE, "linewidth": 0.8, "linestyle": ":"}
    for axes, panel in zip(panels, TITLES, strict=True):
        _draw_layer(axes, table["strip_width"].iloc[0])
        _draw_top(axes, panel)
        rows = table[table["panel"] == panel]
        axes.plot([ZERO_DISPLACEMENT] * 2, [0.0, 1.0], **zero_line)
        x = ZERO_DISPLACEMENT + rows["displacement"]
        axes.plot(x, rows["y"], color=BLUE, linewidth=1.5, gid="displacement")
        axes.set_title(TITLES[panel], loc="center")
        axes.set(xlim=(-0.65, LAYER_LENGTH + 0.68), ylim=(-0.55, 1.46), aspect="equal")
        axes.set_axis_off()
    return figure


def _draw_layer(axes: Axes, strip_width: float) -> None:
    """Draw the layer on its substrate, the strip, and the friction at the bottom of the layer.

    Positions are in layer thicknesses, with y = 0 at the bottom of the layer.
    """
    middle = 0.5 * LAYER_LENGTH
    layer_look: Look = {"facecolor": "#e6edf4", "edgecolor": BLACK, "linewidth": 0.8}
    # The digits 22 are the opacity of the face.
    strip_look: Look = {"facecolor": RED + "22", "edgecolor": RED, "linewidth": 1.4, "gid": "strip"}
    axes.add_patch(Rectangle((0.0, -RIGID_DEPTH), LAYER_LENGTH, RIGID_DEPTH, **HATCHED_LOOK))
    axes.add_patch(Rectangle((0.0, 0.0), LAYER_LENGTH, 1.0, **layer_look))
    strip_begin = STRIP_CENTRE - 0.5 * strip_width
    axes.add_patch(Rectangle((strip_begin, 0.0), strip_width, 1.0, **strip_look))
    label(axes, STRIP_CENTRE, 0.47, r"$\mathrm{d}x$", RED, va="bottom")
    label(axes, 0.7, 0.68, r"$G,\ \lambda,\ \rho$", ha="center")
    white = {"facecolor": "white", "edgecolor": "none", "pad": 0.3}
    label(axes, middle, -0.5 * RIGID_DEPTH, "rigid substrate", fontsize=8, bbox=white)
    arrow(axes, (0.27 * LAYER_LENGTH, 0.05), (0.13 * LAYER_LENGTH, 0.05), BLACK, gid="friction")
    label(axes, 0.7, 0.1, "$f_f$", va="bottom")
    law = r"$y = 0$:  $f_f \leq \mu_s\sigma_n$ at rest,  $f_f = \mu_k\sigma_n$ sliding"
    label(axes, middle, -RIGID_DEPTH - 0.08, law, va="top")
    _draw_height_and_axes(axes)


def _draw_height_and_axes(axes: Axes) -> None:
    """Draw the height of the layer to its right, and arrows for the axes x and y to its left."""
    right = LAYER_LENGTH + 0.13
    arrow(axes, (right, 0.0), (right, 1.0), MUTED_GREY, **TWO_HEADS)
    for y, text in ((0.0, "$y = 0$"), (0.5, "$H$"), (1.0, "$y = H$")):
        label(axes, LAYER_LENGTH + 0.23, y, text, MUTED_GREY, ha="left")
    origin = (-0.42, 0.0)
    arrow(axes, origin, (-0.07, 0.0), MUTED_GREY)
    arrow(axes, origin, (-0.42, 0.35), MUTED_GREY)
    label(axes, -0.24, -0.13, "$x$", MUTED_GREY)
    label(axes, -0.55, 0.25, "$y$", MUTED_GREY)


def _draw_top(axes: Axes, panel: str) -> None:
    """Draw the boundary condition on top of the layer, and the symbol of the displacement."""
    middle = 0.5 * LAYER_LENGTH
    if panel == "stress":
        for x in np.linspace(0.03, 0.85, 6) * LAYER_LENGTH:
            arrow(axes, (x, 1.1), (x + 0.12 * LAYER_LENGTH, 1.1), ORANGE, gid="imposed stress")
        label(axes, middle, 1.19, r"$\tau$", ORANGE, va="bottom")
        x = ZERO_DISPLACEMENT + MAX_DISPLACEMENT + 0.06
        label(axes, x, 0.5, r"$\langle u_x\rangle_y$", BLUE, ha="left")
    else:
        look = HATCHED_LOOK | {"gid": "held top"}
        axes.add_patch(Rectangle((0.0, 1.0), LAYER_LENGTH, RIGID_DEPTH, **look))
        held = r"$\partial u_x/\partial t = 0$"
        label(axes, middle, 1.03 + RIGID_DEPTH, held, ORANGE, va="bottom")
        x = ZERO_DISPLACEMENT + 0.5 * MAX_DISPLACEMENT + 0.14
        label(axes, x, 0.5, "$u_x(y)$", BLUE, ha="left")
