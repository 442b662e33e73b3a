"""The steady pulse against damping: the paper's formulas, the damped theory, simulations."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from ..theory.front_law import front_speed
from ..theory.pulse import paper_pulse, steady_pulse
from .style import GREY, PAGE, colour_scale, new_figure, panel_letter

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {"measured": ["pulse_damping"]}

QUANTITIES = {
    "peak_velocity": r"largest slip velocity",
    "width": r"width",
    "slip": r"final slip",
}
POINTS = 41


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Peak velocity, width and slip of each simulated pulse with theory beside it, and theory over beta/dx.

    Parameters
    ----------
    data : not used
    measured : pulse_damping
    settings : not used
    """
    runs = measured["pulse_damping"]
    parts = []
    for _, run in runs.iterrows():
        exact = _exact(run["left"], run["gamma"], run["damping_ratio"], run["dx"], run["release"])
        paper = paper_pulse(run["left"], run["gamma"])
        for quantity in QUANTITIES:
            parts.append(
                {
                    "role": "simulation",
                    "quantity": quantity,
                    "tau0": run["left"],
                    "damping_ratio": run["damping_ratio"],
                    "dx": run["dx"],
                    "y": run[f"pulse_{quantity}"],
                    "theory": getattr(exact, quantity),
                    "paper": getattr(paper, quantity),
                    "run_flags": run["run_flags"],
                }
            )
    gamma, dx, release = runs["gamma"].iloc[0], runs["dx"].iloc[0], runs["release"].iloc[0]
    for tau0 in np.unique(runs["left"]):
        paper = paper_pulse(tau0, gamma)
        for ratio in np.linspace(0.0, float(runs["damping_ratio"].max()), POINTS):
            exact = _exact(tau0, gamma, ratio, dx, release)
            for quantity in QUANTITIES:
                row = {"role": "theory", "quantity": quantity, "tau0": tau0, "damping_ratio": ratio, "dx": dx}
                parts.append(row | {"y": getattr(exact, quantity), "paper": getattr(paper, quantity)})
    return pd.DataFrame(parts)


def _exact(tau0: float, gamma: float, ratio: float, dx: float, release: str):
    speed = float(front_speed(tau0, ratio, release))
    return steady_pulse(tau0, gamma, ratio * dx, speed)


def plot(table: pd.DataFrame) -> Figure:
    """Above: each quantity in units of the paper's formula; below: simulation against the damped theory."""
    figure = new_figure(PAGE, 4.1)
    grid = figure.subplots(2, 3, sharex=True, height_ratios=(2.0, 1.0))
    for column, (quantity, label) in enumerate(QUANTITIES.items()):
        axes, rest = grid[:, column]
        axes.axhline(1.0, color=GREY, linewidth=0.8, linestyle="--", label="paper")
        for tau0, rows in table[table["quantity"] == quantity].groupby("tau0"):
            colour = colour_scale("tau_0").to_rgba(tau0)
            theory, runs = rows[rows["role"] == "theory"], rows[rows["role"] == "simulation"]
            axes.plot(
                theory["damping_ratio"], theory["y"] / theory["paper"], color=colour, gid=f"theory {tau0:g}",
                label=rf"theory, $\tau_0 = {tau0:g}$",
            )  # fmt: skip
            for flagged, group in runs.groupby(runs["run_flags"].notna()):
                look = {"linestyle": "none", "marker": "o", "color": colour}
                look |= {"markerfacecolor": "none"} if flagged else {}
                x = group["damping_ratio"]
                axes.plot(x, group["y"] / group["paper"], gid=f"simulation {tau0:g}", **look)
                rest.plot(x, np.abs(group["y"] / group["theory"] - 1.0), **look)
        axes.set_ylabel(f"{label} / paper's formula")
        axes.set_xlim(-0.02, None)
        rest.set_yscale("log")
        rest.set_xlabel(r"damping ratio $b$")
        panel_letter(axes, "abc"[column])
    grid[0, 2].plot([], [], color=GREY, marker="o", linestyle="none", label="simulation")
    handles, labels = grid[0, 2].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels), columnspacing=1.0)
    grid[1, 0].set_ylabel("|simulation/theory\n" + r"$-\,1|$", linespacing=0.9)
    return figure
