"""The arrest of the left front under a stress boundary, on lattices and by exact theory.

In the continuum the front approaches its final position for ever.
"""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

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
# Which runs of each simulation the figure can draw, in the words of configuration/drawn.py.
DRAWS = {
    "arrest": "boundary stress, left level below 0, right level 0 and no steps",
}

PATH_POINTS = 150
SIMULATION_LOOK: Look = {"linewidth": 3.0, "alpha": 0.35}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the path of each left front (roles path, exact_path) and arrest times (run)."""
    runs = tables["arrest"]
    # Times are in units of |x_minus|, the paper's estimate of the transition time.
    scale = runs["paper_transition_time"]
    numbers = runs[["left", "right", "width", "damping_ratio", "dx", "run_flags"]].assign(
        role="run",
        last_release=runs["last_release_time"] / scale,
        fraction=settings["measure"]["fraction"],
        fraction_time=runs["transition_time"] / scale,
        exact_fraction_time=runs["exact_transition_time"] / scale,
    )
    parts = [numbers, tables["arrest_path"].assign(role="exact_path")]
    for ratio, index in runs.groupby("damping_ratio")["dx"].idxmin().items():
        time, distance = front_path(point(data["arrest"], int(index)), "left")
        kept = np.unique(np.linspace(0, time.size - 1, PATH_POINTS).astype(int))
        lines = {"time": time[kept] / scale[index], "to_go": 1.0 - distance[kept] / scale[index]}
        parts.append(pd.DataFrame(lines).assign(role="path", damping_ratio=ratio))
    return pd.concat(parts, ignore_index=True)


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a) the remaining distance, (b) the times of the stated fraction and last release."""
    figure, (path_axes, spacing_axes) = style.new_panels(PAGE_WIDTH, 3.1, "ab")
    longest = float(table.loc[table["role"] == "path", "time"].max()) * 1.08
    for (ratio, rows), marker in zip(table.groupby("damping_ratio"), MARKERS, strict=False):
        # The colour scale is logarithmic and has no colour for 0.
        look: Look = {"color": style.colour("damping_ratio", ratio) if ratio else ORANGE}
        simulated, exact = rows[rows["role"] == "path"], rows[rows["role"] == "exact_path"]
        exact = exact[exact["time"] <= longest]
        path_axes.plot(simulated["time"], simulated["to_go"], **SIMULATION_LOOK | look)
        path_axes.plot(exact["time"], exact["to_go"], linewidth=0.9, **look)
        last, label = simulated.iloc[-1], f"$b$ = {ratio:g}"
        path_axes.plot(last["time"], last["to_go"], marker, label=label, **look)
        runs = rows[rows["role"] == "run"].sort_values("dx")
        spacing_axes.plot(runs["dx"], runs["last_release"], marker=marker, **look)
        spacing_axes.plot(runs["dx"], runs["fraction_time"], marker + "--", **OPEN_MARKER | look)
        spacing_axes.plot(runs["dx"].min() * 0.8, runs["exact_fraction_time"].iloc[0], "<", **look)
    looks = {"simulation": SIMULATION_LOOK, "exact": {"linewidth": 0.9}}
    looks["last release (does not converge)"] = {"marker": "o"}
    fraction_label = f"{100.0 * table['fraction'].max():g} % of the way (converges)"
    looks |= {fraction_label: {"marker": "o"} | OPEN_MARKER, "the same, exact": {"marker": "<"}}
    handles = [entry(label, color=GREY, **look) for label, look in looks.items()]
    style.legend_below(figure, [*style.labelled([path_axes]), *handles], 5)
    path_axes.set(yscale="log", xlabel=r"time $t\,/\,|x_{-}|$", ylim=(5e-4, 1.1))
    levels = table.loc[table["role"] == "run", ["left", "right", "width"]].iloc[0]
    scene = style.conditions(False, **levels)
    path_axes.set(ylabel=r"still to go, $1-|x|/|x_{-}|$", title=scene)
    spacing_axes.set(xscale="log", xlabel=r"spacing $\Delta x$", ylabel=r"time $t\,/\,|x_{-}|$")
    style.few_ticks(spacing_axes.xaxis, np.unique(table["dx"].dropna()))
    return figure
