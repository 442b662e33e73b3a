"""Pulses that enter another pre-stress.

A pulse forms in one level of the pre-stress (column before) and enters another one (column level)
at a step. Under a displacement boundary (Gamma = 1) it settles to the steady pulse of the new
level. Under a stress boundary (Gamma = 0) it grows, decays or stays as it is.
"""

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slippulse.data.point import point
from slippulse.model.prestress import prestress_from
from slippulse.plotting import style
from slippulse.plotting.style import BLACK, GREY, OPEN_MARKER, PAGE_WIDTH, SMALL_TEXT, Look, entry

from ..text.numerals import setting

NEEDS = {"data": ["pulses_across_a_step", "regimes_beyond"], "studies": ["pulse_memory"]}

# About this number of points of a lattice is kept. Of these, one in POINTS_PER_MARKER is marked.
LATTICE_POINTS = 100
POINTS_PER_MARKER = 5
# A relative deviation that is exactly 0 is computed with about this error.
ROUNDING_ERROR = 2e-9
# The smallest slip velocity on the axis.
MIN_DRAWN_VELOCITY = 0.03


def table(data: dict, tables: dict[str, pd.DataFrame], settings: dict) -> pd.DataFrame:
    """Return the rows of three parts of the figure, which the column role names.

    exact, lattice : final slip as a function of the distance x from the step, under a displacement
        boundary
    velocity : largest slip velocity at each sampled time, under a stress boundary
    """
    exact = tables["pulse_memory"]
    parts = [exact.assign(role="exact")]
    held_top = data["pulses_across_a_step"]
    # The lattices are drawn over the same distances as the exact slip.
    for number in range(held_top.sizes["point"]):
        parts.append(lattice_slip(point(held_top, number), exact).assign(role="lattice"))
    held_stress = data["regimes_beyond"]
    # The velocity is drawn for the lowest level on the left. It gives the narrowest pulse, which
    # needs the shortest time to cross the step.
    left_levels = held_stress["left"].values
    for index in np.flatnonzero(left_levels == left_levels.min()):
        velocities = largest_velocities(point(held_stress, int(index)))
        parts.append(velocities.assign(role="velocity"))
    return pd.concat(parts, ignore_index=True)


def lattice_slip(run: xr.Dataset, exact: pd.DataFrame) -> pd.DataFrame:
    """Return the final slip of a run as a function of the distance x from the step.

    Only a block that has stuck has its final slip. About LATTICE_POINTS such blocks are kept.

    exact : the exact slip of all runs; the result covers the same distances
    """
    step_position, level = prestress_from(run.attrs).steps[-1]
    x = run["x"].values - step_position
    exact_x = exact.loc[np.isclose(exact["level"], level), "x"]
    has_stuck = np.isfinite(run["stick_time"].values)
    stuck_blocks = np.flatnonzero(has_stuck & (x > exact_x.min()) & (x < exact_x.max()))
    kept = stuck_blocks[:: max(1, stuck_blocks.size // LATTICE_POINTS)]
    rows = pd.DataFrame({"x": x[kept], "slip": run["slip"].values[kept]})
    return rows.assign(level=level, dx=run.attrs["dx"])


def largest_velocities(run: xr.Dataset) -> pd.DataFrame:
    """Return the largest slip velocity of the right pulse at each sampled time.

    The columns before and level have the pre-stress before and beyond the step, and the column step
    has its position.
    """
    step_position, level = prestress_from(run.attrs).steps[-1]
    # The right pulse is at positions above 0. The slice leaves out 0 itself.
    velocity_on_right = run["sample_velocity"].sel(sample_position=slice(1e-9, None))
    largest = velocity_on_right.max("sample_position").values
    rows = pd.DataFrame({"time": run["sample_time"].values, "largest_velocity": largest})
    return rows.assign(level=level, before=run.attrs["right"], step=step_position)


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a) slip across the step, (b) its deviation from the new steady slip, (c) velocity.

    Lines are exact, and markers are some points of the lattice. In panel a, a tick on each line
    marks the end of the memory (see `_draw_slip`).
    """
    figure, (slip_axes, deviation_axes, velocity_axes) = style.new_panels(PAGE_WIDTH, 3.2, "abc")
    slip = table[table["role"].isin(["exact", "lattice"])].sort_values("x")
    for level, rows in slip.groupby("level"):
        colour = style.colour("tau_0", level)
        exact = rows[rows["role"] == "exact"]
        marked = rows[rows["role"] == "lattice"].iloc[::POINTS_PER_MARKER]
        _draw_slip(slip_axes, exact, marked, colour, rf"$\tau_0 = {level:g}$ beyond")
        _draw_deviation(deviation_axes, exact, marked, colour)
    slip_axes.axvline(0.0, color=GREY, linewidth=0.6, linestyle=":")
    slip_axes.set(xlabel=r"distance beyond the step $x$", ylabel=r"slip left behind $u$")
    # All runs have the same level before the step and the same spacing.
    slip_axes.set_title(rf"$\Gamma = 1$, $\tau_0 = {slip['before'].max():g}$ before")
    handles_of_levels, _ = slip_axes.get_legend_handles_labels()
    lattice_label = rf"lattice, $\Delta x = {slip['dx'].max():g}$"
    handles = [
        *handles_of_levels,
        entry("exact", color=GREY),
        entry(lattice_label, color=GREY, marker="o", **OPEN_MARKER),
        entry("finite memory", color=GREY, marker="|", markersize=7.0),
    ]
    style.legend_below(figure, handles, columns=4)
    _finish_deviation(deviation_axes)
    _draw_velocity(velocity_axes, table[table["role"] == "velocity"])
    return figure


def _draw_slip(
    axes: Axes, exact: pd.DataFrame, marked: pd.DataFrame, colour: np.ndarray, label: str
) -> None:
    """Draw the exact slip, some points of the lattice as markers, and the end of the memory.

    A pulse remembers the old level only up to a finite distance beyond the step, its memory. From
    there on, its slip is exactly that of the steady pulse.

    marked : the points of the lattice
    """
    steady, memory = exact["steady"].iloc[0], exact["memory"].iloc[0]
    axes.plot(exact["x"], exact["slip"], color=colour, label=label)
    axes.plot(marked["x"], marked["slip"], "o", color=colour, markersize=2.2, **OPEN_MARKER)
    axes.plot(memory, steady, "|", color=colour, markersize=9.0, markeredgewidth=1.2)


def _draw_deviation(
    axes: Axes, exact: pd.DataFrame, marked: pd.DataFrame, colour: np.ndarray
) -> None:
    """Draw the relative deviation of slip from the new steady slip, as a function of distance.

    The distance beyond the step is in units of the memory, the distance over which a pulse
    remembers the old level. The exact slip is drawn as a line, and some points of the lattice
    (``marked``) as markers.
    """
    steady, memory = exact["steady"].iloc[0], exact["memory"].iloc[0]
    # Beyond the memory the exact deviation is 0. The line ends at the first point beyond it.
    count_within_memory = int((exact["x"] <= memory).sum())
    drawn_exact = exact.iloc[: count_within_memory + 1]
    look: Look = {"color": colour, "markersize": 2.2} | OPEN_MARKER
    for rows, line in ((drawn_exact, "-"), (marked, "o")):
        beyond_step = rows[rows["x"] > 0.0]
        deviation = np.abs(beyond_step["slip"] / steady - 1.0)
        # A deviation of exactly 0 is drawn at the rounding error.
        drawn = np.maximum(deviation, ROUNDING_ERROR)
        axes.plot(beyond_step["x"] / memory, drawn, line, **look)


def _finish_deviation(axes: Axes) -> None:
    """Mark the end of the memory and the size of the rounding error, and set the axes.

    The memory W_p/(v - 1) is the distance over which a pulse remembers the old level.
    """
    axes.axvline(1.0, color=GREY, linewidth=0.9, linestyle="--")
    axes.axhspan(0.1 * ROUNDING_ERROR, 2.0 * ROUNDING_ERROR, color="0.9", linewidth=0.0)
    axes.text(0.04, 0.45 * ROUNDING_ERROR, "rounding", va="center")
    axes.set(yscale="log", xlim=(0.0, 1.35), ylim=(0.1 * ROUNDING_ERROR, 3.0))
    axes.set(xlabel=r"distance / $W_\text{p}/(v - 1)$", title=r"$\Gamma = 1$")
    axes.set_ylabel("|slip / new steady slip $-$ 1|")


def _draw_velocity(axes: Axes, rows: pd.DataFrame) -> None:
    """Draw the largest velocity as a function of time, with one line for each level.

    A line has the colour of growth, decay or neither. The level of a line is written at its end, or
    where the line leaves the panel.
    """
    # The velocity of a dead pulse is 0, which a logarithmic axis cannot show.
    rows = rows[rows["largest_velocity"] > 0.0]
    # A pulse decays at a negative level, and grows at a positive one.
    colours = {-1.0: style.GREEN, 0.0: style.YELLOW, 1.0: style.PURPLE}
    look: Look = {"xytext": (4, 0), "textcoords": "offset points", "va": "center"}
    for level, line in rows.groupby("level"):
        colour = colours[float(np.sign(level))]
        time, velocity = line["time"], line["largest_velocity"]
        axes.plot(time, velocity, "o-", color=colour, markersize=2.0, linewidth=0.8)
        label_position = _end_within_panel(time.to_numpy(), velocity.to_numpy())
        axes.annotate(setting(level), label_position, color=BLACK, fontsize=SMALL_TEXT, **look)
    axes.axvline(rows["step"].iloc[0], color=GREY, linewidth=0.6, linestyle=":")
    axes.set(yscale="log", xlabel=r"time $t$", ylabel=r"largest slip velocity, $x > 0$")
    axes.set_xlim(None, 1.28 * rows["time"].max())
    axes.set_ylim(MIN_DRAWN_VELOCITY, 2.5 * rows["largest_velocity"].max())
    axes.set_title(rf"$\Gamma = 0$, $\tau = {rows['before'].iloc[0]:g}$ before")
    axes.text(0.97, 0.96, r"$\tau$ beyond", transform=axes.transAxes, ha="right", va="top")


def _end_within_panel(time: np.ndarray, velocity: np.ndarray) -> tuple[float, float]:
    """Return the last point of a velocity curve that lies within the panel.

    If the curve falls below the lowest drawn velocity, it is the point where the curve crosses the
    lower edge of the panel, moved up a little.
    """
    if velocity[-1] > MIN_DRAWN_VELOCITY:
        return time[-1], velocity[-1]
    # The curve is straight between two samples on the logarithmic axis, so logarithms are
    # interpolated. They fall with time, but must ascend for interpolation.
    exit_time = np.interp(np.log(MIN_DRAWN_VELOCITY), np.log(velocity[::-1]), time[::-1])
    return float(exit_time), 1.15 * MIN_DRAWN_VELOCITY
