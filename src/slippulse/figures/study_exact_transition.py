"""The transition against the paper's formulas and exact theory, and what the formulas leave out."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from . import style
from .shared import scaling
from .style import BLACK, BLUE, GREY, ORANGE, PAGE, Look

NEEDS = {
    "measured": ["scaling_displacement", "scaling_stress", "transition_convergence"],
    "predicted": {
        "scaling_displacement": ["transition"],
        "scaling_stress": ["transition"],
        "transition_convergence": ["transition"],
    },
    "studies": ["gaussian_transition"],
}

KINDS = {"displacement": (BLUE, r"$\Gamma = 1$"), "stress": (ORANGE, r"$\Gamma = 0$")}
REFERENCES = {"exact": ("from exact theory", "-"), "paper": ("from the paper's formula", "--")}
QUANTITIES = {"time": ("v", BLACK), "length": ("P", GREY)}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """T_trans and L_trans of runs (role sweep or refinement); and the study (role gaussian)."""
    kept = ["boundary", "left", "width", "gamma", "damping_ratio", "dx", "run_flags"]
    for source in ("transition", "paper_transition", "exact_transition"):
        kept += [f"{source}_{quantity}" for quantity in QUANTITIES]
    roles = dict(zip(NEEDS["measured"], ("sweep", "sweep", "refinement"), strict=True))
    parts = [tables[name][kept].assign(role=role) for name, role in roles.items()]
    parts.append(tables["gaussian_transition"].assign(role="gaussian"))
    return pd.concat(parts, ignore_index=True)


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a, b) distributions of errors, (c) refined lattices, (d) exact T_trans alone."""
    figure, (*distributions, refined_axes, last) = style.new_panels(PAGE, 5.0, "ab;cd")
    for axes, quantity in zip(distributions, QUANTITIES, strict=True):
        _draw_distributions(axes, table[table["role"] == "sweep"], quantity)
    _draw_refinement(refined_axes, table[table["role"] == "refinement"])
    style.legend_above(figure, distributions[0])
    _draw_uniform(last, table[table["role"] == "gaussian"])
    return figure


def _draw_uniform(axes: Axes, rows: pd.DataFrame) -> None:
    """Draw exact T_trans over pi/sqrt(gamma), for a uniform pre-stress and with the Gaussian."""
    uniform = rows[rows["gamma"].isna()]
    axes.axhline(1.0, color=BLACK, linewidth=0.6)
    axes.plot(uniform["left"], uniform["over_paper"], "--", color=BLACK, label="uniform")
    for gamma, line in rows.groupby("gamma"):
        look: Look = {"color": style.colour("gamma", gamma)}
        axes.plot(line["left"], line["over_paper"], label=rf"$\gamma = {gamma:g}$", **look)
    axes.set(xlabel=r"pre-stress $\tau_0$", ylim=(0.85, 1.4))
    axes.set_ylabel(r"exact $T_\text{trans}\,\gamma^{1/2}/\pi$")
    axes.set_title(r"$\Gamma = 1$, $b = 0$, exact", loc="right")
    axes.legend(loc="upper right", ncols=2)


def _draw_distributions(axes: Axes, sweep: pd.DataFrame, quantity: str) -> None:
    """Draw the fraction of the runs that are nearer to each prediction than a distance."""
    for boundary, (colour, boundary_name) in KINDS.items():
        runs = sweep[(sweep["boundary"] == boundary) & sweep["run_flags"].isna()]
        for reference, (name, line) in REFERENCES.items():
            predicted = runs[f"{reference}_transition_{quantity}"]
            ratio = (runs[f"transition_{quantity}"] / predicted).dropna()
            look: Look = {"color": colour, "linestyle": line, "gid": f"{boundary} {reference}"}
            axes.ecdf(np.abs(ratio - 1.0), label=f"{boundary_name}, {name}", **look)
    symbol = scaling.QUANTITIES[quantity]
    axes.set(xscale="log", xlabel=f"|measured / predicted ${symbol}$ $-$ 1|", ylim=(0.0, 1.0))
    axes.set_ylabel("fraction of runs that are nearer")


def _draw_refinement(axes: Axes, runs: pd.DataFrame) -> None:
    """Draw the relative distance from exact theory over dx/W, of every scene, and the largest."""
    spacing = runs["dx"] / runs["width"]
    for quantity, (marker, colour) in QUANTITIES.items():
        error = np.abs(runs[f"transition_{quantity}"] / runs[f"exact_transition_{quantity}"] - 1.0)
        look: Look = {"markersize": 2.5, "markerfacecolor": "none", "markeredgewidth": 0.5}
        axes.plot(spacing, error, marker, color=colour, **look)
        largest, label = error.groupby(spacing).max(), f"${scaling.QUANTITIES[quantity]}$, largest"
        axes.plot(largest, marker=marker, color=colour, label=label)
    ends = spacing.agg(["min", "max"]).to_numpy()
    axes.plot(ends, 0.4 * ends, color=BLACK, linewidth=0.8, linestyle=":", label="first order")
    axes.set(xscale="log", yscale="log", xlabel=r"spacing $\Delta x/W$")
    axes.set_ylabel(r"|measured / exact $-$ 1|")
    style.few_ticks(axes.xaxis, np.unique(spacing))
    axes.set_title(r"$\Gamma = 1$, refining", loc="right")
    axes.legend(loc="lower right")
