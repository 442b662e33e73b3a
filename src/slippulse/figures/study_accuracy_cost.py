"""Error against work for every scheme, order, step and spacing; fronts that lock on the step."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from .style import BLACK, BLUE, GREY, HALO, ORDER_COLOURS, PAGE, Look, entry, new_panels

NEEDS = {"studies": ["accuracy_cost"]}

PANELS = {
    "front_speed": "front speed",
    "peak_velocity": "peak slip velocity",
    "transition_time": r"$T_\text{trans}$",
}
MARKERS = dict(zip(ORDER_COLOURS, "osD^P>", strict=True))
# Marker sizes by step, in spacings.
SIZES = {1.0: 4.0, 0.5: 2.8, 0.25: 1.8}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Rows of the study without the exact solution, which does no work on a lattice."""
    study = tables["accuracy_cost"]
    return study[study["scheme"] != "continuum"]


def plot(table: pd.DataFrame) -> Figure:
    """Draw three errors against the work, and the speed of the front against the step."""
    figure, axes = new_panels(PAGE, 5.0, 2, 2)
    trade = table[table["part"] == "trade"]
    for panel, (name, title) in zip(axes, PANELS.items(), strict=False):
        _draw_trade(panel, trade, name)
        panel.set(ylabel=f"relative error of {title}", xlabel="stencil passes over a block")
        panel.set_title(r"$\Gamma = 1$", loc="right")
    _draw_locking(axes[3], table[table["part"] == "locking"])
    look: Look = {"ncols": 5, "columnspacing": 1.0, "handletextpad": 0.3}
    figure.legend(handles=_handles(trade), loc="outside upper center", **look)
    return figure


def _draw_trade(axes: Axes, rows: pd.DataFrame, name: str) -> None:
    """Draw a mark a setting; presets have a ring.

    Lines join the textbook scheme over its steps, and the localised one at step 1 over spacings.
    """
    textbook = rows[rows["scheme"] == "fixed_step"]
    axes.plot(textbook["work"], textbook[name], "x-", color=BLACK, linewidth=0.6)
    for (order, step), marks in rows[rows["scheme"] == "localised"].groupby(["order", "step"]):
        look: Look = {"linewidth": 0.6} if step == 1.0 else {"alpha": 0.35, "linestyle": "none"}
        look |= {"color": ORDER_COLOURS[order], "marker": MARKERS[order]}
        look["markersize"] = SIZES.get(step, 2.3)
        marks = marks.sort_values("work")
        axes.plot(marks["work"], marks[name], markeredgewidth=0.0, **look)
    presets = rows[rows["preset"].notna()]
    axes.plot(presets["work"], presets[name], "o", color=BLACK, markersize=8.0, fillstyle="none")
    # The names of the presets stand on the side that is empty.
    look = {"xytext": (4, 6), "textcoords": "offset points", "fontsize": 7.5, "path_effects": HALO}
    for _, preset in presets.iterrows():
        axes.annotate(preset["preset"], (preset["work"], preset[name]), **look)
    axes.set(xscale="log", yscale="log")


def _handles(rows: pd.DataFrame) -> list[Line2D]:
    """Legend entries: colours and markers are orders, sizes are steps."""
    textbook = rows.loc[rows["scheme"] == "fixed_step", "dx"].unique()
    spacings = ", ".join(f"{dx:g}" for dx in textbook)
    orders = np.sort(rows.loc[rows["scheme"] == "localised", "order"].unique())
    line: Look = {"linewidth": 0.6, "linestyle": "-"}
    entries = [entry(f"textbook, dx = {spacings}", color=BLACK, marker="x", **line)]
    entries.append(entry("preset", color=BLACK, marker="o", markersize=8.0, fillstyle="none"))
    for order in orders:
        look = line | {"color": ORDER_COLOURS[order], "marker": MARKERS[order], "markersize": 4.0}
        entries.append(entry(f"order {order:g}", **look))
    for step, size in SIZES.items():
        look = {"alpha": 1.0 if step == 1.0 else 0.5, "marker": "o", "color": GREY}
        entries.append(entry(f"step {step:g} dx", markersize=size, **look))
    return entries


def _draw_locking(axes: Axes, rows: pd.DataFrame) -> None:
    """Draw the front speeds of both schemes and theory, and dx/(n dt), on which fronts lock."""
    fixed, local = (rows[rows["scheme"] == scheme] for scheme in ("fixed_step", "localised"))
    steps = np.linspace(fixed["step"].min(), fixed["step"].max(), 400)
    low, high = float(fixed["front_speed"].min()) - 0.03, float(fixed["front_speed"].max()) + 0.03
    for n in range(1, 12):
        locked = 1.0 / (n * steps)
        shown = np.where((locked > low) & (locked < high), locked, np.nan)
        label = r"$\Delta x/(n\,\Delta t)$, $n = 1, 2, \dots$" if n == 1 else None
        axes.plot(steps, shown, color="0.75", linewidth=0.8, label=label)
    axes.axhline(float(rows["exact"].iloc[0]), color=BLUE, linewidth=0.9, label="exact")
    axes.plot(fixed["step"], fixed["front_speed"], "x", color=BLACK, label="textbook scheme")
    look: Look = {"label": "localised scheme", "fillstyle": "none", "markersize": 4.0}
    axes.plot(local["step"], local["front_speed"], "o", color=BLUE, **look)
    # The legend stands above the marks.
    axes.set(ylim=(low, low + 1.32 * (high - low)), xlabel=r"time step $\Delta t\,/\,\Delta x$")
    axes.set_ylabel("front speed")
    axes.legend(loc="upper center", ncols=2, columnspacing=1.0, handlelength=1.6)
