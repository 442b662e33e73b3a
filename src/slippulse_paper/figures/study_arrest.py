"""The arrest of the left front under a stress boundary, on lattices and by exact theory.

In the continuum the front approaches the balance position x_minus for ever. A time can be compared
only at a stated fraction of its path.
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
# Runs of each simulation that the figure can draw, in the words of configuration/drawn.py.
DRAWS = {
    "arrest": "boundary stress, left level below 0, right level 0 and no steps",
}

# A path on a lattice is drawn with at most this number of points.
PATH_POINTS = 150
SIMULATION_LOOK: Look = {"linewidth": 3.0, "alpha": 0.35}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the rows of three parts of the figure, which the column role names.

    run : one row for each run, with the time of the last release on the left, and the time at which
        the left front has covered the stated fraction of its path
    path, exact_path : for each damping ratio, the fraction of the path that the left front has not
        yet covered (to_go) as a function of time, on the finest lattice and exact

    Times and distances are in units of the length of the path, the balance distance |x_minus|.
    """
    runs = tables["arrest"]
    # The paper's estimate of the transition time is |x_minus|, as the wave speed is 1.
    balance_distance = runs["paper_transition_time"]
    times = runs[["left", "right", "width", "damping_ratio", "dx", "run_flags"]].assign(
        role="run",
        last_release=runs["last_release_time"] / balance_distance,
        fraction=settings["measure"]["fraction"],
        fraction_time=runs["transition_time"] / balance_distance,
        exact_fraction_time=runs["exact_transition_time"] / balance_distance,
    )
    parts = [times, tables["arrest_path"].assign(role="exact_path")]
    finest_runs = runs.groupby("damping_ratio")["dx"].idxmin()
    for ratio, index in finest_runs.items():
        time, distance = front_path(point(data["arrest"], int(index)), "left")
        kept = np.unique(np.linspace(0, time.size - 1, PATH_POINTS).astype(int))
        relative_time = time / balance_distance[index]
        relative_distance = distance / balance_distance[index]
        path = {"time": relative_time[kept], "to_go": 1.0 - relative_distance[kept]}
        parts.append(pd.DataFrame(path).assign(role="path", damping_ratio=ratio))
    return pd.concat(parts, ignore_index=True)


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a) the remaining distance by time, (b) two times of arrest by spacing.

    The two times are that of the stated fraction of the path and that of the last release.
    """
    figure, (path_axes, spacing_axes) = style.new_panels(PAGE_WIDTH, 3.1, "ab")
    end = float(table.loc[table["role"] == "path", "time"].max()) * 1.08
    for (ratio, rows), marker in zip(table.groupby("damping_ratio"), MARKERS, strict=False):
        # The colour scale is logarithmic and has no colour for 0.
        colour = style.colour("damping_ratio", ratio) if ratio > 0.0 else ORANGE
        look: Look = {"color": colour}
        roles = style.by_role(rows)
        draw_path(path_axes, roles["path"], roles["exact_path"], end, look)
        path_end = roles["path"].iloc[-1]
        label = f"$b$ = {ratio:g}"
        path_axes.plot(path_end["time"], path_end["to_go"], marker, label=label, **look)
        draw_times(spacing_axes, roles["run"].sort_values("dx"), marker, look)
    fraction = table["fraction"].max()
    style.legend_below(figure, [*style.legend_handles([path_axes]), *legend_entries(fraction)], 5)
    path_axes.set(yscale="log", xlabel=r"time $t\,/\,|x_{-}|$", ylim=(5e-4, 1.1))
    levels = table.loc[table["role"] == "run", ["left", "right", "width"]].iloc[0]
    scene = style.conditions(False, **levels)
    path_axes.set(ylabel=r"still to go, $1-|x|/|x_{-}|$", title=scene)
    spacing_axes.set(xscale="log", xlabel=r"spacing $\Delta x$", ylabel=r"time $t\,/\,|x_{-}|$")
    style.few_ticks(spacing_axes.xaxis, np.unique(table["dx"].dropna()))
    return figure


def draw_path(
    axes: Axes, simulated: pd.DataFrame, exact: pd.DataFrame, end: float, look: Look
) -> None:
    """Draw the remaining distance of one left front, on a lattice and exact, by time.

    end : time up to which the exact distance is drawn
    """
    exact = exact[exact["time"] <= end]
    axes.plot(simulated["time"], simulated["to_go"], **SIMULATION_LOOK | look)
    axes.plot(exact["time"], exact["to_go"], linewidth=0.9, **look)


def draw_times(axes: Axes, runs: pd.DataFrame, marker: str, look: Look) -> None:
    """Draw both times of arrest as functions of the spacing, at one damping ratio.

    The exact time of the stated fraction is marked on the left of the finest spacing.
    """
    axes.plot(runs["dx"], runs["last_release"], marker=marker, **look)
    axes.plot(runs["dx"], runs["fraction_time"], marker + "--", **OPEN_MARKER | look)
    axes.plot(runs["dx"].min() * 0.8, runs["exact_fraction_time"].iloc[0], "<", **look)


def legend_entries(fraction: float) -> list[Line2D]:
    """Return the legend entries for the lines and markers that all damping ratios share.

    fraction : the fraction of the path at which times are compared
    """
    looks: dict[str, Look] = {
        "simulation": SIMULATION_LOOK,
        "exact": {"linewidth": 0.9},
        "last release (does not converge)": {"marker": "o"},
        f"{100.0 * fraction:g} % of the way (converges)": {"marker": "o"} | OPEN_MARKER,
        "the same, exact": {"marker": "<"},
    }
    return [entry(label, color=GREY, **look) for label, look in looks.items()]
