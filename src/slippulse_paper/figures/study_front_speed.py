"""The front speed as a function of pre-stress, damping, leaf springs and spacing.

In all panels, lines are the exact speeds of the study front_law, and markers are lattice runs.
"""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slippulse.plotting import style
from slippulse.plotting.style import (
    BLACK,
    GREY,
    MARKERS,
    OPEN_MARKER,
    PAGE_WIDTH,
    TEXT_OUTLINE,
    Look,
    colour,
    few_ticks,
)

NEEDS = {
    "measured": {
        "front_speed": ["front"],
        "front_speed_slow": ["front"],
        "front_speed_springs": ["front"],
        "continuum_fixed_ratio": ["front"],
        "continuum_fixed_beta": ["front"],
        "front_speed_fixed_beta": ["front"],
    },
    "studies": ["front_law"],
}

RELEASE_RULES = ("total", "elastic")
# The theory of fronts with leaf springs holds for pulses of at least this number of blocks. A
# narrower pulse sticks within the lattice waves behind its front, which the theory leaves out.
MIN_PULSE_BLOCKS = 4.0
# Columns of the table that describe a run or a line.
COLUMNS = ["panel", "release", "left", "gamma", "beta", "damping_ratio", "dx"]
COLUMNS += ["springs", "held", "fixed"]


def table(data: dict, tables: dict[str, pd.DataFrame], settings: dict) -> pd.DataFrame:
    """Return the exact lines of the study front_law (role theory) and runs (role simulation).

    The column panel names the panel of a row: prestress, springs or refined. The value limit marks
    exact limits dx -> 0, which are not drawn. A run has its measured speed, its theoretical speed
    (theory), and the paper's speed without damping (undamped). The column sound is True if the run
    has no flag and meets the conditions of the theory.
    """
    lines = tables["front_law"].assign(role="theory")
    runs = pd.concat(
        [uniform_runs(tables), spring_runs(tables, lines), refined_runs(tables, lines)]
    )
    # The theory of fronts with leaf springs needs a steady and wide pulse. Without leaf springs, in
    # the panel prestress, there is no pulse and no such condition.
    has_springs = runs["panel"] != "prestress"
    is_steady = runs["pulse_state"] == "steady"
    is_wide = runs["pulse_width"] >= MIN_PULSE_BLOCKS * runs["dx"]
    meets_conditions = ~has_springs | (is_steady & is_wide)
    # The columns lattice_front_speed are from the theory with leaf springs. Where it has no speed,
    # because leaf springs are absent or hardly matter, the exact theory without them is used.
    theory = runs["lattice_front_speed_right"].fillna(runs["exact_front_speed_right"])
    rows = runs[COLUMNS].assign(
        role="simulation",
        speed=runs["front_speed_right"],
        # For refined lattices, the lines already contain the theory.
        theory=theory.where(runs["panel"] != "refined"),
        undamped=runs["paper_front_speed_right"],
        sound=runs["run_flags"].isna() & meets_conditions,
    )
    return pd.concat([rows, lines], ignore_index=True)


def uniform_runs(tables: dict[str, pd.DataFrame]) -> pd.DataFrame:
    """Return the runs without leaf springs, for both release rules."""
    runs = pd.concat([tables["front_speed"], tables["front_speed_slow"]])
    return runs.assign(panel="prestress")


def spring_runs(tables: dict[str, pd.DataFrame], lines: pd.DataFrame) -> pd.DataFrame:
    """Return the runs with leaf springs that have the release rule of the theoretical lines.

    The column springs has gamma dx^2, the dimensionless stiffness of the leaf springs.
    """
    runs = tables["front_speed_springs"]
    # All lines of this panel have one release rule.
    release = lines.loc[lines["panel"] == "springs", "release"].iloc[0]
    runs = runs[runs["release"] == release]
    return runs.assign(panel="springs", springs=runs["gamma"] * runs["dx"] ** 2)


def refined_runs(tables: dict[str, pd.DataFrame], lines: pd.DataFrame) -> pd.DataFrame:
    """Return the runs on refined lattices that belong to a theoretical line.

    As dx falls along a line, either beta or b = beta/dx is kept fixed. The column held has the name
    of the fixed one, "beta" or "b", and the column fixed has its value.
    """
    at_fixed_ratio = tables["continuum_fixed_ratio"]
    at_fixed_ratio = at_fixed_ratio.assign(held="b", fixed=at_fixed_ratio["damping_ratio"])
    at_fixed_beta = pd.concat([tables["continuum_fixed_beta"], tables["front_speed_fixed_beta"]])
    at_fixed_beta = at_fixed_beta.assign(held="beta", fixed=at_fixed_beta["beta"])
    runs = pd.concat([at_fixed_ratio, at_fixed_beta])
    line_columns = ["release", "left", "gamma", "held", "fixed"]
    parameters_of_lines = lines.loc[lines["panel"] == "refined", line_columns].drop_duplicates()
    # Merging keeps only the runs that have the parameters of a line.
    return runs.merge(parameters_of_lines).assign(panel="refined")


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a, b) both release rules, (c) leaf springs and (d) refined lattices.

    A legend above all panels has the colours of the damping ratios.
    """
    figure, panels = style.new_panels(PAGE_WIDTH, 5.2, "ab;cd")
    total_axes, elastic_axes, spring_axes, refined_axes = panels
    rows_by_panel = {str(panel): rows for panel, rows in table.groupby("panel")}
    uniform = rows_by_panel["prestress"]
    for axes, rule in zip((total_axes, elastic_axes), RELEASE_RULES, strict=True):
        _draw_uniform(axes, uniform[uniform["release"] == rule])
        axes.set_title(rf"$\Gamma = 0$, release by {rule} stress")
    total_axes.set(yscale="log", ylim=(0.93, 30.0))
    few_ticks(total_axes.yaxis, (1, 2, 5, 10, 20))
    elastic_axes.set_ylim(0.98, 1.45)
    _draw_strong_damping(elastic_axes)
    _draw_springs(spring_axes, rows_by_panel["springs"])
    _draw_refined(refined_axes, rows_by_panel["refined"])
    style.legend_above(figure, total_axes, title="damping ratio $b$")
    return figure


def _draw_uniform(axes: Axes, rows: pd.DataFrame) -> None:
    """Draw the front speed, divided by the speed without damping, as a function of pre-stress."""
    # The undamped speed is 1/sqrt(1 - tau_0^2).
    rows = rows.assign(scaled_speed=rows["speed"] * np.sqrt(1.0 - rows["left"] ** 2))
    for (ratio, group), marker in zip(rows.groupby("damping_ratio"), MARKERS, strict=False):
        line = group[group["role"] == "theory"]
        look: Look = {"color": colour("damping_ratio", ratio)}
        axes.plot(line["left"], line["scaled_speed"], gid=f"theory {ratio:g}", **look)
        _mark_runs(axes, group, "left", "scaled_speed", marker)
        # The entry in the legend has a filled marker, even if all runs are flagged.
        axes.plot([], [], marker, label=f"{ratio:g}", **look)
    axes.set(xlabel=r"pre-stress $\tau_0$", xlim=(0.0, 1.0), ylabel=r"$v\,\sqrt{1-\tau_0^2}$")


def _draw_strong_damping(axes: Axes) -> None:
    """Draw the limit of strong damping (b -> infinity) under the elastic release rule.

    In this limit the front speed v is 1/sqrt(1 - tau_0).
    """
    tau0 = np.linspace(0.0, 1.0, 101)
    # The vertical axis shows v sqrt(1 - tau_0^2), which is sqrt(1 + tau_0) in this limit.
    scaled_speed = np.sqrt(1.0 + tau0)
    label = r"$v=1/\sqrt{1-\tau_0}$, $b\to\infty$"
    limit = axes.plot(tau0, scaled_speed, ":", color=BLACK, label=label)
    axes.legend(handles=limit, loc="upper left")


def _draw_springs(axes: Axes, rows: pd.DataFrame) -> None:
    """Draw the front speed as a function of the stiffness gamma dx^2 of the leaf springs.

    A cross marks where a line ends, because no front beyond is faster than the waves. Levels of the
    pre-stress are distinguished by dashes and markers, and damping ratios by colours.
    """
    looks = (("--", "s"), ("-", "o"))
    look_of_level = dict(zip(np.unique(rows["left"]), looks, strict=False))
    for (level, ratio), group in rows.groupby(["left", "damping_ratio"]):
        line = group[group["role"] == "theory"].sort_values("springs")
        dashes, marker = look_of_level[level]
        shade = colour("damping_ratio", ratio)
        axes.plot(line["springs"], line["speed"], dashes, color=shade)
        # The theory has no speed beyond the end of the line.
        if line["speed"].isna().any():
            end = line.dropna(subset="speed").tail(1)
            axes.plot(end["springs"], end["speed"], "x", color=shade)
        _mark_runs(axes, group, "springs", "speed", marker)
    for level, (dashes, marker) in look_of_level.items():
        axes.plot([], [], dashes, marker=marker, color=GREY, label=rf"$\tau_0 = {level:g}$")
    axes.plot([], [], "x", color=GREY, label="no front beyond")
    axes.plot([], [], "s", color=GREY, label="too narrow for the theory", **OPEN_MARKER)
    axes.set(xscale="log", yscale="log", xlabel=r"leaf springs $\gamma\,\Delta x^2$")
    axes.set(ylabel="front speed $v$", title=r"$\Gamma = 1$, release by total stress")
    few_ticks(axes.yaxis, (1, 1.5, 2, 3, 4, 5))
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 0.56))


def _draw_refined(axes: Axes, rows: pd.DataFrame) -> None:
    """Draw front speeds as functions of the spacing, and two formulas as horizontal lines.

    Along a line, either beta or b = beta/dx is fixed: its name is in the column held, and its value
    in the column fixed. The formulas are the speeds without damping and with strong damping (see
    `_draw_strong_damping`). At fixed beta, the damping becomes strong as dx falls.
    """
    symbols = {"b": "b", "beta": r"\beta"}
    lines = rows.groupby(["held", "fixed", "release"])
    for ((fixed_name, fixed_value, rule), group), marker in zip(lines, MARKERS, strict=False):
        line = group[group["role"] == "theory"].sort_values("dx")
        label = rf"fixed ${symbols[fixed_name]} = {fixed_value:g}$, {rule}"
        look: Look = {"color": GREY, "linewidth": 0.8}
        axes.plot(line["dx"], line["speed"], **look)
        _mark_runs(axes, group, "dx", "speed", marker)
        axes.plot([], [], marker=marker, label=label, **look)
    # All runs have the same pre-stress.
    tau0 = float(rows["left"].iloc[0])
    undamped = 1.0 / np.sqrt(1.0 - tau0**2)
    strongly_damped = 1.0 / np.sqrt(1.0 - tau0)
    label = r"$1/\sqrt{1-\tau_0}$"
    _mark_speed(axes, strongly_damped, label, dashes=":", edge="bottom")
    _mark_speed(axes, undamped, r"$1/\sqrt{1-\tau_0^2}$", dashes="--", edge="top")
    axes.set(xscale="log", yscale="log", xlabel=r"spacing $\Delta x$", ylabel="front speed $v$")
    few_ticks(axes.yaxis, (1.2, 1.5, 2, 2.5, 3))
    title = rf"$\Gamma = 1$, refining, $\tau_0 = {tau0:g}$"
    axes.set(ylim=(0.88 * undamped, None), title=title)
    axes.legend(loc="upper right")


def _mark_speed(axes: Axes, speed: float, label: str, dashes: str, edge: str) -> None:
    """Draw a horizontal line at a speed. The "top" or "bottom" edge of its label is on the line."""
    axes.axhline(speed, color=BLACK, linewidth=0.8, linestyle=dashes)
    look: Look = {"transform": axes.get_yaxis_transform(), "ha": "right", "va": edge}
    axes.text(0.99, speed, label, path_effects=TEXT_OUTLINE, **look)


def _mark_runs(axes: Axes, rows: pd.DataFrame, x: str, y: str, marker: str) -> None:
    """Mark the runs among some rows in the colour of their damping ratio.

    Markers are open if a run is flagged or does not meet the conditions of the theory (see the
    column sound in `table`).

    x, y : columns on the axes
    """
    runs = rows[rows["role"] == "simulation"]
    groups = runs.groupby(["damping_ratio", runs["sound"].astype(bool)])
    for (ratio, is_sound), group in groups:
        look: Look = {} if is_sound else OPEN_MARKER
        axes.plot(group[x], group[y], marker, color=colour("damping_ratio", ratio), **look)
