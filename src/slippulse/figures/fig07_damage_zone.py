"""Figure 7: a fault with a damaged core, and the stress drop against the contrast of stiffness."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, Rectangle

from ..theory.dimensional import damage_zone_stress_drop
from .style import CYCLE, PAGE, new_figure, panel_letter

# The sketch: thickness of zone and rock, their stiffness ratio, and the slip, all in units of the zone's thickness.
SKETCH = {"zone": 1.0, "rock": 1.6, "stiffness_ratio": 0.15, "slip": 1.0, "width": 4.0}


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Stress drop over G delta/H for each thickness ratio, its limit, and the geometry of the sketch."""
    span = settings["stiffness_ratios"]
    ratios = np.geomspace(span["from"], span["to"], span["count"])
    parts = [sketch_rows()]
    for thickness in settings["thickness_ratios"]:
        drop = damage_zone_stress_drop(1.0, ratios, 1.0, 1.0, thickness) / ratios
        parts.append(
            pd.DataFrame({"role": "curve", "x": ratios, "y": drop}).assign(thickness_ratio=float(thickness))
        )
    parts.append(pd.DataFrame({"role": "limit", "x": ratios[[0, -1]], "y": [1.0, 1.0]}))
    return pd.concat(parts, ignore_index=True)


def sketch_rows() -> pd.DataFrame:
    """Change of displacement across zone and rock after slip: strains in inverse ratio of the moduli."""
    zone, rock, ratio = SKETCH["zone"], SKETCH["rock"], SKETCH["stiffness_ratio"]
    strain = float(damage_zone_stress_drop(SKETCH["slip"], 1.0, 1.0 / ratio, zone, rock))
    y = np.array([0.0, zone, zone + rock])
    change = SKETCH["slip"] - np.array([0.0, strain * zone, strain * (zone + ratio * rock)])
    return pd.DataFrame({"role": "profile", "x": change, "y": y})


def plot(table: pd.DataFrame) -> Figure:
    """Left: the schematic. Right: stress drop against G/G_r."""
    figure = new_figure(PAGE, 2.9)
    left, right = figure.subplots(1, 2, width_ratios=[1.05, 1.0])
    draw_sketch(left, table[table["role"] == "profile"])
    for colour, (thickness, rows) in zip(
        CYCLE, table[table["role"] == "curve"].groupby("thickness_ratio"), strict=False
    ):
        right.plot(rows["x"], rows["y"], color=colour, label=rf"$H_r/H = {thickness:g}$", gid="curve")
    limit = table[table["role"] == "limit"]
    right.plot(
        limit["x"],
        limit["y"],
        color="black",
        linestyle="--",
        linewidth=0.8,
        label=r"$G \ll G_r$",
        gid="limit",
    )
    right.set_xscale("log")
    right.set_xlabel(r"$G/G_r$")
    right.set_ylabel(r"stress drop $\Delta\tau\,/\,(G\delta/H)$")
    right.set_ylim(0.0, 1.08)
    right.legend(loc="lower left")
    panel_letter(left, "a")
    panel_letter(right, "b")
    return figure


def draw_sketch(axes, profile: pd.DataFrame) -> None:
    """Damage zone under host rock, the far displacement, the slip and the change of displacement over y."""
    y = profile["y"].to_numpy()
    zone, top, width = y[1], y[2], SKETCH["width"]
    axes.add_patch(Rectangle((0, 0), width, zone, facecolor="#f6d9b8", edgecolor="none", gid="zone"))
    axes.add_patch(Rectangle((0, zone), width, top - zone, facecolor="#d7dde4", edgecolor="none", gid="rock"))
    axes.plot([0, width], [0, 0], color="black", linewidth=1.6)
    axes.plot([0, width], [zone, zone], color="0.35", linewidth=0.8, linestyle="--")
    axes.plot([0, width], [top, top], color="black", linewidth=0.8)
    origin = 0.62 * width
    axes.plot(origin + profile["x"], y, color=CYCLE[0], linewidth=1.6, gid="profile")
    axes.plot([origin, origin], [0, top], color=CYCLE[0], linewidth=0.7, linestyle=":")
    arrow = {
        "arrowstyle": "-|>",
        "mutation_scale": 8,
        "linewidth": 1.0,
        "color": CYCLE[1],
        "shrinkA": 0,
        "shrinkB": 0,
    }
    axes.add_patch(FancyArrowPatch((origin, -0.12), (origin + profile["x"].iloc[0], -0.12), **arrow))
    axes.text(
        origin + 0.5 * profile["x"].iloc[0], -0.2, r"slip $\delta$", ha="center", va="top", color=CYCLE[1]
    )
    for start in (0.15, 0.45):
        axes.add_patch(
            FancyArrowPatch(
                (start * width, top + 0.15), ((start + 0.2) * width, top + 0.15), **arrow | {"color": "black"}
            )
        )
    axes.text(0.72 * width, top + 0.15, r"imposed $\hat u$", va="center")
    axes.text(0.05 * width, 0.5 * zone, r"damage zone $G$", va="center")
    axes.text(0.05 * width, zone + 0.5 * (top - zone), r"host rock $G_r > G$", va="center")
    double = {
        "arrowstyle": "<|-|>",
        "mutation_scale": 6,
        "linewidth": 0.7,
        "color": "0.2",
        "shrinkA": 0,
        "shrinkB": 0,
    }
    for low, high, name in ((0.0, zone, "$H$"), (zone, top, "$H_r$")):
        axes.add_patch(FancyArrowPatch((width + 0.15, low), (width + 0.15, high), **double))
        axes.text(width + 0.25, 0.5 * (low + high), name, va="center")
    axes.text(0.05 * width, -0.2, r"fault, $y = 0$", va="top")
    axes.set_xlim(-0.1, width + 0.75)
    axes.set_ylim(-0.6, top + 0.4)
    axes.set_aspect("equal")
    axes.set_axis_off()
