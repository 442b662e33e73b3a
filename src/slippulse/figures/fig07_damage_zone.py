"""Figure 7: a fault with a damaged core, and the stress drop against the contrast of stiffness."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, Rectangle

from ..theory.dimensional import damage_zone_stress_drop
from .style import BLACK, BLUE, COLUMN, CYCLE, GREY, ORANGE, new_figure, panel_letter

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {}

# The sketch, in thicknesses of the zone: host rock, width, where displacements are counted from, slip and imposed
# displacement; and the ratio G/G_r that it is drawn for.
ROCK, WIDTH, ORIGIN, SLIP, IMPOSED, STIFFNESS_RATIO = 1.6, 4.2, 1.95, 1.1, 1.9, 0.2
MUTED = "0.25"
RECTANGLES = {"damage zone": "#f6d9b8", "host rock": "#d7dde4"}
ARROWS = {
    "slip": ("-|>", ORANGE),
    "imposed": ("-|>", BLACK),
    "thickness": ("<|-|>", MUTED),
    "axis": ("-|>", MUTED),
}
LINES = {
    "before": {"color": GREY, "linewidth": 1.2, "linestyle": "--"},
    "after": {"color": BLUE, "linewidth": 1.6},
    "origin": {"color": MUTED, "linewidth": 0.7, "linestyle": ":"},
    "fault": {"color": BLACK, "linewidth": 1.8},
    "interface": {"color": MUTED, "linewidth": 0.7},
    "far boundary": {"color": BLACK, "linewidth": 1.0},
}
# Alignment (horizontal, vertical) and colour of a text.
TEXTS = {
    "damage zone": ("left", "center", BLACK),
    "host rock": ("left", "center", BLACK),
    "slip": ("center", "top", ORANGE),
    "imposed": ("center", "bottom", BLACK),
    "before": ("right", "center", GREY),
    "after": ("left", "center", BLUE),
    "change": ("center", "center", BLUE),
    "thickness": ("left", "center", MUTED),
    "height": ("right", "center", MUTED),
    "axis": ("left", "center", MUTED),
}


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Stress drop over G delta/H for each thickness ratio, its limit, and the sketch.

    Parameters
    ----------
    data, measured : not used
    settings : stiffness_ratios (from, to, count; G/G_r) and thickness_ratios (H_r/H)

    Returns
    -------
    DataFrame with panel ("sketch" or "stress_drop"), role, name, x, y. Roles of the sketch: rectangle (from x, y by
    width, height), line, arrow (to x_end, y_end), text (its text), in thicknesses of the damage zone. Roles of the
    other: curve (by thickness_ratio) and limit, x = G/G_r, y the normalised stress drop.

    Source: section IV C 2 of the paper.
    """
    span = settings["stiffness_ratios"]
    ratios = np.geomspace(span["from"], span["to"], int(span["count"]))
    curves = [
        pd.DataFrame({"role": "curve", "x": ratios, "y": normalised(ratios, 1.0, thickness)}).assign(
            thickness_ratio=float(thickness)
        )
        for thickness in settings["thickness_ratios"]
    ]
    # Rock that does not yield at all: the displacement is imposed at y = H.
    ends = ratios[[0, -1]]
    limit = pd.DataFrame({"role": "limit", "x": ends, "y": normalised(ends, np.inf, 1.0)})
    return pd.concat(
        [sketch_rows(), *(part.assign(panel="stress_drop") for part in (*curves, limit))], ignore_index=True
    )


def normalised(shear_modulus, rock_shear_modulus, thickness_ratio):
    """Stress drop over G delta/H, for unit slip and a zone of unit thickness."""
    return (
        damage_zone_stress_drop(1.0, shear_modulus, rock_shear_modulus, 1.0, thickness_ratio) / shear_modulus
    )


def displacement(slip: float) -> np.ndarray:
    """Displacement at y = 0, H and H + H_r of the sketch: one stress, so strains in inverse ratio of the moduli."""
    stress = float(damage_zone_stress_drop(IMPOSED - slip, 1.0, 1.0 / STIFFNESS_RATIO, 1.0, ROCK))
    return slip + stress * np.array([0.0, 1.0, 1.0 + STIFFNESS_RATIO * ROCK])


def sketch_rows() -> pd.DataFrame:
    """Zone and rock, what is imposed, and the displacement over y before and after slip."""
    top = 1.0 + ROCK
    before, after = displacement(0.0), displacement(SLIP)
    rectangles = [("damage zone", 0.0, 0.0, WIDTH, 1.0), ("host rock", 0.0, 1.0, WIDTH, ROCK)]
    lines = [
        ("interface", [0.0, WIDTH], [1.0, 1.0]),
        ("far boundary", [0.0, WIDTH], [top, top]),
        ("fault", [0.0, WIDTH], [0.0, 0.0]),
        ("origin", [ORIGIN, ORIGIN], [0.0, top]),
        ("before", ORIGIN + before, [0.0, 1.0, top]),
        ("after", ORIGIN + after, [0.0, 1.0, top]),
    ]
    arrows = [
        ("slip", ORIGIN, -0.14, ORIGIN + SLIP, -0.14),
        ("imposed", ORIGIN, top + 0.14, ORIGIN + IMPOSED, top + 0.14),
        ("thickness", WIDTH + 0.16, 0.0, WIDTH + 0.16, 1.0),
        ("thickness", WIDTH + 0.16, 1.0, WIDTH + 0.16, top),
        ("axis", -0.12, 0.0, -0.12, top + 0.35),
    ]
    texts = [
        ("damage zone", 0.12, 0.5, "damage zone\n$G$"),
        ("host rock", 0.12, 1.0 + 0.5 * ROCK, "host rock\n$G_r > G$"),
        ("slip", ORIGIN + 0.5 * SLIP, -0.22, r"slip $\delta$"),
        ("imposed", ORIGIN + 0.5 * IMPOSED, top + 0.2, r"imposed $\hat u$"),
        ("before", ORIGIN + np.interp(1.5, [1.0, top], before[1:]) - 0.12, 1.5, "before"),
        ("after", ORIGIN + np.interp(0.4, [0.0, 1.0], after[:2]) + 0.1, 0.4, "after"),
        ("change", ORIGIN + 0.5 * SLIP, 0.15, "change"),
        ("thickness", WIDTH + 0.26, 0.5, "$H$"),
        ("thickness", WIDTH + 0.26, 1.0 + 0.5 * ROCK, "$H_r$"),
        ("height", -0.2, 0.0, "fault  $0$"),
        ("height", -0.2, 1.0, "$H$"),
        ("height", -0.2, top, "$H + H_r$"),
        ("axis", -0.04, top + 0.32, "$y$"),
    ]
    return pd.concat(
        [
            pd.DataFrame(rectangles, columns=["name", "x", "y", "width", "height"]).assign(role="rectangle"),
            *(pd.DataFrame({"name": name, "x": x, "y": y, "role": "line"}) for name, x, y in lines),
            pd.DataFrame(arrows, columns=["name", "x", "y", "x_end", "y_end"]).assign(role="arrow"),
            pd.DataFrame(texts, columns=["name", "x", "y", "text"]).assign(role="text"),
        ]
    ).assign(panel="sketch")


def plot(table: pd.DataFrame) -> Figure:
    """Above: the schematic. Below: stress drop against G/G_r."""
    figure = new_figure(COLUMN, 4.6)
    above, below = figure.subplots(2, 1, height_ratios=[1.15, 1.0])
    draw_sketch(above, table[table["panel"] == "sketch"])
    draw_stress_drop(below, table[table["panel"] == "stress_drop"])
    panel_letter(above, "a")
    panel_letter(below, "b")
    return figure


def draw_sketch(axes, rows: pd.DataFrame) -> None:
    """Damage zone under host rock, the far displacement, the slip and the displacement over y."""
    of = {role: group for role, group in rows.groupby("role", sort=False)}
    for box in of["rectangle"].itertuples():
        look = {"facecolor": RECTANGLES[box.name], "edgecolor": "none"}
        axes.add_patch(Rectangle((box.x, box.y), box.width, box.height, gid=box.name, **look))
    for name, line in of["line"].groupby("name", sort=False):
        axes.plot(line["x"], line["y"], gid=name, **LINES[name])
    change = {name: line.sort_values("y") for name, line in of["line"].groupby("name")}
    axes.fill_betweenx(
        change["after"]["y"], change["before"]["x"], change["after"]["x"], color=BLUE, alpha=0.18, linewidth=0.0,
        gid="change",
    )  # fmt: skip
    for arrow in of["arrow"].itertuples():
        style, colour = ARROWS[arrow.name]
        axes.add_patch(
            FancyArrowPatch(
                (arrow.x, arrow.y), (arrow.x_end, arrow.y_end), arrowstyle=style, mutation_scale=7, color=colour,
                linewidth=1.0, shrinkA=0, shrinkB=0, gid=arrow.name,
            )
        )  # fmt: skip
    for text in of["text"].itertuples():
        horizontal, vertical, colour = TEXTS[text.name]
        axes.text(text.x, text.y, text.text, ha=horizontal, va=vertical, color=colour)
    boxes = of["rectangle"]
    top, right = float((boxes["y"] + boxes["height"]).max()), float(boxes["width"].max())
    axes.set_xlim(-1.0, right + 0.65)
    axes.set_ylim(-0.55, top + 0.55)
    axes.set_aspect("equal")
    axes.set_axis_off()


def draw_stress_drop(axes, rows: pd.DataFrame) -> None:
    """One curve a thickness ratio, and the limit of rock that does not yield."""
    curves = rows[rows["role"] == "curve"]
    for colour, (thickness, curve) in zip(CYCLE, curves.groupby("thickness_ratio"), strict=False):
        axes.plot(curve["x"], curve["y"], color=colour, label=rf"$H_r/H = {thickness:g}$", gid="curve")
    limit = rows[rows["role"] == "limit"]
    axes.plot(
        limit["x"], limit["y"], color=BLACK, linestyle="--", linewidth=0.8,
        label=r"$G \ll G_r$: imposed at $y = H$", gid="limit",
    )  # fmt: skip
    axes.set_xscale("log")
    axes.set_xlim(limit["x"].min(), limit["x"].max())
    axes.set_ylim(0.0, 1.08)
    axes.set_xlabel("ratio of shear moduli $G/G_r$")
    axes.set_ylabel(r"stress drop $\Delta\tau\,/\,(G\delta/H)$")
    axes.legend(loc="lower left")
