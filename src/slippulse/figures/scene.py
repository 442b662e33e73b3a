"""One scene: slip velocity over time and position, the profile at the end, and its numbers beside theory."""

import math

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from ..data.numerals import MOST, number, with_uncertainty
from .shared.numbers import with_symbols
from .shared.space_time import description, draw_map, draw_profile, limits, run_rows, thin
from .style import BLUE, GREY, ORANGE, PAGE, new_figure, panel_letter

# Blocks drawn of a profile.
PROFILE_POINTS = 400
FIELDS = {"slip_velocity": r"slip velocity $\dot u$", "slip": r"slip $u$"}
# The number of a steady pulse that the largest value of each field is.
LARGEST = {"slip_velocity": "pulse_peak_velocity", "slip": "pulse_slip"}


def table(run: xr.Dataset, numbers: pd.DataFrame, title: str) -> pd.DataFrame:
    """Roles of `run_rows` of a run with fields; profile (series: field at the end); number (series: its quantity), as
    `shared.numbers.scene_numbers` has them; title (series: the text).
    """
    lower, upper = limits(run)
    x = run["x"].values
    inside = np.flatnonzero((x >= lower) & (x <= upper))
    parts = [pd.DataFrame([{"role": "title", "series": title}]), run_rows(run)]
    for name in FIELDS:
        values = run[name].values
        kept = np.union1d(
            inside[thin(inside.size, PROFILE_POINTS)], inside[np.argmax(values[inside])]
        )
        rows = {"role": "profile", "series": name, "position": x[kept], "value": values[kept]}
        parts.append(pd.DataFrame(rows))
    parts.append(numbers.rename(columns={"quantity": "series"}).assign(role="number"))
    columns = ["role", "series", "label", "time", "position", "value", "uncertainty", "theory"]
    return pd.concat(parts, ignore_index=True).reindex(columns=columns)


def number_text(value: float, uncertainty: float, theory: float) -> str:
    """A number with its uncertainty, where the grid study has one, and the theory's beside it."""
    text = with_uncertainty(value, uncertainty)
    return f"{text} (theory {number(theory, MOST)})" if math.isfinite(theory) else text


def plot(table: pd.DataFrame) -> Figure:
    """Draw the figure from its table."""
    roles = {str(role): rows for role, rows in table.groupby("role")}
    numbers = roles.get("number", table.iloc[:0])
    rows = math.ceil(len(numbers) / 2)
    figure, heights = new_figure(PAGE, 4.9 + 0.16 * rows), (3.1, 1.6, 0.2 + 0.16 * rows)
    upper, lower, text = figure.subfigures(3, 1, squeeze=False, height_ratios=heights).flat
    draw_space_time(upper, roles)
    for axes, letter, field in zip(lower.subplots(1, 2), "bc", FIELDS, strict=True):
        draw_end(axes, roles["profile"], numbers, field)
        panel_letter(axes, letter)
    for index, row in enumerate(numbers.itertuples()):
        line = f"{with_symbols(row.label)}: {number_text(row.value, row.uncertainty, row.theory)}"
        height = 1.0 - (index // 2 + 0.6) / (rows + 0.4)
        text.text(0.06 + 0.48 * (index % 2), height, line, va="center", fontsize=8.0)
    return figure


def draw_space_time(figure: SubFigure, roles: dict[str, pd.DataFrame]) -> None:
    """Pre-stress and map, under title and parameters."""
    profile, axes = figure.subplots(1, 2, sharey=True, width_ratios=(0.16, 1.0))
    draw_profile(profile, roles["prestress"])
    image = draw_map(axes, roles)
    axes.legend(loc="upper left")
    figure.colorbar(image, ax=axes, pad=0.015, aspect=25).set_label(r"slip velocity $\dot u$")
    panel_letter(profile, "a")
    title = str(roles["title"]["series"].iloc[0]).replace("$", r"\$")
    spacing = roles["parameter"].set_index("series").loc["dx", "value"]
    figure.suptitle(
        rf"{title}" + "\n" + rf"{description(roles)}, $\Delta x = {spacing:g}$", fontsize=9.0
    )


def draw_end(axes: Axes, profile: pd.DataFrame, numbers: pd.DataFrame, field: str) -> None:
    """A field at the end, and what exact theory has for its value in the right pulse, where that is steady."""
    rows = profile[profile["series"] == field]
    axes.axhline(0.0, color=GREY, linewidth=0.5)
    axes.plot(rows["position"], rows["value"], color=BLUE, label="simulated")
    theory = numbers.loc[numbers["series"] == LARGEST[field], "theory"].dropna()
    for value in theory:
        axes.axhline(
            value, color=ORANGE, linewidth=0.8, linestyle=(0, (3, 1.5)), label="steady pulse, exact"
        )
    if len(theory):
        axes.legend(loc="center")
    axes.set(xlabel=r"position $x$", ylabel=f"{FIELDS[field]} at the end")
    axes.set_xlim(rows["position"].min(), rows["position"].max())
