"""The arrest that never comes: the left front under a stress boundary against the exact theory."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from ..data.points import point
from ..measure.fronts import arrival, path
from ..model.scene import prestress_from
from ..theory.arrest import ArrestingCrack
from .style import BLACK, CYCLE, GREY, PAGE, new_figure, panel_letter

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {"data": ["arrest"], "measured": ["arrest"]}

SHARES = (0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99)
# The share whose convergence is drawn for every damping ratio.
DRAWN_SHARE = 0.9
PATH_POINTS = 300
MARKERS = ("o", "s", "^", "D", "v")


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """The left front's path, its last release, and its share times, simulated and exact.

    Parameters
    ----------
    data : arrest
    measured : arrest
    settings : not used

    Returns
    -------
    DataFrame in units of |x_minus|: role path and exact_path (x: time, y: distance), share (share, y: time, exact) and
    arrest (y: time of the last release)
    """
    sweep, runs = data["arrest"], measured["arrest"]
    parts, cracks = [], {}
    finest = runs.groupby("damping_ratio")["dx"].idxmin()
    for index, row in runs.iterrows():
        run = point(sweep, int(index))
        ratio = row["damping_ratio"]
        if ratio not in cracks:
            cracks[ratio] = ArrestingCrack(prestress_from(run.attrs), ratio, row["release"])
        crack = cracks[ratio]
        scale = abs(crack.balance_position)
        common = {"damping_ratio": ratio, "dx": row["dx"], "run_flags": row["run_flags"]}
        for share in SHARES:
            time = arrival(run, share * scale, "left") / scale
            exact = crack.share_time(share) / scale
            parts.append(
                pd.DataFrame([{"role": "share", "share": share, "y": time, "exact": exact} | common])
            )
        arrest = row["last_release_time"] / scale
        parts.append(pd.DataFrame([{"role": "arrest", "y": arrest} | common]))
        if index == finest[ratio]:
            times, distances = path(run, "left")
            step = max(1, times.size // PATH_POINTS)
            kept = np.unique(np.append(np.arange(0, times.size, step), times.size - 1))
            parts.append(
                pd.DataFrame({"x": times[kept] / scale, "y": distances[kept] / scale}).assign(
                    role="path", **common
                )
            )
            # Crowded towards x_minus, which takes for ever.
            reached = 1.0 - np.geomspace(1.0, 1e-6, PATH_POINTS)[1:]
            exact = np.array([crack.share_time(share) for share in reached]) / scale
            parts.append(pd.DataFrame({"x": exact, "y": reached}).assign(role="exact_path", **common))
    return pd.concat(parts, ignore_index=True)


def plot(table: pd.DataFrame) -> Figure:
    """(a) path and (b) what is left of it, at the finest spacing; (c) share and arrest times against dx."""
    figure = new_figure(PAGE, 2.9)
    path_axes, rest_axes, spacing_axes = figure.subplots(1, 3)
    ratios = np.unique(table["damping_ratio"])
    longest = float(table.loc[table["role"] == "path", "x"].max()) * 1.08
    for colour, ratio, marker in zip(CYCLE, ratios, MARKERS, strict=False):
        rows = table[table["damping_ratio"] == ratio]
        simulated, exact = rows[rows["role"] == "path"], rows[rows["role"] == "exact_path"]
        exact = exact[exact["x"] <= longest]
        for axes, transform in ((path_axes, lambda y: y), (rest_axes, lambda y: 1.0 - y)):
            axes.plot(
                simulated["x"], transform(simulated["y"]), color=colour, linewidth=3.0, alpha=0.35,
                gid=f"simulation {ratio:g}",
            )  # fmt: skip
            axes.plot(exact["x"], transform(exact["y"]), color=colour, linewidth=0.9, gid=f"theory {ratio:g}")
        last = simulated.iloc[-1]
        path_axes.plot(last["x"], last["y"], marker=marker, color=colour, linestyle="none")
        rest_axes.plot(last["x"], max(1.0 - last["y"], 1e-6), marker=marker, color=colour, linestyle="none")
        arrest = rows[rows["role"] == "arrest"].sort_values("dx")
        share = rows[(rows["role"] == "share") & (rows["share"] == DRAWN_SHARE)].sort_values("dx")
        spacing_axes.plot(arrest["dx"], arrest["y"], marker=marker, color=colour, gid=f"arrest {ratio:g}")
        spacing_axes.plot(
            share["dx"], share["y"], marker=marker, color=colour, linestyle="--", markerfacecolor="white",
            gid=f"share {ratio:g}",
        )  # fmt: skip
        spacing_axes.plot(
            share["dx"].min() * 0.8, share["exact"].iloc[0], marker="<", color=colour, linestyle="none"
        )
        spacing_axes.plot([], [], marker=marker, color=colour, label=f"{ratio:g}")
    path_axes.axhline(1.0, color=BLACK, linewidth=0.6, linestyle=":")
    path_axes.set(xlabel=r"time $t\,/\,|x_-|$", ylabel=r"left front $|x|\,/\,|x_-|$")
    path_axes.plot([], [], color=GREY, linewidth=3.0, alpha=0.35, label="simulation")
    path_axes.plot([], [], color=GREY, linewidth=0.9, label="exact")
    path_axes.plot([], [], color=GREY, marker="o", linestyle="none", label="last release")
    path_axes.legend(loc="lower right")
    rest_axes.set(yscale="log", xlabel=r"time $t\,/\,|x_-|$", ylabel=r"still to go, $1-|x|/|x_-|$")
    rest_axes.set_ylim(3e-4, 1.1)
    spacing_axes.set(xscale="log", xlabel=r"spacing $\Delta x$", ylabel=r"time $t\,/\,|x_-|$")
    spacing_axes.plot([], [], marker="o", color=GREY, label="last release")
    label = f"{DRAWN_SHARE:.0%} of the path"
    spacing_axes.plot([], [], marker="o", color=GREY, linestyle="--", markerfacecolor="white", label=label)
    spacing_axes.plot([], [], marker="<", color=GREY, linestyle="none", label="the same, exact")
    spacing_axes.legend(title=r"$b$", ncols=2, loc="upper right", columnspacing=0.8)
    spacing_axes.xaxis.set_minor_formatter(NullFormatter())
    spacing_axes.set_xticks(
        np.unique(table["dx"].dropna()), [f"{dx:g}" for dx in np.unique(table["dx"].dropna())]
    )
    low, high = spacing_axes.get_ylim()
    spacing_axes.set_ylim(low, high + 0.6 * (high - low))
    for axes, letter in zip((path_axes, rest_axes, spacing_axes), "abc", strict=True):
        panel_letter(axes, letter)
    return figure
