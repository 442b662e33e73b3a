"""The transition against the paper's predictions and against the exact theory, and what the predictions leave out."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .shared.scaling import SYMBOLS
from .style import (
    BLACK,
    BLUE,
    GREY,
    ORANGE,
    PAGE,
    Look,
    colour_scale,
    few_ticks,
    legend_above,
    new_panels,
)

NEEDS = {
    "measured": ["scaling_displacement", "scaling_stress", "transition_convergence"],
    "predicted": {
        "scaling_displacement": ["transition"], "scaling_stress": ["transition"],
        "transition_convergence": ["transition"],
    },
    "studies": ["gaussian_transition"],
}  # fmt: skip

KINDS = {"displacement": ("o", BLUE, r"$\Gamma = 1$"), "stress": ("s", ORANGE, r"$\Gamma = 0$")}
REFERENCES: dict[str, tuple[str, Look]] = {
    "paper": ("paper's value", {"markersize": 2.5, "markerfacecolor": "white"}),
    "exact": ("exact one", {"markersize": 1.7, "zorder": 3.0}),
}
QUANTITIES = {"time": ("v", BLACK), "length": ("P", GREY)}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """T_trans and L_trans of runs, predicted and exact (roles sweep, refinement), and the study (role gaussian)."""
    sources = ("transition", "paper_transition", "exact_transition")
    kept = ["boundary", "left", "width", "gamma", "damping_ratio", "dx", "run_flags"]
    kept += [f"{source}_{quantity}" for source in sources for quantity in QUANTITIES]
    roles = dict(zip(NEEDS["measured"], ("sweep", "sweep", "refinement"), strict=True))
    runs = [tables[name][kept].assign(role=role) for name, role in roles.items()]
    return pd.concat(
        [*runs, tables["gaussian_transition"].assign(role="gaussian")], ignore_index=True
    )


def plot(table: pd.DataFrame) -> Figure:
    """(a, b) measured over the paper's and over the exact T_trans and L_trans; (c) refined; (d) exact T_trans alone."""
    figure, (*scatter, refined_axes, last) = new_panels(PAGE, 5.0, 2, 2)
    for axes, quantity in zip(scatter, QUANTITIES, strict=True):
        _draw_ratios(axes, table[table["role"] == "sweep"], quantity)
    _draw_refinement(refined_axes, table[table["role"] == "refinement"])
    legend_above(figure, scatter[0])
    # T_trans over the paper's pi/sqrt(gamma): uniform pre-stress, and with the Gaussian.
    rows = table[table["role"] == "gaussian"]
    line = rows[rows["gamma"].isna()]
    last.axhline(1.0, color=BLACK, linewidth=0.6)
    last.plot(line["left"], line["over_paper"], "--", color=BLACK, label="uniform")
    for gamma, line in rows.groupby("gamma"):
        look: Look = {
            "color": colour_scale("gamma").to_rgba(gamma),
            "label": rf"$\gamma = {gamma:g}$",
        }
        last.plot(line["left"], line["over_paper"], **look)
    last.set(xlabel=r"pre-stress $\tau_0$", ylim=(0.85, 1.4))
    last.set_ylabel(r"exact $T_\text{trans}\,\gamma^{1/2}/\pi$")
    last.set_title(r"$\Gamma = 1$, $b = 0$, exact", loc="right")
    last.legend(loc="upper right", ncols=2)
    return figure


def _draw_ratios(axes: Axes, sweep: pd.DataFrame, quantity: str) -> None:
    """Against the exact value: measured over exact filled, over the paper's prediction open."""
    axes.axhline(1.0, color=BLACK, linewidth=0.6)
    for reference, (name, own) in REFERENCES.items():
        for boundary, (marker, colour, label) in KINDS.items():
            runs = sweep[(sweep["boundary"] == boundary) & sweep["run_flags"].isna()]
            exact, measured = runs[f"exact_transition_{quantity}"], runs[f"transition_{quantity}"]
            ratio = measured / runs[f"{reference}_transition_{quantity}"]
            look: Look = {"color": colour, "label": f"{label}, over the {name}"} | own
            axes.plot(exact, ratio, marker, markeredgewidth=0.5, **look)
    symbol = SYMBOLS[quantity]
    axes.set(xscale="log", xlabel=f"exact ${symbol}$", ylabel=f"measured / predicted ${symbol}$")


def _draw_refinement(axes: Axes, runs: pd.DataFrame) -> None:
    """Relative distance from the exact theory over dx/W: every scene, and the largest."""
    spacing = runs["dx"] / runs["width"]
    for quantity, (marker, colour) in QUANTITIES.items():
        error = np.abs(runs[f"transition_{quantity}"] / runs[f"exact_transition_{quantity}"] - 1.0)
        look: Look = {
            "color": colour,
            "markersize": 2.5,
            "markerfacecolor": "none",
            "markeredgewidth": 0.5,
        }
        axes.plot(spacing, error, marker, **look)
        largest, label = error.groupby(spacing).max(), f"${SYMBOLS[quantity]}$, largest"
        axes.plot(largest, marker=marker, color=colour, label=label)
    ends = spacing.agg(["min", "max"]).to_numpy()
    axes.plot(ends, 0.4 * ends, color=BLACK, linewidth=0.8, linestyle=":", label="first order")
    axes.set(
        xscale="log",
        yscale="log",
        xlabel=r"spacing $\Delta x/W$",
        ylabel=r"|measured / exact $-$ 1|",
    )
    few_ticks(axes.xaxis, np.unique(spacing))
    axes.set_title(r"$\Gamma = 1$, refining", loc="right")
    axes.legend(loc="lower right")
