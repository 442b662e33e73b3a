"""Other friction laws than that of the paper: their regimes, and their front speed.

Some pulses stick, and others creep. The front speed is shown at a fixed damping beta.
"""

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slippulse.plotting import style
from slippulse.plotting.style import BLACK, BLUE, GREY, MARKERS, OPEN_MARKER, PAGE_WIDTH, SKY

NEEDS = {"studies": ["friction_laws"]}
table = style.as_given

RATE_LABEL, WEAKENING_LABEL = r"$F/\tau_0$", r"$\gamma d_c/\tau_0^2$"
# The friction laws in each panel, the label of its horizontal axis, and the formulas of the laws.
PANEL_LAWS = {
    ("rate_weakening", "bounded_rate"): (RATE_LABEL, r"$-\min(a\dot u,F)$, $F\dot u/(\dot u+v_0)$"),
    ("slip_weakening",): (WEAKENING_LABEL, r"$1-u/d_c$"),
    ("exponential_weakening",): (WEAKENING_LABEL, r"$\mathrm{e}^{-u/d_c}$"),
}
LEVEL_COLOURS = (SKY, BLUE)


def draw(table: pd.DataFrame) -> Figure:
    """Draw regimes of (a) bounded rate laws and (b, c) slip weakening, and (d) front speeds.

    The role plane has the regimes, and the role selection has the front speeds of panel d.
    """
    figure, (*planes, speed_axes) = style.new_panels(PAGE_WIDTH, 5.2, "ab;cd")
    rows_by_role = style.by_role(table)
    runs = rows_by_role["plane"]
    for axes, (laws, (label, title)) in zip(planes, PANEL_LAWS.items(), strict=True):
        style.draw_regimes(axes, runs[runs["law"].isin(laws)], "strength")
        axes.set(xlabel=label, ylabel=r"pre-stress $\tau_0$", ylim=(0.1, 0.9))
        axes.set_title(title)
    # Friction weakens with slip velocity on the left of this line, and strengthens on its right.
    planes[0].axvline(0.0, color=GREY, linewidth=0.6, linestyle=":")
    draw_speeds(speed_axes, rows_by_role["selection"])
    handles = style.legend_handles(planes)
    style.legend_below(figure, handles, columns=len(handles))
    return figure


def draw_speeds(axes: Axes, runs: pd.DataFrame) -> None:
    """Draw front speeds under slip weakening, exact and on lattices.

    The horizontal axis is the slip-weakening distance d_c divided by the block spacing. Each level
    of the pre-stress has a colour, and each spacing has a marker.
    """
    for colour, (level, runs_at_level) in zip(LEVEL_COLOURS, runs.groupby("level"), strict=True):
        for marker, (dx, points) in zip(MARKERS, runs_at_level.groupby("dx"), strict=False):
            relative_distance = points["d_c"] / dx
            exact_speed = points["exact_speed"]
            (line,) = axes.plot(relative_distance, exact_speed, color=colour, linewidth=0.8)
            axes.plot(relative_distance, points["speed"], marker, color=colour, **OPEN_MARKER)
        # The exact lines of a level look alike, so only the last one gets an entry in the legend.
        line.set_label(rf"exact, $\tau_0 = {level:g}$")
    for marker, dx in zip(MARKERS, sorted(runs["dx"].unique()), strict=False):
        label = rf"lattice, $\Delta x = {dx:g}$"
        axes.plot([], [], marker, color=GREY, label=label, **OPEN_MARKER)
    # This line is at the wave speed.
    axes.axhline(1.0, color=BLACK, linewidth=0.6, linestyle=":")
    axes.set(xscale="log", xlabel=r"$d_c/\Delta x$", ylabel=r"front speed $v$")
    style.few_ticks(axes.xaxis, (1, 2, 4, 8))
    axes.set_title(rf"$1-u/d_c$, $\beta = {runs['beta'].iloc[0]:g}$")
    # The legend is below the fast fronts and to the left of the slow ones.
    axes.set_ylim(0.7, None)
    axes.legend(loc="lower left")
