"""Error against work of presets, textbook scheme and best settings; fronts locked on the step."""

import numpy as np
import pandas as pd
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
BEST = "smallest error of any setting of the localised scheme at this work"
LOOKS: dict[str, Look] = {
    "textbook": {"color": BLACK, "marker": "x", "linewidth": 0.6, "label": "textbook scheme"},
    "best": {"color": GREY, "drawstyle": "steps-post", "label": BEST},
    "preset": {"color": ORANGE, "marker": "o", "linestyle": "none", "label": "presets"},
}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Role best has the localised settings of which none with less work has a smaller error."""
    study = tables["accuracy_cost"]
    trade = study[study["part"] == "trade"].sort_values("work", kind="stable")
    localised = trade[trade["scheme"] == "localised"]
    parts = [study[study["part"] == "locking"]]
    for name in PANELS:
        smallest = localised[name].cummin()
        rows = {
            "textbook": trade[trade["scheme"] == "fixed_step"],
            "best": localised[localised[name] < smallest.shift(fill_value=np.inf)],
            "preset": trade[trade["preset"].notna()],
        }
        for role, part in rows.items():
            kept = part[["scheme", "order", "step", "dx", "work", "preset", "part"]]
            parts.append(kept.assign(role=role, quantity=name, error=part[name]))
    columns = ["part", "role", "quantity", "scheme", "order", "step", "dx", "work", "error"]
    return pd.concat(parts, ignore_index=True)[[*columns, "preset", "front_speed", "exact"]]


def draw(table: pd.DataFrame) -> Figure:
    """Draw four errors against the work, and the speed of the front against the step."""
    figure, (*trades, speeds) = new_panels(PAGE_WIDTH, 5.0, "aabbcc;dddeee")
    # The names of the presets stand on the side that is empty.
    name: Look = {"textcoords": "offset points", "path_effects": TEXT_OUTLINE}
    for axes, (quantity, (title, boundary)) in zip(trades, PANELS.items(), strict=True):
        rows = table[table["quantity"] == quantity]
        for role, look in LOOKS.items():
            part = rows[rows["role"] == role].sort_values("work")
            if role == "best":
                # More work need not have a larger error.
                part = pd.concat([part, part.tail(1).assign(work=rows["work"].max())])
            axes.plot(part["work"], part["error"], **look)
        for preset in rows[rows["role"] == "preset"].itertuples():
            axes.annotate(preset.preset, (preset.work, preset.error), (4, 5), **name)
        axes.set(xscale="log", yscale="log", xlabel="stencil passes over a block")
        axes.set(ylabel=f"relative error of {title}", title=boundary)
        axes.set_ylim(None, 2.5 * rows["error"].max())
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
