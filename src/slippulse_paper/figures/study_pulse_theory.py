"""The steady pulse as a function of damping: formulas of the paper, exact theory, simulations."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from slippulse.plotting import style
from slippulse.plotting.style import (
    COLOUR_CYCLE,
    GREY,
    MARKERS,
    OPEN_MARKER,
    PAGE_WIDTH,
    Look,
    conditions,
)

NEEDS = {
    "measured": {"pulse_damping": ["pulse"], "continuum_fixed_ratio": []},
    "studies": ["damped_pulse"],
}

QUANTITY_LABELS = {"peak_velocity": "largest velocity", "width": "width", "slip": "final slip"}
# The measured columns on refined lattices.
REFINED_COLUMNS = {name: f"pulse_{name}" for name in QUANTITY_LABELS} | {
    "front_speed": "front_speed_right"
}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return quantities by role: simulation, theory, refined (by dx, with the limit as theory)."""
    runs, study = tables["pulse_damping"], tables["damped_pulse"]
    lines = study[study["role"] == "curve"].rename(columns={"value": "over_paper"})
    parts = [lines.assign(role="theory")]
    for quantity in QUANTITY_LABELS:
        sources = {"value": "", "theory": "exact_", "paper": "paper_"}
        values = {name: runs[f"{source}pulse_{quantity}"] for name, source in sources.items()}
        values |= {"role": "simulation", "quantity": quantity}
        parts.append(runs[["left", "gamma", "damping_ratio", "run_flags"]].assign(**values))
    runs = tables["continuum_fixed_ratio"]
    limits = study[study["role"] == "limit"].set_index("quantity")["value"]
    for quantity, column in REFINED_COLUMNS.items():
        values = {"value": runs[column], "theory": limits[quantity], "quantity": quantity}
        rows = runs[["left", "gamma", "damping_ratio", "dx"]]
        parts.append(rows.assign(**values, role="refined"))
    return pd.concat(parts, ignore_index=True)


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a to c) each quantity divided by the paper's formula, (d) refined lattices."""
    figure, (*grid, refined) = style.new_panels(PAGE_WIDTH, 4.6, "ab;cd")
    roles = style.by_role(table)
    gamma = roles["simulation"]["gamma"].iloc[0]
    for axes, (quantity, label) in zip(grid, QUANTITY_LABELS.items(), strict=True):
        axes.axhline(1.0, color=GREY, linewidth=0.8, linestyle="--", label="paper's formula")
        for left, group in table[table["quantity"] == quantity].groupby("left"):
            colour = style.colour("tau_0", left)
            line, runs = group[group["role"] == "theory"], group[group["role"] == "simulation"]
            name = rf"exact, $\tau_0 = {left:g}$" if len(line) else None
            axes.plot(line["damping_ratio"], line["over_paper"], color=colour, label=name)
            for flagged, marks in runs.groupby(runs["run_flags"].notna()):
                look: Look = {"color": colour} | (OPEN_MARKER if flagged else {})
                axes.plot(marks["damping_ratio"], marks["value"] / marks["paper"], "o", **look)
        axes.set(xlabel=r"damping ratio $b$", ylabel=f"{label} / paper's formula")
        axes.set(xlim=(-0.02, None), title=conditions(True, gamma=gamma))
    grid[0].plot([], [], "o", color=GREY, label="simulation")
    style.legend_above(figure, grid[0])
    rows = roles["refined"]
    for quantity, shade, marker in zip(REFINED_COLUMNS, COLOUR_CYCLE, MARKERS, strict=False):
        line = rows[rows["quantity"] == quantity].sort_values("dx")
        error = np.abs(line["value"] / line["theory"] - 1.0)
        label = QUANTITY_LABELS.get(quantity, "front speed")
        refined.plot(line["dx"], error, marker=marker, color=shade, label=label)
    style.draw_first_order(refined, rows["dx"], 0.4, GREY)
    left, gamma, ratio = rows[["left", "gamma", "damping_ratio"]].iloc[0]
    scene = conditions(True, gamma=gamma, tau_0=left, damping_ratio=ratio)
    refined.set(ylabel=r"|simulation / limit $-$ 1|", ylim=(1e-6, None), title=scene)
    refined.legend(loc="lower right")
    return figure
