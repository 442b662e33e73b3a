"""Figure 4: slip velocity over time and position, of cracks that become two pulses and one."""

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from ..data.points import point
from ..measurement.fronts import position_at
from . import style
from .shared import space_time
from .style import BLACK, HALO, ORANGE, PAGE, PURPLE, Look

NEEDS = {
    "data": ["space_time_displacement", "space_time_stress"],
    "measured": ["space_time_displacement", "space_time_stress"],
    "studies": ["exact_space_time"],
    "settings": ["measure.share"],
}

PANELS = {"displacement": "a", "stress": "b"}
COLUMNS = ["role", "series", "time", "position", "value"]


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Rows of `run_rows` for the first run of both sweeps, with exact edges and the transition.

    Role fraction: of |x_minus|, that the left front has covered at T_trans under held stress.
    """
    parts = []
    for panel in PANELS:
        name = f"space_time_{panel}"
        run, exact = point(data[name], 0), tables["exact_space_time"].query("simulation == @name")
        rows = [space_time.run_rows(run), transition_rows(run, tables[name].iloc[0])]
        for role, column in (("exact_front", "release_time"), ("exact_trailing", "stick_time")):
            edge = {"role": role, "position": exact["position"], "time": exact[column]}
            rows.append(pd.DataFrame(edge).dropna())
        if panel == "stress":
            fraction = {"role": "fraction", "value": settings["measure"]["share"]}
            rows.append(pd.DataFrame([fraction]))
        parts.append(pd.concat(rows).assign(panel=panel))
    return pd.concat(parts, ignore_index=True)[["panel", *COLUMNS]]


def transition_rows(run: xr.Dataset, numbers: pd.Series) -> pd.DataFrame:
    """Both fronts (series) at T_trans, and L_trans, by role: measured, paper, and last_release (the
    last release on the left, where the run has one).
    """
    rows: list[tuple] = []

    def add(role: str, time: float, left: float, right: float, length: float) -> None:
        rows.append((role, "left", time, left, length))
        rows.append((role, "right", time, right, length))

    time, length = numbers["transition_time"], numbers["transition_length"]
    right, half = float(position_at(run, time, "right")), 0.5 * numbers["paper_transition_length"]
    add("measured", time, right - length, right, length)
    add("paper", numbers["paper_transition_time"], -half, half, 2.0 * half)
    if "last_release_time" in numbers:
        left, length = -numbers["last_release_distance"], numbers["last_release_length"]
        add("last_release", numbers["last_release_time"], left, length + left, length)
    return pd.DataFrame(rows, columns=COLUMNS)


def draw(table: pd.DataFrame) -> Figure:
    """Draw the figure; a legend entry that is in one panel alone names the panel."""
    figure = style.new_figure(PAGE, 3.3)
    figure.set_layout_engine("constrained", wspace=0.01, w_pad=0.03)
    handles: dict[str, Artist] = {}
    # Letters of the panels that have a label.
    shown_in: dict[str, str] = {}
    sides = figure.subfigures(1, 2, squeeze=False, wspace=0.03).flat
    for side, (panel, letter) in zip(sides, PANELS.items(), strict=True):
        profile, axes = side.subplots(1, 2, sharey=True, width_ratios=(0.28, 1.0))
        roles = style.by_role(table[table["panel"] == panel])
        space_time.draw_profile(profile, roles["prestress"])
        image = space_time.draw_map(axes, roles)
        draw_transition(axes, roles)
        bar = side.colorbar(image, ax=axes, pad=0.02, aspect=22)
        bar.set_label(rf"slip velocity $\dot u$ (largest {roles['largest']['value'].iloc[0]:#.3g})")
        style.panel_letter(profile, letter)
        when = "first stick"
        if "fraction" in roles:
            percent = 100.0 * roles["fraction"]["value"].iloc[0]
            when = rf"left front at {percent:g} % of its way to $x_-$"
        title = f"{space_time.description(roles)}\n" + rf"$T_\text{{trans}}$: {when}"
        side.suptitle(title, fontsize=9.0)
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            handles[label] = handle
            shown_in[label] = shown_in.get(label, "") + letter
    for label, colour in (("not yet slipped", "white"), ("stuck again", space_time.STUCK)):
        handles[label] = Patch(facecolor=colour, edgecolor=BLACK, linewidth=0.5)
    # The stuck part is grey behind a trailing edge.
    shown_in |= {"not yet slipped": "ab", "stuck again": shown_in.get("trailing edge", "a")}
    for label, handle in handles.items():
        handle.set_label(label if shown_in[label] == "ab" else f"{label} ({shown_in[label]})")
    style.legend_below(figure, list(handles.values()), len(handles))
    return figure


def draw_transition(axes: Axes, roles: dict[str, pd.DataFrame]) -> None:
    """Draw exact edges, T_trans and L_trans, the paper's estimate and the last release."""
    look: Look = {"color": PURPLE, "linestyle": (0, (2, 2)), "linewidth": 1.6, "zorder": 2.5}
    for role, label in (("exact_front", "exact"), ("exact_trailing", None)):
        if role in roles:
            axes.plot(roles[role]["time"], roles[role]["position"], label=label, **look)
    # A run that is too short for its transition has none to draw.
    if np.isfinite(roles["measured"]["time"]).all():
        draw_arrows(axes, roles["measured"].set_index("series"))
    look = {"markeredgewidth": 0.8, "markeredgecolor": BLACK, "markersize": 4.5, "zorder": 5.0}
    paper = roles["paper"]
    axes.plot(paper["time"], paper["position"], "D", color=ORANGE, label="paper's estimate", **look)
    if "last_release" in roles:
        # Under a stress boundary the paper's estimate of the time is |x_-|.
        limit = -float(paper["time"].iloc[0])
        axes.axhline(limit, color=BLACK, linewidth=0.6, linestyle="--", zorder=1.9)
        # The label stands beside the ticks of the axis.
        beside: Look = {"xytext": (6, 1), "textcoords": "offset points", "fontsize": 8.5}
        axes.annotate("$x_-$", (0.0, limit), va="bottom", zorder=4.0, **beside)
        left = roles["last_release"].iloc[:1]
        axes.plot(left["time"], left["position"], "o", color="white", label="last release", **look)


def draw_arrows(axes: Axes, ends: pd.DataFrame) -> None:
    """Draw T_trans as an arrow below the lowest position that slips, L_trans between the fronts."""
    time, length = float(ends["time"].iloc[0]), float(ends["value"].iloc[0])
    left, right = float(ends.loc["left", "position"]), float(ends.loc["right", "position"])
    low, high = axes.get_ylim()
    height = high - low
    low -= 0.04 * height
    axes.set_ylim(low - 0.06 * height, high)
    arrow: Look = {"arrowstyle": "<->", "shrinkA": 0.0, "shrinkB": 0.0, "linewidth": 0.9}
    arrow |= {"mutation_scale": 8.0, "path_effects": HALO}
    axes.plot([time, time], [low, left], color=BLACK, linewidth=0.6, linestyle=":", zorder=3.0)
    for start, stop in (((0.0, low), (time, low)), ((time, left), (time, right))):
        axes.annotate("", xy=stop, xytext=start, arrowprops=arrow, zorder=4.0)
    look: Look = {"textcoords": "offset points", "fontsize": 8.5, "path_effects": HALO}
    # The label of T_trans stands above its arrow, clear of the ticks of the axis.
    named = rf"$T_\text{{trans}} = {time:#.3g}$"
    axes.annotate(named, (0.0, low), (6, 3), va="bottom", zorder=4.0, **look)
    named = rf"$L_\text{{trans}} = {length:#.3g}$"
    axes.annotate(named, (time, 0.5 * (left + right)), (4, 0), va="center", zorder=4.0, **look)
