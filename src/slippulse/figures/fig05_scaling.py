"""Figure 5: L_trans and T_trans of every run against the paper's prediction, both boundary conditions."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from ..model.prestress import Prestress
from .shared.scaling import PREDICTIONS, SYMBOLS, collapse_rows, colour_bars, deviations, draw_collapse, norms
from .style import BLUE, GREEN, ORANGE, PAGE, new_figure, panel_letter

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {"measured": ["scaling_displacement", "scaling_stress"], "settings": ["measure.share"]}

INSET_POINTS = 161


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Every run of both sweeps, the summary of each panel, and the pre-stress profiles of the insets."""
    parts = []
    for boundary in ("displacement", "stress"):
        sweep = measured[f"scaling_{boundary}"]
        rows = collapse_rows(sweep, boundary)
        parts.append(rows)
        for panel, group in rows.groupby("panel"):
            count, median, largest = deviations(group)
            parts.append(
                pd.DataFrame(
                    [{"panel": panel, "role": "summary", "runs": count, "median": median, "largest": largest}]
                )
            )
        parts.append(inset_rows(sweep, boundary))
    parts.append(pd.DataFrame([{"panel": "all", "role": "share", "y": settings["measure"]["share"]}]))
    return pd.concat(parts, ignore_index=True)


def inset_rows(sweep: pd.DataFrame, boundary: str) -> pd.DataFrame:
    """Profiles of the lowest, middle and highest level, at the narrowest Gaussian."""
    levels = np.sort(sweep["left"].unique())
    width = float(sweep["width"].min() if boundary == "stress" else sweep["width"].iloc[0])
    x = np.linspace(-6.0 * width, 6.0 * width, INSET_POINTS)
    parts = []
    for level in (levels[0], levels[levels.size // 2], levels[-1]):
        right = level if boundary == "displacement" else float(sweep["right"].iloc[0])
        parts.append(
            pd.DataFrame(
                {
                    "panel": f"{boundary}_inset",
                    "role": "inset",
                    "x": x,
                    "y": Prestress(float(level), float(right), width)(x),
                    "left": level,
                    "width": width,
                }
            )
        )
    return pd.concat(parts, ignore_index=True)


def plot(table: pd.DataFrame) -> Figure:
    """Two rows (L_trans, T_trans) by two columns (displacement, stress)."""
    figure = new_figure(PAGE, 6.0)
    grid = figure.subplots(2, 2)
    markers = table[table["role"] == "marker"]
    share = float(table.loc[table["role"] == "share", "y"].iloc[0])
    for column, boundary in enumerate(("displacement", "stress")):
        rows = markers[markers["panel"].str.startswith(boundary)]
        scales = norms(rows, boundary)
        for row, quantity in enumerate(("length", "time")):
            axes = grid[row, column]
            name = f"{boundary}_{quantity}"
            draw_collapse(axes, rows[rows["panel"] == name], boundary, scales)
            summary = table[(table["role"] == "summary") & (table["panel"] == name)].iloc[0]
            axes.set_xlabel(f"predicted ${SYMBOLS[quantity]}$ = {PREDICTIONS[name]}")
            axes.set_ylabel(f"measured ${SYMBOLS[quantity]}$")
            axes.text(
                0.97,
                0.04,
                f"{summary.runs:.0f} runs\ndeviation from 1:1:\nmedian {summary['median']:.0%},"
                f" largest {summary['largest']:.0%}",
                transform=axes.transAxes,
                ha="right",
                va="bottom",
                fontsize=6.5,
            )
            panel_letter(axes, "abcd"[2 * row + column])
        gamma = r"$\Gamma = 1$" if boundary == "displacement" else r"$\Gamma = 0$"
        how = "when the first block sticks"
        if boundary == "stress":
            how = rf"when the left front reaches ${share:g}\,\bar x_-$"
        grid[0, column].set_title(f"{gamma}, {how}", fontsize=8)
        grid[1, column].legend(loc="upper left", handletextpad=0.4, borderaxespad=0.3)
        draw_inset(grid[0, column], table[table["panel"] == f"{boundary}_inset"])
        colour_bars(
            figure,
            list(grid[:, column]),
            boundary,
            scales,
            location="bottom",
            aspect=40,
            shrink=0.92,
            pad=0.02,
        )
    return figure


def draw_inset(axes, rows: pd.DataFrame) -> None:
    """Pre-stress profiles in the upper left corner."""
    inset = axes.inset_axes([0.1, 0.66, 0.34, 0.31])
    for colour, (_, group) in zip((BLUE, ORANGE, GREEN), rows.groupby("left"), strict=False):
        inset.plot(group["x"], group["y"], color=colour, linewidth=0.9)
    inset.set_xlabel(r"$\bar x$", fontsize=6.5, labelpad=0)
    inset.set_ylabel(r"$\bar\tau$", fontsize=6.5, labelpad=0)
    inset.tick_params(labelsize=5.5, length=2)
