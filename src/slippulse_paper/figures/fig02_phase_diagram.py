"""Figure 2: the regime in which a rupture ends, for each boundary, pre-stress and gamma."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure, SubFigure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon

from slippulse.model.prestress import Prestress
from slippulse.plotting import style
from slippulse.plotting.selection import spread_values
from slippulse.plotting.style import (
    BLACK,
    GREY,
    PAGE_WIDTH,
    SMALL_TEXT,
    Look,
    entry,
    legend_below,
    panel_letter,
)

from ..text.numerals import setting

NEEDS = {
    "measured": {
        "regimes_displacement": ["final_regime"],
        "regimes_displacement_asymmetric": ["final_regime"],
        "regimes_stress": ["final_regime"],
    },
    "studies": ["regime_plane"],
}
# Runs of each simulation that the figure can draw, in the words of configuration/drawn.py.
DRAWS = {
    "regimes_displacement": "`boundary: displacement`",
    "regimes_displacement_asymmetric": "`boundary: displacement`",
    "regimes_stress": "`boundary: stress`",
}

BOUNDARIES = {"displacement": r"$\Gamma = 1$, any $\gamma$", "stress": r"$\Gamma = 0$"}
# Colour of each regime, and its label in the planes.
LOOKS = {
    "arrested": (GREY, "arrest"),
    "crack-like, two-way": (style.BLUE, "two-way\ncrack"),
    "crack-like, one front slow": (style.SKY, "crack, one\nfront slow"),
    "crack-like, one-way": (style.BLACK, "one-way\ncrack"),
    "pulses, two-way": (style.ORANGE, "two\nsteady pulses"),
    "pulse, one-way, growing": (style.PURPLE, "growing pulse"),
    "pulse, one-way, steady": (style.YELLOW, "steady pulse"),
    "pulse, one-way, decaying": (style.GREEN, "decaying pulse"),
}
# Numbers of the drawn velocity profiles.
NUMBERS = "①②③④"
MARK: Look = {"color": BLACK, "markersize": 4.0}
# Number of pre-stress levels on each side that are drawn, for each sweep.
LEVEL_COUNTS = {
    "regimes_displacement": 3,
    "regimes_displacement_asymmetric": 3,
    "regimes_stress": 5,
}


def table(data: dict, tables: dict[str, pd.DataFrame], settings: dict) -> pd.DataFrame:
    """Return the rows of the study regime_plane, and runs of the sweeps with two more roles.

    symmetric : all runs with equal levels on both sides
    run : some runs at the largest gamma, with evenly spread levels on each side
    """
    parts = [tables["regime_plane"]]
    columns = ["boundary", "left", "right", "gamma", "regime", "exact_regime", "run_flags"]
    for name, level_count in LEVEL_COUNTS.items():
        runs = tables[name][columns]
        parts.append(runs[runs["left"] == runs["right"]].assign(role="symmetric"))
        # The final regime does not depend on gamma, so runs at one gamma are enough for the planes.
        runs = runs[runs["gamma"] == runs["gamma"].max()]
        has_drawn_left = runs["left"].isin(spread_values(runs["left"], level_count))
        has_drawn_right = runs["right"].isin(spread_values(runs["right"], level_count))
        parts.append(runs[has_drawn_left & has_drawn_right].assign(role="run"))
    return pd.concat(parts, ignore_index=True)


def draw(table: pd.DataFrame) -> Figure:
    """Draw the final regimes, and on the right numbered velocity profiles of some of them (d).

    Panel a shows runs with equal pre-stress on both sides, as a function of tau_0 and gamma: above
    for the displacement boundary, and below for the stress boundary, where gamma is 0. Panels b and
    c show planes of the pre-stress on the left and on the right, one for each boundary.
    """
    figure = Figure(figsize=(PAGE_WIDTH, 5.0), layout="constrained")
    left_half, right_half = figure.subfigures(1, 2, squeeze=False, width_ratios=(2.0, 1.0)).flat
    above, below = left_half.subfigures(2, 1, squeeze=False, height_ratios=(1.0, 1.1)).flat
    symmetric_panels = above.subplots(2, 1, sharex=True, height_ratios=(3.4, 1.0))
    plane_panels = below.subplots(1, 2)
    profiles = [rows for _, rows in table[table["role"] == "profile"].groupby("series")]
    numbers = numbers_of_regimes(profiles)
    for boundary, axes in zip(BOUNDARIES, symmetric_panels, strict=True):
        rows = table[table["boundary"] == boundary]
        draw_regimes_of_equal_levels(axes, rows[rows["role"] == "area"])
        draw_runs(axes, rows[rows["role"] == "symmetric"], "gamma")
    for (boundary, title), axes, letter in zip(BOUNDARIES.items(), plane_panels, "bc", strict=True):
        rows = table[table["boundary"] == boundary]
        draw_plane(axes, rows[rows["role"].isin(["area", "line"])], numbers)
        draw_runs(axes, rows[rows["role"] == "run"], "right")
        axes.set_title(title, loc="center")
        panel_letter(axes, letter)
    held, imposed = symmetric_panels
    held.set(yscale="log", ylabel=r"$\Gamma = 1$,  $\gamma$")
    imposed.set(xlim=(-1.0, 1.0), ylim=(-1.0, 1.0), yticks=[], ylabel=r"$\Gamma = 0$")
    imposed.set(xticks=(-1, -0.5, 0, 0.5, 1), xlabel=r"pre-stress on both sides $\tau_0$")
    panel_letter(held, "a")
    draw_profiles(right_half, profiles)
    legend_below(figure, legend_entries(table), columns=3)
    return figure


def numbers_of_regimes(profiles: list[pd.DataFrame]) -> dict[tuple[str, str], str]:
    """Return the number of each drawn velocity profile as a text, by its boundary and regime.

    The text is put in front of the name of the regime in the plane.
    """
    numbers = {}
    # There may be fewer profiles than numbers.
    for number, rows in zip(NUMBERS, profiles, strict=False):
        boundary, regime = rows[["boundary", "regime"]].iloc[0]
        numbers[boundary, regime] = f"{number} "
    return numbers


def legend_entries(table: pd.DataFrame) -> list[Line2D]:
    """Return one legend entry for each kind of mark that stands for a run (see `draw_runs`)."""
    label = "simulation, in the colour of its regime"
    handles = [entry(label, marker="o", markerfacecolor=GREY, **MARK)]
    # At the end of such a run, the regime that theory predicts has not yet been reached.
    label = "not settled by its end"
    handles.append(entry(label, marker="o", markerfacecolor="white", **MARK))
    if table["run_flags"].notna().any():
        handles.append(entry("flagged", marker="x", **MARK))
    return handles


def draw_regimes_of_equal_levels(axes: Axes, areas: pd.DataFrame) -> None:
    """Colour and label the regimes along an axis of the pre-stress that is the same on both sides.

    There is one regime for negative and one for positive pre-stress. In the plane of the pre-stress
    on the left and on the right, they are the two quadrants on the diagonal.

    areas : corners of the areas of the plane, in the columns left and right; an area has a number
        in the column series
    """
    for _, corners in areas.groupby("series"):
        centre_left, centre_right = corners[["left", "right"]].mean()
        is_on_diagonal = centre_left == centre_right
        if is_on_diagonal:
            regime = corners["regime"].iloc[0]
            colour, text = LOOKS[regime]
            levels = corners["left"]
            axes.axvspan(levels.min(), levels.max(), facecolor=tint(colour), gid=regime)
            look: Look = {"ha": "center", "va": "bottom", "xycoords": ("data", "axes fraction")}
            axes.annotate(text.replace("\n", " "), (centre_left, 1.02), **look)


def tint(colour: str) -> tuple[float, ...]:
    """Return a light shade of a colour: 35 % of it, mixed with white."""
    return tuple(1.0 - 0.35 * (1.0 - component) for component in to_rgb(colour))


def draw_plane(axes: Axes, rows: pd.DataFrame, numbers: dict[tuple, str]) -> None:
    """Draw the regimes of the plane of pre-stress on the left and on the right.

    A regime fills a quadrant, a narrow area, or a line on which one level is 0. Narrow areas and
    lines occur twice, as mirror images, and only those with the lower level on the left are
    labelled.

    rows : corners of areas and ends of lines, in the columns left and right. The rows of one shape
        have the same number in the column series
    numbers : text before the label of some regimes, by boundary and regime
    """
    look: Look = {"ha": "center", "va": "center", "linespacing": 1.0, "zorder": 4.0}
    for _, shape in rows.groupby("series", sort=False):
        role, boundary, regime = shape[["role", "boundary", "regime"]].iloc[0]
        corners = shape[["left", "right"]].to_numpy()
        centre_left, centre_right = corners.mean(axis=0)
        colour, text = LOOKS[regime]
        text = numbers.get((boundary, regime), "") + text
        if role == "line":
            line: Look = {"color": colour, "linewidth": 3.0, "solid_capstyle": "butt"}
            axes.plot(shape["left"], shape["right"], gid=regime, **line)
        else:
            axes.add_patch(Polygon(corners, facecolor=tint(colour), gid=regime))
        is_quadrant = role == "area" and len(corners) == 4
        is_labelled_image = centre_left < centre_right
        if is_quadrant:
            # In the upper quadrants, the label leaves room for that of a narrow area below it.
            height = centre_right + 0.1 if centre_right > 0.0 else centre_right
            axes.text(centre_left, height, text, **look)
        elif is_labelled_image and role == "line":
            # This line is the left half of the horizontal axis.
            axes.text(centre_left, -0.1, text, **look)
        elif is_labelled_image:
            # The label of a narrow area stands outside, with a line that points to the area.
            pointer = {"arrowstyle": "-", "linewidth": 0.6, "shrinkA": 0.0, "shrinkB": 0.0}
            axes.annotate(text, (-0.75, 0.04), (-0.6, 0.19), arrowprops=pointer, **look)
    ticks = (-1, 0, 1)
    axes.set(xlim=(-1.0, 1.0), ylim=(-1.0, 1.0), aspect="equal", xticks=ticks, yticks=ticks)
    axes.set(xlabel=r"pre-stress on the left $\tau_{0,l}$", ylabel=r"on the right $\tau_{0,r}$")


def draw_runs(axes: Axes, runs: pd.DataFrame, y_column: str) -> None:
    """Mark runs in the colour of their regime, with the pre-stress on the left as horizontal axis.

    A mark is open if theory predicts another final regime, and a cross if the run is flagged.

    y_column : column on the vertical axis
    """
    for run in runs.itertuples():
        colour, _ = LOOKS[run.regime]
        # If theory does not decide the regime, exact_regime is not the name of a regime.
        differs_from_theory = run.exact_regime in LOOKS and run.exact_regime != run.regime
        look = MARK | {"markerfacecolor": "white" if differs_from_theory else colour}
        marker = "x" if isinstance(run.run_flags, str) else "o"
        axes.plot(run.left, getattr(run, y_column), marker, gid=run.role, zorder=3.0, **look)


def draw_profiles(figure: SubFigure, profiles: list[pd.DataFrame]) -> None:
    """Draw one panel for each profile: slip velocity and pre-stress as functions of position.

    profiles : points of each profile; all profiles are at the same time
    """
    strips = figure.subplots(len(profiles), 1, sharex=True)
    panel_letter(strips[0], "d")
    # All panels show the positions from -end to end.
    end = 1.08 * pd.concat(profiles)["x"].abs().max()
    title = rf"slip velocity at $t = {profiles[0]['time'].iloc[0]:g}$"
    strips[0].set_title(title, loc="center")
    for number, axes, rows in zip(NUMBERS, strips, profiles, strict=False):
        draw_strip(axes, rows, number, end)
    strips[-1].set(xlabel="position $x$", xlim=(-end, end))


def draw_strip(axes: Axes, rows: pd.DataFrame, number: str, end: float) -> None:
    """Draw the slip velocity of one profile divided by its largest value, and its pre-stress.

    rows : points of the profile. All have the boundary, levels and regime of its scene
    number : number of the profile, as text
    end : the pre-stress is drawn from the position -end to the position end
    """
    first = rows.iloc[0]
    colour, _ = LOOKS[first["regime"]]
    relative_velocity = rows["slip_velocity"] / rows["slip_velocity"].max()
    axes.fill_between(rows["x"], relative_velocity, color=tint(colour), linewidth=0.0)
    axes.plot(rows["x"], relative_velocity, color=colour)
    capital_gamma = int(first["boundary"] == "displacement")
    levels = f"{setting(first['left'])}, {setting(first['right'])}"
    label = rf"{number} $\Gamma = {capital_gamma}$, $\tau_0$ = {levels}"
    axes.text(0.02, 1.0, label, transform=axes.transAxes, va="top")
    # The pre-stress stands above the velocity, on a scale of its own: its value 0 is at the height
    # zero, and its value 1 is higher by unit_height.
    zero, unit_height = 1.5, 0.4
    axes.axhline(zero, color=GREY, linewidth=0.6, linestyle=":")
    x = np.linspace(-end, end, 201)
    tau = Prestress(first["left"], first["right"])(x)
    axes.plot(x, zero + unit_height * tau, color=BLACK, linewidth=0.8, gid="prestress")
    axes.set_yticks([zero, zero + unit_height], ["0", "1"], fontsize=SMALL_TEXT)
    axes.set_ylabel(r"$\tau$", y=0.65, rotation=0, va="center")
    axes.set_ylim(0.0, 2.6)
    axes.spines[["left", "right", "top"]].set_visible(False)
