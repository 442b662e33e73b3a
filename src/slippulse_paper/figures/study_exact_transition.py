"""Compare measured transitions with the paper's formulas and with exact theory."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from slippulse.plotting import style
from slippulse.plotting.style import BLACK, BLUE, GREY, OPEN_MARKER, ORANGE, PAGE_WIDTH

from .shared import scaling

NEEDS = {
    "measured": {
        "scaling_displacement": ["transition"],
        "scaling_stress": ["transition"],
        "transition_convergence": ["transition"],
    },
    "studies": ["gaussian_transition"],
}
# Which runs of each simulation the figure can draw, in the words of configuration/drawn.py.
DRAWS = {
    "scaling_displacement": "boundary displacement and equal levels above 0",
    "scaling_stress": "boundary stress, left level below 0, right level 0 and no steps",
}

BOUNDARY_LOOKS = {"displacement": (BLUE, r"$\Gamma = 1$"), "stress": (ORANGE, r"$\Gamma = 0$")}
REFERENCE_LOOKS = {"exact": ("from exact theory", "-"), "paper": ("from the paper's formula", "--")}
QUANTITY_LOOKS = {"time": ("v", BLACK), "length": ("P", GREY)}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return T_trans and L_trans of runs (role sweep or refinement) and the study (gaussian)."""
    kept = ["boundary", "left", "width", "gamma", "damping_ratio", "dx", "run_flags"]
    for source in ("transition", "paper_transition", "exact_transition"):
        kept += [f"{source}_{quantity}" for quantity in QUANTITY_LOOKS]
    roles = zip(NEEDS["measured"], ("sweep", "sweep", "refinement"), strict=True)
    parts = [tables[name][kept].assign(role=role) for name, role in roles]
    parts.append(tables["gaussian_transition"].assign(role="gaussian"))
    return pd.concat(parts, ignore_index=True)


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a, b) error distributions, (c) refined lattices, (d) the exact transition time."""
    figure, (*distributions, refined, gaussian) = style.new_panels(PAGE_WIDTH, 5.0, "ab;cd")
    roles = style.by_role(table)
    sweep, runs = roles["sweep"], roles["refinement"]
    for axes, quantity in zip(distributions, QUANTITY_LOOKS, strict=True):
        for boundary, (colour, boundary_name) in BOUNDARY_LOOKS.items():
            sound = sweep[(sweep["boundary"] == boundary) & sweep["run_flags"].isna()]
            for reference, (name, line) in REFERENCE_LOOKS.items():
                predicted = sound[f"{reference}_transition_{quantity}"]
                error = (sound[f"transition_{quantity}"] / predicted - 1.0).dropna().abs()
                axes.ecdf(error, color=colour, linestyle=line, label=f"{boundary_name}, {name}")
        symbol = scaling.QUANTITIES[quantity]
        axes.set(xscale="log", xlabel=f"|measured / predicted ${symbol}$ $-$ 1|")
        axes.set(ylim=(0.0, 1.0), ylabel="fraction of runs with a smaller error")
    spacing = runs["dx"] / runs["width"]
    for quantity, (marker, colour) in QUANTITY_LOOKS.items():
        error = np.abs(runs[f"transition_{quantity}"] / runs[f"exact_transition_{quantity}"] - 1.0)
        refined.plot(spacing, error, marker, color=colour, markersize=2.5, **OPEN_MARKER)
        largest, label = error.groupby(spacing).max(), f"${scaling.QUANTITIES[quantity]}$, largest"
        refined.plot(largest, marker=marker, color=colour, label=label)
    style.draw_first_order(refined, spacing, 0.4, BLACK)
    refined.set(xlabel=r"spacing $\Delta x/W$", ylabel=r"|measured / exact $-$ 1|")
    refined.set_title(r"$\Gamma = 1$, refining")
    style.few_ticks(refined.xaxis, np.unique(spacing))
    refined.legend(loc="lower right")
    style.legend_above(figure, distributions[0])
    study = roles["gaussian"]
    uniform = study[study["gamma"].isna()]
    gaussian.axhline(1.0, color=BLACK, linewidth=0.6)
    gaussian.plot(uniform["left"], uniform["over_paper"], "--", color=BLACK, label="uniform")
    for gamma, rows in study.groupby("gamma"):
        shade, label = style.colour("gamma", gamma), rf"$\gamma = {gamma:g}$"
        gaussian.plot(rows["left"], rows["over_paper"], color=shade, label=label)
    gaussian.set(xlabel=r"pre-stress $\tau_0$", ylim=(0.85, 1.4))
    title = r"$\Gamma = 1$, $b = 0$, exact"
    gaussian.set(ylabel=r"exact $T_\text{trans}\,\gamma^{1/2}/\pi$", title=title)
    gaussian.legend(loc="upper right", ncols=2)
    return figure
