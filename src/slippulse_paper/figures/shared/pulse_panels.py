"""Pulses in the frame that moves with them, simulated and exact: their table, and the drawing."""

import numpy as np
import pandas as pd
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

# Labels of the fields in the units of each boundary condition.
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
# The level gives a run its colour, and another column its line style.
STYLED = {"displacement": "damping_ratio", "stress": "width"}
STYLES = ("-", "--", ":", "-.")
# The number of levels drawn.
LEVELS = {"displacement": 2, "stress": 3}
# Points of a simulated curve, and decimals of its values that can be seen.
POINTS, DECIMALS = 300, 4
# A simulated pulse is drawn this far ahead of its front and behind its tail, in pulse widths.
AHEAD, BEHIND = 0.08, 0.25
PALE: Look = {"linewidth": 2.6, "alpha": 0.3}
PARAMETERS = ["left", "right", "width", "gamma", "damping_ratio", "run_flags"]


def pulse_table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Simulated pulses of each sweep at some levels, and exact ones, from the largest velocity on.

    Units under a displacement boundary are those of the paper's pulse; under a stress boundary the
    width of a Gaussian, slip and velocity of the exact pulse far from the nucleation, and that
    velocity over that width, since the exact acceleration has no bound.
    """
    window = settings["measure"]["front_window"]
    profiles = tables["pulse_profiles"].groupby(["simulation", "run"])
    parts = []
    for name, sweep in data.items():
        runs = tables[name]
        boundary = str(runs["boundary"].iloc[0])
        runs = runs[runs["left"].isin(spread_values(runs["left"], LEVELS[boundary]))]
        # Pulses that are not steady are flagged here; those under held stress have no state.
        steady = runs["pulse_state"].isin(["steady", "none"])
        flags = runs["run_flags"].where(steady, runs["pulse_state"])
        rows = [runs[PARAMETERS].assign(role="run", run=runs.index, run_flags=flags)]
        for index, numbers in runs.iterrows():
            exact = profiles.get_group((name, index)).assign(role="exact")
            if boundary == "displacement":
                length = numbers["exact_pulse_width"]
                extent = -(1.0 + BEHIND) * length, AHEAD * length
                kinds = ("width", "slip", "peak_velocity", "acceleration")
                units = [numbers[f"paper_pulse_{kind}"] for kind in kinds]
            else:
                length = float(np.ptp(exact["x"]))
                extent = -length, AHEAD * length
                width, peak = numbers["width"], numbers["exact_largest_velocity"]
                units = [width, exact["slip"].max(), peak, peak / width]
            run = point(sweep, int(index))
            pulse = leading_pulse(run, window)
            profile = pd.DataFrame(comoving(run, pulse))
            inside = profile[profile["xi"].between(*extent)]
            simulated = inside.iloc[:: int(np.ceil(len(inside) / POINTS))]
            x = simulated["xi"] - (pulse.peak_distance - pulse.front)
            both = pd.concat([simulated.assign(role="simulation", x=x), exact])
            curves = (both[["x", *FIELDS]] / units).round(DECIMALS)
            curves.insert(0, "role", both["role"])
            rows.append(curves.assign(run=index))
        parts.append(pd.concat(rows).assign(panel=boundary))
    return pd.concat(parts, ignore_index=True)


def styled_runs(table: pd.DataFrame) -> pd.DataFrame:
    """The runs of one boundary, with the colour and the line style of each."""
    boundary, runs = table["panel"].iloc[0], table[table["role"] == "run"]
    styled = runs[STYLED[boundary]]
    styles = dict(zip(np.sort(styled.unique()), STYLES, strict=False))
    colours = [*style.colour(LEVEL_COLUMNS[boundary], runs["left"])]
    return runs.assign(colour=colours, dashes=styled.map(styles))


def draw_pulses(axes: Axes, table: pd.DataFrame, field: str) -> None:
    """Draw a field of the pulses of one boundary: simulated ones pale, exact ones thin."""
    for run in styled_runs(table).itertuples():
        rows = table[table["run"] == run.run]
        simulated, exact = (rows[rows["role"] == role] for role in ("simulation", "exact"))
        pale = PALE | {"color": "0.7" if isinstance(run.run_flags, str) else run.colour}
        axes.plot(simulated["x"], simulated[field], gid=f"simulation {run.run}", **pale)
        axes.plot(exact["x"], exact[field], run.dashes, color=run.colour, gid=f"exact {run.run}")
    boundary = table["panel"].iloc[0]
    axes.set(xlabel=DISTANCE[boundary], ylabel=FIELDS[field][boundary])


def plot_fields(table: pd.DataFrame) -> Figure:
    """Draw figures 8 and 9: the three fields of the pulses of one boundary."""
    figure, panels = style.new_panels(PAGE_WIDTH, 2.8, "abc")
    for axes, field in zip(panels, FIELDS, strict=True):
        draw_pulses(axes, table, field)
    panels[1].set_title(title(table), loc="center")
    if table["panel"].iloc[0] == "displacement":
        # The undamped lattice rings beyond the theory at the front.
        panels[2].set_ylim(-1.3, 1.3)
    else:
        # The inset stands where slip and velocity are small.
        draw_prestress(panels[1], (0.09, 0.66, 0.33, 0.22), styled_runs(table), 5.0)
        # The exact acceleration has no bound at the front.
        panels[2].set(xlim=(-4.0, 4.0), ylim=(-0.3, 3.0))
    style.legend_below(figure, handles(table), 6)
    return figure


def handles(table: pd.DataFrame) -> list[Line2D]:
    """Legend entries of one boundary: the colours, the line styles and the simulation."""
    runs, boundary = styled_runs(table), table["panel"].iloc[0]
    level, styled = SYMBOLS[LEVEL_COLUMNS[boundary]], STYLED[boundary]
    entries = []
    for run in runs.drop_duplicates("left").sort_values("left").itertuples():
        entries.append(entry(f"${level} = {run.left:g}$", color=run.colour))
    for _, run in runs.drop_duplicates(styled).sort_values(styled).iterrows():
        name = f"exact, ${SYMBOLS[styled]} = {run[styled]:g}$"
        entries.append(entry(name, color=BLACK, linestyle=run["dashes"]))
    return [*entries, entry("simulation", color=BLACK, **PALE)]


def title(table: pd.DataFrame) -> str:
    """Title that names the boundary of the runs, and gamma or b, which their looks do not tell."""
    held = table["panel"].iloc[0] == "displacement"
    column = "gamma" if held else "damping_ratio"
    values = ", ".join(f"{value:g}" for value in table[column].dropna().unique())
    return rf"{style.conditions(held)}, ${SYMBOLS[column]} = {values}$"


def draw_prestress(axes: Axes, box: Box, runs: pd.DataFrame, widths: float) -> None:
    """Draw the pre-stress of coloured runs in an inset, to some widths of the widest Gaussian."""
    inset = style.small_inset(axes, box, r"pre-stress $\tau(x)$")
    # Tables of pre-stress without a Gaussian have no width.
    runs = runs[np.isfinite(runs["width"])]
    x = np.linspace(-widths, widths, 161) * runs["width"].max()
    for run in runs.drop_duplicates(["left", "right", "width"]).itertuples():
        tau = Prestress(run.left, run.right, run.width)(x)
        inset.plot(x, tau, color=run.colour, linewidth=0.8)
    inset.locator_params(nbins=3, integer=True)
    # Room between the peak and the title.
    inset.margins(y=0.12)
    inset.set_xlabel("$x$", fontsize=SMALL_TEXT, labelpad=0.0)
