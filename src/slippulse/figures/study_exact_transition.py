"""The sweeps of the scaling figure against the paper's predictions and against the exact theory, side by side."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from ..comparison.exact_transition import exact_transition
from .shared.exact_transitions import draw_one_way, draw_peak, one_way_rows, peak_rows
from .shared.scaling import SYMBOLS
from .style import BLACK, BLUE, GREEN, GREY, ORANGE, PAGE, PURPLE, SKY, YELLOW, new_figure, panel_letter

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {
    "measured": ["scaling_displacement", "scaling_stress", "transition_convergence"],
    "settings": ["measure.share", "model.damping_ratio"],
}

# Black and grey, since colours tell levels and gamma in the other panels.
MARKERS = {"displacement": ("o", BLACK, r"$\Gamma = 1$"), "stress": ("s", GREY, r"$\Gamma = 0$")}
REFINED = (BLUE, ORANGE, GREEN, PURPLE, SKY, YELLOW)
COLUMNS = {"time": "transition_time", "length": "transition_length"}


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Each run's T_trans and L_trans with the paper's prediction and the exact value.

    Parameters
    ----------
    data : not used
    measured : scaling_displacement, scaling_stress, transition_convergence
    settings : measure (share), model (damping_ratio)

    Returns
    -------
    DataFrame of role sweep and role refinement, and of exact transitions alone: roles uniform, peak and one_way, and
    limit where the construction of one ends early
    """
    share = settings["measure"]["share"]
    parts = []
    for name, boundary in (("scaling_displacement", "displacement"), ("scaling_stress", "stress")):
        parts.append(_rows(measured[name], boundary, share).assign(role="sweep"))
    parts.append(_rows(measured["transition_convergence"], "displacement", share).assign(role="refinement"))
    parts += [peak_rows(), one_way_rows(settings["model"]["damping_ratio"])]
    return pd.concat(parts, ignore_index=True)


def _rows(runs: pd.DataFrame, boundary: str, share: float) -> pd.DataFrame:
    rows = []
    for _, run in runs.iterrows():
        found = exact_transition(run, share)
        exact = {"time": found.time, "length": found.length}
        for quantity, column in COLUMNS.items():
            rows.append(
                {
                    "boundary": boundary,
                    "quantity": quantity,
                    "left": run["left"],
                    "width": run["width"],
                    "gamma": run["gamma"],
                    "damping_ratio": run["damping_ratio"],
                    "dx": run["dx"],
                    "measured": run[column],
                    "paper": run[f"paper_{column}"],
                    "exact": exact[quantity],
                    "run_flags": run["run_flags"],
                }
            )
    return pd.DataFrame(rows)


def plot(table: pd.DataFrame) -> Figure:
    """T_trans and L_trans over the paper's prediction and the exact theory, and residuals; theory alone below."""
    figure = new_figure(PAGE, 6.4)
    above, beneath = figure.subfigures(2, 1, height_ratios=(4.5, 2.0))
    grid, below = above.subplots(2, 3), beneath.subplots(1, 4)
    draw_peak(below[0], table)
    draw_one_way(below[1:], table)
    for axes, letter in zip(below, "ghij", strict=True):
        panel_letter(axes, letter)
    sweep = table[table["role"] == "sweep"]
    for row, quantity in enumerate(COLUMNS):
        for column, reference in enumerate(("paper", "exact")):
            axes = grid[row, column]
            axes.axhline(1.0, color=BLACK, linewidth=0.8)
            lines = []
            for boundary, (marker, colour, label) in MARKERS.items():
                rows = sweep[(sweep["boundary"] == boundary) & (sweep["quantity"] == quantity)]
                sound = rows["run_flags"].isna() & rows["measured"].notna()
                ratio = rows["measured"] / rows[reference]
                axes.plot(
                    rows.loc[sound, reference], ratio[sound], marker, color=colour, markersize=2.5, alpha=0.8,
                    markeredgewidth=0.0, label=label, gid=boundary,
                )  # fmt: skip
                if (~sound).any():
                    axes.plot(
                        rows.loc[~sound, reference], ratio[~sound], marker, color=colour, markersize=2.5,
                        markerfacecolor="none", gid=f"flagged {boundary}",
                    )  # fmt: skip
                deviation = np.abs(ratio[sound] - 1.0)
                lines.append(f"{label}: median {deviation.median():.2g}, largest {deviation.max():.2g}")
            axes.set_xscale("log")
            axes.set_xlabel(f"{'paper' if reference == 'paper' else 'exact'} ${SYMBOLS[quantity]}$")
            axes.set_ylabel(f"measured / {reference}")
            axes.text(
                0.03,
                0.97,
                "deviation\n" + "\n".join(lines),
                transform=axes.transAxes,
                va="top",
                fontsize=7.0,
                linespacing=1.0,
            )
        low, high = grid[row, 0].get_ylim()
        for axes in grid[row, :2]:
            axes.set_ylim(min(low, 0.6), high + 0.4 * (high - low))
        _draw_refinement(grid[row, 2], table[table["quantity"] == quantity], quantity)
        for axes, letter in zip(grid[row], "abcdef"[3 * row : 3 * row + 3], strict=True):
            panel_letter(axes, letter)
    grid[0, 0].legend(loc="lower right", ncols=2, handletextpad=0.1)
    grid[0, 0].set_title("against the paper")
    grid[0, 1].set_title("against the exact theory")
    grid[0, 2].set_title("residual")
    return figure


def _draw_refinement(axes, rows: pd.DataFrame, quantity: str) -> None:
    """Distance from the exact theory over dx/W; the levels share a colour, lines join what differs in dx alone."""
    refinement = rows[rows["role"] == "refinement"]
    keys = refinement.groupby(["left", "gamma"])
    for colour, ((left, gamma), group) in zip(REFINED, keys, strict=False):
        for (ratio, line), style in zip(group.groupby("damping_ratio"), ("-", "--"), strict=False):
            line = line.sort_values("dx")
            error = np.abs(line["measured"] / line["exact"] - 1.0)
            axes.plot(
                line["dx"] / line["width"], error, style, marker="o", markersize=2.0, linewidth=0.8, color=colour,
                label=rf"{left:g}, {gamma:g}" if style == "-" else None, gid=f"{left:g} {gamma:g} {ratio:g}",
            )  # fmt: skip
    marker, colour, label = MARKERS["stress"]
    stress = rows[(rows["role"] == "sweep") & (rows["boundary"] == "stress") & rows["run_flags"].isna()]
    error = np.abs(stress["measured"] / stress["exact"] - 1.0)
    axes.plot(
        stress["dx"] / stress["width"], error, marker, color=colour, markersize=2.0, alpha=0.5,
        markeredgewidth=0.0, label=label, gid="stress",
    )  # fmt: skip
    ends = np.array([2e-3, 0.1])
    axes.plot(ends, 0.3 * ends, color=BLACK, linewidth=0.8, linestyle=":")
    axes.set(xscale="log", yscale="log", xlabel=r"spacing $\Delta x/W$")
    axes.set_ylabel(f"|measured/exact $-$ 1|, ${SYMBOLS[quantity]}$")
    axes.set_ylim(3e-7, 0.3)
    if quantity == "time":
        axes.legend(title=r"$\Gamma = 1$: $\tau_0,\ \gamma$", fontsize=7.0, ncols=2, loc="lower right")
