"""Figure 2: the regime in which a rupture ends, by boundary and both levels of the pre-stress."""

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure, SubFigure
from matplotlib.patches import Polygon

from ..data.numerals import setting
from . import style
from .shared.selection import spread_values
from .style import BLACK, GREY, PAGE, Look, entry, legend_below, new_figure, panel_letter

NEEDS = {
    "measured": ["regimes_displacement", "regimes_displacement_asymmetric", "regimes_stress"],
    "predicted": {
        "regimes_displacement": ["final_regime"],
        "regimes_displacement_asymmetric": ["final_regime"],
        "regimes_stress": ["final_regime"],
    },
    "studies": ["regime_plane"],
}

BOUNDARIES = {"displacement": r"$\Gamma = 1$, any $\gamma$", "stress": r"$\Gamma = 0$"}
# Colour of each regime, and its label in the planes.
LOOKS = {
    "arrested": (GREY, "arrest"),
    "crack-like, two-way": (style.BLUE, "two-way\ncrack"),
    "crack-like, one-way": (style.SKY, "one-way\ncrack"),
    "pulses, two-way": (style.ORANGE, "two\nsteady pulses"),
    "pulse, one-way, growing": (style.PURPLE, "growing pulse"),
    "pulse, one-way, steady": (style.YELLOW, "steady pulse"),
    "pulse, one-way, decaying": (style.GREEN, "decaying pulse"),
}
NUMBERS = "①②③④"
MARK: Look = {"color": BLACK, "markersize": 4.0, "markeredgewidth": 0.6}
# The number of levels of each side that is drawn of a sweep.
DRAWN = {"regimes_displacement": 3, "regimes_displacement_asymmetric": 3, "regimes_stress": 5}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Study of the planes, and some runs (role run), those with leaf springs at the largest gamma.

    The regime is that at the end of the run, exact_regime the final one by exact theory.
    """
    parts = [tables["regime_plane"]]
    for name, count in DRAWN.items():
        runs = tables[name][tables[name]["gamma"] == tables[name]["gamma"].max()]
        left = runs["left"].isin(spread_values(runs["left"], count))
        right = runs["right"].isin(spread_values(runs["right"], count))
        kept = ["boundary", "left", "right", "gamma", "regime", "exact_regime", "run_flags"]
        parts.append(runs.loc[left & right, kept].assign(role="run"))
    return pd.concat(parts, ignore_index=True)


def plot(table: pd.DataFrame) -> Figure:
    """Draw a plane for each boundary, and velocity profiles of the ruptures numbered in them."""
    figure = new_figure(PAGE, 2.75)
    planes, strips = figure.subfigures(1, 2, squeeze=False, width_ratios=(2.05, 1.0)).flat
    profiles = [rows for _, rows in table[table["role"] == "profile"].groupby("series")]
    for axes, letter, boundary in zip(planes.subplots(1, 2), "ab", BOUNDARIES, strict=True):
        rows = table[table["boundary"] == boundary]
        draw_plane(axes, rows[rows["role"].isin(["area", "line"])], labels(profiles, boundary))
        draw_runs(axes, rows[rows["role"] == "run"])
        axes.set_title(BOUNDARIES[boundary], fontsize=9)
        panel_letter(axes, letter)
    draw_profiles(strips, profiles)
    faces = {"simulation, in the colour of its regime": GREY, "not settled by its end": "white"}
    look = MARK | {"marker": "o"}
    handles = [entry(label, markerfacecolor=face, **look) for label, face in faces.items()]
    if table.loc[table["role"] == "run", "run_flags"].notna().any():
        handles.append(entry("flagged", marker="x", **MARK))
    legend_below(figure, handles, 3)
    return figure


def tint(colour: str) -> tuple[float, ...]:
    """Mix a colour with white."""
    return tuple(1.0 - 0.35 * (1.0 - part) for part in to_rgb(colour))


def labels(profiles: list[pd.DataFrame], boundary: str) -> dict[str, str]:
    """Label of each regime in the plane of a boundary, with the number of its velocity profile."""
    texts = {regime: text for regime, (_, text) in LOOKS.items()}
    for number, rows in zip(NUMBERS, profiles, strict=False):
        if rows["boundary"].iloc[0] == boundary:
            texts[rows["regime"].iloc[0]] = f"{number} {LOOKS[rows['regime'].iloc[0]][1]}"
    return texts


def draw_plane(axes: Axes, rows: pd.DataFrame, texts: dict[str, str]) -> None:
    """Draw the regimes as areas, and as lines where one level is 0, each with one label."""
    look: Look = {"ha": "center", "va": "center", "fontsize": 8.0, "zorder": 4.0}
    look["linespacing"] = 1.0
    for (role, _), part in rows.groupby(["role", "series"], sort=False):
        regime, corners = part["regime"].iloc[0], part[["left", "right"]].to_numpy()
        (left, right), colour = corners.mean(axis=0), LOOKS[regime][0]
        if role == "line":
            axes.plot(*corners.T, color=colour, linewidth=3.0, solid_capstyle="butt", gid=regime)
            if left < right:
                axes.text(left, -0.1, texts[regime], **look)
            continue
        axes.add_patch(Polygon(corners, facecolor=tint(colour), gid=regime))
        if len(corners) == 4:
            axes.text(left, right + 0.1 if right > 0.0 else right, texts[regime], **look)
        elif left < right:
            line = {"arrowstyle": "-", "linewidth": 0.6, "shrinkA": 0.0, "shrinkB": 0.0}
            axes.annotate(texts[regime], (-0.75, 0.04), (-0.6, 0.19), arrowprops=line, **look)
    ticks = (-1, 0, 1)
    axes.set(xlim=(-1.0, 1.0), ylim=(-1.0, 1.0), aspect="equal", xticks=ticks, yticks=ticks)
    axes.set(xlabel=r"pre-stress on the left $\tau_{0,l}$", ylabel=r"on the right $\tau_{0,r}$")


def draw_runs(axes: Axes, runs: pd.DataFrame) -> None:
    """Mark runs: open if theory has another final regime, crossed out if flagged."""
    for run in runs.itertuples():
        early = run.exact_regime in LOOKS and run.exact_regime != run.regime
        look = MARK | {"markerfacecolor": "white" if early else LOOKS[run.regime][0]}
        marker = "x" if isinstance(run.run_flags, str) else "o"
        axes.plot(run.left, run.right, marker, gid="run", zorder=3.0, **look)


def draw_profiles(figure: SubFigure, profiles: list[pd.DataFrame]) -> None:
    """Draw slip velocities over position, each over its largest value, one above the other."""
    strips = figure.subplots(len(profiles), 1, sharex=True)
    panel_letter(strips[0], "c")
    strips[0].set_title(rf"slip velocity at $t = {profiles[0]['time'].iloc[0]:g}$", fontsize=9)
    for number, axes, rows in zip(NUMBERS, strips, profiles, strict=False):
        colour = LOOKS[rows["regime"].iloc[0]][0]
        levels = [setting(rows[side].iloc[0]) for side in ("left", "right")]
        shape = rows["slip_velocity"] / rows["slip_velocity"].max()
        axes.fill_between(rows["x"], shape, color=tint(colour), linewidth=0.0)
        axes.plot(rows["x"], shape, color=colour)
        gamma = int(rows["boundary"].iloc[0] == "displacement")
        label = rf"{number} $\Gamma = {gamma}$, $\tau_0$ = {', '.join(levels)}"
        axes.text(0.02, 1.0, label, transform=axes.transAxes, va="top", fontsize=8.0)
        axes.set(yticks=[], ylim=(0.0, 1.75))
        axes.spines[["left", "right", "top"]].set_visible(False)
    axes.set_xlabel("position $x$")
