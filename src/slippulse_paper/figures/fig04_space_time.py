"""Figure 4: slip velocity in time and space of two ruptures.

One is a crack that becomes two pulses, and the other is a crack that becomes a single pulse.
"""

from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slippulse.data.point import point
from slippulse.data.points import AnyRun
from slippulse.measurement.front_paths import front_position
from slippulse.plotting import space_time, style
from slippulse.plotting.style import BLACK, ORANGE, PAGE_WIDTH, PURPLE, TEXT_OUTLINE, Look

NEEDS = {
    "data": ["space_time_displacement", "space_time_stress"],
    "measured": {"space_time_displacement": [], "space_time_stress": []},
    "studies": ["exact_space_time"],
    "settings": ["measure.fraction"],
}
# Runs of each simulation that the figure can draw, in the words of configuration/drawn.py.
DRAWS = {
    "space_time_displacement": "`boundary: displacement` and equal levels > 0",
    "space_time_stress": "`boundary: stress`, left level < 0, right level 0, no steps",
}

PANELS = {"displacement": "a", "stress": "b"}
COLUMNS = ["panel", "role", "series", "time", "position", "value"]
MARK_LOOK: Look = {
    "markeredgewidth": 0.8,
    "markeredgecolor": BLACK,
    "markersize": 4.5,
    "zorder": 5.0,
}


class RuptureExtent(NamedTuple):
    """A time, with the position of the left front and the distance between both fronts."""

    time: float
    left: float
    length: float


def table(data: dict, tables: dict[str, pd.DataFrame], settings: dict) -> pd.DataFrame:
    """Return the rows of `space_time.run_table` for the first run of each sweep, and more roles.

    exact_front, exact_trailing : front and trailing edge of the exact solution
    measured, paper, last_release : the measured transition, the paper's estimate of it, and the
        last release of the left front. Each has one row for each front, with its position and the
        time. The column value has the distance between both fronts
    fraction : under a stress boundary, the transition is when the left front has covered this
        fraction of its way to the balance position x_minus
    """
    parts = []
    for panel in PANELS:
        simulation = f"space_time_{panel}"
        run = point(data[simulation], 0)
        rows = [space_time.run_table(run)]
        numbers = tables[simulation].iloc[0]
        for role, extent in rupture_extents(run, numbers).items():
            right = extent.left + extent.length
            fronts = pd.DataFrame({"series": ["left", "right"], "position": [extent.left, right]})
            rows.append(fronts.assign(role=role, time=extent.time, value=extent.length))
        exact = tables["exact_space_time"]
        exact = exact[exact["simulation"] == simulation]
        for role, column in (("exact_front", "release_time"), ("exact_trailing", "stick_time")):
            edge = pd.DataFrame({"position": exact["position"], "time": exact[column]})
            rows.append(edge.assign(role=role).dropna())
        if panel == "stress":
            fraction = settings["measure"]["fraction"]
            rows.append(pd.DataFrame([{"role": "fraction", "value": fraction}]))
        parts.append(pd.concat(rows).assign(panel=panel))
    return pd.concat(parts, ignore_index=True)[COLUMNS]


def rupture_extents(run: AnyRun, numbers: pd.Series) -> dict[str, RuptureExtent]:
    """Return the extent of the rupture at its transition, and at the last release on the left.

    The transition is given as measured ("measured"), and by the paper's estimate ("paper"). The
    last release ("last_release") exists only under a stress boundary.

    numbers : measured and predicted numbers of the run
    """
    time, length = numbers["transition_time"], numbers["transition_length"]
    left = front_position(run, time, "right") - length
    extents = {"measured": RuptureExtent(time, left, length)}
    # The estimates of the paper have no position, and are drawn symmetric about x = 0.
    length = numbers["paper_transition_length"]
    extents["paper"] = RuptureExtent(numbers["paper_transition_time"], -0.5 * length, length)
    if "last_release_time" in numbers:
        extents["last_release"] = RuptureExtent(
            time=numbers["last_release_time"],
            left=-numbers["last_release_distance"],
            length=numbers["last_release_length"],
        )
    return extents


def draw(table: pd.DataFrame) -> Figure:
    """Draw one pair of panels for each boundary condition: pre-stress, and space-time map."""
    figure = Figure(figsize=(PAGE_WIDTH, 3.3))
    figure.set_layout_engine("constrained", wspace=0.01, w_pad=0.03)
    sides = figure.subfigures(1, 2, squeeze=False, wspace=0.03).flat
    for side, (panel, letter) in zip(sides, PANELS.items(), strict=True):
        profile, axes = side.subplots(1, 2, sharey=True, width_ratios=(0.28, 1.0))
        rows_by_role = style.by_role(table[table["panel"] == panel])
        space_time.draw_profile(profile, rows_by_role)
        space_time.draw_map(axes, rows_by_role)
        draw_transition(axes, rows_by_role)
        style.panel_letter(profile, letter)
        transition = "first stick"
        # Under a stress boundary, the transition is when the left front has covered this fraction
        # of its way to the balance position x_minus.
        if "fraction" in rows_by_role:
            percent = 100.0 * rows_by_role["fraction"]["value"].iloc[0]
            transition = rf"left front at {percent:g} % of its way to $x_-$"
        definition = rf"$T_\text{{trans}}$: {transition}"
        side.suptitle(f"{space_time.run_title(rows_by_role)}\n{definition}")
    # The legend has an entry for everything that either panel shows.
    handles = style.legend_handles(figure.axes)
    style.legend_below(figure, handles, columns=len(handles))
    return figure


def draw_transition(axes: Axes, rows_by_role: dict[str, pd.DataFrame]) -> None:
    """Mark the measured transition and the paper's estimate of it.

    The exact front and trailing edge are drawn as well. Under a stress boundary, the last release
    of the left front and the balance position x_minus are also marked.

    rows_by_role : rows of the table of the figure, by their role
    """
    look: Look = {"color": PURPLE, "linestyle": (0, (2, 2)), "linewidth": 1.6, "zorder": 2.5}
    for role, label in (("exact_front", "exact"), ("exact_trailing", None)):
        if role in rows_by_role:
            axes.plot(
                rows_by_role[role]["time"], rows_by_role[role]["position"], label=label, **look
            )
    # The column value has the distance between both fronts.
    left_front = rows_by_role["measured"].iloc[0]
    time, left, length = left_front[["time", "position", "value"]]
    # A run that ends before its transition has no arrows.
    if np.isfinite(time):
        draw_arrows(axes, RuptureExtent(time, left, length))
    paper = rows_by_role["paper"]
    look = MARK_LOOK | {"color": ORANGE, "label": "paper's estimate"}
    axes.plot(paper["time"], paper["position"], "D", **look)
    # Only runs under a stress boundary have this role.
    if "last_release" in rows_by_role:
        # The paper's estimate of the transition time is then |x_minus|.
        x_minus = -float(paper["time"].iloc[0])
        draw_last_release(axes, rows_by_role["last_release"].iloc[:1], x_minus)


def draw_last_release(axes: Axes, left_front: pd.DataFrame, x_minus: float) -> None:
    """Mark the last release of the left front, and draw a line at the balance position x_minus.

    left_front : the row of the last release
    """
    axes.axhline(x_minus, color=BLACK, linewidth=0.6, linestyle="--", zorder=1.9)
    # The label stands to the right of the ticks of the vertical axis.
    axes.annotate("$x_-$", (0.0, x_minus), (6, 1), textcoords="offset points", zorder=4.0)
    look = MARK_LOOK | {"color": "white", "label": "last release"}
    axes.plot(left_front["time"], left_front["position"], "o", **look)


def draw_arrows(axes: Axes, transition: RuptureExtent) -> None:
    """Draw the transition time as a horizontal arrow, and the transition length as a vertical one.

    The horizontal arrow runs from time 0 to the transition, below the map. The vertical arrow leads
    from front to front at the transition. A dotted line connects both arrows.
    """
    time, left, length = transition
    bottom, top = axes.get_ylim()
    # The panel is extended downwards, to make room for the horizontal arrow at this height.
    map_height = top - bottom
    arrow_height = bottom - 0.04 * map_height
    axes.set_ylim(arrow_height - 0.06 * map_height, top)
    arrow: Look = {"arrowstyle": "<->", "shrinkA": 0.0, "shrinkB": 0.0, "linewidth": 0.9}
    arrow |= {"mutation_scale": 8.0, "path_effects": TEXT_OUTLINE}
    dotted: Look = {"color": BLACK, "linewidth": 0.6, "linestyle": ":", "zorder": 3.0}
    axes.plot([time, time], [arrow_height, left], **dotted)
    time_arrow = ((0.0, arrow_height), (time, arrow_height))
    length_arrow = ((time, left), (time, left + length))
    for start, stop in (time_arrow, length_arrow):
        axes.annotate("", xy=stop, xytext=start, arrowprops=arrow, zorder=4.0)
    text_look: Look = {"textcoords": "offset points", "path_effects": TEXT_OUTLINE, "zorder": 4.0}
    # The label of T_trans stands above its arrow, clear of the ticks of the axis.
    label = rf"$T_\text{{trans}} = {time:#.3g}$"
    axes.annotate(label, (0.0, arrow_height), (6, 3), va="bottom", **text_look)
    label = rf"$L_\text{{trans}} = {length:#.3g}$"
    axes.annotate(label, (time, left + 0.5 * length), (4, 0), va="center", **text_look)
