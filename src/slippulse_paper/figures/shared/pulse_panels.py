"""Tabulate and draw simulated and exact pulses, as functions of the distance from their peak."""

from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from slippulse.data.point import point
from slippulse.measurement.pulses import comoving, leading_pulse
from slippulse.model.prestress import Prestress
from slippulse.plotting import style
from slippulse.plotting.selection import spaced_indices, spread_values
from slippulse.plotting.style import (
    BLACK,
    LEVEL_COLUMNS,
    PAGE_WIDTH,
    SMALL_TEXT,
    SYMBOLS,
    Box,
    Look,
    entry,
)

# Axis labels of the fields, with the units that are used under each boundary condition.
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
DISTANCE_LABELS = {"displacement": r"$\chi$ / paper's width", "stress": r"$\chi/W$"}
# The column that decides the line style of a run. The level of the pre-stress decides its colour.
LINE_STYLE_COLUMNS = {"displacement": "damping_ratio", "stress": "width"}
LINE_STYLES = ("-", "--", ":", "-.")
# Number of drawn levels of the pre-stress.
LEVEL_COUNT = {"displacement": 2, "stress": 3}
# Largest number of points of a simulated curve, and number of decimals of its values.
CURVE_POINTS, VISIBLE_DECIMALS = 300, 4
# A simulated pulse is drawn beyond its front and beyond its tail by these fractions of its width.
MARGIN_AHEAD, MARGIN_BEHIND = 0.08, 0.25
SIMULATION_LOOK: Look = {"linewidth": 2.6, "alpha": 0.3}
PARAMETERS = ["left", "right", "width", "gamma", "damping_ratio", "run_flags"]


def pulse_table(data: dict, tables: dict[str, pd.DataFrame], settings: dict) -> pd.DataFrame:
    """Return simulated and exact pulses of each sweep at a few levels of pre-stress.

    The column role is "run" (one row for each run, with its parameters), "simulation" or "exact"
    (the points of a curve). Positions x are relative to the peak of the slip velocity.
    `frame_of_pulse` describes the units.
    """
    # The front speed of a run is measured over this last fraction of the front's path.
    window = settings["measure"]["front_window"]
    exact_profiles = tables["pulse_profiles"].groupby(["simulation", "run"])
    parts = []
    for name, sweep in data.items():
        runs = tables[name]
        # Only runs with an exact pulse are drawn.
        runs = runs[[(name, number) in exact_profiles.groups for number in runs.index]]
        # All runs of a sweep have the same boundary condition.
        boundary = str(runs["boundary"].iloc[0])
        drawn_levels = spread_values(runs["left"], LEVEL_COUNT[boundary])
        runs = runs[runs["left"].isin(drawn_levels)]
        # A pulse that is not steady counts as flagged, and its state is the flag. Under a stress
        # boundary the state is always "none", which is no flag.
        is_steady = runs["pulse_state"].isin(["steady", "none"])
        flags = runs["run_flags"].where(is_steady, runs["pulse_state"])
        rows = [runs[PARAMETERS].assign(role="run", run=runs.index, run_flags=flags)]
        for run_number, numbers in runs.iterrows():
            exact = exact_profiles.get_group((name, run_number))
            frame = frame_of_pulse(boundary, numbers, exact)
            simulated = simulated_profile(point(sweep, int(run_number)), window, frame)
            for role, profile in (("simulation", simulated), ("exact", exact)):
                curve = (profile[["x", *FIELDS]] / frame.units).round(VISIBLE_DECIMALS)
                curve.insert(0, "role", role)
                rows.append(curve.assign(run=run_number))
        parts.append(pd.concat(rows).assign(panel=boundary))
    return pd.concat(parts, ignore_index=True)


class PulseFrame(NamedTuple):
    """The range in which a simulated pulse is drawn, and the units of its curves.

    begin, end : first and last drawn distance from the front; distances are negative behind it
    units : the unit of x and of each of FIELDS, by name
    """

    begin: float
    end: float
    units: pd.Series


def frame_of_pulse(boundary: str, numbers: pd.Series, exact: pd.DataFrame) -> PulseFrame:
    """Return the drawn range and the units of one pulse.

    Under a displacement boundary, the units are the pulse width, slip, peak velocity and
    acceleration by the paper's formulas. Under a stress boundary, the unit of length is the width
    of the Gaussian. The units of slip and velocity are the largest values of the exact pulse far
    from the nucleation. The exact acceleration has no largest value, so its unit is that of
    velocity divided by that of length.

    numbers : measured and predicted numbers of the run
    exact : profile of the exact pulse
    """
    if boundary == "displacement":
        length = numbers["exact_pulse_width"]
        begin = -(1.0 + MARGIN_BEHIND) * length
        units = {
            "x": numbers["paper_pulse_width"],
            "slip": numbers["paper_pulse_slip"],
            "slip_velocity": numbers["paper_pulse_peak_velocity"],
            "slip_acceleration": numbers["paper_pulse_acceleration"],
        }
    else:
        # The pulse is drawn over the length of its exact profile.
        length = float(np.ptp(exact["x"]))
        begin = -length
        gaussian_width, largest_velocity = numbers["width"], numbers["exact_largest_velocity"]
        units = {
            "x": gaussian_width,
            "slip": exact["slip"].max(),
            "slip_velocity": largest_velocity,
            "slip_acceleration": largest_velocity / gaussian_width,
        }
    return PulseFrame(begin, MARGIN_AHEAD * length, pd.Series(units, dtype=float))


def simulated_profile(run: xr.Dataset, window: float, frame: PulseFrame) -> pd.DataFrame:
    """Return the right pulse at the end of a run: the columns of FIELDS as functions of x.

    x is the position relative to the peak of the slip velocity. Only blocks inside the frame are
    kept, and of these at most CURVE_POINTS.

    window : the last fraction of the front's path, from which its speed is measured
    """
    pulse = leading_pulse(run, window)
    # The column xi has the position relative to the front.
    blocks = pd.DataFrame(comoving(run, pulse))
    in_frame = blocks[blocks["xi"].between(frame.begin, frame.end)]
    kept = in_frame.iloc[spaced_indices(len(in_frame), CURVE_POINTS)]
    peak_relative_to_front = pulse.peak_distance - pulse.front
    return kept.assign(x=kept["xi"] - peak_relative_to_front)


def styled_runs(table: pd.DataFrame) -> pd.DataFrame:
    """Return the runs of one boundary condition, with their looks in the columns colour and dashes.

    The colour depends on the level on the left. The line style (dashes) depends on the damping
    ratio under a displacement boundary, and on the width of the Gaussian under a stress boundary.
    """
    # A panel has the name of its boundary condition.
    boundary, runs = table["panel"].iloc[0], table[table["role"] == "run"]
    colours = list(style.colour(LEVEL_COLUMNS[boundary], runs["left"]))
    values = runs[LINE_STYLE_COLUMNS[boundary]]
    dashes_of_value = dict(zip(np.sort(values.unique()), LINE_STYLES, strict=False))
    return runs.assign(colour=colours, dashes=values.map(dashes_of_value))


def draw_pulses(axes: Axes, table: pd.DataFrame, field: str) -> None:
    """Draw a field of the pulses of one boundary condition.

    Simulations are wide pale lines, which are grey if the run is flagged. Exact pulses are thin
    lines.
    """
    for run in styled_runs(table).itertuples():
        rows = table[table["run"] == run.run]
        simulated, exact = (rows[rows["role"] == role] for role in ("simulation", "exact"))
        is_flagged = isinstance(run.run_flags, str)
        pale = SIMULATION_LOOK | {"color": "0.7" if is_flagged else run.colour}
        axes.plot(simulated["x"], simulated[field], gid=f"simulation {run.run}", **pale)
        axes.plot(exact["x"], exact[field], run.dashes, color=run.colour, gid=f"exact {run.run}")
    boundary = table["panel"].iloc[0]
    axes.set(xlabel=DISTANCE_LABELS[boundary], ylabel=FIELDS[field][boundary])


def plot_fields(table: pd.DataFrame) -> Figure:
    """Draw figure 8 or 9: the three fields of the pulses of one boundary condition.

    table : the rows of `pulse_table` for this boundary condition (column panel)
    """
    figure, panels = style.new_panels(PAGE_WIDTH, 2.8, "abc")
    _, velocity_axes, acceleration_axes = panels
    for axes, field in zip(panels, FIELDS, strict=True):
        draw_pulses(axes, table, field)
    velocity_axes.set_title(title(table), loc="center")
    if table["panel"].iloc[0] == "displacement":
        # The undamped lattice oscillates at the front with a larger amplitude than theory has.
        acceleration_axes.set_ylim(-1.3, 1.3)
    else:
        # Under a stress boundary, the shape of the pulse depends on the Gaussian of the pre-stress.
        # An inset shows it where the velocity is small.
        box = (0.09, 0.66, 0.33, 0.22)
        draw_prestress(velocity_axes, box, styled_runs(table), half_length_in_widths=5.0)
        # The exact acceleration has no bound at the front.
        acceleration_axes.set(xlim=(-4.0, 4.0), ylim=(-0.3, 3.0))
    style.legend_below(figure, legend_entries(table), columns=6)
    return figure


def legend_entries(table: pd.DataFrame) -> list[Line2D]:
    """Return the legend entries of one boundary condition: colours, line styles, simulation."""
    runs, boundary = styled_runs(table), table["panel"].iloc[0]
    level_symbol = SYMBOLS[LEVEL_COLUMNS[boundary]]
    line_style_column = LINE_STYLE_COLUMNS[boundary]
    entries = []
    for run in runs.drop_duplicates("left").sort_values("left").itertuples():
        entries.append(entry(f"${level_symbol} = {run.left:g}$", color=run.colour))
    one_run_per_style = runs.drop_duplicates(line_style_column).sort_values(line_style_column)
    for _, run in one_run_per_style.iterrows():
        name = f"exact, ${SYMBOLS[line_style_column]} = {run[line_style_column]:g}$"
        entries.append(entry(name, color=BLACK, linestyle=run["dashes"]))
    return [*entries, entry("simulation", color=BLACK, **SIMULATION_LOOK)]


def title(table: pd.DataFrame) -> str:
    """Return a title with the boundary condition, and with all values of gamma or b.

    Gamma is named under a displacement boundary, and b under a stress boundary, because neither
    colour nor line style shows it there.
    """
    is_held = table["panel"].iloc[0] == "displacement"
    column = "gamma" if is_held else "damping_ratio"
    values = ", ".join(f"{value:g}" for value in table[column].dropna().unique())
    return rf"{style.conditions(held=is_held)}, ${SYMBOLS[column]} = {values}$"


def draw_prestress(axes: Axes, box: Box, runs: pd.DataFrame, half_length_in_widths: float) -> None:
    """Add an inset to a panel that shows the pre-stress of some runs as a function of position.

    box : place of the inset in the panel
    runs : the runs, with their colours in the column colour
    half_length_in_widths : half of the drawn length, in widths of the widest Gaussian
    """
    inset = style.small_inset(axes, box, r"pre-stress $\tau(x)$")
    # A pre-stress that is given as a table without a Gaussian has no width, and is not drawn.
    runs = runs[np.isfinite(runs["width"])]
    in_widths = np.linspace(-half_length_in_widths, half_length_in_widths, 161)
    x = in_widths * runs["width"].max()
    # Runs that differ only in other parameters have the same pre-stress, which is drawn once.
    for run in runs.drop_duplicates(["left", "right", "width"]).itertuples():
        tau = Prestress(run.left, run.right, run.width)(x)
        inset.plot(x, tau, color=run.colour, linewidth=0.8)
    inset.locator_params(nbins=3, integer=True)
    # Leave room between the peak and the title.
    inset.margins(y=0.12)
    inset.set_xlabel("$x$", fontsize=SMALL_TEXT, labelpad=0.0)
