"""Exact transitions over a grid of scenes: what the Gaussian costs, and one-way pulses under leaf springs."""

from __future__ import annotations

import numpy as np
import pandas as pd

from ...data.numerals import setting
from ...model.prestress import Prestress
from ...theory.exact_transition import exact_transition_displacement, uniform_transition_time
from ...theory.rupture import Rupture
from ..style import BLACK, colour_scale

LEVELS = (0.1, 0.2, 0.4, 0.6, 0.8, 0.9)
GAMMAS = (0.01, 0.1, 0.65)
# One-way pulses: levels on both sides, elasticity ratio, and a time by which all have stuck somewhere.
LEFTS, RIGHTS, ONE_WAY_GAMMA, DURATION = (-0.1, -0.3, -0.6, -1.0), (0.1, 0.3, 0.5, 0.7, 0.9), 0.65, 9.0


def peak_rows() -> pd.DataFrame:
    """T_trans sqrt(gamma)/pi over tau_0 without damping: role uniform, and role peak for each gamma (W = 1)."""
    rows = []
    for tau0 in LEVELS:
        rows.append({"role": "uniform", "left": tau0, "exact": uniform_transition_time(tau0, 1.0) / np.pi})
        for gamma in GAMMAS:
            time = exact_transition_displacement(Prestress(tau0, tau0), gamma).time
            rows.append(
                {"role": "peak", "left": tau0, "gamma": gamma, "exact": time * np.sqrt(gamma) / np.pi}
            )
    return pd.DataFrame(rows).assign(quantity="time", damping_ratio=0.0)


def one_way_rows(damping_ratio: float) -> pd.DataFrame:
    """Role one_way: where the left front stops (quantity stop), T_trans, L_trans; role limit if a construction ends."""
    rows = []
    for left in LEFTS:
        for right in RIGHTS:
            rupture = Rupture(Prestress(left, right), ONE_WAY_GAMMA, damping_ratio, duration=DURATION)
            end = rupture.front_ends[0][0]
            found = {
                "stop": -end.x if end.reason == "stops" else np.nan,
                "time": rupture.transition_time,
                "length": rupture.transition_length,
            }
            common = {"left": left, "right": right, "gamma": ONE_WAY_GAMMA, "damping_ratio": damping_ratio}
            rows += [
                common | {"role": "one_way", "quantity": name, "exact": value}
                for name, value in found.items()
            ]
            if rupture.limit:
                rows.append(common | {"role": "limit"})
    return pd.DataFrame(rows)


def draw_peak(axes, table: pd.DataFrame) -> None:
    """T_trans over the paper's pi/sqrt(gamma): uniform pre-stress, and with the Gaussian."""
    axes.axhline(1.0, color=BLACK, linewidth=0.8)
    line = table[table["role"] == "uniform"]
    axes.plot(line["left"], line["exact"], "--", color=BLACK, label="uniform", gid="uniform")
    for gamma, rows in table[table["role"] == "peak"].groupby("gamma"):
        colour = colour_scale("gamma").to_rgba(gamma)
        axes.plot(
            rows["left"], rows["exact"], color=colour, marker="o", markersize=2.0, label=rf"$\gamma = {gamma:g}$",
            gid=f"peak {gamma:g}",
        )  # fmt: skip
    axes.set(xlabel=r"pre-stress $\tau_0$", ylabel=r"exact $T_\mathrm{trans}\,\gamma^{1/2}/\pi$")
    axes.set_ylim(0.85, 1.52)
    axes.legend(
        loc="upper right", ncols=2, columnspacing=0.6, handlelength=1.2, handletextpad=0.4, fontsize=7.0
    )


def draw_one_way(panels, table: pd.DataFrame) -> None:
    """Three panels: where the left front stops, T_trans and L_trans, over the right level."""
    labels = {
        "stop": r"left front stops, $-x$",
        "time": r"exact $T_\mathrm{trans}$",
        "length": r"exact $L_\mathrm{trans}$",
    }
    rows = table[table["role"] == "one_way"]
    scene = rows.iloc[0]
    panels[1].set_title(rf"$\gamma = {scene['gamma']:g},\ b = {scene['damping_ratio']:g}$", fontsize=7.0)
    for axes, (quantity, label) in zip(panels, labels.items(), strict=True):
        groups = rows[rows["quantity"] == quantity].groupby("left")
        for left, line in groups:
            colour = colour_scale("tau_l").to_rgba(left)
            axes.plot(
                line["right"], line["exact"], color=colour, marker="o", markersize=2.0, label=setting(left),
                gid=f"{quantity} {left:g}",
            )  # fmt: skip
        axes.set(xlabel=r"$\tau_{0,r}$", ylabel=label)
        low, high = axes.get_ylim()
        axes.set_ylim(max(0.0, low), high + 0.35 * (high - low) * (quantity == "stop"))
    panels[0].legend(
        title=r"$\tau_{0,l}$", loc="upper center", ncols=4, columnspacing=0.5, handlelength=0.7, handletextpad=0.3,
        fontsize=7.0,
    )  # fmt: skip
    if (table["role"] == "limit").any():
        panels[1].text(
            0.05,
            0.95,
            "some exact solutions\nend early",
            transform=panels[1].transAxes,
            va="top",
            fontsize=7.0,
        )
