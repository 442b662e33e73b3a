"""The depth to which a steady pulse enters negative pre-stress: exact, on lattices, estimated."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
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

# Points of the interpolated map along each axis, its colour bands, and its contour lines.
MAP_POINTS, COLOUR_BANDS = 41, 33
CONTOUR_DEPTHS = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 11.0)
# Elasticity ratio and levels of pre-stress of the curves. Depths of other ratios are scaled to it.
CURVE_GAMMA = 0.65
CURVE_LEVELS = (0.2, 0.5, 0.8)


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the lattice depths of the study, and two interpolated parts: fine (a finer map) and
    curve (at one gamma).
    """
    study = tables["barriers"]
    parts = [study[study["part"] == "depth"]]
    for ratio, rows in study[study["part"] == "map"].groupby("damping_ratio"):
        levels = np.linspace(rows["tau0"].min(), rows["tau0"].max(), MAP_POINTS)
        fine = _interpolated(rows, levels, 1.0, {"exact": 0.5})
        curve = _interpolated(
            rows, np.array(CURVE_LEVELS), CURVE_GAMMA, {"exact": 0.5, "paper": 1.0}
        )
        parts.append(fine.assign(part="fine", damping_ratio=ratio))
        parts.append(curve.assign(part="curve", damping_ratio=ratio))
    return pd.concat(parts, ignore_index=True)


def _interpolated(
    rows: pd.DataFrame, levels: np.ndarray, gamma: float, powers: dict[str, float]
) -> pd.DataFrame:
    """Interpolate depths at some levels and evenly spaced barriers.

    powers : for each column of depths, the power of 1/gamma with which it scales
    """
    # The logarithm of the depth is nearly linear in tau_0 and in log |tau_b|.
    tau0, log_barrier = np.sort(rows["tau0"].unique()), np.sort(np.log(-rows["barrier"].unique()))
    y = np.linspace(log_barrier[0], log_barrier[-1], MAP_POINTS)
    pairs = pd.MultiIndex.from_product([levels, -np.exp(y)], names=["tau0", "barrier"])
    columns = pairs.to_frame(index=False)
    for name, power in powers.items():
        depths = rows.pivot(index="tau0", columns="barrier", values=name).to_numpy()[:, ::-1]
        log_depths = barycentric_interpolate(tau0, np.log(depths), levels)
        depth = np.exp(barycentric_interpolate(log_barrier, log_depths, y, axis=1))
        columns[name] = depth.ravel() / gamma**power
    return columns.assign(gamma=gamma)


def draw(table: pd.DataFrame) -> Figure:
    """Draw maps without and with damping above, and below them curves and convergence."""
    figure, (*maps, curve_axes, convergence) = style.new_panels(PAGE_WIDTH, 5.4, "ab;cd")
    fine, runs = (table[table["part"] == part] for part in ("fine", "depth"))
    finest = runs[runs["dx"] == runs["dx"].min()]
    ends = fine["exact"].min(), fine["exact"].max()
    ratios = np.sort(runs["damping_ratio"].unique())
    # Only the light part of the colour map is used, so that dark lines are visible.
    shades: Look = {"norm": LogNorm(ends[0], 3.0 * ends[1]), "cmap": "GnBu"}
    filled = shades | {"levels": np.geomspace(*ends, COLOUR_BANDS), "extend": "both"}
    for axes, ratio in zip(maps, ratios, strict=True):
        drawn, marked = (rows[rows["damping_ratio"] == ratio] for rows in (fine, finest))
        grid = drawn.pivot(index="barrier", columns="tau0", values="exact").sort_index()
        image = axes.contourf(grid.columns, -grid.index, grid, **filled)
        look: Look = {"levels": CONTOUR_DEPTHS, "colors": BLACK, "linewidths": 0.5}
        lines = axes.contour(grid.columns, -grid.index, grid, **look)
        axes.clabel(lines, fmt="%g", fontsize=SMALL_TEXT, zorder=2.5)
        for marker, (gamma, group) in zip(MARKERS, marked.groupby("gamma"), strict=False):
            depth = group["measured"] * np.sqrt(gamma)
            look = {"c": depth, "edgecolors": BLACK, "s": 26.0, "linewidths": 0.9} | shades
            axes.scatter(group["tau0"], -group["barrier"], marker=marker, zorder=3.0, **look)
        axes.set(yscale="log", xlabel=r"pre-stress before $\tau_0$")
        axes.set(ylabel=r"barrier $-\tau_\text{b}$", title=conditions(True, damping_ratio=ratio))
        few_ticks(axes.yaxis, (0.1, 0.2, 0.5, 1.0))
    bar = figure.colorbar(image, ax=maps, aspect=25, pad=0.02)
    bar.set_label(r"exact depth $\times\ \gamma^{1/2}$")
    few_ticks(bar.ax.yaxis, CONTOUR_DEPTHS)
    largest = ratios[-1]
    curves = table[(table["part"] == "curve") & (table["damping_ratio"] == largest)]
    _draw_curves(curve_axes, curves, finest[finest["damping_ratio"] == largest])
    curve_axes.set_title(conditions(True, damping_ratio=largest))
    for line_style, (ratio, rows) in zip(("o-", "s--"), runs.groupby("damping_ratio"), strict=True):
        look = OPEN_MARKER | {"color": style.colour("damping_ratio", ratio), "linewidth": 0.7}
        scenes = rows.sort_values("dx").groupby(["tau0", "barrier", "gamma"])
        for _, line in scenes:
            convergence.plot(line["dx"], line["measured"] / line["exact"], line_style, **look)
        convergence.lines[-1].set_label(rf"$b = {ratio:g}$")
    convergence.axhline(1.0, color=BLACK, linewidth=0.8)
    convergence.set(xlabel=r"spacing $\Delta x$", ylabel="lattice depth / exact depth")
    convergence.set(xlim=(0.0, None), title=rf"$\Gamma = 1$, {scenes.ngroups} scenes a ratio")
    convergence.legend(loc="upper left")
    return figure


def _draw_curves(axes: Axes, curves: pd.DataFrame, finest: pd.DataFrame) -> None:
    """Draw exact depths, the estimate, and the finest lattices, all scaled to one gamma."""
    markers = dict(zip(np.sort(finest["gamma"].unique()), MARKERS, strict=False))
    for tau0, rows in curves.groupby("tau0"):
        colour = style.colour("tau_0", tau0)
        axes.plot(-rows["barrier"], rows["exact"], color=colour, label=rf"$\tau_0 = {tau0:g}$")
        axes.plot(-rows["barrier"], rows["paper"], "--", color=colour, linewidth=0.8)
        for gamma, runs in finest[finest["tau0"] == tau0].groupby("gamma"):
            depth = runs["measured"] * np.sqrt(gamma / CURVE_GAMMA)
            axes.plot(-runs["barrier"], depth, markers[gamma], color=colour, **OPEN_MARKER)
    axes.plot([], [], color="0.3", linestyle="--", linewidth=0.8, label="authors' later estimate")
    for gamma, marker in markers.items():
        axes.plot(
            [], [], marker, color="0.3", label=rf"lattice, $\gamma = {gamma:g}$", **OPEN_MARKER
        )
    axes.set(xscale="log", yscale="log", ylim=(0.25, 14.0), xlabel=r"barrier $-\tau_\text{b}$")
    axes.set_ylabel(rf"depth $\times\ (\gamma/{CURVE_GAMMA:g})^{{1/2}}$")
    few_ticks(axes.xaxis, (0.1, 0.2, 0.5, 1.0))
    few_ticks(axes.yaxis, (0.5, 1, 2, 5, 10))
    axes.legend(loc="lower left", fontsize=SMALL_TEXT, ncols=2, borderaxespad=0.2)
