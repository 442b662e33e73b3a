"""How deep a steady pulse enters negative pre-stress: exact, on lattices, and by the later estimate."""

from collections.abc import Iterable

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from numpy.polynomial.chebyshev import chebvander

from .style import BLACK, PAGE, Look, colour_scale, few_ticks, new_panels

NEEDS = {"studies": ["barriers"]}

MAP = "cividis"
# Points of the interpolated map along each axis, its bands of colour, and contour lines on it.
FINE, BANDS, CONTOURS = 41, 33, (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 11.0)
# Above this depth the map is light, and what is written on it dark.
LIGHT = 3.5
MARKERS = ("o", "s", "^")
OPEN: Look = {"markersize": 3.8, "markerfacecolor": "white"}
# gamma of the curves, for which the later estimate is drawn; exact depths scale to it.
GAMMA = 0.65
LEVELS = (0.2, 0.5, 0.8)


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Part "depth" as in the study; interpolated parts "fine" (exact at gamma = 1) and "curve" (exact and paper, the
    later estimate, over the barrier's level at gamma = GAMMA).
    """
    study = tables["barriers"]
    parts = [study[study["part"] == "depth"]]
    for ratio, rows in study[study["part"] == "map"].groupby("damping_ratio"):
        # log depth over tau_0 and log |tau_b| is nearly straight.
        at = np.sort(rows["tau0"].unique()), np.sort(np.log(-rows["barrier"].unique()))
        x, y = (np.linspace(nodes[0], nodes[-1], FINE) for nodes in at)
        for part, levels, gamma, powers in (
            ("fine", x, 1.0, {"exact": 0.5}),
            ("curve", np.array(LEVELS), GAMMA, {"exact": 0.5, "paper": 1.0}),
        ):
            pairs = pd.MultiIndex.from_product([levels, -np.exp(y)], names=["tau0", "barrier"])
            out = pairs.to_frame(index=False)
            for name, power in powers.items():
                depths = rows.pivot(index="tau0", columns="barrier", values=name).to_numpy()[
                    :, ::-1
                ]
                depth = np.exp(_between(at[0], levels) @ np.log(depths) @ _between(at[1], y).T)
                out[name] = depth.ravel() / gamma**power
            parts.append(out.assign(part=part, gamma=gamma, damping_ratio=ratio))
    return pd.concat(parts, ignore_index=True)


def _between(nodes: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Weights of the values at the nodes in the polynomial through them; nodes are denser at the ends."""
    middle, half = 0.5 * (nodes[0] + nodes[-1]), 0.5 * (nodes[-1] - nodes[0])
    by_node, by_point = (chebvander((x - middle) / half, nodes.size - 1) for x in (nodes, at))
    return np.linalg.solve(by_node.T, by_point.T).T


def plot(table: pd.DataFrame) -> Figure:
    """Above: maps without and with damping. Below: curves with the estimate, and convergence."""
    figure, (*maps, curve_axes, last) = new_panels(PAGE, 5.4, 2, 2)
    fine, runs = (table[table["part"] == part] for part in ("fine", "depth"))
    finest = runs[runs["dx"] == runs["dx"].min()]
    ends = fine["exact"].min(), fine["exact"].max()
    scale, bands = LogNorm(*ends), np.geomspace(*ends, BANDS)
    ratios = np.sort(runs["damping_ratio"].unique())
    for axes, ratio in zip(maps, ratios, strict=True):
        at, marked = (rows[rows["damping_ratio"] == ratio] for rows in (fine, finest))
        image = _draw_map(axes, at, marked, scale, bands)
        axes.set_title(rf"$\Gamma = 1$, $b = {ratio:g}$", loc="right")
    bar = figure.colorbar(image, ax=maps, aspect=25, pad=0.02)
    bar.set_label(r"exact depth $\times\ \gamma^{1/2}$")
    few_ticks(bar.ax.yaxis, CONTOURS)
    # At the larger damping ratio, which is the last above.
    curves = table[(table["part"] == "curve") & (table["damping_ratio"] == ratio)]
    _draw_curves(curve_axes, curves, marked)
    curve_axes.set_title(rf"$\Gamma = 1$, $b = {ratio:g}$", loc="right")
    for style, (ratio, chosen) in zip(("o-", "s--"), runs.groupby("damping_ratio"), strict=True):
        look: Look = {"color": colour_scale("damping_ratio").to_rgba(ratio), "markersize": 2.4}
        look |= {"linewidth": 0.7, "markerfacecolor": "white", "markeredgewidth": 0.7}
        for number, (_, line) in enumerate(chosen.groupby(["tau0", "barrier", "gamma"])):
            line, label = line.sort_values("dx"), None if number else rf"$b = {ratio:g}$"
            last.plot(line["dx"], line["measured"] / line["exact"], style, label=label, **look)
    last.axhline(1.0, color=BLACK, linewidth=0.8)
    last.set(xlabel=r"spacing $\Delta x$", ylabel="lattice depth / exact depth", xlim=(0.0, None))
    scenes = runs.groupby(["tau0", "barrier", "gamma"]).ngroups
    last.set_title(rf"$\Gamma = 1$, {scenes} scenes a ratio", loc="right")
    last.legend(loc="upper left")
    return figure


def _draw_map(
    axes: Axes, fine: pd.DataFrame, finest: pd.DataFrame, scale: LogNorm, bands: np.ndarray
):
    grid = fine.pivot(index="barrier", columns="tau0", values="exact").sort_index()
    x, y = grid.columns.to_numpy(), -grid.index.to_numpy()
    image = axes.contourf(x, y, grid.to_numpy(), levels=bands, norm=scale, cmap=MAP, extend="both")
    lines = axes.contour(
        x, y, grid.to_numpy(), levels=CONTOURS, colors=_ink(CONTOURS), linewidths=0.5
    )
    axes.clabel(lines, fmt="%g", fontsize=7.0, zorder=2.5)
    look: Look = {"s": 26.0, "linewidths": 0.9, "norm": scale, "cmap": MAP, "zorder": 3.0}
    for marker, (gamma, group) in zip(MARKERS, finest.groupby("gamma"), strict=False):
        depth = group["measured"] * np.sqrt(gamma)
        look |= {"c": depth, "edgecolors": _ink(depth), "marker": marker}
        axes.scatter(group["tau0"], -group["barrier"], **look)
    axes.set(yscale="log", xlabel=r"pre-stress before $\tau_0$", ylabel=r"barrier $-\tau_\text{b}$")
    few_ticks(axes.yaxis, (0.1, 0.2, 0.5, 1.0))
    return image


def _ink(depths: Iterable[float]) -> list[str]:
    return [BLACK if depth > LIGHT else "white" for depth in depths]


def _draw_curves(axes: Axes, curves: pd.DataFrame, finest: pd.DataFrame) -> None:
    """Exact lines, the estimate, and the finest lattices scaled to one gamma."""
    markers = dict(zip(np.sort(finest["gamma"].unique()), MARKERS, strict=False))
    for tau0, rows in curves.groupby("tau0"):
        colour = colour_scale("tau_0").to_rgba(tau0)
        axes.plot(-rows["barrier"], rows["exact"], color=colour, label=rf"$\tau_0 = {tau0:g}$")
        axes.plot(-rows["barrier"], rows["paper"], "--", color=colour, linewidth=0.8)
        for gamma, found in finest[finest["tau0"] == tau0].groupby("gamma"):
            depth = found["measured"] * np.sqrt(gamma / GAMMA)
            axes.plot(-found["barrier"], depth, markers[gamma], color=colour, **OPEN)
    axes.plot([], [], color="0.3", linestyle="--", linewidth=0.8, label="authors' later estimate")
    for gamma, marker in markers.items():
        axes.plot([], [], marker, color="0.3", label=rf"lattice, $\gamma = {gamma:g}$", **OPEN)
    axes.set(xscale="log", yscale="log", ylim=(0.33, 14.0), xlabel=r"barrier $-\tau_\text{b}$")
    axes.set_ylabel(rf"depth $\times\ (\gamma/{GAMMA:g})^{{1/2}}$")
    few_ticks(axes.xaxis, (0.1, 0.2, 0.5, 1.0))
    few_ticks(axes.yaxis, (0.5, 1, 2, 5, 10))
    look: Look = {"ncols": 2, "columnspacing": 0.6, "handletextpad": 0.3, "handlelength": 1.3}
    axes.legend(loc="lower left", borderaxespad=0.2, fontsize=7.0, **look)
