"""Figure 1: the layer on its rigid substrate, both conditions at the top, and the strip that is integrated."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, Rectangle

from .style import BLUE, ORANGE, PAGE, new_figure, panel_letter

# Length of the layer shown, in thicknesses; largest displacement drawn, as a share of it.
LENGTH, DISPLACEMENT = 3.6, 0.14
TITLES = {
    "stress": r"$\Gamma = 0$: stress imposed at $y = H$",
    "displacement": r"$\Gamma = 1$: displacement held at $y = H$",
}


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Corners of layer, substrate and strip, and the displacement over y that each condition is reduced with."""
    height = float(settings["thickness"])
    strip = float(settings["strip_width"]) * height
    length = LENGTH * height
    rectangles = [
        ("layer", 0.0, 0.0, length, height),
        ("substrate", 0.0, -0.18 * height, length, 0.18 * height),
        ("strip", 0.5 * (length - strip), 0.0, strip, height),
    ]
    y = np.linspace(0.0, height, 21)
    profiles = {
        # One displacement for the whole height stands for the interface under an imposed stress; with the top held
        # it falls linearly to zero there (appendix A of the paper).
        "stress": np.full(y.size, DISPLACEMENT * length),
        "displacement": DISPLACEMENT * length * (1.0 - y / height),
    }
    parts = []
    for panel, profile in profiles.items():
        rows = pd.DataFrame(rectangles, columns=["name", "x", "y", "width", "height"])
        parts.append(rows.assign(panel=panel, role="rectangle"))
        parts.append(
            pd.DataFrame(
                {"panel": panel, "role": "profile", "x": 0.68 * length + profile, "y": y, "name": "profile"}
            )
        )
        parts.append(
            pd.DataFrame(
                {"panel": panel, "role": "rest", "x": 0.68 * length, "y": [0.0, height], "name": "rest"}
            )
        )
    return pd.concat(parts, ignore_index=True)


def plot(table: pd.DataFrame) -> Figure:
    """Two panels, one a boundary condition."""
    figure = new_figure(PAGE, 2.0)
    for axes, panel, letter in zip(figure.subplots(1, 2), TITLES, "ab", strict=True):
        draw_panel(axes, table[table["panel"] == panel], panel)
        axes.set_title(TITLES[panel], fontsize=8)
        panel_letter(axes, letter)
    return figure


def draw_panel(axes, rows: pd.DataFrame, panel: str) -> None:
    """Layer, substrate, strip, top condition, friction, displacement profile and axes."""
    boxes = rows[rows["role"] == "rectangle"].set_index("name")
    layer, strip = boxes.loc["layer"], boxes.loc["strip"]
    looks = {
        "layer": {"facecolor": "#e6edf4", "edgecolor": "black", "linewidth": 0.8},
        "substrate": {"facecolor": "0.85", "edgecolor": "0.4", "hatch": "////", "linewidth": 0.0},
        "strip": {"facecolor": "none", "edgecolor": "#c00000", "linewidth": 1.4},
    }
    for name, look in looks.items():
        box = boxes.loc[name]
        axes.add_patch(Rectangle((box["x"], box["y"]), box["width"], box["height"], gid=name, **look))
    height, length = float(layer["height"]), float(layer["width"])
    arrow = {"arrowstyle": "-|>", "mutation_scale": 8, "linewidth": 1.0, "shrinkA": 0, "shrinkB": 0}
    if panel == "stress":
        for start in np.linspace(0.04, 0.84, 5) * length:
            axes.add_patch(
                FancyArrowPatch(
                    (start, 1.09 * height), (start + 0.12 * length, 1.09 * height), color=ORANGE, **arrow
                )
            )
        axes.text(0.5 * length, 1.17 * height, r"$\tau$", color=ORANGE, ha="center", va="bottom")
    else:
        axes.add_patch(
            Rectangle(
                (0, height),
                length,
                0.14 * height,
                facecolor="0.85",
                edgecolor="0.4",
                hatch="////",
                linewidth=0.0,
            )
        )
        axes.text(
            0.5 * length,
            1.17 * height,
            r"$\partial u_x/\partial t = 0$",
            color=ORANGE,
            ha="center",
            va="bottom",
        )
    profile, rest = rows[rows["role"] == "profile"], rows[rows["role"] == "rest"]
    axes.plot(rest["x"], rest["y"], color=BLUE, linewidth=0.8, linestyle=":")
    axes.plot(profile["x"], profile["y"], color=BLUE, linewidth=1.5, gid="profile")
    axes.text(float(profile["x"].max()) + 0.03 * length, 0.5 * height, r"$u_x(y)$", color=BLUE, va="center")
    axes.text(
        strip["x"] + 0.5 * strip["width"],
        0.5 * height,
        r"$\mathrm{d}x$",
        color="#c00000",
        ha="center",
        va="center",
    )
    axes.text(0.17 * length, 0.62 * height, r"$G,\ \lambda,\ \rho$", ha="center", va="center")
    axes.text(
        0.02 * length,
        -0.25 * height,
        r"friction $f_f \leq \mu_s\sigma_n$ at rest, $\mu_k\sigma_n$ sliding",
        va="top",
    )
    axes.annotate(
        "",
        (0.09 * length, 0.0),
        (0.24 * length, 0.0),
        arrowprops={"arrowstyle": "-|>", "color": "black", "lw": 1.0},
    )
    axes.text(0.165 * length, 0.05 * height, "$f_f$", ha="center", va="bottom")
    double = {
        "arrowstyle": "<|-|>",
        "mutation_scale": 6,
        "linewidth": 0.7,
        "color": "0.2",
        "shrinkA": 0,
        "shrinkB": 0,
    }
    axes.add_patch(FancyArrowPatch((1.03 * length, 0.0), (1.03 * length, height), **double))
    axes.text(1.045 * length, 0.5 * height, "$H$", va="center")
    origin = (-0.1 * length, 0.0)
    axes.add_patch(FancyArrowPatch(origin, (origin[0] + 0.09 * length, 0.0), color="black", **arrow))
    axes.add_patch(FancyArrowPatch(origin, (origin[0], 0.34 * height), color="black", **arrow))
    axes.text(origin[0] + 0.03 * length, -0.05 * height, "$x$", va="top")
    axes.text(origin[0] - 0.015 * length, 0.3 * height, "$y$", ha="right")
    axes.set_xlim(-0.15 * length, 1.12 * length)
    axes.set_ylim(-0.5 * height, 1.42 * height)
    axes.set_aspect("equal")
    axes.set_axis_off()
