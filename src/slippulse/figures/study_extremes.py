"""The edges of the solver's domain: how each ends, and its error against its tolerance."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from ..studies.outcomes import FLAGGED, NO_NUMBER, NOT_OFFERED, REFUSED, RIGHT, STOPPED, WRONG
from .style import BLACK, BLUE, COLUMN, GREY, ORANGE, PURPLE, new_figure

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
MARKS = {RIGHT: "o", FLAGGED: "D", REFUSED: "s", STOPPED: "^", NO_NUMBER: "v", NOT_OFFERED: "<"}
# Errors below this are drawn at it: rounding.
LEAST = 1e-13


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """The rows of the study as they are drawn."""
    return measured["extremes"]


def plot(table: pd.DataFrame) -> Figure:
    """One line an edge: its relative error against its tolerance, in the colour of its outcome."""
    figure = new_figure(COLUMN, 0.9 + 0.112 * len(table))
    axes = figure.subplots()
    lines = np.arange(len(table))
    shown = np.maximum(table["error"].to_numpy(), LEAST)
    for kind, rows in table.groupby("verdict", sort=False):
        finite = np.isfinite(rows["error"].to_numpy())
        # What ends without a number has its mark on the left edge.
        places = np.where(finite, shown[rows.index], LEAST)
        axes.plot(
            places, rows.index, MARKS.get(kind, "X"), color=COLOURS[kind], markersize=3.2, linestyle="none", label=kind,
            gid=kind, clip_on=False,
        )  # fmt: skip
    bound = table["tolerance"] > 0.0
    axes.plot(
        table["tolerance"][bound], lines[bound], "|", color=BLACK, markersize=5.0, gid="tolerance", label="tolerance"
    )  # fmt: skip
    starts = np.flatnonzero(table["family"].ne(table["family"].shift()))
    for line in starts:
        axes.axhline(line - 0.5, color="0.85", linewidth=0.5, zorder=0)
    names = [f"{row.family}: {row.value}" for row in table.itertuples()]
    axes.set_yticks(lines, names, fontsize=7.0)
    axes.tick_params(axis="y", length=0.0)
    axes.set_xscale("log")
    axes.set_xlim(LEAST, 3.0)
    axes.set_ylim(len(table) - 0.4, -0.6)
    axes.set_xlabel("relative error\n(absolute for 0)", linespacing=0.9)
    figure.legend(loc="outside lower center", ncols=3, handletextpad=0.2, columnspacing=0.8)
    return figure
