"""Pulses that enter another pre-stress.

With the displacement held they settle. With the stress held they grow, decay or stay as they are.
"""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slippulse.data.point import point
from slippulse.model.prestress import prestress_from
from slippulse.plotting import style
from slippulse.plotting.style import BLACK, GREY, OPEN_MARKER, PAGE_WIDTH, SMALL_TEXT, Look, entry

from ..text.numerals import setting

NEEDS = {"data": ["pulses_across_a_step", "regimes_beyond"], "studies": ["pulse_memory"]}

# Points kept of a lattice, and how many of them there are for each marker.
LATTICE_POINTS, POINTS_PER_MARKER = 100, 5
# What rounding leaves of a distance that is exactly 0.
ROUNDING_ERROR = 2e-9
# The smallest drawn velocity.
MIN_DRAWN_VELOCITY = 0.03


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return slip beyond a step (roles exact and lattice) and velocity by time (role velocity)."""
    exact = tables["pulse_memory"]
    parts = [exact.assign(role="exact")]
    across, beyond_step = data["pulses_across_a_step"], data["regimes_beyond"]
    for run in (point(across, i) for i in range(across.sizes["point"])):
        position, level = prestress_from(run.attrs).steps[-1]
        x = run["x"].values - position
        # Keep the slip of stuck blocks at the distances that the exact solution covers.
        drawn = exact.loc[np.isclose(exact["level"], level), "x"]
        inside = np.isfinite(run["stick_time"].values) & (x > drawn.min()) & (x < drawn.max())
        kept = np.flatnonzero(inside)
        kept = kept[:: max(1, kept.size // LATTICE_POINTS)]
        rows = pd.DataFrame({"x": x[kept], "slip": run["slip"].values[kept]})
        parts.append(rows.assign(role="lattice", level=level, dx=run.attrs["dx"]))
    # The runs with the lowest level on the left have the narrowest pulse.
    lowest = beyond_step["left"].values == beyond_step["left"].values.min()
    for run in (point(beyond_step, int(i)) for i in np.flatnonzero(lowest)):
        right = run["sample_velocity"].sel(sample_position=slice(1e-9, None))
        position, level = prestress_from(run.attrs).steps[-1]
        largest = right.max("sample_position").values
        rows = pd.DataFrame({"time": run["sample_time"].values, "largest_velocity": largest})
        before = {"before": run.attrs["right"], "step": position}
        parts.append(rows.assign(role="velocity", level=level, **before))
    return pd.concat(parts, ignore_index=True)


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a) slip across the step, (b) its deviation from the new steady slip, (c) velocity."""
    figure, (slip_axes, rest_axes, velocity_axes) = style.new_panels(PAGE_WIDTH, 3.2, "abc")
    slip = table[table["role"].isin(["exact", "lattice"])].sort_values("x")
    for level, rows in slip.groupby("level"):
        colour, label = style.colour("tau_0", level), rf"$\tau_0 = {level:g}$ beyond"
        exact, lattice = (rows[rows["role"] == role] for role in ("exact", "lattice"))
        steady, memory = exact["steady"].iloc[0], exact["memory"].iloc[0]
        slip_axes.plot(exact["x"], exact["slip"], color=colour, label=label)
        marks = lattice.iloc[::POINTS_PER_MARKER]
        look: Look = {"color": colour, "markersize": 2.2} | OPEN_MARKER
        slip_axes.plot(marks["x"], marks["slip"], "o", **look)
        slip_axes.plot(memory, steady, "|", color=colour, markersize=9.0, markeredgewidth=1.2)
        # The exact deviation is 0 beyond the memory of the pulse.
        ahead = (exact["x"] <= memory) | (exact["x"].shift() <= memory)
        for part, line in ((exact[ahead], "-"), (marks, "o")):
            part = part[part["x"] > 0.0]
            rest = np.maximum(np.abs(part["slip"] / steady - 1.0), ROUNDING_ERROR)
            rest_axes.plot(part["x"] / memory, rest, line, **look)
    slip_axes.axvline(0.0, color=GREY, linewidth=0.6, linestyle=":")
    handles = [*slip_axes.get_legend_handles_labels()[0], entry("exact", color=GREY)]
    lattice = rf"lattice, $\Delta x = {slip['dx'].max():g}$"
    handles.append(entry(lattice, color=GREY, marker="o", **OPEN_MARKER))
    handles.append(entry("finite memory", color=GREY, marker="|", markersize=7.0))
    slip_axes.set(xlabel=r"distance beyond the step $x$", ylabel=r"slip left behind $u$")
    slip_axes.set_title(rf"$\Gamma = 1$, $\tau_0 = {slip['before'].max():g}$ before")
    style.legend_below(figure, handles, 4)
    rest_axes.axvline(1.0, color=GREY, linewidth=0.9, linestyle="--")
    # A deviation of exactly 0 is drawn at the rounding error.
    rest_axes.axhspan(0.1 * ROUNDING_ERROR, 2.0 * ROUNDING_ERROR, color="0.9", linewidth=0.0)
    rest_axes.text(0.04, 0.45 * ROUNDING_ERROR, "rounding", va="center")
    rest_axes.set(yscale="log", xlim=(0.0, 1.35), ylim=(0.1 * ROUNDING_ERROR, 3.0))
    rest_axes.set(xlabel=r"distance / $W_\text{p}/(v - 1)$", title=r"$\Gamma = 1$")
    rest_axes.set_ylabel("|slip / new steady slip $-$ 1|")
    _draw_velocity(velocity_axes, table[table["role"] == "velocity"])
    return figure


def _draw_velocity(axes: Axes, rows: pd.DataFrame) -> None:
    """Draw one line for each level, labelled with it, in a colour for growth, decay or neither."""
    rows = rows[rows["largest_velocity"] > 0.0]
    colours = {-1.0: style.GREEN, 0.0: style.YELLOW, 1.0: style.PURPLE}
    look: Look = {"xytext": (4, 0), "textcoords": "offset points", "va": "center"}
    for level, line in rows.groupby("level"):
        colour = colours[float(np.sign(level))]
        time, velocity = line["time"], line["largest_velocity"]
        axes.plot(time, velocity, "o-", color=colour, markersize=2.0, linewidth=0.8)
        end = time.iloc[-1], velocity.iloc[-1]
        if end[1] <= MIN_DRAWN_VELOCITY:
            # Put the label where the line leaves the panel. Velocities fall with time.
            last = time.iloc[::-1], np.log(velocity.iloc[::-1])
            end = np.interp(np.log(MIN_DRAWN_VELOCITY), last[1], last[0]), 1.15 * MIN_DRAWN_VELOCITY
        axes.annotate(setting(level), end, color=BLACK, fontsize=SMALL_TEXT, **look)
    axes.axvline(rows["step"].iloc[0], color=GREY, linewidth=0.6, linestyle=":")
    axes.set(yscale="log", xlabel=r"time $t$", ylabel=r"largest slip velocity, $x > 0$")
    axes.set_xlim(None, 1.28 * rows["time"].max())
    axes.set_ylim(MIN_DRAWN_VELOCITY, 2.5 * rows["largest_velocity"].max())
    axes.set_title(rf"$\Gamma = 0$, $\tau = {rows['before'].iloc[0]:g}$ before")
    axes.text(0.97, 0.96, r"$\tau$ beyond", transform=axes.transAxes, ha="right", va="top")
