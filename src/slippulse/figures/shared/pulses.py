"""Pulses in their own frame, simulated and exact: rows of a figure's table, and how they are drawn."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ...data.points import point
from ...measurement.pulses import comoving, leading_pulse
from ...model.prestress import Prestress
from ..style import BLACK, PAGE, Look, colour_scale, entry, legend_below, new_panels
from .scaling import chosen

# Their labels in the units of each boundary.
FIELDS = {
    "slip": {"displacement": r"slip $u\,\gamma/2\tau_0$", "stress": r"slip $u/u_\text{max}$"},
    "slip_velocity": {
        "displacement": r"slip velocity $\dot u\,\sqrt{\gamma}$",
        "stress": r"slip velocity $\dot u/\dot u_\text{max}$",
    },
    "slip_acceleration": {
        "displacement": r"acceleration $\ddot u\,\tau_0$",
        "stress": r"acceleration $\ddot u\,W/\dot u_\text{max}$",
    },
}
DISTANCE = {"displacement": r"$\chi$ / paper's width", "stress": r"$\chi/W$"}
# The quantity of the colours, the column of the line styles, and their symbols; and how many levels are drawn.
LOOKS = {
    "displacement": ("tau_0", "damping_ratio", r"\tau_0", "b"),
    "stress": ("tau_l", "width", r"\tau_{0,l}", "W"),
}
LEVELS = {"displacement": 2, "stress": 3}
STYLES = ("-", "--", ":", "-.")
# Points of a simulated curve, digits that can be seen, and what is drawn ahead of a pulse and behind it, in widths.
POINTS, DIGITS, AHEAD, BEHIND = 300, 4, 0.08, 0.25
PALE: Look = {"linewidth": 2.6, "alpha": 0.3}
# The paper's scales of FIELDS, as its predictions name them.
SCALES = ("slip", "peak_velocity", "acceleration")
# Left and lower end, width and height, as fractions of a panel.
Box = tuple[float, float, float, float]
PARAMETERS = ["left", "right", "width", "gamma", "damping_ratio", "run_flags"]


def pulse_table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Simulated pulses of each sweep at some of its levels, and the exact one of each run; panel is the boundary.

    Role "run" has the parameters, roles "simulation" and "exact" are over x, both in units of the scales: width, slip,
    velocity and acceleration of the paper's pulse under a displacement boundary; under a stress boundary the width of
    the Gaussian, largest slip and velocity of the exact pulse far from nucleation, and that velocity over that width,
    since its acceleration has no bound.
    """
    window = settings["measure"]["front_window"]
    profiles = tables["pulse_profiles"].groupby("simulation")
    parts = [
        _rows(sweep, tables[name], profiles.get_group(name), window) for name, sweep in data.items()
    ]
    return pd.concat(parts, ignore_index=True)


def _rows(
    sweep: xr.Dataset, runs: pd.DataFrame, profiles: pd.DataFrame, window: float
) -> pd.DataFrame:
    runs = runs[runs["left"].isin(chosen(runs["left"], LEVELS[runs["boundary"].iloc[0]]))]
    parts = [runs[PARAMETERS].assign(role="run", run=runs.index)]
    for index, numbers in runs.iterrows():
        exact = profiles[profiles["run"] == index].assign(role="exact")
        if numbers["boundary"] == "displacement":
            scale = dict(
                zip(FIELDS, numbers[[f"paper_pulse_{kind}" for kind in SCALES]], strict=True)
            )
            scale["x"], span, reach = (
                numbers["paper_pulse_width"],
                numbers["exact_pulse_width"],
                1.0 + BEHIND,
            )
        else:
            peak, width = numbers["exact_largest_velocity"], numbers["width"]
            scale = {
                "slip": exact["slip"].max(),
                "slip_velocity": peak,
                "slip_acceleration": peak / width,
            }
            scale["x"], span, reach = width, float(np.ptp(exact["x"])), 1.0
        run = point(sweep, int(index))
        pulse = leading_pulse(run, window)
        found = pd.DataFrame(comoving(run, pulse)).assign(role="simulation")
        inside = found[found["xi"].between(-reach * span, AHEAD * span)]
        thinned = inside.iloc[:: int(np.ceil(len(inside) / POINTS))]
        found = pd.concat(
            [thinned.assign(x=thinned["xi"] - (pulse.peak_distance - pulse.front)), exact]
        )
        curves = {key: (found[key] / scale[key]).round(DIGITS) for key in ("x", *FIELDS)}
        parts.append(pd.DataFrame({"role": found["role"], "run": index, **curves}))
    return pd.concat(parts, ignore_index=True).assign(panel=runs["boundary"].iloc[0])


def looks(table: pd.DataFrame) -> dict[int, tuple[Any, str]]:
    """Colour and line style of each run of one boundary."""
    quantity, other, *_ = LOOKS[table["panel"].iloc[0]]
    runs = table[table["role"] == "run"].set_index("run")
    style, scale = (
        dict(zip(np.sort(runs[other].unique()), STYLES, strict=False)),
        colour_scale(quantity),
    )
    return {run: (scale.to_rgba(row["left"]), style[row[other]]) for run, row in runs.iterrows()}


def draw_pulses(axes: Axes, table: pd.DataFrame, field: str) -> None:
    """Pulses of one boundary in units of their scales: simulated ones pale, exact ones thin."""
    flagged = set(table.loc[table["run_flags"].notna(), "run"])
    for run, (colour, style) in looks(table).items():
        rows = table[table["run"] == run]
        simulated, exact = (rows[rows["role"] == role] for role in ("simulation", "exact"))
        shade = "0.7" if run in flagged else colour
        axes.plot(simulated["x"], simulated[field], color=shade, gid=f"simulation {run}", **PALE)
        axes.plot(exact["x"], exact[field], style, color=colour, linewidth=0.8, gid=f"exact {run}")
    boundary = table["panel"].iloc[0]
    axes.set(xlabel=DISTANCE[boundary], ylabel=FIELDS[field][boundary])


def plot_fields(table: pd.DataFrame) -> Figure:
    """Figures 8 and 9: slip, slip velocity and acceleration of the pulses of one boundary."""
    figure, panels = new_panels(PAGE, 2.8, 1, 3)
    for axes, field in zip(panels, FIELDS, strict=True):
        draw_pulses(axes, table, field)
    panels[1].set_title(conditions(table))
    if table["panel"].iloc[0] == "displacement":
        # The undamped lattice rings beyond the theory at the front.
        panels[2].set_ylim(-1.3, 1.3)
    else:
        # Where slip and velocity are small.
        draw_prestress(panels[1], table, (0.09, 0.66, 0.33, 0.22), 5.0)
        # The exact acceleration has no bound at the front.
        panels[2].set(xlim=(-4.0, 4.0), ylim=(-0.3, 3.0))
    legend_below(figure, handles(table), 6)
    return figure


def draw_prestress(axes: Axes, table: pd.DataFrame, box: Box, widths: float) -> None:
    """The pre-stress of the runs in an inset, over some widths of the widest Gaussian."""
    runs, look = (
        table[table["role"] == "run"].drop_duplicates(["left", "right", "width"]),
        looks(table),
    )
    prestress_inset(axes, box, runs, [look[run][0] for run in runs["run"]], widths)


def handles(table: pd.DataFrame) -> list[Line2D]:
    """Legend of one boundary: what the colours and the line styles of the exact pulses are, and what is pale."""
    runs, look = table[table["role"] == "run"].set_index("run"), looks(table)
    _, other, symbol, other_symbol = LOOKS[table["panel"].iloc[0]]
    levels, others = (runs[column].drop_duplicates().sort_values() for column in ("left", other))
    found = [entry(rf"${symbol} = {level:g}$", color=look[run][0]) for run, level in levels.items()]
    for run, value in others.items():
        name, line = rf"exact, ${other_symbol} = {value:g}$", look[run][1]
        found.append(entry(name, color=BLACK, linewidth=0.8, linestyle=line))
    return [*found, entry("simulation", color=BLACK, **PALE)]


def conditions(table: pd.DataFrame) -> str:
    """The boundary of the runs, and gamma or b, which their looks do not tell."""
    held = table["panel"].iloc[0] == "displacement"
    column, symbol = ("gamma", r"\gamma") if held else ("damping_ratio", "b")
    values = ", ".join(f"{value:g}" for value in table[column].dropna().unique())
    return rf"$\Gamma = {int(held)}$, ${symbol} = {values}$"


def prestress_inset(
    axes: Axes, box: Box, runs: pd.DataFrame, colours: Sequence, widths: float
) -> None:
    """Profiles of pre-stress of some runs in a box of a panel, over some widths of the widest Gaussian."""
    inset = axes.inset_axes(box)
    x = np.linspace(-widths, widths, 161) * runs["width"].max()
    for run, colour in zip(runs.itertuples(), colours, strict=True):
        inset.plot(x, Prestress(run.left, run.right, run.width)(x), color=colour, linewidth=0.8)
    inset.locator_params(nbins=3, integer=True)
    inset.set_title(r"$\tau(x)$", fontsize=8.0, pad=2.5)
    inset.tick_params(labelsize=7.0, length=1.5, pad=1.0)
