"""Other friction laws: where pulses stick or creep, and the front speed at fixed damping."""

import pandas as pd
from matplotlib.figure import Figure

from slippulse.plotting import style
from slippulse.plotting.style import BLACK, BLUE, GREY, MARKERS, OPEN_MARKER, PAGE_WIDTH, SKY

NEEDS = {"studies": ["friction_laws"]}
table = style.as_given

RATE_LABEL, WEAKENING_LABEL = r"$F/\tau_0$", r"$\gamma d_c/\tau_0^2$"
# The laws of each panel, with its axis label and the formula of the friction strength.
PANEL_LAWS = {
    ("rate_weakening", "bounded_rate"): (RATE_LABEL, r"$-\min(a\dot u,F)$, $F\dot u/(\dot u+v_0)$"),
    ("slip_weakening",): (WEAKENING_LABEL, r"$1-u/d_c$"),
    ("exponential_weakening",): (WEAKENING_LABEL, r"$\mathrm{e}^{-u/d_c}$"),
}
LEVEL_COLOURS = (SKY, BLUE)


def draw(table: pd.DataFrame) -> Figure:
    """Draw regimes of (a) bounded rate laws and (b, c) slip weakening, and (d) front speeds."""
    figure, (*planes, speeds) = style.new_panels(PAGE_WIDTH, 5.2, "ab;cd")
    roles = style.by_role(table)
    runs, fronts = roles["plane"], roles["selection"]
    for axes, (laws, (label, title)) in zip(planes, PANEL_LAWS.items(), strict=True):
        style.draw_regimes(axes, runs[runs["law"].isin(laws)], "strength")
        axes.set(xlabel=label, ylabel=r"pre-stress $\tau_0$", ylim=(0.1, 0.9))
        axes.set_title(title)
    planes[0].axvline(0.0, color=GREY, linewidth=0.6, linestyle=":")
    for colour, (level, rows) in zip(LEVEL_COLOURS, fronts.groupby("level"), strict=True):
        for marker, (dx, points) in zip(MARKERS, rows.groupby("dx"), strict=False):
            resolution = points["d_c"] / dx
            speeds.plot(resolution, points["exact_speed"], color=colour, linewidth=0.8)
            speeds.plot(resolution, points["speed"], marker, color=colour, **OPEN_MARKER)
        speeds.lines[-2].set_label(rf"exact, $\tau_0 = {level:g}$")
    for marker, dx in zip(MARKERS, sorted(fronts["dx"].unique()), strict=False):
        speeds.plot(
            [], [], marker, color=GREY, label=rf"lattice, $\Delta x = {dx:g}$", **OPEN_MARKER
        )
    speeds.axhline(1.0, color=BLACK, linewidth=0.6, linestyle=":")
    speeds.set(xscale="log", xlabel=r"$d_c/\Delta x$", ylabel=r"front speed $v$")
    style.few_ticks(speeds.xaxis, (1, 2, 4, 8))
    speeds.set_title(rf"$1-u/d_c$, $\beta = {fronts['beta'].iloc[0]:g}$")
    # The legend is below the fast fronts and to the left of the slow ones.
    speeds.set_ylim(0.7, None)
    speeds.legend(loc="lower left")
    handles = style.labelled(planes)
    style.legend_below(figure, handles, len(handles))
    return figure
