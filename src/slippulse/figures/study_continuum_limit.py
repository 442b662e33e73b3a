"""Refining the lattice at fixed beta/dx and at fixed beta: what converges, to what, at what order."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from ..model.scene import prestress_from
from ..theory.exact_transition import exact_transition_displacement
from ..theory.front_law import front_speed, front_speed_undamped
from ..theory.pulse import steady_pulse
from .style import BLACK, BLUE, GREEN, GREY, ORANGE, PAGE, new_figure, panel_letter

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {"measured": ["continuum_fixed_ratio", "continuum_fixed_beta"]}

SERIES = {
    "fixed ratio, total": (BLUE, "o", r"fixed $b = %g$, %s"),
    "fixed beta, total": (ORANGE, "s", r"fixed $\beta = %g$, %s"),
    "fixed beta, elastic": (GREEN, "^", r"fixed $\beta = %g$, %s"),
}
# Columns of the measured table, as the error panel names them.
ERRORS = {
    "front_speed_right": ("front speed", "o"),
    "pulse_peak_velocity": ("largest velocity", "s"),
    "pulse_slip": ("slip", "^"),
    "pulse_width": ("width", "D"),
    "transition_time": (r"$T_\mathrm{trans}$", "v"),
    "transition_length": (r"$L_\mathrm{trans}$", "P"),
}


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Measured numbers over dx with the theory for the same beta/dx, and the limits.

    Parameters
    ----------
    data : not used
    measured : continuum_fixed_ratio and continuum_fixed_beta
    settings : not used

    Returns
    -------
    DataFrame of role simulation (quantity, value, theory; ``fixed`` is what is held), and limit
    """
    parts = []
    for held, column in (("ratio", "damping_ratio"), ("beta", "beta")):
        for _, run in measured[f"continuum_fixed_{held}"].iterrows():
            theory = _theory(run, continuum=held == "ratio")
            for quantity in ERRORS:
                parts.append(
                    {
                        "role": "simulation",
                        "series": f"fixed {held}, {run['release']}",
                        "quantity": quantity,
                        "dx": run["dx"],
                        "value": run[quantity],
                        "theory": theory.get(quantity, np.nan),
                        "fixed": run[column],
                        "release": run["release"],
                        "run_flags": run["run_flags"],
                    }
                )
    tau0 = float(measured["continuum_fixed_ratio"]["left"].iloc[0])
    for series, value in (
        ("no damping", float(front_speed_undamped(tau0))),
        ("elastic, strong damping", 1.0 / np.sqrt(1.0 - tau0)),
    ):
        parts.append({"role": "limit", "series": series, "quantity": "front_speed_right", "value": value})
    return pd.DataFrame(parts)


def _theory(run: pd.Series, continuum: bool) -> dict[str, float]:
    """Exact values: of the front and of the pulse at this dx, of the transition in the continuum limit."""
    speed = float(front_speed(run["left"], run["damping_ratio"], run["release"]))
    # In the limit at fixed beta/dx beta itself vanishes.
    pulse = steady_pulse(run["left"], run["gamma"], 0.0 if continuum else run["beta"], speed)
    out = {
        "front_speed_right": speed,
        "pulse_peak_velocity": pulse.peak_velocity,
        "pulse_slip": pulse.slip,
        "pulse_width": pulse.width,
    }
    if continuum:
        exact = exact_transition_displacement(
            prestress_from(run), run["gamma"], run["damping_ratio"], run["release"]
        )
        out |= {"transition_time": exact.time, "transition_length": exact.length}
    return out


def plot(table: pd.DataFrame) -> Figure:
    """(a) front speed over dx for what is held; (b) errors at fixed beta/dx against the continuum; (c) their order."""
    figure = new_figure(PAGE, 2.9)
    speed_axes, error_axes = figure.subplots(1, 2)
    runs = table[table["role"] == "simulation"]
    for name, (colour, marker, label) in SERIES.items():
        rows = runs[(runs["series"] == name) & (runs["quantity"] == "front_speed_right")].sort_values("dx")
        text = label % (rows["fixed"].iloc[0], rows["release"].iloc[0])
        speed_axes.plot(rows["dx"], rows["theory"], color=colour, gid=f"theory {name}")
        speed_axes.plot(
            rows["dx"], rows["value"], marker=marker, linestyle="none", color=colour, label=text, gid=name
        )
    for (_, limit), style in zip(table[table["role"] == "limit"].iterrows(), ("--", ":"), strict=True):
        speed_axes.axhline(limit["value"], color=BLACK, linewidth=0.8, linestyle=style, label=limit["series"])
    speed_axes.set(xscale="log", xlabel=r"spacing $\Delta x$", ylabel=r"front speed $v$")
    speed_axes.legend(loc="upper right")
    panel_letter(speed_axes, "a")
    speed_axes.set_title("lines: exact theory")

    fixed = runs[runs["series"] == "fixed ratio, total"]
    for quantity, (label, marker) in ERRORS.items():
        rows = fixed[fixed["quantity"] == quantity].sort_values("dx")
        error = np.abs(rows["value"] / rows["theory"] - 1.0)
        order = np.polyfit(np.log(rows["dx"]), np.log(error), 1)[0]
        error_axes.plot(rows["dx"], error, marker=marker, label=f"{label}, order {order:.1f}", gid=quantity)
    dx = np.sort(fixed["dx"].unique())[[0, -1]]
    error_axes.plot(dx, 0.05 * dx / dx[-1], color=GREY, linestyle="--", linewidth=0.8, label="first order")
    error_axes.set(
        xscale="log",
        yscale="log",
        xlabel=r"spacing $\Delta x$",
        ylabel=r"|simulation/continuum $-$ 1|",
        title=r"fixed $b$",
    )
    error_axes.set_ylim(1e-8, 0.1)
    error_axes.legend(loc="lower right")
    panel_letter(error_axes, "b")
    return figure
