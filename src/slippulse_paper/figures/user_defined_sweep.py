"""The main numbers of a user-defined sweep as functions of the parameters that vary in it."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slippulse.model.scene import EXTRA_TERMS
from slippulse.plotting.style import (
    COLOUR_CYCLE,
    GREY,
    OPEN_MARKER,
    PAGE_WIDTH,
    SYMBOLS,
    conditions,
    entry,
    legend_below,
    new_panels,
)

from .shared.main_numbers import main_numbers, with_symbols

# Columns of parameters that may vary in a sweep.
VARYING_COLUMNS = (
    "tau_0",
    "left",
    "right",
    "gamma",
    *EXTRA_TERMS,
    "damping_ratio",
    "width",
    "beyond",
    "release",
    "dx",
)
# The same for a sweep with pre-stress tables. Seed and profile describe a table better than the
# levels at its ends.
TABLE_SWEEP_COLUMNS = (
    "seed",
    "profile",
    "gamma",
    *EXTRA_TERMS,
    "damping_ratio",
    "width",
    "release",
    "dx",
)
# Names of columns without a symbol.
COLUMN_WORDS = {"beyond": "level beyond the step", "release": "release rule"}
COLUMN_WORDS |= {"profile": "profile", "seed": "seed"}


def table(data: dict, tables: dict[str, pd.DataFrame], settings: dict) -> pd.DataFrame:
    """Return the main measured numbers of each run, with its flags and four more columns.

    axis : name of the parameter on the horizontal axis
    x : value of this parameter
    series : values of the other parameters that vary, as a text
    fixed : settings that all runs share, as a text
    """
    # The figure needs only the table of its sweep.
    (runs,) = tables.values()
    has_equal_levels = (runs["left"] == runs["right"]).all()
    # The column tau_0 has the level of both sides, or NaN if they differ in some run.
    runs = runs.assign(tau_0=runs["left"] if has_equal_levels else np.nan)
    # If nothing varies, as in a single run, the axis shows the profile or the level on the left.
    axis_of_equal_runs = "profile" if "profile" in runs else "left"
    axis, *other_columns = varying_columns(runs) or [axis_of_equal_runs]
    parts = []
    for _, run in runs.iterrows():
        series = ", ".join(f"{_name(column)} = {_text(run[column])}" for column in other_columns)
        numbers = main_numbers(run).assign(run_flags=run["run_flags"])
        parts.append(numbers.assign(axis=axis, x=run[axis], series=series))
    rows = pd.concat(parts).set_index("quantity")
    # If two quantities are equal in every run, only the first one is kept. To compare them, the
    # values of a quantity in all runs become one tuple.
    values_of_all_runs = rows.groupby("quantity", sort=False)["value"].agg(tuple)
    kept = values_of_all_runs.drop_duplicates().index
    levels = ["tau_0"] if has_equal_levels else ["left", "right"]
    return rows.loc[kept].reset_index().assign(fixed=fixed_settings(runs, levels))


def fixed_settings(runs: pd.DataFrame, levels: list[str]) -> str:
    """Return the boundary condition and the settings that all runs share, as a text.

    levels : the columns with the levels of the pre-stress; left out for tables of pre-stress
    """
    is_held = runs["boundary"].iloc[0] == "displacement"
    columns = ["gamma"] if is_held else []
    if "profile" not in runs:
        columns += levels
    columns += ["damping_ratio", "width", "dx"]
    shared = [column for column in columns if runs[column].nunique() == 1]
    return conditions(held=is_held, **runs[shared].iloc[0])


def varying_columns(runs: pd.DataFrame) -> list[str]:
    """Return the names of the columns that vary: first numbers, then texts.

    In each of these two groups, the column with the most values comes first.
    """
    # Only a sweep with pre-stress tables has the column profile.
    columns = TABLE_SWEEP_COLUMNS if "profile" in runs else VARYING_COLUMNS
    # If two columns are equal in every run, only the first one is kept. In the transposed table,
    # each column is a row.
    different = runs[list(columns)].T.drop_duplicates().index
    counts = runs[different].nunique()
    varying = counts[counts > 1].sort_values(ascending=False, kind="stable").index
    # A seed is an integer without a meaning of its own, so it counts as a text.
    numbers = [column for column in varying if runs[column].dtype.kind == "f"]
    texts = [column for column in varying if column not in numbers]
    return numbers + texts


def _name(column: str) -> str:
    """Return the name of a column in the figure: words, or a symbol as a formula."""
    return COLUMN_WORDS.get(column) or f"${SYMBOLS[column]}$"


def _text(value: float | str) -> str:
    """Return a value, which may be a number or a text, as text."""
    return value if isinstance(value, str) else f"{value:g}"


def draw(table: pd.DataFrame) -> Figure:
    """Draw one panel for each quantity: runs as markers, open if flagged, and theory as lines."""
    # A CSV file has NaN in place of an empty text.
    table = table.assign(series=table["series"].astype(object).fillna(""))
    figure, panels = new_panels(PAGE_WIDTH, 4.2, "abc;def")
    rows_by_quantity = [rows for _, rows in table.groupby("quantity", sort=False)]
    # Quantities for which there is no panel are left out.
    drawn = rows_by_quantity[: len(panels)]
    for axes, rows in zip(panels, drawn, strict=False):
        draw_quantity(axes, rows)
    for empty_panel in panels[len(drawn) :]:
        empty_panel.set_visible(False)
    # All panels are hidden if no run has a number, for example because all runs are too short.
    no_numbers = "no run gives a number that this figure shows"
    figure.suptitle(no_numbers if table.empty else table["fixed"].iloc[0])
    series, _ = panels[0].get_legend_handles_labels()
    handles = [*series, entry("simulation", marker="o", color=GREY)]
    if table["theory"].notna().any():
        handles.append(entry("exact theory", color=GREY, linewidth=0.8))
    if table["run_flags"].notna().any():
        handles.append(entry("flagged", marker="o", color=GREY, **OPEN_MARKER))
    legend_below(figure, handles, columns=5)
    return figure


def draw_quantity(axes: Axes, rows: pd.DataFrame) -> None:
    """Draw one quantity: runs as markers, open if flagged, and theory as a line.

    A series is a set of runs that differ only in the parameter on the horizontal axis, and has a
    colour. If there are not enough colours, everything is grey and has no entry in the legend.
    """
    groups = rows.groupby("series", sort=False)
    has_colours = 1 < groups.ngroups <= len(COLOUR_CYCLE)
    colours = COLOUR_CYCLE if has_colours else [GREY] * groups.ngroups
    for colour, (series, group) in zip(colours, groups, strict=False):
        group = group.sort_values("x")
        is_flagged = group["run_flags"].notna()
        axes.plot(group["x"], group["theory"], color=colour, linewidth=0.8)
        # NaN values are not drawn.
        unflagged, flagged = group["value"].mask(is_flagged), group["value"].where(is_flagged)
        axes.plot(group["x"], unflagged, "o", color=colour, label=series if has_colours else None)
        axes.plot(group["x"], flagged, "o", color=colour, **OPEN_MARKER)
    axes.set(xlabel=_name(rows["axis"].iloc[0]), ylabel=with_symbols(rows["label"].iloc[0]))
