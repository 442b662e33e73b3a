"""The arrest of the left front under a stress boundary, on lattices and by exact theory.

In the continuum the front approaches its final position for ever.
"""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from slippulse.data.point import point
from slippulse.measurement.front_paths import front_path
from slippulse.plotting import style
from slippulse.plotting.style import GREY, MARKERS, OPEN_MARKER, ORANGE, PAGE_WIDTH, Look, entry

NEEDS = {
    "data": ["arrest"],
    "measured": {"arrest": ["transition"]},
    "studies": ["arrest_path"],
    "settings": ["measure.fraction"],
}
# Which runs of each simulation the figure can draw, in the words of configuration/drawn.py.
DRAWS = {
    "arrest": "boundary stress, left level below 0, right level 0 and no steps",
}

PATH_POINTS = 150
SIMULATION_LOOK: Look = {"linewidth": 3.0, "alpha": 0.35}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the rows of three parts of the figure, which the column role names.

    run : one row for each run, with the time of the last release, and the time at which the left
        front has covered the stated fraction of its path
    path, exact_path : fraction of the path that is still to go, by time and damping ratio

    Times and distances are in units of |x_minus|, which is also the paper's estimate of the
    transition time.
    """
    runs = tables["arrest"]
    scale = runs["paper_transition_time"]
    times = runs[["left", "right", "width", "damping_ratio", "dx", "run_flags"]].assign(
        role="run",
        last_release=runs["last_release_time"] / scale,
        fraction=settings["measure"]["fraction"],
        fraction_time=runs["transition_time"] / scale,
        exact_fraction_time=runs["exact_transition_time"] / scale,
    )
    parts = [times, tables["arrest_path"].assign(role="exact_path")]
    # The path of the finest lattice of each damping ratio is drawn.
    for ratio, index in runs.groupby("damping_ratio")["dx"].idxmin().items():
        time, distance = front_path(point(data["arrest"], int(index)), "left")
        kept = np.unique(np.linspace(0, time.size - 1, PATH_POINTS).astype(int))
        relative_time, relative_distance = time / scale[index], distance / scale[index]
        path = {"time": relative_time[kept], "to_go": 1.0 - relative_distance[kept]}
        parts.append(pd.DataFrame(path).assign(role="path", damping_ratio=ratio))
    return pd.concat(parts, ignore_index=True)


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a) the remaining distance, (b) the times of the stated fraction and last release."""
    figure, (path_axes, spacing_axes) = style.new_panels(PAGE_WIDTH, 3.1, "ab")
    longest = float(table.loc[table["role"] == "path", "time"].max()) * 1.08
    for (ratio, rows), marker in zip(table.groupby("damping_ratio"), MARKERS, strict=False):
        # The colour scale is logarithmic and has no colour for 0.
        colour = style.colour("damping_ratio", ratio) if ratio > 0.0 else ORANGE
        look: Look = {"color": colour}
        roles = style.by_role(rows)
        draw_path(path_axes, roles["path"], roles["exact_path"], longest, look)
        last = roles["path"].iloc[-1]
        path_axes.plot(last["time"], last["to_go"], marker, label=f"$b$ = {ratio:g}", **look)
        draw_times(spacing_axes, roles["run"].sort_values("dx"), marker, look)
    fraction = table["fraction"].max()
    style.legend_below(figure, [*style.labelled([path_axes]), *legend_entries(fraction)], 5)
    path_axes.set(yscale="log", xlabel=r"time $t\,/\,|x_{-}|$", ylim=(5e-4, 1.1))
    levels = table.loc[table["role"] == "run", ["left", "right", "width"]].iloc[0]
    scene = style.conditions(False, **levels)
    path_axes.set(ylabel=r"still to go, $1-|x|/|x_{-}|$", title=scene)
    spacing_axes.set(xscale="log", xlabel=r"spacing $\Delta x$", ylabel=r"time $t\,/\,|x_{-}|$")
    style.few_ticks(spacing_axes.xaxis, np.unique(table["dx"].dropna()))
    return figure


def draw_path(
    axes: Axes, simulated: pd.DataFrame, exact: pd.DataFrame, longest: float, look: Look
) -> None:
    """Draw the remaining distance of one left front, the exact one up to the time ``longest``."""
    exact = exact[exact["time"] <= longest]
    axes.plot(simulated["time"], simulated["to_go"], **SIMULATION_LOOK | look)
    axes.plot(exact["time"], exact["to_go"], linewidth=0.9, **look)


def draw_times(axes: Axes, runs: pd.DataFrame, marker: str, look: Look) -> None:
    """Draw the times of both arrests as functions of spacing, and the exact time on the left."""
    axes.plot(runs["dx"], runs["last_release"], marker=marker, **look)
    axes.plot(runs["dx"], runs["fraction_time"], marker + "--", **OPEN_MARKER | look)
    axes.plot(runs["dx"].min() * 0.8, runs["exact_fraction_time"].iloc[0], "<", **look)


def legend_entries(fraction: float) -> list[Line2D]:
    """Return the entries of the legend for lines and markers of all damping ratios."""
    looks: dict[str, Look] = {
        "simulation": SIMULATION_LOOK,
        "exact": {"linewidth": 0.9},
        "last release (does not converge)": {"marker": "o"},
        f"{100.0 * fraction:g} % of the way (converges)": {"marker": "o"} | OPEN_MARKER,
        "the same, exact": {"marker": "<"},
    }
    return [entry(label, color=GREY, **look) for label, look in looks.items()]
