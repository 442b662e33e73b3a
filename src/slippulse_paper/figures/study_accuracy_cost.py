"""Error against stencil passes for every scheme and order; fronts locked on the step."""

import numpy as np
import pandas as pd
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


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the errors with the number of stencil passes, and the speeds by the step."""
    study = tables["accuracy_cost"]
    trade = study[study["part"] == "trade"]
    errors = error_rows(trade, "work", lambda quantity: "work").assign(part="trade")
    table = pd.concat([study[study["part"] == "locking"], errors], ignore_index=True)
    columns = ["part", "role", "quantity", "scheme", "order", "step", "dx", "work", "error"]
    return table[[*columns, "preset", "front_speed", "exact"]]


def draw(table: pd.DataFrame) -> Figure:
    """Draw four errors against the work, and the speed of the front against the step."""
    figure, (*trades, speeds) = new_panels(PAGE_WIDTH, 5.0, "aabbcc;dddeee")
    errors = table[table["part"] == "trade"]
    draw_errors(trades, errors, "work", "stencil passes over a block")
    # On dx/(n dt) fronts lock.
    rows = table[table["part"] == "locking"]
    fixed, local = (rows[rows["scheme"] == scheme] for scheme in ("fixed_step", "localised"))
    steps = np.linspace(fixed["step"].min(), fixed["step"].max(), 400)
    low, high = float(fixed["front_speed"].min()) - 0.03, float(fixed["front_speed"].max()) + 0.03
    locked = 1.0 / np.outer(steps, np.arange(1, 12))
    shown = np.where((locked > low) & (locked < high), locked, np.nan)
    lines = speeds.plot(steps, shown, color="0.75", linewidth=0.8)
    lines[0].set_label(r"$\Delta x/(n\,\Delta t)$, $n = 1, 2, \dots$")
    speeds.axhline(float(rows["exact"].iloc[0]), color=BLUE, linewidth=0.9, label="exact")
    speeds.plot(fixed["step"], fixed["front_speed"], "x", color=BLACK, label="textbook scheme")
    look = OPEN_MARKER | {"color": BLUE, "label": "localised scheme"}
    speeds.plot(local["step"], local["front_speed"], "o", **look)
    # The legend stands above the marks.
    speeds.set(ylim=(low, low + 1.32 * (high - low)), xlabel=r"time step $\Delta t\,/\,\Delta x$")
    speeds.set(ylabel="front speed", title=r"$\Gamma = 0$")
    speeds.legend(loc="upper center", ncols=2)
    legend_above(figure, trades[0])
    return figure
