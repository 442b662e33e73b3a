"""Errors as functions of work for every scheme and order, and fronts that lock onto the time step.

The work of a run is the number of passes of the stencil over one block. It does not depend on the
machine.
"""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slippulse.plotting.style import (
    BLACK,
    BLUE,
    OPEN_MARKER,
    PAGE_WIDTH,
    legend_above,
    new_panels,
)

from .shared.error_panels import draw_errors, error_rows

NEEDS = {"studies": ["accuracy_cost"]}


def table(data: dict, tables: dict[str, pd.DataFrame], settings: dict) -> pd.DataFrame:
    """Return the rows of two parts of the figure, which the column part names.

    trade : errors as functions of work, in the form that `error_rows` returns
    locking : front speed for each scheme and time step, as in the study
    """
    study = tables["accuracy_cost"]
    trade = study[study["part"] == "trade"]
    # The cost is the work of a run, which is the same for every quantity that the run gives.
    errors = error_rows(trade, cost="work", cost_column_of=lambda quantity: "work")
    table = pd.concat(
        [study[study["part"] == "locking"], errors.assign(part="trade")], ignore_index=True
    )
    columns = ["part", "role", "quantity", "scheme", "order", "step", "dx", "work", "error"]
    return table[[*columns, "preset", "front_speed", "exact"]]


def draw(table: pd.DataFrame) -> Figure:
    """Draw four errors as functions of work, and the front speed as a function of the step."""
    figure, (*error_panels, speed_axes) = new_panels(PAGE_WIDTH, 5.0, "aabbcc;dddeee")
    errors = table[table["part"] == "trade"]
    draw_errors(error_panels, errors, "work", "stencil passes over a block")
    draw_locking(speed_axes, table[table["part"] == "locking"])
    legend_above(figure, error_panels[0])
    return figure


def draw_locking(axes: Axes, rows: pd.DataFrame) -> None:
    """Draw the front speed as a function of the time step dt, for both schemes.

    With the textbook scheme, fronts lock onto the speeds dx/(n dt), where n is a whole number. Grey
    lines show these speeds.
    """
    fixed, localised = (rows[rows["scheme"] == scheme] for scheme in ("fixed_step", "localised"))
    steps = np.linspace(fixed["step"].min(), fixed["step"].max(), 400)
    low, high = float(fixed["front_speed"].min()) - 0.03, float(fixed["front_speed"].max()) + 0.03
    # One row for each step dt/dx, and one column for each n that may give a speed in the panel.
    locked_speeds = 1.0 / np.outer(steps, np.arange(1, 12))
    is_shown = (locked_speeds > low) & (locked_speeds < high)
    shown_speeds = np.where(is_shown, locked_speeds, np.nan)
    lines = axes.plot(steps, shown_speeds, color="0.75", linewidth=0.8)
    lines[0].set_label(r"$\Delta x/(n\,\Delta t)$, $n = 1, 2, \dots$")
    axes.axhline(float(rows["exact"].iloc[0]), color=BLUE, linewidth=0.9, label="exact")
    axes.plot(fixed["step"], fixed["front_speed"], "x", color=BLACK, label="textbook scheme")
    look = OPEN_MARKER | {"color": BLUE, "label": "localised scheme"}
    axes.plot(localised["step"], localised["front_speed"], "o", **look)
    # The legend stands above the marks.
    axes.set(ylim=(low, low + 1.32 * (high - low)), xlabel=r"time step $\Delta t\,/\,\Delta x$")
    axes.set(ylabel="front speed", title=r"$\Gamma = 0$")
    axes.legend(loc="upper center", ncols=2)
