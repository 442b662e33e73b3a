"""The arrest of the left front under a stress boundary, on lattices and by exact theory.

In the continuum the front approaches the balance position x_minus for ever. A time can be compared
only at a stated fraction of its path.
"""

from typing import TypeAlias

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from slippulse.data.point import point
from slippulse.data.points import AnyRun
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
    "arrest": "`boundary: stress`, left level < 0, right level 0, no steps",
}

# A name such as "#D55E00", or red, green, blue and opacity.
Colour: TypeAlias = str | np.ndarray
# A path on a lattice is drawn with at most this number of points.
PATH_POINTS = 150
SIMULATION_LOOK: Look = {"linewidth": 3.0, "alpha": 0.35}


def table(data: dict, tables: dict[str, pd.DataFrame], settings: dict) -> pd.DataFrame:
    """Return the rows of three parts of the figure, which the column role names.

    run : one row for each run, with the time of the last release on the left (last_release), and
        the time at which the left front has covered the stated fraction of its path (fraction_time)
    path, exact_path : for each damping ratio, the fraction of the path that the left front has not
        yet covered (to_go) as a function of time, on the finest lattice and exact

    Times are divided by the balance distance |x_minus|, which is the length of the path.
    """
    # An overlay may add runs with other parameters. The exact paths are for the first run whose
    # left front stops.
    runs = tables["arrest"].query("left < 0.0 and right == 0.0")
    scene = runs[["left", "right", "width", "release"]]
    runs = runs[(scene == scene.iloc[0]).all(axis=1)]
    # The paper estimates that the transition takes the time |x_minus|, since the wave speed is 1.
    balance_distance = runs["paper_transition_time"]
    times = runs[["left", "right", "width", "damping_ratio", "dx", "run_flags"]].assign(
        role="run",
        last_release=runs["last_release_time"] / balance_distance,
        fraction=settings["measure"]["fraction"],
        fraction_time=runs["transition_time"] / balance_distance,
        exact_fraction_time=runs["exact_transition_time"] / balance_distance,
    )
    parts = [times, tables["arrest_path"].assign(role="exact_path")]
    number_of_finest_run = runs.groupby("damping_ratio")["dx"].idxmin()
    for ratio, number in number_of_finest_run.items():
        path = lattice_path(point(data["arrest"], int(number)), balance_distance[number])
        parts.append(path.assign(role="path", damping_ratio=ratio))
    return pd.concat(parts, ignore_index=True)


def lattice_path(run: AnyRun, balance_distance: float) -> pd.DataFrame:
    """Return the fraction of its path that the left front has not yet covered (column to_go).

    The column time has the times, divided by the balance distance. At most PATH_POINTS of the
    blocks are kept.
    """
    time, distance = front_path(run, "left")
    kept = np.unique(np.linspace(0, time.size - 1, PATH_POINTS).astype(int))
    relative_time, covered = time[kept] / balance_distance, distance[kept] / balance_distance
    return pd.DataFrame({"time": relative_time, "to_go": 1.0 - covered})


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a) the distance still to go as a function of time, (b) two times by block spacing.

    One time is that of the last release on the left. At the other, the left front has covered the
    stated fraction of its path.
    """
    figure, (path_axes, spacing_axes) = style.new_panels(PAGE_WIDTH, 3.1, "ab")
    # Exact paths go on for ever. They are drawn a little longer than the paths on lattices.
    end = float(table.loc[table["role"] == "path", "time"].max()) * 1.08
    for (ratio, rows), marker in zip(table.groupby("damping_ratio"), MARKERS, strict=False):
        # The colour scale is logarithmic and has no colour for 0.
        colour: Colour = style.colour("damping_ratio", ratio) if ratio > 0.0 else ORANGE
        rows_by_role = style.by_role(rows)
        draw_path(path_axes, rows_by_role["path"], rows_by_role["exact_path"], end, colour)
        # A marker stands at the end of the path on the lattice.
        last = rows_by_role["path"].iloc[-1]
        label = f"$b$ = {ratio:g}"
        path_axes.plot(last["time"], last["to_go"], marker, label=label, color=colour)
        draw_times(spacing_axes, rows_by_role["run"].sort_values("dx"), marker, colour)
    # All runs have the same fraction, and the other rows have none.
    fraction = table["fraction"].max()
    handles = [*style.legend_handles([path_axes]), *legend_entries(fraction)]
    style.legend_below(figure, handles, columns=5)
    path_axes.set(yscale="log", xlabel=r"time $t\,/\,|x_{-}|$", ylim=(5e-4, 1.1))
    # All runs have the same pre-stress.
    parameters = table.loc[table["role"] == "run", ["left", "right", "width"]].iloc[0]
    scene = style.conditions(held=False, **parameters)
    path_axes.set(ylabel=r"still to go, $1-|x|/|x_{-}|$", title=scene)
    spacing_axes.set(xscale="log", xlabel=r"spacing $\Delta x$", ylabel=r"time $t\,/\,|x_{-}|$")
    style.few_ticks(spacing_axes.xaxis, np.unique(table["dx"].dropna()))
    return figure


def draw_path(
    axes: Axes, simulated: pd.DataFrame, exact: pd.DataFrame, end: float, colour: Colour
) -> None:
    """Draw the distance that one left front has still to go, as a function of time.

    The wide pale line is from a lattice, and the thin line is exact.

    end : time up to which the exact distance is drawn
    """
    exact = exact[exact["time"] <= end]
    axes.plot(simulated["time"], simulated["to_go"], color=colour, **SIMULATION_LOOK)
    axes.plot(exact["time"], exact["to_go"], linewidth=0.9, color=colour)


def draw_times(axes: Axes, runs: pd.DataFrame, marker: str, colour: Colour) -> None:
    """Draw two times of the left front as functions of the spacing, at one damping ratio.

    A solid line is the time of the last release, and a dashed line is the time at which the front
    has covered the stated fraction of its path. The exact value of the latter is marked on the left
    of the finest spacing.
    """
    axes.plot(runs["dx"], runs["last_release"], marker=marker, color=colour)
    axes.plot(runs["dx"], runs["fraction_time"], marker + "--", color=colour, **OPEN_MARKER)
    axes.plot(runs["dx"].min() * 0.8, runs["exact_fraction_time"].iloc[0], "<", color=colour)


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
