"""The transition against the paper's predictions and against the exact theory, and what the predictions leave out."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from .shared.scaling import SYMBOLS
from .style import BLACK, BLUE, GREY, ORANGE, PAGE, colour_scale, new_figure, panel_letter

# What is drawn: data, measured numbers, predictions and studies by name, and keys of the configuration.
NEEDS = {
    "measured": ["scaling_displacement", "scaling_stress", "transition_convergence"],
    "predicted": ["scaling_displacement", "scaling_stress", "transition_convergence"],
    "studies": ["gaussian_transition"],
}

KINDS = {"displacement": ("o", BLUE, r"$\Gamma = 1$"), "stress": ("s", ORANGE, r"$\Gamma = 0$")}
QUANTITIES = {"time": ("v", BLACK), "length": ("P", GREY)}


def table(
    data: Mapping[str, xr.Dataset], tables: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Each run's T_trans and L_trans with the paper's prediction and the exact value.

    Parameters
    ----------
    data, settings : not used
    tables : the simulations and the study in NEEDS

    Returns
    -------
    DataFrame of role sweep and refinement (transition_*, paper_transition_*, exact_transition_*) and gaussian (the
    study gaussian_transition)
    """
    sources = ("transition", "paper_transition", "exact_transition")
    kept = ["boundary", "left", "width", "gamma", "damping_ratio", "dx", "run_flags"]
    kept += [f"{source}_{quantity}" for source in sources for quantity in QUANTITIES]
    return pd.concat(
        [
            tables["scaling_displacement"][kept].assign(role="sweep"),
            tables["scaling_stress"][kept].assign(role="sweep"),
            tables["transition_convergence"][kept].assign(role="refinement"),
            tables["gaussian_transition"].assign(role="gaussian"),
        ],
        ignore_index=True,
    )


def plot(table: pd.DataFrame) -> Figure:
    """(a, b) measured over the paper's and over the exact T_trans and L_trans; (c) refined; (d) exact T_trans alone."""
    figure = new_figure(PAGE, 5.0)
    *scatter, refined_axes, gaussian_axes = figure.subplots(2, 2).ravel()
    for axes, quantity in zip(scatter, QUANTITIES, strict=True):
        _draw_ratios(axes, table[table["role"] == "sweep"], quantity)
    _draw_refinement(refined_axes, table[table["role"] == "refinement"])
    _draw_gaussian(gaussian_axes, table[table["role"] == "gaussian"])
    for axes, letter in zip((*scatter, refined_axes, gaussian_axes), "abcd", strict=True):
        panel_letter(axes, letter)
    handles, labels = scatter[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=len(labels))
    return figure


def _draw_ratios(axes, sweep: pd.DataFrame, quantity: str) -> None:
    """Against the exact value: measured over exact filled, over the paper's prediction open."""
    axes.axhline(1.0, color=BLACK, linewidth=0.6)
    for reference in ("paper", "exact"):
        for boundary, (marker, colour, label) in KINDS.items():
            runs = sweep[(sweep["boundary"] == boundary) & sweep["run_flags"].isna()]
            exact, measured = runs[f"exact_transition_{quantity}"], runs[f"transition_{quantity}"]
            ratio = measured / runs[f"{reference}_transition_{quantity}"]
            face = "white" if reference == "paper" else colour
            look = {"markersize": 2.5, "markerfacecolor": face, "markeredgewidth": 0.5}
            name = "the paper's value" if reference == "paper" else "the exact one"
            axes.plot(
                exact,
                ratio,
                marker,
                color=colour,
                **look,
                label=f"{label}, over {name}",
                gid=f"{reference} {boundary}",
            )
    symbol = SYMBOLS[quantity]
    axes.set(xscale="log", xlabel=f"exact ${symbol}$", ylabel=f"measured / predicted ${symbol}$")


def _draw_refinement(axes, runs: pd.DataFrame) -> None:
    """Relative distance from the exact theory over dx/W: every scene, and the largest."""
    spacing = runs["dx"] / runs["width"]
    for quantity, (marker, colour) in QUANTITIES.items():
        error = np.abs(runs[f"transition_{quantity}"] / runs[f"exact_transition_{quantity}"] - 1.0)
        axes.plot(
            spacing, error, marker, color=colour, markersize=2.5, markerfacecolor="none", markeredgewidth=0.5
        )
        largest = error.groupby(spacing).max()
        label = f"${SYMBOLS[quantity]}$, largest"
        axes.plot(largest.index, largest, marker=marker, color=colour, label=label, gid=f"refined {quantity}")
    ends = spacing.agg(["min", "max"]).to_numpy()
    axes.plot(ends, 0.4 * ends, color=BLACK, linewidth=0.8, linestyle=":", label="first order")
    axes.set(xscale="log", yscale="log", xlabel=r"spacing $\Delta x/W$", ylabel=r"|measured / exact $-$ 1|")
    axes.set_xticks(np.unique(spacing), [f"{each:g}" for each in np.unique(spacing)])
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_title(r"$\Gamma = 1$, refining", loc="right")
    axes.legend(loc="lower right")


def _draw_gaussian(axes, rows: pd.DataFrame) -> None:
    """T_trans over the paper's pi/sqrt(gamma): uniform pre-stress, and with the Gaussian."""
    axes.axhline(1.0, color=BLACK, linewidth=0.6)
    line = rows[rows["gamma"].isna()]
    axes.plot(line["left"], line["over_paper"], "--", color=BLACK, label="uniform", gid="uniform")
    for gamma, line in rows.groupby("gamma"):
        colour = colour_scale("gamma").to_rgba(gamma)
        axes.plot(
            line["left"],
            line["over_paper"],
            color=colour,
            label=rf"$\gamma = {gamma:g}$",
            gid=f"peak {gamma:g}",
        )
    axes.set(
        xlabel=r"pre-stress $\tau_0$", ylabel=r"exact $T_\mathrm{trans}\,\gamma^{1/2}/\pi$", ylim=(0.85, 1.4)
    )
    axes.set_title(r"$\Gamma = 1$, $b = 0$, exact", loc="right")
    axes.legend(loc="upper right", ncols=2)
