"""Panels that show the error of a quantity as a function of the cost of a run."""

from collections.abc import Callable, Sequence

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from slippulse.plotting.style import BLACK, BLUE, ORANGE, SMALL_TEXT, TEXT_OUTLINE, Look

# Title and boundary condition of each quantity, in the order of falling errors.
QUANTITIES = {
    "share_time": ("the 95 % time", r"$\Gamma = 0$"),
    "transition_time": (r"$T_\text{trans}$", r"$\Gamma = 1$"),
    "peak_velocity": ("peak velocity", r"$\Gamma = 1$"),
    "front_speed": ("front speed", r"$\Gamma = 1$"),
}
# Orders are drawn in the colours between these two points of the colour map.
ORDER_MAP = "viridis"
FIRST_COLOUR, LAST_COLOUR = 0.9, 0.0
# Look of a text beside a marker or a line.
BESIDE: Look = {"textcoords": "offset points", "path_effects": TEXT_OUTLINE}


def error_rows(
    trade: pd.DataFrame, cost: str, cost_column_of: Callable[[str], str]
) -> pd.DataFrame:
    """Return the error and the cost of each quantity with the settings that a figure draws.

    A setting is a scheme with its order, time step and block spacing. A setting has one row for
    each of these roles (column role) that it plays:

    textbook : a setting of the textbook scheme
    preset : a setting that is a preset
    exact : the exact solution
    frontier : a setting whose error is smaller than that of all cheaper settings with the same
        scheme and order

    Parameters
    ----------
    trade : errors and costs of all settings, from the study accuracy_cost
    cost : name of the column with the cost in the result, such as "work"
    cost_column_of : function of the name of a quantity; it returns the name of the column of
        ``trade`` with the cost of this quantity
    """
    settings = trade[["scheme", "order", "step", "dx", "preset"]]
    parts = []
    for quantity in QUANTITIES:
        rows = settings.assign(quantity=quantity, error=trade[quantity])
        rows[cost] = trade[cost_column_of(quantity)]
        rows = rows.sort_values(cost, kind="stable")
        roles = {
            "textbook": rows[rows["scheme"] == "fixed_step"],
            "preset": rows[rows["preset"].notna()],
            "exact": rows[rows["scheme"] == "continuum"],
        }
        lattices = rows[rows["scheme"] != "continuum"].dropna(subset="error")
        roles["frontier"] = lattices[lattices["error"] < _smallest_error_of_cheaper(lattices)]
        parts += [part.assign(role=role) for role, part in roles.items()]
    return pd.concat(parts, ignore_index=True)


def _smallest_error_of_cheaper(rows: pd.DataFrame) -> pd.Series:
    """Return for each row the smallest error of all cheaper rows with its scheme and order.

    The error is infinite for the cheapest row.

    rows : settings in the order of their cost
    """
    errors_by_order = rows.groupby(["scheme", "order"])["error"]
    # The cumulative minimum includes the row itself. The shift moves it to the next row.
    return errors_by_order.transform(lambda errors: errors.cummin().shift(fill_value=np.inf))


def draw_errors(panels: Sequence[Axes], table: pd.DataFrame, cost: str, axis_label: str) -> None:
    """Draw one panel for each quantity: its error as a function of the cost.

    table : the rows of `error_rows`
    cost : name of the column with the cost
    axis_label : label of the horizontal axis
    """
    for axes, (quantity, (title, boundary)) in zip(panels, QUANTITIES.items(), strict=True):
        rows = table[table["quantity"] == quantity]
        _draw_frontiers(axes, rows, cost)
        textbook, presets = (rows[rows["role"] == role] for role in ("textbook", "preset"))
        axes.plot(textbook[cost], textbook["error"], "x", color=BLACK, label="textbook scheme")
        axes.plot(presets[cost], presets["error"], "o", color=ORANGE, label="presets")
        for _, row in presets.iterrows():
            axes.annotate(row["preset"], (row[cost], row["error"]), (4, 5), **BESIDE)
        lattices = rows[rows["role"] != "exact"]
        axes.set(xscale="log", yscale="log", xlabel=axis_label)
        axes.set(ylabel=f"relative error of {title}", title=boundary)
        # The names of the presets and the error of the exact solution need some room.
        axes.set_ylim(0.2 * lattices["error"].min(), 2.5 * lattices["error"].max())
        # If the cost counts passes over blocks, the exact solution has none, and its cost is NaN.
        exact = rows[rows["role"] == "exact"].iloc[0]
        if np.isfinite(exact[cost]):
            _draw_exact(axes, exact[cost], exact["error"])


def _draw_frontiers(axes: Axes, rows: pd.DataFrame, cost: str) -> None:
    """Draw as steps the smallest error that can be reached up to a cost.

    The localised scheme has one coloured line for each order, and the textbook scheme one thin
    black line.

    cost : name of the column with the cost
    """
    frontier = rows[rows["role"] == "frontier"]
    orders = sorted(frontier.loc[frontier["scheme"] == "localised", "order"].unique())
    shades = np.linspace(FIRST_COLOUR, LAST_COLOUR, len(orders))
    colours = dict(zip(orders, matplotlib.colormaps[ORDER_MAP](shades), strict=True))
    for (scheme, order), line in frontier.groupby(["scheme", "order"]):
        # The last step extends to the largest cost, at which its error can be reached as well.
        end = line.tail(1).assign(**{cost: rows[cost].max()})
        line = pd.concat([line, end])
        # In the legend, the textbook scheme has the crosses that `draw_errors` draws.
        look: Look = {"color": BLACK, "linewidth": 0.6}
        if scheme == "localised":
            look = {"color": colours[order], "label": f"order {order:.0f}"}
        axes.plot(line[cost], line["error"], drawstyle="steps-post", **look)


def _draw_exact(axes: Axes, cost: float, error: float) -> None:
    """Draw a vertical line at the cost of the exact solution, and write its error beside the line.

    The error is written because it lies below the panel.
    """
    axes.axvline(cost, color=BLUE, linewidth=0.9, label="exact solution")
    # An error of 2e-13 is written as 2 x 10^-13.
    digit, exponent = f"{error:.0e}".split("e")
    text = rf"error ${digit} \times 10^{{{int(exponent)}}}$"
    look = BESIDE | {"color": BLUE, "fontsize": SMALL_TEXT, "ha": "right"}
    bottom, _ = axes.get_ylim()
    axes.annotate(text, (cost, bottom), (-3, 4), **look)
