"""Compare measured transitions with the paper's formulas and with exact theory."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slippulse.plotting import style
from slippulse.plotting.style import BLACK, BLUE, GREY, OPEN_MARKER, ORANGE, PAGE_WIDTH, Look

from .shared import scaling

NEEDS = {
    "measured": {
        "scaling_displacement": ["transition"],
        "scaling_stress": ["transition"],
        "transition_convergence": ["transition"],
    },
    "studies": ["gaussian_transition"],
}
# Runs of each simulation that the figure can draw, in the words of configuration/drawn.py.
DRAWS = {
    "scaling_displacement": "`boundary: displacement` and equal levels > 0",
    "scaling_stress": "`boundary: stress`, left level < 0, right level 0, no steps",
}

BOUNDARY_LOOKS = {"displacement": (BLUE, r"$\Gamma = 1$"), "stress": (ORANGE, r"$\Gamma = 0$")}
REFERENCE_LOOKS = {"exact": ("from exact theory", "-"), "paper": ("from the paper's formula", "--")}
QUANTITY_LOOKS = {"time": ("v", BLACK), "length": ("P", GREY)}


def table(data: dict, tables: dict[str, pd.DataFrame], settings: dict) -> pd.DataFrame:
    """Return the rows of three parts of the figure, which the column role names.

    sweep : the runs of figure 5
    refinement : runs on refined lattices
    gaussian : the rows of the study gaussian_transition

    A run has T_trans and L_trans as measured (columns transition_time and transition_length), by
    the paper's formulas (prefix paper_), and exact (prefix exact_).
    """
    columns = ["boundary", "left", "width", "gamma", "damping_ratio", "dx", "run_flags"]
    for source in ("transition", "paper_transition", "exact_transition"):
        columns += [f"{source}_{quantity}" for quantity in QUANTITY_LOOKS]
    roles = {
        "scaling_displacement": "sweep",
        "scaling_stress": "sweep",
        "transition_convergence": "refinement",
    }
    parts = [tables[name][columns].assign(role=role) for name, role in roles.items()]
    parts.append(tables["gaussian_transition"].assign(role="gaussian"))
    return pd.concat(parts, ignore_index=True)


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a, b) error distributions, (c) refined lattices, (d) the exact transition time."""
    figure, panels = style.new_panels(PAGE_WIDTH, 5.0, "ab;cd")
    time_axes, length_axes, refined_axes, gaussian_axes = panels
    rows_by_role = style.by_role(table)
    draw_distributions(time_axes, rows_by_role["sweep"], "time")
    draw_distributions(length_axes, rows_by_role["sweep"], "length")
    draw_refinement(refined_axes, rows_by_role["refinement"])
    style.legend_above(figure, time_axes)
    draw_exact_times(gaussian_axes, rows_by_role["gaussian"])
    return figure


def draw_distributions(axes: Axes, runs: pd.DataFrame, quantity: str) -> None:
    """Draw the distribution of errors: the fraction of runs whose error is smaller than a value.

    There is one line for exact theory and one for the paper's formula, for each boundary. Flagged
    runs are left out.

    quantity : "time" or "length"
    """
    for boundary, (colour, boundary_name) in BOUNDARY_LOOKS.items():
        sound = runs[(runs["boundary"] == boundary) & runs["run_flags"].isna()]
        for reference, (name, line) in REFERENCE_LOOKS.items():
            predicted = sound[f"{reference}_transition_{quantity}"]
            ratio = sound[f"transition_{quantity}"] / predicted
            error = (ratio - 1.0).dropna().abs()
            look: Look = {"color": colour, "label": f"{boundary_name}, {name}"}
            if error.empty:
                # There is no run to draw, so only the legend gets an entry.
                axes.plot([], [], line, **look)
            else:
                axes.ecdf(error, linestyle=line, **look)
    symbol = scaling.QUANTITIES[quantity]
    axes.set(xscale="log", xlabel=f"|measured / predicted ${symbol}$ $-$ 1|")
    axes.set(ylim=(0.0, 1.0), ylabel="fraction of runs with a smaller error")


def draw_refinement(axes: Axes, runs: pd.DataFrame) -> None:
    """Draw the errors of all runs as functions of the spacing.

    A line connects the largest errors of all spacings.
    """
    spacing = runs["dx"] / runs["width"]
    for quantity, (marker, colour) in QUANTITY_LOOKS.items():
        ratio = runs[f"transition_{quantity}"] / runs[f"exact_transition_{quantity}"]
        error = np.abs(ratio - 1.0)
        axes.plot(spacing, error, marker, color=colour, markersize=2.5, **OPEN_MARKER)
        # The index of this series has the spacings.
        largest_error = error.groupby(spacing).max()
        label = f"${scaling.QUANTITIES[quantity]}$, largest"
        axes.plot(largest_error, marker=marker, color=colour, label=label)
    # A dotted guide: the error 0.4 dx/W, which falls with first order.
    style.draw_first_order(axes, spacing, slope=0.4, colour=BLACK)
    axes.set(xlabel=r"spacing $\Delta x/W$", ylabel=r"|measured / exact $-$ 1|")
    axes.set_title(r"$\Gamma = 1$, refining")
    style.few_ticks(axes.xaxis, np.unique(spacing))
    axes.legend(loc="lower right")


def draw_exact_times(axes: Axes, study: pd.DataFrame) -> None:
    """Draw the exact transition time divided by the paper's estimate pi/sqrt(gamma).

    The dashed line holds for a rupture that starts at a point of uniform pre-stress. The other
    lines, one for each gamma, hold for nucleation by the Gaussian.
    """
    # This ratio is the same for every gamma, so its rows have no gamma.
    uniform = study[study["gamma"].isna()]
    axes.axhline(1.0, color=BLACK, linewidth=0.6)
    axes.plot(uniform["left"], uniform["over_paper"], "--", color=BLACK, label="uniform")
    for gamma, rows in study.groupby("gamma"):
        colour, label = style.colour("gamma", gamma), rf"$\gamma = {gamma:g}$"
        axes.plot(rows["left"], rows["over_paper"], color=colour, label=label)
    axes.set(xlabel=r"pre-stress $\tau_0$", ylim=(0.85, 1.4))
    title = r"$\Gamma = 1$, $b = 0$, exact"
    axes.set(ylabel=r"exact $T_\text{trans}\,\gamma^{1/2}/\pi$", title=title)
    axes.legend(loc="upper right", ncols=2)
