"""The steady pulse against damping: the paper's formulas, the damped theory, simulations, and their limit dx -> 0."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from .style import CYCLE, GREY, PAGE, Look, colour_scale, legend_above, new_panels

NEEDS = {
    "measured": ["pulse_damping", "continuum_fixed_ratio"],
    "predicted": {"pulse_damping": ["pulse"]},
    "studies": ["damped_pulse"],
}

QUANTITIES = {"peak_velocity": "largest velocity", "width": "width", "slip": "final slip"}
# Measured columns on refined lattices.
REFINED = {name: f"pulse_{name}" for name in QUANTITIES} | {"front_speed": "front_speed_right"}
MARKERS = ("o", "s", "^", "D")


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Of each quantity role simulation (value, theory and paper), theory (over_paper) and refined (value over dx, and
    theory: the limit).
    """
    runs, study = tables["pulse_damping"], tables["damped_pulse"]
    lines = study[study["role"] == "curve"].rename(columns={"value": "over_paper"})
    parts = [lines.assign(role="theory")]
    for quantity in QUANTITIES:
        sources = {"value": "", "theory": "exact_", "paper": "paper_"}
        values = {name: runs[f"{source}pulse_{quantity}"] for name, source in sources.items()}
        values |= {"role": "simulation", "quantity": quantity}
        parts.append(runs[["left", "gamma", "damping_ratio", "run_flags"]].assign(**values))
    runs = tables["continuum_fixed_ratio"]
    limits = study[study["role"] == "limit"].set_index("quantity")["value"]
    for quantity, column in REFINED.items():
        values = {
            "value": runs[column],
            "theory": limits[quantity],
            "quantity": quantity,
            "role": "refined",
        }
        parts.append(runs[["left", "gamma", "damping_ratio", "dx"]].assign(**values))
    return pd.concat(parts, ignore_index=True)


def plot(table: pd.DataFrame) -> Figure:
    """(a to c) each quantity in units of the paper's formula; (d) the distance from the limit on refined lattices."""
    figure, (*grid, fine) = new_panels(PAGE, 4.6, 2, 2)
    for axes, (quantity, label) in zip(grid, QUANTITIES.items(), strict=True):
        axes.axhline(1.0, color=GREY, linewidth=0.8, linestyle="--", label="paper's formula")
        for left, rows in table[table["quantity"] == quantity].groupby("left"):
            colour = colour_scale("tau_0").to_rgba(left)
            line, runs = rows[rows["role"] == "theory"], rows[rows["role"] == "simulation"]
            name = rf"exact, $\tau_0 = {left:g}$" if len(line) else None
            axes.plot(line["damping_ratio"], line["over_paper"], color=colour, label=name)
            for flagged, group in runs.groupby(runs["run_flags"].notna()):
                look: Look = {"color": colour} | ({"markerfacecolor": "white"} if flagged else {})
                axes.plot(group["damping_ratio"], group["value"] / group["paper"], "o", **look)
        gamma = table.loc[table["role"] == "simulation", "gamma"].iloc[0]
        axes.set_title(rf"$\Gamma = 1$, $\gamma = {gamma:g}$", loc="right")
        axes.set(
            xlabel=r"damping ratio $b$", ylabel=f"{label} / paper's formula", xlim=(-0.02, None)
        )
    grid[0].plot([], [], "o", color=GREY, label="simulation")
    legend_above(figure, grid[0], columnspacing=1.0)
    rows = table[table["role"] == "refined"]
    for quantity, shade, marker in zip(REFINED, CYCLE, MARKERS, strict=False):
        line = rows[rows["quantity"] == quantity].sort_values("dx")
        error = np.abs(line["value"] / line["theory"] - 1.0)
        look = {"color": shade, "label": QUANTITIES.get(quantity, "front speed")}
        fine.plot(line["dx"], error, marker=marker, **look)
    ends = rows["dx"].agg(["min", "max"]).to_numpy()
    fine.plot(ends, 0.4 * ends, color=GREY, linestyle=":", linewidth=0.8, label="first order")
    fine.set(
        xscale="log",
        yscale="log",
        xlabel=r"spacing $\Delta x$",
        ylabel=r"|simulation / limit $-$ 1|",
    )
    left, gamma, ratio = rows[["left", "gamma", "damping_ratio"]].iloc[0]
    fine.set_title(
        rf"$\Gamma = 1$, $\gamma = {gamma:g}$, $\tau_0 = {left:g}$, $b = {ratio:g}$", loc="right"
    )
    fine.legend(loc="lower right", fontsize=7.0, labelspacing=0.1)
    fine.set_ylim(1e-6, None)
    return figure
