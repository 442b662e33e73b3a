"""How deep a steady pulse enters negative pre-stress: exact, on lattices, and by the later estimate."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import matplotlib
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from ..data.numerals import setting
from ..theory.barrier import barrier_depth_estimate
from .style import BLACK, BLUE, GREY, ORANGE, PAGE, colour_scale, new_figure, panel_letter

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {"studies": ["barriers"]}

MAP = "cividis"
# Points of the smooth map along each axis, and contour lines on it.
FINE, CONTOURS = 41, (1.0, 1.5, 2.0, 3.0, 4.5, 7.0, 10.0, 14.0)
# The labels of the lines keep this factor from the ends of the axis of barriers.
RIM = 1.12
MARKERS, COLOURS = ("o", "s", "^"), (BLUE, ORANGE)
# gamma of the curves, for which the later estimate is drawn; exact depths scale to it.
GAMMA = 0.65
LEVELS = (0.2, 0.5, 0.8)


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """The study with a smooth map and curves of exact depths and of the estimate.

    Parameters
    ----------
    data, settings : not used
    measured : barriers

    Returns
    -------
    DataFrame of the study's rows (part map left out) and part smooth: exact at gamma = 1 on a fine grid; part curve:
    exact and paper (the later estimate) over the barrier's level at gamma = GAMMA
    """
    # Slow to load, and needed here only.
    from scipy.interpolate import RectBivariateSpline

    study = measured["barriers"]
    parts = [study[study["part"] != "map"]]
    for ratio, rows in study[study["part"] == "map"].groupby("damping_ratio"):
        # log depth over tau_0 and log |tau_b| is nearly straight.
        grid = rows.pivot(index="tau0", columns="barrier", values="exact").sort_index(axis=1, ascending=False)
        tau0, barrier = grid.index.to_numpy(), np.log(-grid.columns.to_numpy())
        spline = RectBivariateSpline(tau0, barrier, np.log(grid.to_numpy()))
        x, y = np.linspace(*tau0[[0, -1]], FINE), np.linspace(*barrier[[0, -1]], FINE)
        exact = np.exp(spline(x, y))
        level, depth = np.meshgrid(x, -np.exp(y), indexing="ij")
        parts.append(_rows("smooth", 1.0, ratio, level.ravel(), depth.ravel(), exact.ravel()))
        for chosen in LEVELS:
            exact = np.exp(spline(chosen, y)).ravel() / np.sqrt(GAMMA)
            curve = _rows("curve", GAMMA, ratio, np.full(y.size, chosen), -np.exp(y), exact)
            parts.append(curve.assign(paper=[barrier_depth_estimate(chosen, -v, GAMMA) for v in np.exp(y)]))
    return pd.concat(parts, ignore_index=True)


def _rows(part: str, gamma: float, ratio: float, tau0, barrier, exact) -> pd.DataFrame:
    return pd.DataFrame(
        {
            "part": part,
            "gamma": gamma,
            "damping_ratio": ratio,
            "tau0": tau0,
            "barrier": barrier,
            "exact": exact,
        }
    )


def plot(table: pd.DataFrame) -> Figure:
    """Above: maps without and with damping, and curves with the estimate. Below: convergence, and who passes."""
    figure = new_figure(PAGE, 5.3)
    axes = figure.subplot_mosaic("abc;dee", height_ratios=(1.0, 1.05))
    smooth = table[table["part"] == "smooth"]
    runs = table[table["part"] == "depth"]
    scale = LogNorm(float(smooth["exact"].min()), float(smooth["exact"].max()))
    ratios = np.sort(runs["damping_ratio"].unique())
    for name, ratio in zip("ab", ratios, strict=True):
        image = _draw_map(
            axes[name], smooth[smooth["damping_ratio"] == ratio], runs[runs["damping_ratio"] == ratio], scale
        )
        axes[name].set_title(_ratio(ratio), loc="right")
    bar = figure.colorbar(image, ax=[axes["a"], axes["b"]], location="top", aspect=50, pad=0.02)
    bar.set_label(r"exact depth $\times\ \gamma^{1/2}$")
    bar.set_ticks([1, 2, 3, 5, 7, 10], labels=["1", "2", "3", "5", "7", "10"])
    bar.ax.xaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
    _draw_curves(axes["c"], table, runs)
    _draw_convergence(axes["d"], runs, ratios)
    _draw_passing(axes["e"], table[table["part"] == "passing"], ratios)
    for name in "abcde":
        panel_letter(axes[name], name)
    return figure


def _ratio(value: float) -> str:
    return rf"$b = {value:g}$"


def _finest(runs: pd.DataFrame) -> pd.DataFrame:
    return runs[runs["dx"] == runs["dx"].min()]


def _label_places(x: np.ndarray, y: np.ndarray, depth: np.ndarray) -> Iterator[tuple[float, float]]:
    """Where a label stands on each contour: on the left, but a label's height away from the rim."""
    for level in CONTOURS:
        for column in range(x.size // 5, x.size):
            order = np.argsort(depth[:, column])
            place = np.interp(level, depth[order, column], y[order])
            if RIM * y.min() < place < y.max() / RIM:
                yield x[column], place
                break


def _draw_map(axes, smooth: pd.DataFrame, runs: pd.DataFrame, scale: LogNorm):
    grid = smooth.pivot(index="barrier", columns="tau0", values="exact").sort_index()
    x, y = grid.columns.to_numpy(), -grid.index.to_numpy()
    image = axes.pcolormesh(x, y, grid.to_numpy(), norm=scale, cmap=MAP, shading="gouraud", rasterized=True)
    lines = axes.contour(x, y, grid.to_numpy(), levels=CONTOURS, colors="white", linewidths=0.5)
    axes.clabel(lines, fmt="%g", fontsize=7.0, zorder=2.5, manual=list(_label_places(x, y, grid.to_numpy())))
    finest = _finest(runs)
    for marker, (gamma, group) in zip(MARKERS, finest.groupby("gamma"), strict=False):
        axes.scatter(
            group["tau0"], -group["barrier"], c=group["measured"] * np.sqrt(gamma), norm=scale, cmap=MAP, marker=marker,
            s=26.0, edgecolors="white", linewidths=0.9, label=rf"$\gamma = {gamma:g}$", gid="lattice", zorder=3.0,
        )  # fmt: skip
    axes.set(yscale="log", xlabel=r"pre-stress before $\tau_0$", ylabel=r"barrier $-\tau_\mathrm{b}$")
    axes.set_yticks([0.1, 0.2, 0.5, 1.0], ["0.1", "0.2", "0.5", "1"])
    axes.yaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
    return image


def _draw_curves(axes, table: pd.DataFrame, runs: pd.DataFrame) -> None:
    """At the larger damping ratio: exact lines, the estimate, and the finest lattices scaled to one gamma."""
    curves = table[table["part"] == "curve"]
    damped = float(curves["damping_ratio"].max())
    curves = curves[curves["damping_ratio"] == damped]
    finest = _finest(runs[runs["damping_ratio"] == damped])
    markers = dict(zip(np.sort(finest["gamma"].unique()), MARKERS, strict=False))
    for tau0, rows in curves.groupby("tau0"):
        colour = colour_scale("tau_0").to_rgba(tau0)
        axes.plot(
            -rows["barrier"],
            rows["exact"],
            color=colour,
            gid=f"exact {tau0:g}",
            label=rf"$\tau_0 = {tau0:g}$",
        )
        axes.plot(
            -rows["barrier"], rows["paper"], color=colour, linestyle="--", linewidth=0.8, gid=f"estimate {tau0:g}"
        )  # fmt: skip
        for gamma, found in finest[finest["tau0"] == tau0].groupby("gamma"):
            axes.plot(
                -found["barrier"], found["measured"] * np.sqrt(found["gamma"] / GAMMA), markers[gamma], color=colour,
                markersize=3.8, markerfacecolor="white", gid=f"lattice {tau0:g}",
            )  # fmt: skip
    axes.plot([], [], color="0.3", linestyle="--", linewidth=0.8, label="later estimate")
    for gamma, marker in markers.items():
        axes.plot(
            [], [], marker, color="0.3", markersize=3.8, markerfacecolor="white", label=rf"$\gamma = {gamma:g}$"
        )  # fmt: skip
    axes.set(xscale="log", yscale="log", xlabel=r"barrier $-\tau_\mathrm{b}$")
    axes.set_ylabel(rf"depth at $\gamma = {GAMMA:g}$")
    axes.set_title(_ratio(damped), loc="right")
    axes.set_xticks([0.1, 0.2, 0.5, 1.0], ["0.1", "0.2", "0.5", "1"])
    axes.set_yticks([0.5, 1, 2, 5, 10], ["0.5", "1", "2", "5", "10"])
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_minor_formatter(matplotlib.ticker.NullFormatter())
    axes.set_ylim(0.4, 45.0)
    axes.legend(
        loc="upper right", labelspacing=0.2, ncols=2, columnspacing=0.8, handletextpad=0.4, handlelength=1.4
    )


def _draw_convergence(axes, runs: pd.DataFrame, ratios: np.ndarray) -> None:
    for colour, ratio in zip(COLOURS, ratios, strict=True):
        chosen = runs[runs["damping_ratio"] == ratio]
        for _, line in chosen.groupby(["tau0", "barrier", "gamma"]):
            line = line.sort_values("dx")
            axes.plot(
                line["dx"], line["measured"] / line["exact"], color=colour, linewidth=0.7, marker="o", markersize=1.8,
                alpha=0.8, gid=f"lattice {ratio:g}",
            )  # fmt: skip
        axes.plot([], [], color=colour, marker="o", markersize=2.0, label=_ratio(ratio))
    axes.axhline(1.0, color=BLACK, linewidth=0.8)
    axes.set(xlabel=r"spacing $\Delta x$", ylabel="lattice depth / exact depth", xlim=(0.0, None))
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.35 * (high - low))
    axes.legend(loc="upper left")


def _draw_passing(axes, rows: pd.DataFrame, ratios: np.ndarray) -> None:
    pairs = list(rows.groupby(["tau0", "barrier"], sort=True).groups)
    for colour, ratio, shift in zip(COLOURS, ratios, (0.17, -0.17), strict=True):
        chosen = rows[rows["damping_ratio"] == ratio]
        height = [pairs.index(key) + shift for key in zip(chosen["tau0"], chosen["barrier"], strict=True)]
        for passed, face in ((1.0, colour), (0.0, "white")):
            kept = (chosen["measured"] == passed).to_numpy()
            axes.plot(
                chosen["length"][kept], np.asarray(height)[kept], "o", color=colour, markerfacecolor=face,
                markersize=3.0, markeredgewidth=0.7, gid=f"{'passed' if passed else 'stopped'} {ratio:g}",
            )  # fmt: skip
    axes.axvline(1.0, color=GREY, linewidth=0.9, linestyle="--")
    axes.set_yticks(
        range(len(pairs)), [rf"{tau0:g} $\to$ {setting(barrier)}" for tau0, barrier in pairs], fontsize=7.0
    )
    for face, label in (("0.3", "passed"), ("white", "not passed")):
        axes.plot([], [], "o", color="0.3", markerfacecolor=face, markersize=3.5, label=label)
    for colour, ratio in zip(COLOURS, ratios, strict=True):
        axes.plot([], [], "s", color=colour, markersize=3.5, label=_ratio(ratio))
    lengths = np.sort(rows["length"].unique())
    axes.set(
        xlabel="length of the barrier / exact depth", ylabel=r"$\tau_0 \to \tau_\mathrm{b}$", xticks=lengths
    )
    axes.set_xlim(lengths[0] - 0.1, lengths[-1] + 0.1)
    axes.set_ylim(-0.6, len(pairs) + 1.6)
    axes.legend(
        loc="upper center",
        ncols=4,
        handletextpad=0.2,
        columnspacing=1.2,
        frameon=True,
        framealpha=1.0,
        edgecolor="none",
    )
