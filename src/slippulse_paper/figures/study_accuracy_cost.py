"""Errors of presets, textbook scheme and best settings by work; fronts that lock onto the step.

The work of a setting is its number of stencil passes over a block.
"""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slippulse.plotting.style import (
    BLACK,
    BLUE,
    GREY,
    OPEN_MARKER,
    ORANGE,
    PAGE_WIDTH,
    TEXT_OUTLINE,
    Look,
    legend_above,
    new_panels,
)

NEEDS = {"studies": ["accuracy_cost"]}

# Quantities with their title and the boundary condition, the one with the largest errors first.
PANELS = {
    "share_time": ("the 95 % time", r"$\Gamma = 0$"),
    "transition_time": (r"$T_\text{trans}$", r"$\Gamma = 1$"),
    "peak_velocity": ("peak velocity", r"$\Gamma = 1$"),
    "front_speed": ("front speed", r"$\Gamma = 1$"),
}
BEST_LABEL = "smallest error of any setting of the localised scheme at this work"
LOOKS: dict[str, Look] = {
    "textbook": {"color": BLACK, "marker": "x", "linewidth": 0.6, "label": "textbook scheme"},
    "best": {"color": GREY, "drawstyle": "steps-post", "label": BEST_LABEL},
    "preset": {"color": ORANGE, "marker": "o", "linestyle": "none", "label": "presets"},
}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the part locking of the study, and the errors of PANELS by role (part trade).

    textbook, preset : all settings of the textbook scheme, and the presets
    best : localised settings such that no setting with less work has a smaller error
    """
    study = tables["accuracy_cost"]
    trade = study[study["part"] == "trade"].sort_values("work", kind="stable")
    localised = trade[trade["scheme"] == "localised"]
    parts = [study[study["part"] == "locking"]]
    for quantity in PANELS:
        error = localised[quantity]
        smallest_with_less_work = error.cummin().shift(fill_value=np.inf)
        rows_by_role = {
            "textbook": trade[trade["scheme"] == "fixed_step"],
            "best": localised[error < smallest_with_less_work],
            "preset": trade[trade["preset"].notna()],
        }
        for role, rows in rows_by_role.items():
            kept = rows[["scheme", "order", "step", "dx", "work", "preset", "part"]]
            parts.append(kept.assign(role=role, quantity=quantity, error=rows[quantity]))
    columns = ["part", "role", "quantity", "scheme", "order", "step", "dx", "work", "error"]
    columns += ["preset", "front_speed", "exact"]
    return pd.concat(parts, ignore_index=True)[columns]


def draw(table: pd.DataFrame) -> Figure:
    """Draw four errors as functions of work, and the front speed as a function of the step."""
    figure, (*error_panels, speed_axes) = new_panels(PAGE_WIDTH, 5.0, "aabbcc;dddeee")
    for axes, (quantity, (title, boundary)) in zip(error_panels, PANELS.items(), strict=True):
        draw_errors(axes, table[table["quantity"] == quantity])
        axes.set(ylabel=f"relative error of {title}", title=boundary)
    draw_locking(speed_axes, table[table["part"] == "locking"])
    legend_above(figure, error_panels[0])
    return figure


def draw_errors(axes: Axes, rows: pd.DataFrame) -> None:
    """Draw the error of one quantity as a function of work, and name the presets."""
    for role, line in LOOKS.items():
        points = rows[rows["role"] == role].sort_values("work")
        if role == "best":
            # More work need not have a larger error, so the best line goes on to the right.
            end = points.tail(1).assign(work=rows["work"].max())
            points = pd.concat([points, end])
        axes.plot(points["work"], points["error"], **line)
    # The names of the presets stand on the side that is empty.
    look: Look = {"textcoords": "offset points", "path_effects": TEXT_OUTLINE}
    for preset in rows[rows["role"] == "preset"].itertuples():
        axes.annotate(preset.preset, (preset.work, preset.error), (4, 5), **look)
    axes.set(xscale="log", yscale="log", xlabel="stencil passes over a block")
    axes.set_ylim(None, 2.5 * rows["error"].max())


def draw_locking(axes: Axes, rows: pd.DataFrame) -> None:
    """Draw the front speed as a function of the step, for both schemes.

    Under the textbook scheme fronts lock onto the speeds dx/(n dt) with a whole number n, which are
    drawn as grey lines.
    """
    fixed, localised = (rows[rows["scheme"] == scheme] for scheme in ("fixed_step", "localised"))
    steps = np.linspace(fixed["step"].min(), fixed["step"].max(), 400)
    low, high = float(fixed["front_speed"].min()) - 0.03, float(fixed["front_speed"].max()) + 0.03
    # One row for each step dt/dx, and one column for each n.
    locked = 1.0 / np.outer(steps, np.arange(1, 12))
    is_shown = (locked > low) & (locked < high)
    lines = axes.plot(steps, np.where(is_shown, locked, np.nan), color="0.75", linewidth=0.8)
    lines[0].set_label(r"$\Delta x/(n\,\Delta t)$, $n = 1, 2, \dots$")
    axes.axhline(float(rows["exact"].iloc[0]), color=BLUE, linewidth=0.9, label="exact")
    axes.plot(fixed["step"], fixed["front_speed"], "x", color=BLACK, label="textbook scheme")
    look = OPEN_MARKER | {"color": BLUE, "label": "localised scheme"}
    axes.plot(localised["step"], localised["front_speed"], "o", **look)
    # The legend stands above the marks.
    axes.set(ylim=(low, low + 1.32 * (high - low)), xlabel=r"time step $\Delta t\,/\,\Delta x$")
    axes.set(ylabel="front speed", title=r"$\Gamma = 0$")
    axes.legend(loc="upper center", ncols=2)
