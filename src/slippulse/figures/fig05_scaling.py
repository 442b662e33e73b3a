"""Figure 5: L_trans and T_trans of every run against the paper's prediction, both boundary conditions."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from ..model.prestress import Prestress
from .shared.scaling import (
    OTHERS,
    SYMBOLS,
    chosen,
    collapse_rows,
    draw_collapse,
    draw_ratio,
    exact_rows,
    level_bar,
    summaries,
)
from .style import BLACK, COLUMN, GREY, colour_scale, new_figure, panel_letter

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {"measured": ["scaling_displacement", "scaling_stress"], "settings": ["measure.share"]}

INSET_POINTS = 161


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Every run of both sweeps, exact theory at some of them, the summary of each panel, and pre-stress profiles."""
    share = settings["measure"]["share"]
    parts = []
    # In the continuum the ratios under a stress boundary do not depend on the width: its ends are enough.
    for boundary, most in (("displacement", {"left": 5, "gamma": 5}), ("stress", {"left": 5, "width": 2})):
        sweep = measured[f"scaling_{boundary}"]
        rows = collapse_rows(sweep, boundary)
        parts += [rows, exact_rows(chosen(sweep, **most), boundary, share), summaries(rows)]
        parts.append(inset_rows(sweep, boundary))
    return pd.concat(parts, ignore_index=True)


def inset_rows(sweep: pd.DataFrame, boundary: str) -> pd.DataFrame:
    """Profiles of the lowest, middle and highest level, at the narrowest Gaussian."""
    width = float(sweep["width"].min())
    x = np.linspace(-6.0 * width, 6.0 * width, INSET_POINTS)
    parts = []
    for level in chosen(sweep, left=3)["left"].unique():
        right = level if boundary == "displacement" else float(sweep["right"].iloc[0])
        tau = Prestress(float(level), float(right), width)(x)
        parts.append(pd.DataFrame({"role": "inset", "x": x, "y": tau, "left": level, "width": width}))
    return pd.concat(parts).assign(panel=f"{boundary}_inset")


def plot(table: pd.DataFrame) -> Figure:
    """A column a boundary: the collapse, and below it L_trans and T_trans over their predictions."""
    figure = new_figure(COLUMN, 5.4)
    grid = figure.subplots(3, 2, height_ratios=(1.25, 1.0, 1.0))
    markers = table[table["role"] == "marker"]
    for column, (boundary, title) in enumerate(
        (("displacement", r"$\Gamma = 1$"), ("stress", r"$\Gamma = 0$"))
    ):
        above, below = grid[0, column], grid[1:, column]
        draw_collapse(above, markers[markers["panel"].str.startswith(boundary)], boundary)
        above.set_title(title, fontsize=9)
        above.set_xlabel(r"predicted $L$, $T$")
        draw_inset(above, table[table["panel"] == f"{boundary}_inset"], boundary)
        across, label = OTHERS[boundary]
        for axes, quantity in zip(below, SYMBOLS, strict=True):
            draw_ratio(axes, table, f"{boundary}_{quantity}", across)
            axes.set_xlabel(label)
        level_bar(figure, list(grid[:, column]), boundary, location="bottom", aspect=25, pad=0.01)
        for row in range(3):
            panel_letter(grid[row, column], "abcdef"[2 * row + column])
    grid[0, 0].set_ylabel(r"measured $L$, $T$")
    for axes, symbol in zip(grid[1:, 0], SYMBOLS.values(), strict=True):
        axes.set_ylabel(f"${symbol}$, measured\nover predicted", linespacing=0.9)
    figure.legend(
        handles=handles(table), loc="outside lower center", ncols=3, columnspacing=0.9, handletextpad=0.6
    )
    return figure


def handles(table: pd.DataFrame) -> list[Line2D]:
    """What markers and lines are."""
    entries = [
        ({"marker": "o", "linestyle": "none"}, "length"),
        ({"marker": "^", "linestyle": "none"}, "time"),
        ({"marker": "x", "linestyle": "none"}, "literal definition"),
        ({"color": BLACK, "linewidth": 0.8}, "equality"),
        ({"linewidth": 0.8}, "exact theory"),
    ]
    if table["run_flags"].notna().any():
        entries.append(({"marker": "o", "linestyle": "none", "fillstyle": "none"}, "flagged"))
    return [
        Line2D([], [], **({"color": GREY, "markersize": 3.5} | look), label=label) for look, label in entries
    ]


def draw_inset(axes, rows: pd.DataFrame, boundary: str) -> None:
    """Pre-stress profiles in the lower right corner."""
    scale = colour_scale("tau_0" if boundary == "displacement" else "tau_l")
    inset = axes.inset_axes([0.62, 0.16, 0.36, 0.3])
    for level, group in rows.groupby("left"):
        inset.plot(group["x"], group["y"], color=scale.to_rgba(level), linewidth=0.8)
    inset.xaxis.set_major_locator(MaxNLocator(2, integer=True))
    inset.set_title(r"$\tau(x)$", fontsize=7.0, pad=1.0)
    inset.tick_params(labelsize=7.0, length=1.5, pad=1.0)
