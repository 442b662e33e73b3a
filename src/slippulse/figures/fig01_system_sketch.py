"""Figure 1: the layer on its rigid substrate, both conditions at the top, and the strip that is integrated."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, Rectangle

from .style import BLACK, BLUE, COLUMN, ORANGE, new_figure, panel_letter

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {}

TITLES = {"stress": r"$\Gamma = 0$: stress imposed", "displacement": r"$\Gamma = 1$: displacement held"}
# In thicknesses: length of the layer shown, depth of what is rigid, largest displacement drawn.
LENGTH, RIGID, DISPLACEMENT = 3.5, 0.2, 0.5
# Positions along the layer, as shares of its length: moduli, strip, undisplaced line of the profile.
MODULI, STRIP, REST = 0.2, 0.48, 0.68
RED, MUTED = "#c00000", "0.25"
RECTANGLES = {
    "layer": {"facecolor": "#e6edf4", "edgecolor": BLACK, "linewidth": 0.8},
    "substrate": {"facecolor": "0.87", "edgecolor": "0.45", "hatch": "////", "linewidth": 0.0},
    "held top": {"facecolor": "0.87", "edgecolor": "0.45", "hatch": "////", "linewidth": 0.0},
    "strip": {"facecolor": RED + "22", "edgecolor": RED, "linewidth": 1.4},
}
ARROWS = {
    "imposed stress": ("-|>", ORANGE),
    "friction": ("-|>", BLACK),
    "thickness": ("<|-|>", MUTED),
    "axis": ("-|>", MUTED),
    "strip width": ("<|-|>", RED),
}
# Alignment (horizontal, vertical) and colour of a text.
TEXTS = {
    "moduli": ("center", "center", BLACK),
    "substrate": ("center", "center", BLACK),
    "top condition": ("center", "bottom", ORANGE),
    "friction": ("center", "bottom", BLACK),
    "friction law": ("center", "top", BLACK),
    "strip width": ("center", "bottom", RED),
    "profile": ("left", "center", BLUE),
    "thickness": ("left", "center", MUTED),
    "axis": ("center", "center", MUTED),
}


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Rectangles, arrows, texts and displacement profiles of both panels.

    Parameters
    ----------
    data, measured : not used
    settings : thickness H, and strip_width in units of it

    Returns
    -------
    DataFrame with panel ("stress" or "displacement"), role, name, x, y. Roles: rectangle (from x, y by width, height),
    arrow (to x_end, y_end), text (its text), profile (displacement over y), rest (the line that it starts from).

    Source: section II and appendix A of the paper.
    """
    height = float(settings["thickness"])
    strip = float(settings["strip_width"])
    parts = [shapes(panel, strip) for panel in TITLES] + [profile_rows(panel) for panel in TITLES]
    rows = pd.concat(parts, ignore_index=True)
    lengths = ["x", "y", "width", "height", "x_end", "y_end"]
    rows[lengths] *= height
    return rows


def shapes(panel: str, strip: float) -> pd.DataFrame:
    """Rectangles, arrows and texts of one panel, in thicknesses."""
    rectangles = [
        ("layer", 0.0, 0.0, LENGTH, 1.0),
        ("substrate", 0.0, -RIGID, LENGTH, RIGID),
        ("strip", STRIP * LENGTH - 0.5 * strip, 0.0, strip, 1.0),
    ]
    arrows = [
        ("friction", 0.27 * LENGTH, 0.05, 0.13 * LENGTH, 0.05),
        ("thickness", LENGTH + 0.13, 0.0, LENGTH + 0.13, 1.0),
        ("axis", -0.42, 0.0, -0.07, 0.0),
        ("axis", -0.42, 0.0, -0.42, 0.35),
    ]
    texts = [
        ("moduli", MODULI * LENGTH, 0.68, r"$G,\ \lambda,\ \rho$"),
        ("substrate", 0.5 * LENGTH, -0.5 * RIGID, "rigid substrate"),
        ("friction", MODULI * LENGTH, 0.1, "$f_f$"),
        ("friction law", 0.5 * LENGTH, -RIGID - 0.08,
         r"$y = 0$:  $f_f \leq \mu_s\sigma_n$ at rest,  $f_f = \mu_k\sigma_n$ sliding"),
        ("strip width", STRIP * LENGTH, 0.47, r"$\mathrm{d}x$"),
        ("thickness", LENGTH + 0.23, 0.5, "$H$"),
        ("thickness", LENGTH + 0.23, 1.0, "$y = H$"),
        ("thickness", LENGTH + 0.23, 0.0, "$y = 0$"),
        ("axis", -0.24, -0.13, "$x$"),
        ("axis", -0.55, 0.25, "$y$"),
    ]  # fmt: skip
    if panel == "stress":
        starts = np.linspace(0.03, 0.85, 6) * LENGTH
        arrows += [("imposed stress", x, 1.1, x + 0.12 * LENGTH, 1.1) for x in starts]
        texts += [
            ("top condition", 0.5 * LENGTH, 1.19, r"$\tau$"),
            ("profile", REST * LENGTH + DISPLACEMENT + 0.06, 0.5, r"$\langle u_x\rangle_y$"),
        ]
    else:
        rectangles += [("held top", 0.0, 1.0, LENGTH, RIGID)]
        texts += [
            ("top condition", 0.5 * LENGTH, 1.0 + RIGID + 0.03, r"$\partial u_x/\partial t = 0$"),
            ("profile", REST * LENGTH + 0.5 * DISPLACEMENT + 0.14, 0.5, "$u_x(y)$"),
        ]
    return pd.concat(
        [
            pd.DataFrame(rectangles, columns=["name", "x", "y", "width", "height"]).assign(role="rectangle"),
            pd.DataFrame(arrows, columns=["name", "x", "y", "x_end", "y_end"]).assign(role="arrow"),
            pd.DataFrame(texts, columns=["name", "x", "y", "text"]).assign(role="text"),
        ]
    ).assign(panel=panel)


def profile_rows(panel: str) -> pd.DataFrame:
    """Displacement since the start over y, as each condition is reduced with, in thicknesses.

    Under an imposed stress the mean over the height stands for the interface; with the top held the displacement falls
    linearly from the interface to the top, so that its mean is half of the slip (appendix A of the paper).
    """
    y = np.linspace(0.0, 1.0, 21)
    share = np.ones(y.size) if panel == "stress" else 1.0 - y
    profile = pd.DataFrame({"role": "profile", "x": REST * LENGTH + DISPLACEMENT * share, "y": y})
    rest = pd.DataFrame({"role": "rest", "x": REST * LENGTH, "y": [0.0, 1.0]})
    return pd.concat([profile, rest]).assign(panel=panel, name="displacement")


def plot(table: pd.DataFrame) -> Figure:
    """Two panels, one a boundary condition."""
    figure = new_figure(COLUMN, 3.4)
    for axes, panel, letter in zip(figure.subplots(2, 1), TITLES, "ab", strict=True):
        draw_panel(axes, table[table["panel"] == panel])
        axes.set_title(TITLES[panel], fontsize=9)
        panel_letter(axes, letter)
    return figure


def draw_panel(axes, rows: pd.DataFrame) -> None:
    """Everything of one boundary condition."""
    of = {role: group for role, group in rows.groupby("role", sort=False)}
    for box in of["rectangle"].itertuples():
        axes.add_patch(Rectangle((box.x, box.y), box.width, box.height, gid=box.name, **RECTANGLES[box.name]))
    for arrow in of["arrow"].itertuples():
        style, colour = ARROWS[arrow.name]
        axes.add_patch(
            FancyArrowPatch(
                (arrow.x, arrow.y), (arrow.x_end, arrow.y_end), arrowstyle=style, mutation_scale=7, color=colour,
                linewidth=1.0, shrinkA=0, shrinkB=0, gid=arrow.name,
            )
        )  # fmt: skip
    axes.plot(of["rest"]["x"], of["rest"]["y"], color=BLUE, linewidth=0.8, linestyle=":", gid="rest")
    axes.plot(of["profile"]["x"], of["profile"]["y"], color=BLUE, linewidth=1.5, gid="profile")
    for text in of["text"].itertuples():
        horizontal, vertical, colour = TEXTS[text.name]
        label = axes.text(text.x, text.y, text.text, ha=horizontal, va=vertical, color=colour)
        if text.name == "substrate":
            label.set(fontsize=8, bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0})
    layer = of["rectangle"].set_index("name").loc["layer"]
    height, length = layer["height"], layer["width"]
    axes.set_xlim(-0.65 * height, length + 0.68 * height)
    axes.set_ylim(-0.55 * height, 1.46 * height)
    axes.set_aspect("equal")
    axes.set_axis_off()
