"""Panels of the error of a quantity against the cost, for every scheme and order."""

from collections.abc import Callable, Mapping, Sequence

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from slippulse.plotting.style import BLACK, BLUE, ORANGE, SMALL_TEXT, TEXT_OUTLINE, Look

# Quantities with their title and the boundary condition, the one with the largest errors first.
QUANTITIES = {
    "share_time": ("the 95 % time", r"$\Gamma = 0$"),
    "transition_time": (r"$T_\text{trans}$", r"$\Gamma = 1$"),
    "peak_velocity": ("peak velocity", r"$\Gamma = 1$"),
    "front_speed": ("front speed", r"$\Gamma = 1$"),
}
ORDER_MAP, FIRST_COLOUR, LAST_COLOUR = "viridis", 0.9, 0.0
NAME: Look = {"textcoords": "offset points", "path_effects": TEXT_OUTLINE}


def error_rows(trade: pd.DataFrame, cost: str, column_of: Callable[[str], str]) -> pd.DataFrame:
    """Return one row for each quantity and setting that a figure draws, by role.

    textbook, preset, exact : the textbook scheme, the presets, and the exact solution
    frontier : for each scheme and order, the settings whose error is smaller than that of all
        cheaper ones

    cost : name of the cost in the result
    column_of : function that returns the column of ``trade`` with the cost for a quantity
    """
    parts = []
    for name in QUANTITIES:
        kept = trade[["scheme", "order", "step", "dx", "preset"]]
        rows = kept.assign(quantity=name, error=trade[name], **{cost: trade[column_of(name)]})
        rows = rows.sort_values(cost, kind="stable")
        roles = {
            "textbook": rows[rows["scheme"] == "fixed_step"],
            "preset": rows[rows["preset"].notna()],
            "exact": rows[rows["scheme"] == "continuum"],
        }
        lattices = rows[rows["scheme"] != "continuum"].dropna(subset="error")
        # The rows are in the order of their cost, so the smallest error of all cheaper settings is
        # the running minimum of the row before.
        running_minimum = lattices.groupby(["scheme", "order"])["error"].transform("cummin")
        by_order = running_minimum.groupby([lattices["scheme"], lattices["order"]])
        smallest_of_cheaper = by_order.shift(fill_value=np.inf)
        roles["frontier"] = lattices[lattices["error"] < smallest_of_cheaper]
        parts += [part.assign(role=role) for role, part in roles.items()]
    return pd.concat(parts, ignore_index=True)


def draw_errors(panels: Sequence[Axes], table: pd.DataFrame, cost: str, axis_label: str) -> None:
    """Draw one panel for each quantity, with logarithmic axes."""
    for axes, (quantity, (title, boundary)) in zip(panels, QUANTITIES.items(), strict=True):
        rows = table[table["quantity"] == quantity]
        _draw_frontiers(axes, rows, cost)
        textbook, presets = (rows[rows["role"] == role] for role in ("textbook", "preset"))
        look: Look = {"color": BLACK, "linestyle": "none"}
        axes.plot(textbook[cost], textbook["error"], marker="x", label="textbook scheme", **look)
        look["color"] = ORANGE
        axes.plot(presets[cost], presets["error"], marker="o", label="presets", **look)
        for preset in presets.to_dict("records"):
            axes.annotate(preset["preset"], (preset[cost], preset["error"]), (4, 5), **NAME)
        lattices = rows[rows["role"] != "exact"]
        axes.set(xscale="log", yscale="log", xlabel=axis_label)
        axes.set(ylabel=f"relative error of {title}", title=boundary)
        # The names of the presets and the error of the exact solution need some room.
        axes.set_ylim(0.2 * lattices["error"].min(), 2.5 * lattices["error"].max())
        (exact,) = rows[rows["role"] == "exact"].to_dict("records")
        if np.isfinite(exact[cost]):
            _draw_exact(axes, exact, cost)


def _draw_frontiers(axes: Axes, rows: pd.DataFrame, cost: str) -> None:
    """Draw the smallest error that a cost can buy, for each order and the textbook scheme."""
    frontier, end = rows[rows["role"] == "frontier"], rows[cost].max()
    orders = sorted(frontier.loc[frontier["scheme"] == "localised", "order"].unique())
    shades = np.linspace(FIRST_COLOUR, LAST_COLOUR, len(orders))
    colours = dict(zip(orders, matplotlib.colormaps[ORDER_MAP](shades), strict=True))
    for (scheme, order), part in frontier.groupby(["scheme", "order"]):
        # A larger cost need not have a larger error.
        part = pd.concat([part, part.tail(1).assign(**{cost: end})])
        look: Look = {"color": BLACK, "linewidth": 0.6}
        if scheme == "localised":
            look = {"color": colours[order], "label": f"order {order:.0f}"}
        axes.plot(part[cost], part["error"], drawstyle="steps-post", **look)


def _draw_exact(axes: Axes, exact: Mapping, cost: str) -> None:
    """Mark the cost of the exact solution. Its error, far below the panel, stands at the line."""
    axes.axvline(exact[cost], color=BLUE, linewidth=0.9, label="exact solution")
    digit, exponent = f"{exact['error']:.0e}".split("e")
    text = rf"error ${digit} \times 10^{{{int(exponent)}}}$"
    look: Look = {"color": BLUE, "fontsize": SMALL_TEXT, "ha": "right"}
    axes.annotate(text, (exact[cost], axes.get_ylim()[0]), (-3, 4), **look, **NAME)
