"""Draw a scene: slip velocity in time and space, fields at the end, and numbers beside theory."""

import math
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from slippulse.model.layer_units import Layer
from slippulse.plotting import space_time
from slippulse.plotting.selection import spaced_indices
from slippulse.plotting.si_tables import table_in_si, with_unit
from slippulse.plotting.style import BLUE, GREY, ORANGE, PAGE_WIDTH, Look, by_role, panel_letter

from ..text.numerals import MAX_DIGITS, number, with_uncertainty
from .shared.main_numbers import with_symbols

# A field at the end is drawn at about this number of blocks.
PROFILE_POINTS = 400
FIELDS = {"slip_velocity": r"slip velocity $\dot u$", "slip": r"slip $u$"}
# Column of the largest value of each field in a pulse; with a prefix, that of its exact value.
LARGEST_VALUE_COLUMNS = {"slip_velocity": "pulse_peak_velocity", "slip": "pulse_slip"}


def table(
    run: xr.Dataset,
    numbers: pd.DataFrame,
    theory: pd.Series,
    title: str,
    layer: Layer | None = None,
) -> pd.DataFrame:
    """Return everything that the figure shows, with a role in each row.

    The roles are those of `run_table`, and:

    title : the title of the scene
    profile : a field at the end of the run, as a function of position
    steady : the largest value of a field in the exact steady pulse on each side
    number : one of the numbers below the panels

    Parameters
    ----------
    numbers : table from `main_numbers.scene_numbers`; in SI units if there is a layer
    theory : row of the run with its measured and predicted numbers
    title : title of the scene
    layer : if given, the table is converted to SI units
    """
    parts = [
        pd.DataFrame([{"role": "title", "series": title}]),
        space_time.run_table(run),
        *(profile_rows(run, field) for field in FIELDS),
        steady_rows(run, theory),
        numbers.rename(columns={"quantity": "series"}).assign(role="number"),
    ]
    rows = pd.concat(parts, ignore_index=True)
    columns = ["role", "series", "label", "time", "position", "value", "uncertainty", "theory"]
    if layer is None:
        return rows.reindex(columns=columns)
    return table_in_si(rows, layer).reindex(columns=[*columns, "unit"])


def profile_rows(run: xr.Dataset, field: str) -> pd.DataFrame:
    """Return a field at the end as a function of position, at some blocks of the drawn range.

    The block with the largest value is among them.
    """
    lower, upper = space_time.drawn_range(run)
    x, values = run["x"].values, run[field].values
    in_range = np.flatnonzero((x >= lower) & (x <= upper))
    spaced = in_range[spaced_indices(in_range.size, PROFILE_POINTS)]
    largest = in_range[np.argmax(values[in_range])]
    kept = np.union1d(spaced, largest)
    rows = {"role": "profile", "series": field, "position": x[kept], "value": values[kept]}
    return pd.DataFrame(rows)


def steady_rows(run: xr.Dataset, theory: pd.Series) -> pd.DataFrame:
    """Return the largest slip and slip velocity of the exact steady pulse on each side.

    A row is drawn as a horizontal line from x = 0 to the end of the drawn range on its side (column
    position). A side without a pulse at the end, or without theory, has no rows.

    theory : measured and predicted numbers of the run
    """
    lower, upper = space_time.drawn_range(run)
    # Only the pulse on the right is measured. On the left there is a pulse if some block has stuck,
    # and if some blocks on the left still slide at the end.
    slides_on_left = (run["slip_velocity"].values[run["x"].values < 0.0] > 0.0).any()
    has_left_pulse = math.isfinite(run.attrs["first_stick_time"]) and slides_on_left
    has_right_pulse = theory["pulse_state"] not in ("none", "stopped")
    rows = []
    for field, column in LARGEST_VALUE_COLUMNS.items():
        if has_left_pulse:
            rows.append((field, lower, theory[f"exact_left_{column}"]))
        if has_right_pulse:
            rows.append((field, upper, theory[f"exact_{column}"]))
    columns = ["series", "position", "value"]
    return pd.DataFrame(rows, columns=columns).assign(role="steady").dropna()


def draw(table: pd.DataFrame) -> Figure:
    """Draw in three rows the space-time map, slip velocity and slip at the end, and the numbers."""
    rows_by_role = by_role(table)
    # A run may have neither numbers nor exact steady pulses.
    no_rows = table.iloc[:0]
    numbers, steady_pulses = (
        rows_by_role.get("number", no_rows),
        rows_by_role.get("steady", no_rows),
    )
    # Numbers are written in two columns.
    line_count = math.ceil(len(numbers) / 2)
    text_height = 0.16 * line_count
    figure = Figure(figsize=(PAGE_WIDTH, 4.9 + text_height), layout="constrained")
    heights = (3.1, 1.6, 0.2 + text_height)
    upper, middle, lower = figure.subfigures(3, 1, squeeze=False, height_ratios=heights).flat
    prestress_axes, map_axes = upper.subplots(1, 2, sharey=True, width_ratios=(0.16, 1.0))
    space_time.draw_profile(prestress_axes, rows_by_role)
    space_time.draw_map(map_axes, rows_by_role)
    space_time.add_map_legend(map_axes)
    panel_letter(prestress_axes, "a")
    # A dollar sign in the title is a character, and does not begin a formula.
    title = str(rows_by_role["title"]["series"].iloc[0]).replace("$", r"\$")
    upper.suptitle(f"{title}\n{space_time.run_title(rows_by_role)}")
    for axes, letter, field in zip(middle.subplots(1, 2), "bc", FIELDS, strict=True):
        draw_field(axes, rows_by_role, field, steady_pulses[steady_pulses["series"] == field])
        panel_letter(axes, letter)
    write_numbers(lower, numbers, line_count)
    return figure


def draw_field(
    axes: Axes, rows_by_role: dict[str, pd.DataFrame], field: str, steady_pulses: pd.DataFrame
) -> None:
    """Draw a field at the end, and as dashed lines its largest values in exact steady pulses.

    field : "slip_velocity" or "slip"
    steady_pulses : the rows of `steady_rows` for this field; a dashed line runs from x = 0 to the
        position of a row, which is the end of the panel on the side of the pulse
    """
    rows = rows_by_role["profile"][rows_by_role["profile"]["series"] == field]
    axes.axhline(0.0, color=GREY, linewidth=0.5)
    handles = axes.plot(rows["position"], rows["value"], color=BLUE, label="simulated")
    look: Look = {"color": ORANGE, "gid": "steady", "label": "exact steady pulse on each side"}
    for pulse in steady_pulses.itertuples():
        handles += axes.plot([0.0, pulse.position], [pulse.value, pulse.value], "--", **look)
    # The legend stands in the panel of the velocity, which is 0 in the middle. It holds for both
    # panels, and has one entry for all steady pulses.
    if len(handles) > 1 and field == "slip_velocity":
        axes.legend(handles=handles[:2], loc="center")
    axes.set_xlabel(with_unit(r"position $x$", rows_by_role, "position"))
    # A label with a unit needs a second line, since the panel is low.
    separator = "\n" if "unit" in rows_by_role else " "
    axes.set_ylabel(with_unit(FIELDS[field], rows_by_role, field) + separator + "at the end")
    axes.set_xlim(rows["position"].min(), rows["position"].max())


def write_numbers(figure: SubFigure, numbers: pd.DataFrame, line_count: int) -> None:
    """Write each number with its uncertainty and its value by theory, in two columns.

    line_count : number of lines of a column
    """
    for index, row in enumerate(numbers.itertuples()):
        measured = f"{with_uncertainty(row.value, row.uncertainty)} {_unit(row)}".strip()
        text = f"{with_symbols(row.label)}: {measured}"
        if math.isfinite(row.theory):
            text += f" (theory {number(row.theory, MAX_DIGITS)})"
        # Numbers with an even index are in the left column.
        line, column = divmod(index, 2)
        height = 1.0 - (line + 0.6) / (line_count + 0.4)
        figure.text(0.06 + 0.48 * column, height, text, va="center")


def _unit(row: Any) -> str:
    """Return the unit of a number; empty if the table is not in SI units."""
    unit = getattr(row, "unit", "")
    return unit if isinstance(unit, str) else ""
