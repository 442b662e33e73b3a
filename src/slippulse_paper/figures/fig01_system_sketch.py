"""Figure 1: the layer on a rigid substrate, both boundary conditions, the strip of the model."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from slippulse.plotting.style import BLACK, BLUE, COLUMN_WIDTH, ORANGE, Look, new_panels

from .shared.sketch import BOTH, MUTED, arrow, label

NEEDS = {"data": ()}

TITLES = {
    "stress": r"$\Gamma = 0$: stress imposed",
    "displacement": r"$\Gamma = 1$: displacement held",
}
# In thicknesses: length of the layer, depth of the rigid parts, largest displacement drawn.
LENGTH, RIGID = 3.5, 0.2
DISPLACEMENT = 0.5
# Position of the strip, and of displacement 0.
STRIP, REST = 1.68, 2.38
RED = "#c00000"
HATCHED: Look = {"facecolor": "0.87", "edgecolor": "0.45", "hatch": "////", "linewidth": 0.0}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Displacement over the height, and the strip's width (section II, appendix A of the paper)."""
    # Under an imposed stress the mean over the height stands for the interface. With the top held
    # the displacement falls linearly to 0, so that its mean is half of the slip.
    panels = ["stress", "stress", "displacement", "displacement"]
    displacement = [DISPLACEMENT, DISPLACEMENT, DISPLACEMENT, 0.0]
    rows = pd.DataFrame({"panel": panels, "y": [0.0, 1.0] * 2, "displacement": displacement})
    return rows.assign(strip_width=settings["strip_width"])


def draw(table: pd.DataFrame) -> Figure:
    """Draw two panels, one a boundary condition: layer, substrate, strip, friction, and axes."""
    figure, panels = new_panels(COLUMN_WIDTH, 3.4, "a;b")
    strip = table["strip_width"].iloc[0]
    box: Look = {"facecolor": "#e6edf4", "edgecolor": BLACK, "linewidth": 0.8}
    cut: Look = {"facecolor": RED + "22", "edgecolor": RED, "linewidth": 1.4, "gid": "strip"}
    law = r"$y = 0$:  $f_f \leq \mu_s\sigma_n$ at rest,  $f_f = \mu_k\sigma_n$ sliding"
    for axes, panel in zip(panels, TITLES, strict=True):
        axes.add_patch(Rectangle((0.0, -RIGID), LENGTH, RIGID, **HATCHED))
        axes.add_patch(Rectangle((0.0, 0.0), LENGTH, 1.0, **box))
        axes.add_patch(Rectangle((STRIP - 0.5 * strip, 0.0), strip, 1.0, **cut))
        label(axes, STRIP, 0.47, r"$\mathrm{d}x$", RED, va="bottom")
        label(axes, 0.7, 0.68, r"$G,\ \lambda,\ \rho$", ha="center")
        white = {"facecolor": "white", "edgecolor": "none", "pad": 0.3}
        label(axes, 0.5 * LENGTH, -0.5 * RIGID, "rigid substrate", fontsize=8, bbox=white)
        arrow(axes, (0.27 * LENGTH, 0.05), (0.13 * LENGTH, 0.05), BLACK, gid="friction")
        label(axes, 0.7, 0.1, "$f_f$", va="bottom")
        label(axes, 0.5 * LENGTH, -RIGID - 0.08, law, va="top")
        arrow(axes, (LENGTH + 0.13, 0.0), (LENGTH + 0.13, 1.0), MUTED, **BOTH)
        for y, text in ((0.0, "$y = 0$"), (0.5, "$H$"), (1.0, "$y = H$")):
            label(axes, LENGTH + 0.23, y, text, MUTED, ha="left")
        arrow(axes, (-0.42, 0.0), (-0.07, 0.0), MUTED)
        arrow(axes, (-0.42, 0.0), (-0.42, 0.35), MUTED)
        label(axes, -0.24, -0.13, "$x$", MUTED)
        label(axes, -0.55, 0.25, "$y$", MUTED)
        if panel == "stress":
            for x in np.linspace(0.03, 0.85, 6) * LENGTH:
                arrow(axes, (x, 1.1), (x + 0.12 * LENGTH, 1.1), ORANGE, gid="imposed stress")
            label(axes, 0.5 * LENGTH, 1.19, r"$\tau$", ORANGE, va="bottom")
            label(axes, REST + DISPLACEMENT + 0.06, 0.5, r"$\langle u_x\rangle_y$", BLUE, ha="left")
        else:
            axes.add_patch(Rectangle((0.0, 1.0), LENGTH, RIGID, gid="held top", **HATCHED))
            held = r"$\partial u_x/\partial t = 0$"
            label(axes, 0.5 * LENGTH, 1.03 + RIGID, held, ORANGE, va="bottom")
            label(axes, REST + 0.5 * DISPLACEMENT + 0.14, 0.5, "$u_x(y)$", BLUE, ha="left")
        rows = table[table["panel"] == panel]
        axes.plot([REST, REST], [0.0, 1.0], color=BLUE, linewidth=0.8, linestyle=":")
        x = REST + rows["displacement"]
        axes.plot(x, rows["y"], color=BLUE, linewidth=1.5, gid="displacement")
        axes.set_title(TITLES[panel], loc="center")
        axes.set(xlim=(-0.65, LENGTH + 0.68), ylim=(-0.55, 1.46), aspect="equal")
        axes.set_axis_off()
    return figure
