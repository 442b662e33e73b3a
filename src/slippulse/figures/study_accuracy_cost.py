"""Error against work for every scheme, order, step and spacing, and how the textbook front locks on its step."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from .style import BLACK, BLUE, GREY, HALO, ORDER_COLOURS, PAGE, Look, entry, new_panels

NEEDS = {"studies": ["accuracy_cost"]}

PANELS = {
    "front_speed": "front speed", "peak_velocity": "peak slip velocity", "transition_time": r"$T_\text{trans}$"
}  # fmt: skip
MARKERS = dict(zip(ORDER_COLOURS, "osD^P>", strict=True))
# Marker sizes of steps of 1, 1/2 and 1/4 of the spacing.
SIZES = {1.0: 4.0, 0.5: 2.8, 0.25: 1.8}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """The rows of the study; the exact solution, which does no work on a lattice, is not drawn."""
    study = tables["accuracy_cost"]
    return study[study["scheme"] != "continuum"]


def plot(table: pd.DataFrame) -> Figure:
    """Three errors against the work, and the speed of the front against the step."""
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
    """One mark a setting; the textbook scheme joined over its steps, steps of 1 over spacings; presets ringed."""
    textbook = rows[rows["scheme"] == "fixed_step"]
    axes.plot(textbook["work"], textbook[name], "x-", color=BLACK, linewidth=0.6)
    for (order, step), marks in rows[rows["scheme"] == "localised"].groupby(["order", "step"]):
        look: Look = {"linewidth": 0.6} if step == 1.0 else {"alpha": 0.35, "linestyle": "none"}
        look |= {
            "color": ORDER_COLOURS[order],
            "marker": MARKERS[order],
            "markersize": SIZES.get(step, 2.3),
        }
        marks = marks.sort_values("work")
        axes.plot(marks["work"], marks[name], markeredgewidth=0.0, **look)
    presets = rows[rows["preset"].notna()]
    axes.plot(presets["work"], presets[name], "o", color=BLACK, markersize=8.0, fillstyle="none")
    # On the side that is empty.
    look = {"xytext": (4, 6), "textcoords": "offset points", "fontsize": 7.5, "path_effects": HALO}
    for _, preset in presets.iterrows():
        axes.annotate(preset["preset"], (preset["work"], preset[name]), **look)
    axes.set(xscale="log", yscale="log")


def _handles(rows: pd.DataFrame) -> list[Line2D]:
    """Legend: colours and markers are orders, sizes steps."""
    spacings = ", ".join(
        f"{dx:g}" for dx in rows.loc[rows["scheme"] == "fixed_step", "dx"].unique()
    )
    orders = np.sort(rows.loc[rows["scheme"] == "localised", "order"].unique())
    line: Look = {"linewidth": 0.6, "linestyle": "-"}
    found = [entry(f"textbook, dx = {spacings}", color=BLACK, marker="x", **line)]
    found.append(entry("preset", color=BLACK, marker="o", markersize=8.0, fillstyle="none"))
    for order in orders:
        look = line | {"color": ORDER_COLOURS[order], "marker": MARKERS[order], "markersize": 4.0}
        found.append(entry(f"order {order:g}", **look))
    for step, size in SIZES.items():
        look = {
            "alpha": 1.0 if step == 1.0 else 0.5,
            "marker": "o",
            "markersize": size,
            "color": GREY,
        }
        found.append(entry(f"step {step:g} dx", **look))
    return found


def _draw_locking(axes: Axes, rows: pd.DataFrame) -> None:
    """Front speed of both schemes, the exact one, and the speeds dx/(n dt) that the textbook scheme locks on."""
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
