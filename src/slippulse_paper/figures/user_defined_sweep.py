"""A user-defined sweep: its main numbers as functions of what varies, beside exact theory."""

import pandas as pd
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

# Columns that may vary in a sweep.
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
# The same for a sweep with pre-stress tables, which seed and profile number describe better than
# the levels at their ends.
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
    """Return `main_numbers` of each run, with its flags and four columns for the figure.

    axis, x : the column on the horizontal axis, and its value
    series : the values of the other columns that vary, as a text
    fixed : the settings that all runs share, as a text
    """
    (runs,) = tables.values()
    alike = (runs["left"] == runs["right"]).all()
    runs = runs.assign(tau_0=runs["left"] if alike else 0.0)
    axis, *others = varying_columns(runs) or ["profile" if "profile" in runs else "left"]
    held = runs["boundary"].iloc[0] == "displacement"
    levels = ["tau_0"] if alike else ["left", "right"]
    fixed = runs[[*(["gamma"] if held else []), *levels, "damping_ratio", "width", "dx"]]
    if "profile" in runs:
        fixed = fixed.drop(columns=levels)
    fixed = conditions(held, **fixed.loc[:, fixed.nunique() == 1].iloc[0])
    parts = []
    for _, run in runs.iterrows():
        series = ", ".join(f"{_name(name)} = {_text(run[name])}" for name in others)
        numbers = main_numbers(run).assign(run_flags=run["run_flags"])
        parts.append(numbers.assign(axis=axis, x=run[axis], series=series))
    rows = pd.concat(parts).set_index("quantity")
    # A quantity that equals another one in every run is left out.
    different = rows.groupby("quantity", sort=False)["value"].agg(tuple).drop_duplicates()
    return rows.loc[different.index].reset_index().assign(fixed=fixed)


def varying_columns(runs: pd.DataFrame) -> list[str]:
    """Return the columns that vary: numbers before texts, and those with most values first."""
    # A column that always equals another one is left out.
    names = TABLE_SWEEP_COLUMNS if "profile" in runs else VARYING_COLUMNS
    different = runs[[*names]].T.drop_duplicates().index
    varying = [name for name in different if runs[name].nunique() > 1]
    return sorted(varying, key=lambda name: (runs[name].dtype.kind != "f", -runs[name].nunique()))


def _name(column: str) -> str:
    """Return the words or the symbol of a column."""
    return COLUMN_WORDS.get(column) or f"${SYMBOLS[column]}$"


def _text(value: float | str) -> str:
    """Write a value of a column that may have numbers or texts."""
    return value if isinstance(value, str) else f"{value:g}"


def draw(table: pd.DataFrame) -> Figure:
    """Draw one panel for each quantity: runs as markers, open if flagged, and theory as lines."""
    table = table.assign(series=table["series"].astype(object).fillna(""))
    figure, panels = new_panels(PAGE_WIDTH, 4.2, "abc;def")
    quantities = list(table.groupby("quantity", sort=False))[: len(panels)]
    for axes, (_, rows) in zip(panels, quantities, strict=False):
        groups = rows.groupby("series", sort=False)
        colours = (
            COLOUR_CYCLE if 1 < groups.ngroups <= len(COLOUR_CYCLE) else [GREY] * groups.ngroups
        )
        for colour, (series, group) in zip(colours, groups, strict=False):
            group = group.sort_values("x")
            flagged = group["run_flags"].notna()
            axes.plot(group["x"], group["theory"], color=colour, linewidth=0.8)
            sound, hollow = group["value"].mask(flagged), group["value"].where(flagged)
            axes.plot(group["x"], sound, "o", color=colour, label=series or None)
            axes.plot(group["x"], hollow, "o", color=colour, **OPEN_MARKER)
        axes.set(xlabel=_name(rows["axis"].iloc[0]), ylabel=with_symbols(rows["label"].iloc[0]))
    for axes in panels[len(quantities) :]:
        axes.set_visible(False)
    figure.suptitle(table["fixed"].iloc[0])
    handles = [entry("simulation", marker="o", color=GREY)]
    if table["theory"].notna().any():
        handles.append(entry("exact theory", color=GREY, linewidth=0.8))
    if table["run_flags"].notna().any():
        handles.append(entry("flagged", marker="o", color=GREY, **OPEN_MARKER))
    legend_below(figure, [*panels[0].get_legend_handles_labels()[0], *handles], 5)
    return figure
