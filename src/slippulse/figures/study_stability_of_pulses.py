"""Pulses sent from one pre-stress into another: held displacement settles, imposed stress grows, decays or keeps."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..data.numerals import setting
from ..data.points import point
from ..model.prestress import prestress_from
from . import style
from .style import BLACK, GREY, PAGE, Look, colour_scale, entry, legend_below, new_panels

NEEDS = {"data": ["pulses_across_a_step", "regimes_beyond"], "studies": ["pulse_memory"]}

# Points of a lattice, how many there are to a mark, and what rounding leaves of the exact distance.
POINTS, MARKED, ROUNDING = 100, 5, 2e-9
# The smallest velocity drawn.
LEAST = 0.03


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Of each level beyond the step role exact (as the study has it), lattice (Gamma = 1; x: distance beyond the step,
    slip left behind) and velocity (Gamma = 0; time, largest_velocity right of the nucleation, step: its position).
    """
    exact = tables["pulse_memory"]
    parts = [exact.assign(role="exact")]
    across, beyond = (
        [point(runs, i) for i in range(runs.sizes["point"])] for runs in data.values()
    )
    for run in across:
        position, level = prestress_from(run.attrs).steps[-1]
        x = run["x"].values - position
        drawn = exact.loc[np.isclose(exact["level"], level), "x"]
        inside = np.flatnonzero(
            np.isfinite(run["stick_time"]) & (x > drawn.min()) & (x < drawn.max())
        )
        kept = inside[:: max(1, inside.size // POINTS)]
        lines = pd.DataFrame({"x": x[kept], "slip": run["slip"].values[kept]})
        parts.append(lines.assign(role="lattice", level=level, dx=run.attrs["dx"]))
    # The runs with the lowest level on the left, which sends the narrowest pulse.
    lowest = float(data["regimes_beyond"]["left"].min())
    for run in beyond:
        if run.attrs["left"] == lowest:
            largest = (
                run["sample_velocity"].sel(sample_position=slice(1e-9, None)).max("sample_position")
            )
            lines = pd.DataFrame(
                {"time": run["sample_time"].values, "largest_velocity": largest.values}
            )
            position, level = prestress_from(run.attrs).steps[-1]
            parts.append(
                lines.assign(role="velocity", level=level, before=run.attrs["right"], step=position)
            )
    return pd.concat(parts, ignore_index=True)


def plot(table: pd.DataFrame) -> Figure:
    """(a) slip across the step, (b) how far from the new steady pulse, (c) largest velocity under imposed stress."""
    figure, (slip_axes, rest_axes, velocity_axes) = new_panels(PAGE, 3.2, 1, 3)
    slip = table[table["role"].isin(["exact", "lattice"])]
    for level, rows in slip.groupby("level"):
        colour = colour_scale("tau_0").to_rgba(level)
        _draw_level(slip_axes, rest_axes, rows.sort_values("x"), colour, f"{level:g}")
    slip_axes.axvline(0.0, color=GREY, linewidth=0.6, linestyle=":")
    handles = [*slip_axes.get_legend_handles_labels()[0], entry("exact", color=GREY)]
    lattice: Look = {"color": GREY, "marker": "o", "markersize": 2.5, "markerfacecolor": "white"}
    handles.append(entry(rf"lattice, $\Delta x = {slip['dx'].max():g}$", **lattice))
    handles.append(entry("finite memory", color=GREY, marker="|", markersize=7.0))
    slip_axes.set(xlabel=r"distance beyond the step $x$", ylabel=r"slip left behind $u$")
    slip_axes.set_title(rf"$\Gamma = 1$, $\tau_0 = {slip['before'].max():g}$ before", loc="right")
    legend_below(figure, handles, 4)
    rest_axes.axvline(1.0, color=GREY, linewidth=0.9, linestyle="--")
    # What is exactly 0 is drawn as what rounding leaves.
    rest_axes.axhspan(0.1 * ROUNDING, 2.0 * ROUNDING, color="0.9", linewidth=0.0)
    rest_axes.text(0.04, 0.45 * ROUNDING, "rounding", va="center", fontsize=8.0)
    rest_axes.set(yscale="log", xlim=(0.0, 1.35), ylim=(0.1 * ROUNDING, 3.0))
    rest_axes.set(
        xlabel=r"distance / $W_\text{p}/(v - 1)$", ylabel="|slip / new steady slip $-$ 1|"
    )
    rest_axes.set_title(r"$\Gamma = 1$", loc="right")
    _draw_velocity(velocity_axes, table[table["role"] == "velocity"])
    return figure


def _draw_level(
    slip_axes: Axes, rest_axes: Axes, rows: pd.DataFrame, colour: Any, level: str
) -> None:
    exact, lattice = rows[rows["role"] == "exact"], rows[rows["role"] == "lattice"]
    steady, memory = exact["steady"].iloc[0], exact["memory"].iloc[0]
    slip_axes.plot(exact["x"], exact["slip"], color=colour, label=rf"$\tau_0 = {level}$ beyond")
    marks = lattice.iloc[::MARKED]
    look: Look = {"color": colour, "markerfacecolor": "white"}
    slip_axes.plot(marks["x"], marks["slip"], "o", markersize=1.8, markeredgewidth=0.5, **look)
    slip_axes.plot(memory, steady, "|", color=colour, markersize=9.0, markeredgewidth=1.2)
    # From the memory on the exact rest is 0.
    exact = exact[(exact["x"] > 0.0) & ((exact["x"] <= memory) | (exact["x"].shift() <= memory))]
    marks = marks[marks["x"] > 0.0]
    look |= {"linewidth": 1.0, "markersize": 2.2, "markeredgewidth": 0.6}
    for part, line in ((exact, "-"), (marks, "o")):
        rest = np.maximum(np.abs(part["slip"] / steady - 1.0), ROUNDING)
        rest_axes.plot(part["x"] / memory, rest, line, **look)


def _draw_velocity(axes: Axes, rows: pd.DataFrame) -> None:
    """One line a level, in the colour of what the pulse does, with the level at its end."""
    rows = rows[rows["largest_velocity"] > 0.0]
    for level, line in rows.groupby("level"):
        colour = style.GREEN if level < 0.0 else style.PURPLE if level > 0.0 else style.YELLOW
        axes.plot(
            line["time"],
            line["largest_velocity"],
            "o-",
            color=colour,
            markersize=2.0,
            linewidth=0.8,
        )
        # Where the line ends or leaves the panel; velocities fall with time there.
        seen, below = (
            line[line["largest_velocity"] > LEAST],
            line[line["largest_velocity"] <= LEAST],
        )
        at = tuple(seen[["time", "largest_velocity"]].iloc[-1])
        if len(below):
            two = pd.concat([below.iloc[:1], seen.iloc[-1:]])
            at = (
                np.interp(np.log(LEAST), np.log(two["largest_velocity"]), two["time"]),
                1.15 * LEAST,
            )
        look: Look = {
            "xytext": (4, 0),
            "textcoords": "offset points",
            "va": "center",
            "fontsize": 7.0,
        }
        axes.annotate(setting(level), at, color=BLACK, **look)
    axes.axvline(rows["step"].iloc[0], color=GREY, linewidth=0.6, linestyle=":")
    axes.set(yscale="log", xlabel=r"time $t$", ylabel=r"largest slip velocity, $x > 0$")
    axes.set(xlim=(None, 1.28 * rows["time"].max()), ylim=(LEAST, None))
    axes.set_title(rf"$\Gamma = 0$, $\tau = {rows['before'].iloc[0]:g}$ before", loc="right")
    axes.text(
        0.97, 0.96, r"$\tau$ beyond", transform=axes.transAxes, ha="right", va="top", fontsize=8.0
    )
