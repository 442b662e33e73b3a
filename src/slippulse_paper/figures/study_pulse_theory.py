"""The steady pulse as a function of damping: simulations, exact theory and the paper's formulas."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
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
# The quantities that are compared on refined lattices, and their measured columns.
REFINED_COLUMNS = {name: f"pulse_{name}" for name in QUANTITY_LABELS} | {
    "front_speed": "front_speed_right"
}


def table(data: dict, tables: dict[str, pd.DataFrame], settings: dict) -> pd.DataFrame:
    """Return one row for each quantity of a pulse, in three parts, which the column role names.

    theory : exact values divided by the paper's formula (column over_paper) at each damping ratio
    simulation : measured values (column value), exact values (theory), and the values of the
        paper's formula (paper)
    refined : measured values on lattices of several spacings (value), and their limit (theory)
    """
    study = tables["damped_pulse"]
    runs = like_first_run(tables["pulse_damping"], ["dx", "gamma", "release"])
    curves = study[study["role"] == "curve"].rename(columns={"value": "over_paper"})
    parts = [curves.assign(role="theory")]
    for quantity in QUANTITY_LABELS:
        rows = runs[["left", "gamma", "damping_ratio", "run_flags"]].assign(
            value=runs[f"pulse_{quantity}"],
            theory=runs[f"exact_pulse_{quantity}"],
            paper=runs[f"paper_pulse_{quantity}"],
            role="simulation",
            quantity=quantity,
        )
        parts.append(rows)
    scene_columns = ["left", "right", "gamma", "damping_ratio", "release"]
    refined = like_first_run(tables["continuum_fixed_ratio"], scene_columns)
    limits = study[study["role"] == "limit"].set_index("quantity")["value"]
    for quantity, column in REFINED_COLUMNS.items():
        rows = refined[["left", "gamma", "damping_ratio", "dx"]].assign(
            value=refined[column], theory=limits[quantity], quantity=quantity, role="refined"
        )
        parts.append(rows)
    return pd.concat(parts, ignore_index=True)


def like_first_run(runs: pd.DataFrame, columns: list[str]) -> pd.DataFrame:
    """Return the runs that have the same values in these columns as the first run.

    The exact values are for the first run. An overlay may add runs with other parameters.
    """
    return runs[(runs[columns] == runs[columns].iloc[0]).all(axis=1)]


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a to c) quantities divided by the paper's formula, (d) their errors by spacing."""
    figure, (*quantity_panels, refined_axes) = style.new_panels(PAGE_WIDTH, 4.6, "ab;cd")
    rows_by_role = style.by_role(table)
    gamma = rows_by_role["simulation"]["gamma"].iloc[0]
    for axes, (quantity, label) in zip(quantity_panels, QUANTITY_LABELS.items(), strict=True):
        draw_quantity(axes, table[table["quantity"] == quantity])
        axes.set(xlabel=r"damping ratio $b$", ylabel=f"{label} / paper's formula")
        axes.set(xlim=(-0.02, None), title=conditions(held=True, gamma=gamma))
    # The three panels share the legend of the first one.
    first_axes = quantity_panels[0]
    first_axes.plot([], [], "o", color=GREY, label="simulation")
    style.legend_above(figure, first_axes)
    draw_errors_by_spacing(refined_axes, rows_by_role["refined"])
    return figure


def draw_quantity(axes: Axes, rows: pd.DataFrame) -> None:
    """Draw a quantity, divided by the paper's formula, as a function of the damping ratio.

    Each level of the pre-stress has a colour. Exact theory is drawn as lines, and runs as markers,
    which are open if the run is flagged.

    rows : exact values that are already divided by the formula (column over_paper), and measured
        values (value) with those of the formula (paper)
    """
    axes.axhline(1.0, color=GREY, linewidth=0.8, linestyle="--", label="paper's formula")
    for level, group in rows.groupby("left"):
        colour = style.colour("tau_0", level)
        theory = group[group["role"] == "theory"]
        label = None if theory.empty else rf"exact, $\tau_0 = {level:g}$"
        axes.plot(theory["damping_ratio"], theory["over_paper"], color=colour, label=label)
        runs = group[group["role"] == "simulation"]
        for is_flagged, drawn_runs in runs.groupby(runs["run_flags"].notna()):
            look: Look = OPEN_MARKER if is_flagged else {}
            ratio = drawn_runs["value"] / drawn_runs["paper"]
            axes.plot(drawn_runs["damping_ratio"], ratio, "o", color=colour, **look)


def draw_errors_by_spacing(axes: Axes, rows: pd.DataFrame) -> None:
    """Draw the relative error of each quantity on refined lattices, as a function of the spacing.

    The error is measured from the exact limit for dx -> 0.
    """
    for quantity, colour, marker in zip(REFINED_COLUMNS, COLOUR_CYCLE, MARKERS, strict=False):
        line = rows[rows["quantity"] == quantity].sort_values("dx")
        error = np.abs(line["value"] / line["theory"] - 1.0)
        label = QUANTITY_LABELS.get(quantity, "front speed")
        axes.plot(line["dx"], error, marker=marker, color=colour, label=label)
    # A dotted guide: the error 0.4 dx, which falls with first order.
    style.draw_first_order(axes, rows["dx"], slope=0.4, colour=GREY)
    # All runs are the same scene at several spacings.
    first = rows.iloc[0]
    scene = conditions(
        held=True, gamma=first["gamma"], tau_0=first["left"], damping_ratio=first["damping_ratio"]
    )
    axes.set(ylabel=r"|simulation / limit $-$ 1|", ylim=(1e-6, None), title=scene)
    axes.legend(loc="lower right")
