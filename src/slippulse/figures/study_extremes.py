"""The edges of the solver's domain as a table: what should happen, what did, and by how much."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from ..studies.outcomes import FLAGGED, NO_NUMBER, NOT_OFFERED, REFUSED, RIGHT, STOPPED, WRONG
from .style import BLACK, BLUE, GREY, ORANGE, PAGE, PURPLE, new_figure

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {"studies": ["extremes"]}

COLOURS = {
    RIGHT: BLUE,
    FLAGGED: ORANGE,
    REFUSED: PURPLE,
    STOPPED: PURPLE,
    NO_NUMBER: GREY,
    NOT_OFFERED: GREY,
    WRONG: "red",
}
# Left ends of the text columns, in shares of their panel.
COLUMNS = {"family": 0.0, "value": 0.18, "quantity": 0.54, "verdict": 0.74}
HEADINGS = {"family": "edge", "value": "value", "quantity": "compared", "verdict": "outcome"}
# Errors below this are drawn at it: rounding.
LEAST = 1e-13


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """The rows of the study as they are drawn."""
    return measured["extremes"]


def plot(table: pd.DataFrame) -> Figure:
    """One line an edge: text on the left, relative error against its tolerance on the right."""
    figure = new_figure(PAGE, 0.9 + 0.132 * len(table))
    text, errors = figure.subplots(1, 2, sharey=True, width_ratios=[2.3, 1.0])
    lines = np.arange(len(table))
    text.set_axis_off()
    text.set_xlim(0.0, 1.0)
    small = {"fontsize": 6.2, "va": "center"}
    for name, x in COLUMNS.items():
        text.text(x, -1.1, HEADINGS[name], fontweight="bold", **small)
    before = None
    for line, row in zip(lines, table.itertuples(), strict=True):
        colour = COLOURS[row.verdict]
        if row.family != before:
            text.text(COLUMNS["family"], line, row.family, **small)
            for axes in (text, errors):
                axes.axhline(line - 0.5, color="0.85", linewidth=0.5, zorder=0)
        before = row.family
        text.text(COLUMNS["value"], line, row.value, **small)
        text.text(COLUMNS["quantity"], line, row.quantity, **small)
        text.text(COLUMNS["verdict"], line, outcome(row), color=colour, gid="verdict", **small)

    shown = np.maximum(table["error"].to_numpy(), LEAST)
    for kind, rows in table.groupby("verdict", sort=False):
        chosen = rows.index[np.isfinite(rows["error"])]
        errors.plot(
            shown[chosen], chosen, "o" if kind == RIGHT else "D", color=COLOURS[kind], markersize=2.8,
            linestyle="none", gid=kind,
        )  # fmt: skip
    bound = table["tolerance"] > 0.0
    errors.plot(table["tolerance"][bound], lines[bound], "|", color=BLACK, markersize=5.0, gid="tolerance")
    errors.set_xscale("log")
    errors.set_xlim(0.4 * LEAST, 3.0)
    errors.set_ylim(len(table) - 0.4, -1.7)
    errors.tick_params(labelleft=False, left=False)
    errors.set_xlabel("relative error, bar: tolerance\n(absolute where 0 is expected)")
    return figure


def outcome(row) -> str:
    """The verdict, with the first flag where there is one."""
    if row.verdict != FLAGGED:
        return row.verdict
    return f"{row.verdict}: {row.message.partition(',')[0].replace('_', ' ')}"
