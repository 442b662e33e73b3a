"""The front speed by pre-stress, beta/dx and leaf springs, and its limit on refined lattices."""

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
# Narrower pulses stick inside the lattice waves at their front, which the theory leaves out.
MIN_PULSE_BLOCKS = 4.0
COLUMNS = ["panel", "release", "left", "gamma", "beta", "damping_ratio", "dx"]
COLUMNS += ["springs", "held", "fixed"]


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the lines of the study front_law (role theory) and the runs of each panel.

    The column sound is True if the theory should hold for a run.
    """
    lines = tables["front_law"].assign(role="theory")
    uniform = pd.concat([tables["front_speed"], tables["front_speed_slow"]])
    springs = tables["front_speed_springs"]
    rule = lines.loc[lines["panel"] == "springs", "release"].iloc[0]
    springs = springs[springs["release"] == rule]
    springs = springs.assign(panel="springs", springs=springs["gamma"] * springs["dx"] ** 2)
    ratio = tables["continuum_fixed_ratio"]
    ratio = ratio.assign(held="b", fixed=ratio["damping_ratio"])
    betas = pd.concat([tables["continuum_fixed_beta"], tables["front_speed_fixed_beta"]])
    refined = pd.concat([ratio, betas.assign(held="beta", fixed=betas["beta"])])
    # The study has lines for only some of the refined scenes.
    drawn = lines.loc[lines["panel"] == "refined", ["release", "left", "gamma", "held", "fixed"]]
    refined = refined.merge(drawn.drop_duplicates()).assign(panel="refined")
    runs = pd.concat([uniform.assign(panel="prestress"), springs, refined])
    wide = (runs["pulse_state"] == "steady") & (
        runs["pulse_width"] >= MIN_PULSE_BLOCKS * runs["dx"]
    )
    theory = runs["lattice_front_speed_right"].fillna(runs["exact_front_speed_right"])
    runs = runs[COLUMNS].assign(
        role="simulation",
        speed=runs["front_speed_right"],
        # For refined lattices, the lines already contain the theory.
        theory=theory.where(runs["panel"] != "refined"),
        undamped=runs["paper_front_speed_right"],
        sound=runs["run_flags"].isna() & (wide | (runs["panel"] == "prestress")),
    )
    return pd.concat([runs, lines], ignore_index=True)


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a, b) both release rules, (c) leaf springs and (d) refined lattices."""
    figure, grid = style.new_panels(PAGE_WIDTH, 5.2, "ab;cd")
    panels = {str(panel): rows for panel, rows in table.groupby("panel")}
    uniform = panels["prestress"]
    uniform = uniform.assign(scaled_speed=uniform["speed"] * np.sqrt(1.0 - uniform["left"] ** 2))
    for axes, rule in zip(grid, RELEASE_RULES, strict=False):
        rows = uniform[uniform["release"] == rule]
        for (ratio, group), marker in zip(rows.groupby("damping_ratio"), MARKERS, strict=False):
            line = group[group["role"] == "theory"]
            look: Look = {"color": colour("damping_ratio", ratio), "gid": f"theory {ratio:g}"}
            axes.plot(line["left"], line["scaled_speed"], **look)
            _points(axes, group, "left", "scaled_speed", marker, f"{ratio:g}")
        axes.set(xlabel=r"pre-stress $\tau_0$", xlim=(0.0, 1.0), ylabel=r"$v\,\sqrt{1-\tau_0^2}$")
        axes.set_title(rf"$\Gamma = 0$, release by {rule} stress")
    grid[0].set(yscale="log", ylim=(0.93, 30.0))
    few_ticks(grid[0].yaxis, (1, 2, 5, 10, 20))
    grid[1].set_ylim(0.98, 1.45)
    left, label = np.linspace(0.0, 1.0, 101), r"$v=1/\sqrt{1-\tau_0}$, $b\to\infty$"
    limit = grid[1].plot(left, np.sqrt(1.0 + left), ":", color=BLACK, label=label)
    grid[1].legend(handles=limit, loc="upper left")
    springs, rows = grid[2], panels["springs"]
    looks = dict(zip(np.unique(rows["left"]), (("--", "s"), ("-", "o")), strict=False))
    for (level, ratio), group in rows.groupby(["left", "damping_ratio"]):
        line = group[group["role"] == "theory"].sort_values("springs")
        dashes, marker = looks[level]
        springs.plot(line["springs"], line["speed"], dashes, color=colour("damping_ratio", ratio))
        last = line[line["speed"].notna() & line["speed"].isna().shift(-1, fill_value=False)]
        springs.plot(last["springs"], last["speed"], "x", color=colour("damping_ratio", ratio))
        _points(springs, group, "springs", "speed", marker)
    for level, (dashes, marker) in looks.items():
        springs.plot([], [], dashes, marker=marker, color=GREY, label=rf"$\tau_0 = {level:g}$")
    springs.plot([], [], "x", color=GREY, label="no front beyond")
    springs.plot([], [], "s", color=GREY, label="too narrow for the theory", **OPEN_MARKER)
    springs.set(xscale="log", yscale="log", xlabel=r"leaf springs $\gamma\,\Delta x^2$")
    springs.set(ylabel="front speed $v$", title=r"$\Gamma = 1$, release by total stress")
    few_ticks(springs.yaxis, (1, 1.5, 2, 3, 4, 5))
    springs.legend(loc="lower left", bbox_to_anchor=(0.0, 0.56))
    _draw_refined(grid[3], panels["refined"], float(panels["limit"]["speed"].max()))
    style.legend_above(figure, grid[0], title="damping ratio $b$")
    return figure


def _draw_refined(axes: Axes, rows: pd.DataFrame, limit: float) -> None:
    """Draw front speeds on refined lattices, with both limits as horizontal lines."""
    names = {"b": "b", "beta": r"\beta"}
    lines = rows.groupby(["held", "fixed", "release"])
    for ((held, fixed, rule), group), marker in zip(lines, MARKERS, strict=False):
        line = group[group["role"] == "theory"].sort_values("dx")
        name = rf"fixed ${names[held]} = {fixed:g}$, {rule}"
        look: Look = {"color": GREY, "linewidth": 0.8}
        axes.plot(line["dx"], line["speed"], **look)
        _points(axes, group, "dx", "speed", marker)
        axes.plot([], [], marker=marker, label=name, **look)
    undamped = rows["undamped"].max()
    limits = (limit, ":", r"\tau_0", "bottom"), (undamped, "--", r"\tau_0^2", "top")
    for value, dashes, name, side in limits:
        axes.axhline(value, color=BLACK, linewidth=0.8, linestyle=dashes)
        look = {"transform": axes.get_yaxis_transform(), "ha": "right", "va": side}
        axes.text(0.99, value, rf"$1/\sqrt{{1-{name}}}$", path_effects=TEXT_OUTLINE, **look)
    axes.set(xscale="log", yscale="log", xlabel=r"spacing $\Delta x$", ylabel="front speed $v$")
    few_ticks(axes.yaxis, (1.2, 1.5, 2, 2.5, 3))
    title = rf"$\Gamma = 1$, refining, $\tau_0 = {rows['left'].iloc[0]:g}$"
    axes.set(ylim=(0.88 * undamped, None), title=title)
    axes.legend(loc="upper right")


def _points(
    axes: Axes, rows: pd.DataFrame, x: str, y: str, marker: str, label: str | None = None
) -> None:
    """Mark simulated speeds in the colour of their damping ratio.

    Markers are open if the theory should not hold.
    """
    runs = rows[rows["role"] == "simulation"]
    for (ratio, sound), group in runs.groupby(["damping_ratio", runs["sound"].astype(bool)]):
        look: Look = {"label": label} if sound else OPEN_MARKER
        axes.plot(group[x], group[y], marker, color=colour("damping_ratio", ratio), **look)
