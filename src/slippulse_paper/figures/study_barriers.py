"""The depth to which a steady pulse enters negative pre-stress: exact, on lattices, estimated.

The pulse comes from the level tau_0 > 0 and enters a barrier of the level tau_b < 0. Exact depths
are proportional to gamma^(-1/2), so all depths are scaled to one gamma.
"""

from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure
from scipy.interpolate import barycentric_interpolate

from slippulse.plotting import style
from slippulse.plotting.style import (
    BLACK,
    MARKERS,
    OPEN_MARKER,
    PAGE_WIDTH,
    SMALL_TEXT,
    Look,
    conditions,
    few_ticks,
)

NEEDS = {"studies": ["barriers"]}

# The interpolated map: points along each axis, number of colour bands, and depths of its contours.
MAP_POINTS, COLOUR_BANDS = 41, 33
CONTOUR_DEPTHS = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 11.0)
# Elasticity ratio gamma to which the curves are scaled, and levels tau_0 of the curves.
CURVE_GAMMA = 0.65
CURVE_LEVELS = (0.2, 0.5, 0.8)


def table(data: dict, tables: dict[str, pd.DataFrame], settings: dict) -> pd.DataFrame:
    """Return the rows of three parts of the figure, which the column part names.

    depth : depths on lattices (column measured) and exact ones, as in the study
    fine : exact depths at gamma = 1, interpolated to a finer map
    curve : exact depths and the authors' later estimate (column paper), interpolated to the levels
        CURVE_LEVELS, at CURVE_GAMMA
    """
    study = tables["barriers"]
    parts = [study[study["part"] == "depth"]]
    for ratio, rows in study[study["part"] == "map"].groupby("damping_ratio"):
        levels = np.linspace(rows["tau0"].min(), rows["tau0"].max(), MAP_POINTS)
        fine = _interpolate_depths(rows, ["exact"], levels)
        curve = _interpolate_depths(rows, ["exact", "paper"], np.array(CURVE_LEVELS))
        # The study has depths at gamma = 1. Exact depths are proportional to gamma^(-1/2), and the
        # estimate to gamma^(-1).
        curve["exact"] /= CURVE_GAMMA**0.5
        curve["paper"] /= CURVE_GAMMA
        parts.append(fine.assign(part="fine", gamma=1.0, damping_ratio=ratio))
        parts.append(curve.assign(part="curve", gamma=CURVE_GAMMA, damping_ratio=ratio))
    return pd.concat(parts, ignore_index=True)


def _interpolate_depths(
    rows: pd.DataFrame, depth_columns: list[str], levels: np.ndarray
) -> pd.DataFrame:
    """Interpolate depths between the levels tau_0 and the barriers tau_b of the study.

    The result has one row for each level in ``levels`` and each of MAP_POINTS barriers, which are
    evenly spaced in the logarithm.

    rows : depths of the study, on a grid of levels (column tau0) and barriers (column barrier)
    depth_columns : columns to interpolate
    levels : levels tau_0 of the result
    """
    # A polynomial is fitted to the logarithm of the depth, which is nearly linear in tau_0 and in
    # log |tau_b|.
    study_levels = np.sort(rows["tau0"].unique())
    study_log_barriers = np.sort(np.log(-rows["barrier"].unique()))
    log_barriers = np.linspace(study_log_barriers[0], study_log_barriers[-1], MAP_POINTS)
    pairs = pd.MultiIndex.from_product([levels, -np.exp(log_barriers)], names=["tau0", "barrier"])
    result = pairs.to_frame(index=False)
    for column in depth_columns:
        # One row for each level and one column for each barrier of the study. The columns are
        # reversed, so that |tau_b| rises from left to right.
        study_depths = rows.pivot(index="tau0", columns="barrier", values=column).iloc[:, ::-1]
        log_study_depths = np.log(study_depths.to_numpy())
        # The interpolation is first between the levels, and then between the barriers.
        at_levels = barycentric_interpolate(study_levels, log_study_depths, levels)
        log_depths = barycentric_interpolate(study_log_barriers, at_levels, log_barriers, axis=1)
        result[column] = np.exp(log_depths).ravel()
    return result


def draw(table: pd.DataFrame) -> Figure:
    """Draw maps of the depth without and with damping, and below them curves and convergence.

    The part "fine" of the table has the exact depths of the maps, "depth" has the depths on
    lattices, and "curve" has the exact and estimated depths of the curves.
    """
    figure, (*map_panels, curve_axes, convergence_axes) = style.new_panels(PAGE_WIDTH, 5.4, "ab;cd")
    fine, runs = table[table["part"] == "fine"], table[table["part"] == "depth"]
    finest = runs[runs["dx"] == runs["dx"].min()]
    ratios = np.sort(runs["damping_ratio"].unique())
    depth_range = DepthRange(fine["exact"].min(), fine["exact"].max())
    for axes, ratio in zip(map_panels, ratios, strict=True):
        # Markers on a map show the finest lattices.
        exact_depths = fine[fine["damping_ratio"] == ratio]
        lattice_depths = finest[finest["damping_ratio"] == ratio]
        # Both maps have the same colours, so that one colour bar is enough.
        image = _draw_map(axes, exact_depths, lattice_depths, depth_range)
        axes.set_title(conditions(held=True, damping_ratio=ratio))
    bar = figure.colorbar(image, ax=map_panels, aspect=25, pad=0.02)
    bar.set_label(r"exact depth $\times\ \gamma^{1/2}$")
    few_ticks(bar.ax.yaxis, CONTOUR_DEPTHS)
    largest_ratio = ratios[-1]
    curves = table[(table["part"] == "curve") & (table["damping_ratio"] == largest_ratio)]
    _draw_curves(curve_axes, curves, finest[finest["damping_ratio"] == largest_ratio])
    curve_axes.set_title(conditions(held=True, damping_ratio=largest_ratio))
    _draw_convergence(convergence_axes, runs)
    return figure


class DepthRange(NamedTuple):
    """The smallest and the largest exact depth in both maps."""

    smallest: float
    largest: float


def _draw_map(
    axes: Axes, fine: pd.DataFrame, runs: pd.DataFrame, depth_range: DepthRange
) -> QuadContourSet:
    """Draw exact depths in colour and as contours, and lattice runs as markers.

    The axes are the level tau_0 before the barrier and the level -tau_b of the barrier. A marker
    has the colour of its depth, and a shape for each gamma. Return the coloured map.

    fine : exact depths at gamma = 1, on a fine grid of levels
    runs : depths on lattices; they are scaled to gamma = 1
    depth_range : smallest and largest depth in the colour scale
    """
    smallest, largest = depth_range
    # The largest depth is not the darkest colour, so that dark lines are visible on it.
    shades: Look = {"norm": LogNorm(smallest, 3.0 * largest), "cmap": "GnBu"}
    bands = np.geomspace(smallest, largest, COLOUR_BANDS)
    # One row for each barrier and one column for each level before it.
    grid = fine.pivot(index="barrier", columns="tau0", values="exact").sort_index()
    image = axes.contourf(grid.columns, -grid.index, grid, levels=bands, extend="both", **shades)
    look: Look = {"levels": CONTOUR_DEPTHS, "colors": BLACK, "linewidths": 0.5}
    lines = axes.contour(grid.columns, -grid.index, grid, **look)
    axes.clabel(lines, fmt="%g", fontsize=SMALL_TEXT, zorder=2.5)
    for marker, (gamma, group) in zip(MARKERS, runs.groupby("gamma"), strict=False):
        # Exact depths are proportional to gamma^(-1/2).
        depth = group["measured"] * np.sqrt(gamma)
        look = {"c": depth, "edgecolors": BLACK, "s": 26.0, "linewidths": 0.9} | shades
        axes.scatter(group["tau0"], -group["barrier"], marker=marker, zorder=3.0, **look)
    axes.set(yscale="log", xlabel=r"pre-stress before $\tau_0$")
    axes.set_ylabel(r"barrier $-\tau_\text{b}$")
    few_ticks(axes.yaxis, (0.1, 0.2, 0.5, 1.0))
    return image


def _draw_convergence(axes: Axes, runs: pd.DataFrame) -> None:
    """Draw the depth on lattices divided by the exact depth, as a function of spacing."""
    for line_style, (ratio, rows) in zip(("o-", "s--"), runs.groupby("damping_ratio"), strict=True):
        look = OPEN_MARKER | {"color": style.colour("damping_ratio", ratio), "linewidth": 0.7}
        scenes = rows.sort_values("dx").groupby(["tau0", "barrier", "gamma"])
        for _, scene in scenes:
            axes.plot(scene["dx"], scene["measured"] / scene["exact"], line_style, **look)
        # The last line of a damping ratio gets its entry in the legend.
        axes.lines[-1].set_label(rf"$b = {ratio:g}$")
    axes.axhline(1.0, color=BLACK, linewidth=0.8)
    axes.set(xlabel=r"spacing $\Delta x$", ylabel="lattice depth / exact depth")
    axes.set(xlim=(0.0, None), title=rf"$\Gamma = 1$, {scenes.ngroups} scenes for each $b$")
    axes.legend(loc="upper left")


def _draw_curves(axes: Axes, curves: pd.DataFrame, finest: pd.DataFrame) -> None:
    """Draw depths as functions of the level of the barrier, with one colour for each level before.

    Lines are exact, and dashed lines are the authors' later estimate (column paper). Both are for
    CURVE_GAMMA. Markers are runs on the finest lattices (column measured), at several gamma.
    """
    markers = dict(zip(np.sort(finest["gamma"].unique()), MARKERS, strict=False))
    for tau0, rows in curves.groupby("tau0"):
        colour = style.colour("tau_0", tau0)
        axes.plot(-rows["barrier"], rows["exact"], color=colour, label=rf"$\tau_0 = {tau0:g}$")
        axes.plot(-rows["barrier"], rows["paper"], "--", color=colour, linewidth=0.8)
        runs_of_level = finest[finest["tau0"] == tau0]
        for gamma, runs in runs_of_level.groupby("gamma"):
            # Depths are proportional to gamma^(-1/2). Those of runs are scaled to CURVE_GAMMA.
            depth = runs["measured"] * np.sqrt(gamma / CURVE_GAMMA)
            axes.plot(-runs["barrier"], depth, markers[gamma], color=colour, **OPEN_MARKER)
    axes.plot([], [], color="0.3", linestyle="--", linewidth=0.8, label="authors' later estimate")
    for gamma, marker in markers.items():
        label = rf"lattice, $\gamma = {gamma:g}$"
        axes.plot([], [], marker, color="0.3", label=label, **OPEN_MARKER)
    axes.set(xscale="log", yscale="log", ylim=(0.25, 14.0), xlabel=r"barrier $-\tau_\text{b}$")
    axes.set_ylabel(rf"depth $\times\ (\gamma/{CURVE_GAMMA:g})^{{1/2}}$")
    few_ticks(axes.xaxis, (0.1, 0.2, 0.5, 1.0))
    few_ticks(axes.yaxis, (0.5, 1, 2, 5, 10))
    axes.legend(loc="lower left", fontsize=SMALL_TEXT, ncols=2, borderaxespad=0.2)
