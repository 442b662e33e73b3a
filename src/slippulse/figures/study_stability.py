"""Measured stability boundaries on the derived ones, and the steps that the presets take."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from ..model.stability import MARGIN, largest_step
from .style import BLACK, GREY, ORDER_COLOURS, PAGE, new_figure, panel_letter

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {"studies": ["stability"], "settings": ["studies.stability.between"]}

# Below this the damping axis is linear, so that 0 has a place.
LINEAR = 0.01
POINTS = 200
# An arrow up.
CENSORED = r"$\uparrow$"


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """The rows of the study, with where the search for a step ended, and the derived bounds as lines (kind derived)."""
    rows, (_, most) = measured["stability"], settings["studies"]["stability"]["between"]
    rows = rows.assign(searched_to=most)
    ratios = np.concatenate([[0.0], np.geomspace(LINEAR / 10.0, rows["damping_ratio"].max(), POINTS - 1)])
    lines = [
        pd.DataFrame({"kind": "derived", "scheme": scheme, "order": order, "damping_ratio": ratios}).assign(
            derived=[largest_step(scheme, order, ratio, 0.0) for ratio in ratios]
        )
        for scheme, order in rows.loc[rows["kind"] == "boundary", ["scheme", "order"]]
        .drop_duplicates()
        .to_numpy()
    ]
    return pd.concat([rows, *lines], ignore_index=True)


def plot(table: pd.DataFrame) -> Figure:
    """Left: the largest step against damping. Right: measured over derived, in two scenes, above the margin."""
    figure = new_figure(PAGE, 3.4)
    left, right = figure.subplots(1, 2, width_ratios=[1.25, 1.0])
    rows = table[table["kind"] == "boundary"]
    lines = table[table["kind"] == "derived"]
    for (scheme, order), curve in rows.groupby(["scheme", "order"]):
        colour = BLACK if scheme == "fixed_step" else ORDER_COLOURS[order]
        name = "textbook scheme" if scheme == "fixed_step" else f"localised, order {order}"
        line = lines[(lines["scheme"] == scheme) & (lines["order"] == order)]
        left.plot(
            line["damping_ratio"], line["derived"], color=colour, linewidth=0.9, label=name, gid="derived"
        )
        left.plot(
            curve["damping_ratio"], curve["measured"], "o", color=colour, markersize=3.2, gid="measured"
        )
        for column, marker in (("measured_ratio", "o"), ("measured_rupture_ratio", "^")):
            _draw_ratio(right, curve, column, marker, colour)
    styles = ("-", "--", ":", "-.")
    for style, (name, curve) in zip(
        styles, table[~table["kind"].isin(["boundary", "derived"])].groupby("kind", sort=False), strict=False
    ):
        left.plot(
            curve["damping_ratio"], curve["measured"], color=GREY, linewidth=1.8, alpha=0.7, linestyle=style,
            label=f"preset {name}", gid="preset",
        )  # fmt: skip
    left.set_yscale("log")
    left.set_ylabel(r"time step $\Delta t\,/\,\Delta x$")
    left.legend(loc="lower left", labelspacing=0.2)
    right.axhline(1.0, color=BLACK, linewidth=0.7)
    right.axhline(MARGIN, color=GREY, linewidth=1.8, alpha=0.7)
    right.text(0.98, MARGIN - 0.004, "largest step taken", color="0.4", ha="right", va="top", fontsize=7.5,
               transform=right.get_yaxis_transform())  # fmt: skip
    top = float(rows["measured_rupture_ratio"].max())
    right.set_ylim(MARGIN - 0.05, top + 0.05)
    right.set_ylabel("largest sound step / derived bound")
    for marker, face, name in (
        ("o", "0.3", "chain between walls"),
        ("^", "none", "rupture (events in the steps)"),
    ):
        right.plot([], [], marker, color="0.3", markerfacecolor=face, linestyle="none", label=name)
    right.plot([], [], color="0.3", marker=CENSORED, linestyle="none", label="sound as far as searched")
    right.legend(loc="center right", bbox_to_anchor=(1.0, 0.72))
    for axes, letter in ((left, "a"), (right, "b")):
        axes.set_xscale("symlog", linthresh=LINEAR, linscale=0.4)
        axes.set_xlim(-0.004, None)
        axes.set_xlabel(r"damping ratio $b$")
        panel_letter(axes, letter)
    return figure


def _draw_ratio(axes, curve: pd.DataFrame, column: str, marker: str, colour) -> None:
    """Measured over derived; an arrow up where every step that was tried is sound."""
    beyond = curve[column] > curve["searched_to"] - 1e-6
    for rows, shape in ((curve[~beyond], marker), (curve[beyond], CENSORED)):
        axes.plot(
            rows["damping_ratio"], rows[column], marker=shape, color=colour, markersize=3.6 if shape == marker else 6.0,
            markerfacecolor=colour if marker == "o" else "none", linestyle="none", gid=column,
        )  # fmt: skip
