"""Pulses in their own frame, simulated and exact: rows of a figure's table, and how they are drawn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ...data.points import point
from ...measure.pulses import comoving, leading_pulse
from ..style import BLACK, CYCLE, Look, colour_scale, entry, prestress_inset

FIELDS = {
    "slip": r"slip $u$",
    "slip_velocity": r"slip velocity $\dot u$",
    "slip_acceleration": r"slip acceleration $\ddot u$",
}
STYLES = ("-", "--", ":", "-.")
# Points of a simulated curve, digits that can be seen, and what is drawn ahead of a pulse and behind it, in widths.
POINTS, DIGITS, AHEAD, BEHIND = 400, 5, 0.08, 0.25
PALE: Look = {"linewidth": 2.4, "alpha": 0.35}
# The paper's scales of FIELDS, as its predictions name them.
SCALES = ("slip", "peak_velocity", "acceleration")
PARAMETERS = ["left", "right", "width", "gamma", "damping_ratio", "run_flags"]


def pulse_rows(
    name: str, data: Mapping, tables: Mapping, settings: Mapping, fields: Sequence[str] = tuple(FIELDS)
) -> pd.DataFrame:
    """Simulated pulses of a sweep, and the exact one of each run.

    Parameters
    ----------
    name : of the sweep, whose data and whose measured and predicted table are given
    data, tables, settings : as of the figure, with the study pulse_profiles and the key measure.front_window
    fields : which of FIELDS

    Returns
    -------
    role "run" with the parameters, and roles "simulation" and "exact" over x, both in units of the scales: width, slip,
    velocity and acceleration of the paper's pulse under a displacement boundary; under a stress boundary the width of
    the Gaussian, largest slip and velocity of the exact pulse far from nucleation, and that velocity over that width,
    since its acceleration has no bound; panel: the boundary
    """
    runs, profiles = tables[name], tables["pulse_profiles"]
    profiles = profiles[profiles["simulation"] == name]
    parts = [runs[PARAMETERS].assign(role="run", run=runs.index)]
    for index, numbers in runs.iterrows():
        exact = profiles[profiles["run"] == index].assign(role="exact")
        if numbers["boundary"] == "displacement":
            scale = dict(zip(FIELDS, numbers[[f"paper_pulse_{kind}" for kind in SCALES]], strict=True))
            scale["x"], span, reach = numbers["paper_pulse_width"], numbers["exact_pulse_width"], 1.0 + BEHIND
        else:
            peak, width = numbers["exact_largest_velocity"], numbers["width"]
            scale = {"slip": exact["slip"].max(), "slip_velocity": peak, "slip_acceleration": peak / width}
            scale["x"], span, reach = width, float(np.ptp(exact["x"])), 1.0
        run = point(data[name], int(index))
        simulated = simulation(run, settings["measure"]["front_window"], span, reach)
        found = pd.concat([simulated, exact])
        curves = {key: (found[key] / scale[key]).round(DIGITS) for key in ("x", *fields)}
        parts.append(pd.DataFrame({"role": found["role"], "run": index, **curves}))
    return pd.concat(parts, ignore_index=True).assign(panel=runs["boundary"].iloc[0])


def simulation(run: xr.Dataset, window: float, span: float, reach: float) -> pd.DataFrame:
    """One simulated pulse over the distance from its largest velocity, thinned."""
    pulse = leading_pulse(run, window)
    found = pd.DataFrame(comoving(run, pulse)).assign(role="simulation")
    inside = found[found["xi"].between(-reach * span, AHEAD * span)]
    kept = inside.iloc[:: int(np.ceil(len(inside) / POINTS))]
    return kept.assign(x=kept["xi"] - (pulse.peak_distance - pulse.front))


def looks(table: pd.DataFrame) -> dict[int, tuple[Any, str]]:
    """Colour and line style of each run of one boundary: of its level and damping, or of the run."""
    runs = table[table["role"] == "run"].set_index("run")
    if table["panel"].iloc[0] == "stress":
        return {run: (colour, "-") for run, colour in zip(runs.index, CYCLE, strict=False)}
    style = dict(zip(np.sort(runs["damping_ratio"].unique()), STYLES, strict=False))
    scale = colour_scale("tau_0")
    return {run: (scale.to_rgba(row["left"]), style[row["damping_ratio"]]) for run, row in runs.iterrows()}


def draw_pulses(axes: Axes, table: pd.DataFrame, field: str) -> None:
    """Pulses of one boundary in units of their scales: simulated ones pale, exact ones thin."""
    flagged = set(table.loc[table["run_flags"].notna(), "run"])
    for run, (colour, style) in looks(table).items():
        rows = table[table["run"] == run]
        simulated, exact = (rows[rows["role"] == role] for role in ("simulation", "exact"))
        shade = "0.7" if run in flagged else colour
        axes.plot(simulated["x"], simulated[field], color=shade, gid=f"simulation {run}", **PALE)
        axes.plot(exact["x"], exact[field], style, color=colour, linewidth=0.8, gid=f"exact {run}")


def draw_prestress(axes: Axes, table: pd.DataFrame, widths: float) -> None:
    """The pre-stress of the runs in an inset, over some widths of the widest Gaussian."""
    runs, look = table[table["role"] == "run"].drop_duplicates(["left", "right", "width"]), looks(table)
    colours = [look[run][0] for run in runs["run"]]
    prestress_inset(axes, (0.57, 0.7, 0.4, 0.2), runs, colours, widths)


def handles(table: pd.DataFrame) -> list[Line2D]:
    """Legend of one boundary: what the colours and the line styles of the exact pulses are."""
    runs, look = table[table["role"] == "run"].set_index("run"), looks(table)
    if table["panel"].iloc[0] == "stress":
        names = [rf"$\tau_{{0,l}} = {row['left']:g}$, $W = {row['width']:g}$" for _, row in runs.iterrows()]
        found = [entry(name, color=look[run][0]) for run, name in zip(runs.index, names, strict=True)]
        return [*found, entry("exact, far field", color=BLACK, linewidth=0.8)]
    levels = runs.drop_duplicates("left")
    found = [entry(rf"$\tau_0 = {row['left']:g}$", color=look[run][0]) for run, row in levels.iterrows()]
    for run, row in runs.drop_duplicates("damping_ratio").iterrows():
        name = rf"exact, $b = {row['damping_ratio']:g}$"
        found.append(entry(name, color=BLACK, linewidth=0.8, linestyle=look[run][1]))
    return found


SIMULATION = entry("simulation", color=BLACK, **PALE)
