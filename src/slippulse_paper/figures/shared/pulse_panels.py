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
from slippulse.plotting.selection import spread_values
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
STYLED_COLUMN = {"displacement": "damping_ratio", "stress": "width"}
LINE_STYLES = ("-", "--", ":", "-.")
# Number of drawn levels of the pre-stress.
LEVEL_COUNT = {"displacement": 2, "stress": 3}
# Largest number of points of a simulated curve, and number of decimals of its values.
CURVE_POINTS, VISIBLE_DECIMALS = 300, 4
# A simulated pulse is drawn beyond its front and beyond its tail by these fractions of its width.
MARGIN_AHEAD, MARGIN_BEHIND = 0.08, 0.25
SIMULATION_LOOK: Look = {"linewidth": 2.6, "alpha": 0.3}
PARAMETERS = ["left", "right", "width", "gamma", "damping_ratio", "run_flags"]


def pulse_table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return simulated and exact pulses of each sweep at a few levels of pre-stress.

    The column role is "run" (one row for each run, with its parameters), "simulation" or "exact"
    (the points of a curve). Positions x are relative to the peak of the slip velocity.
    `frame_of_pulse` describes the units.
    """
    window = settings["measure"]["front_window"]
    # The exact profile of each run.
    profiles = tables["pulse_profiles"].groupby(["simulation", "run"])
    parts = []
    # A sweep has one boundary condition.
    for name, sweep in data.items():
        runs = tables[name]
        boundary = str(runs["boundary"].iloc[0])
        drawn_levels = spread_values(runs["left"], LEVEL_COUNT[boundary])
        runs = runs[runs["left"].isin(drawn_levels)]
        # A pulse that is not steady counts as flagged. Under a stress boundary, pulses have no such
        # state ("none").
        is_steady = runs["pulse_state"].isin(["steady", "none"])
        flags = runs["run_flags"].where(is_steady, runs["pulse_state"])
        rows = [runs[PARAMETERS].assign(role="run", run=runs.index, run_flags=flags)]
        for index, numbers in runs.iterrows():
            exact = profiles.get_group((name, index)).assign(role="exact")
            frame = frame_of_pulse(boundary, numbers, exact)
            simulated = simulated_profile(point(sweep, int(index)), window, frame)
            points = pd.concat([simulated.assign(role="simulation"), exact])
            curves = (points[["x", *FIELDS]] / frame.units).round(VISIBLE_DECIMALS)
            curves.insert(0, "role", points["role"])
            rows.append(curves.assign(run=index))
        parts.append(pd.concat(rows).assign(panel=boundary))
    return pd.concat(parts, ignore_index=True)


class PulseFrame(NamedTuple):
    """The range in which a simulated pulse is drawn, and the units of its curves.

    begin, end : first and last drawn distance from the front; distances are negative behind it
    units : units of x and of each of FIELDS
    """

    begin: float
    end: float
    units: list[float]


def frame_of_pulse(boundary: str, numbers: pd.Series, exact: pd.DataFrame) -> PulseFrame:
    """Return the drawn range and the units of one pulse.

    Under a displacement boundary, the units are width, slip, peak velocity and acceleration of the
    pulse by the paper's formulas. Under a stress boundary, the unit of length is the width of the
    Gaussian. The units of slip and velocity are the largest values of the exact pulse far from the
    nucleation. The exact acceleration has no largest value, so its unit is that of velocity divided
    by that of length.

    numbers : measured and predicted numbers of the run
    exact : profile of the exact pulse
    """
    if boundary == "displacement":
        length = numbers["exact_pulse_width"]
        names = ("width", "slip", "peak_velocity", "acceleration")
        units = [numbers[f"paper_pulse_{name}"] for name in names]
        return PulseFrame(-(1.0 + MARGIN_BEHIND) * length, MARGIN_AHEAD * length, units)
    # This pulse has a long tail, which is drawn as far as the exact profile has it.
    length = float(np.ptp(exact["x"]))
    width, peak_velocity = numbers["width"], numbers["exact_largest_velocity"]
    units = [width, exact["slip"].max(), peak_velocity, peak_velocity / width]
    return PulseFrame(-length, MARGIN_AHEAD * length, units)


def simulated_profile(run: xr.Dataset, window: float, frame: PulseFrame) -> pd.DataFrame:
    """Return the right pulse at the end of a run: the columns of FIELDS as functions of x.

    x is the position relative to the peak of the slip velocity.

    window : the last fraction of the front's path, from which its speed is measured
    """
    pulse = leading_pulse(run, window)
    # xi is the position relative to the front.
    profile = pd.DataFrame(comoving(run, pulse))
    in_frame = profile[profile["xi"].between(frame.begin, frame.end)]
    stride = int(np.ceil(len(in_frame) / CURVE_POINTS))
    drawn = in_frame.iloc[::stride]
    peak_xi = pulse.peak_distance - pulse.front
    return drawn.assign(x=drawn["xi"] - peak_xi)


def styled_runs(table: pd.DataFrame) -> pd.DataFrame:
    """Return the runs of one boundary condition, each with a colour and a line style (dashes)."""
    boundary, runs = table["panel"].iloc[0], table[table["role"] == "run"]
    styled_values = runs[STYLED_COLUMN[boundary]]
    style_of_value = dict(zip(np.sort(styled_values.unique()), LINE_STYLES, strict=False))
    colours = [*style.colour(LEVEL_COLUMNS[boundary], runs["left"])]
    return runs.assign(colour=colours, dashes=styled_values.map(style_of_value))


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
    """Draw figure 8 or 9: the three fields of the pulses of one boundary condition."""
    figure, panels = style.new_panels(PAGE_WIDTH, 2.8, "abc")
    for axes, field in zip(panels, FIELDS, strict=True):
        draw_pulses(axes, table, field)
    panels[1].set_title(title(table), loc="center")
    if table["panel"].iloc[0] == "displacement":
        # The undamped lattice oscillates at the front with a larger amplitude than theory has.
        panels[2].set_ylim(-1.3, 1.3)
    else:
        # The inset stands where slip and velocity are small.
        draw_prestress(panels[1], (0.09, 0.66, 0.33, 0.22), styled_runs(table), 5.0)
        # The exact acceleration has no bound at the front.
        panels[2].set(xlim=(-4.0, 4.0), ylim=(-0.3, 3.0))
    style.legend_below(figure, handles(table), 6)
    return figure


def handles(table: pd.DataFrame) -> list[Line2D]:
    """Return the legend entries of one boundary condition: colours, line styles, simulation."""
    runs, boundary = styled_runs(table), table["panel"].iloc[0]
    level_symbol = SYMBOLS[LEVEL_COLUMNS[boundary]]
    styled = STYLED_COLUMN[boundary]
    entries = []
    for run in runs.drop_duplicates("left").sort_values("left").itertuples():
        entries.append(entry(f"${level_symbol} = {run.left:g}$", color=run.colour))
    for _, run in runs.drop_duplicates(styled).sort_values(styled).iterrows():
        name = f"exact, ${SYMBOLS[styled]} = {run[styled]:g}$"
        entries.append(entry(name, color=BLACK, linestyle=run["dashes"]))
    return [*entries, entry("simulation", color=BLACK, **SIMULATION_LOOK)]


def title(table: pd.DataFrame) -> str:
    """Return a title with the boundary condition, and with all values of gamma or b.

    Gamma is named under a displacement boundary, and b under a stress boundary, because neither
    colour nor line style shows it there.
    """
    has_springs = table["panel"].iloc[0] == "displacement"
    column = "gamma" if has_springs else "damping_ratio"
    values = ", ".join(f"{value:g}" for value in table[column].dropna().unique())
    return rf"{style.conditions(has_springs)}, ${SYMBOLS[column]} = {values}$"


def draw_prestress(axes: Axes, box: Box, runs: pd.DataFrame, half_length: float) -> None:
    """Draw the pre-stress of some runs in an inset.

    runs : the runs, with their colours in the column colour
    half_length : the inset shows the positions from -half_length to half_length, in widths of the
        widest Gaussian
    """
    inset = style.small_inset(axes, box, r"pre-stress $\tau(x)$")
    # Tables of pre-stress without a Gaussian have no width.
    runs = runs[np.isfinite(runs["width"])]
    x = np.linspace(-half_length, half_length, 161) * runs["width"].max()
    for run in runs.drop_duplicates(["left", "right", "width"]).itertuples():
        tau = Prestress(run.left, run.right, run.width)(x)
        inset.plot(x, tau, color=run.colour, linewidth=0.8)
    inset.locator_params(nbins=3, integer=True)
    # Leave room between the peak and the title.
    inset.margins(y=0.12)
    inset.set_xlabel("$x$", fontsize=SMALL_TEXT, labelpad=0.0)
