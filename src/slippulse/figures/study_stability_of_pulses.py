"""Pulses sent from one pre-stress into another: held displacement settles, imposed stress grows, decays or keeps."""

from __future__ import annotations

from collections.abc import Mapping

import matplotlib
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from ..data.numerals import setting
from ..data.points import point
from ..measure.pulses import leading_pulse
from ..model.scene import prestress_from
from ..predict.exact_rupture import exact_rupture
from ..theory.front_law import front_speed
from ..theory.pulse import SteadyPulse, steady_pulse
from ..theory.rupture import Rupture
from .style import GREY, PAGE, colour_scale, new_figure, panel_letter

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {"data": ["pulses_across_a_step", "regimes_beyond"], "settings": ["measure.front_window"]}

POINTS = 400
# Points of an exact curve, how far behind the step and beyond the finite memory it is drawn, and its rounding.
EXACT_POINTS, BEHIND, BEYOND, ROUNDING = 121, 10.0, 1.4, 2e-9


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Slip left behind over distance from the step (Gamma = 1), largest velocity over time (Gamma = 0).

    Parameters
    ----------
    data : pulses_across_a_step, regimes_beyond
    measured : not used
    settings : measure (front_window)

    Returns
    -------
    DataFrame of role slip (lattice; x: distance beyond the step, y: slip, steady: the new pulse's exact slip, width:
    its width, memory: the distance W_p/(v - 1) beyond which it is exactly steady), exact (the same of the
    exact solution),
    limit (x, y: where and when its construction ends, if it does) and velocity (x: time, y: largest slip velocity ahead
    of the step)
    """
    window = settings["measure"]["front_window"]
    parts = []
    sweep = data["pulses_across_a_step"]
    for index in range(sweep.sizes["point"]):
        run = point(sweep, index)
        profile = prestress_from(run.attrs)
        place, level = profile.steps[-1]
        ratio, gamma = run.attrs["damping_ratio"], run.attrs["gamma"]
        old_level = run.attrs["right"]
        # In the limit dx -> 0 damping acts through the speed alone.
        old, new = (
            steady_pulse(each, gamma, 0.0, float(front_speed(each, ratio, run.attrs["release"])))
            for each in (old_level, level)
        )
        pulse = leading_pulse(run, window)
        x = run["x"].values
        # Up to two widths behind the trailing edge, where blocks have stuck.
        inside = np.flatnonzero((x > place - 10.0) & (x < pulse.front - 1.05 * pulse.width))
        kept = inside[:: max(1, inside.size // POINTS)]
        common = {"before": old_level, "level": level, "gamma": gamma, "run_flags": run.attrs["run_flags"]}
        common |= {"steady": new.slip, "steady_before": old.slip, "width": new.width, "memory": memory(new)}
        rows = pd.DataFrame({"x": x[kept] - place, "y": run["slip"].values[kept]})
        parts.append(rows.assign(role="slip", dx=run.attrs["dx"], **common))
        parts.append(_exact(exact_rupture(run.attrs), place, memory(new)).assign(**common))
    sweep = data["regimes_beyond"]
    for index in range(sweep.sizes["point"]):
        run = point(sweep, index)
        profile = prestress_from(run.attrs)
        place, level = profile.steps[-1]
        ahead = run["sample_position"].values > 0.0
        largest = run["sample_velocity"].values[:, ahead].max(axis=1)
        parts.append(
            pd.DataFrame({"x": run["sample_time"].values, "y": largest}).assign(
                role="velocity", before=run.attrs["right"], left=run.attrs["left"], level=level, place=place,
                run_flags=run.attrs["run_flags"],
            )
        )  # fmt: skip
    return pd.concat(parts, ignore_index=True)


def memory(pulse: SteadyPulse) -> float:
    """How far a pulse remembers a change of level: the past of its trailing edge reaches no farther."""
    return pulse.width / (pulse.speed - 1.0)


def _exact(rupture: Rupture, place: float, reach: float) -> pd.DataFrame:
    """Final slip of the exact solution around a step, and where its construction ends."""
    beyond = np.linspace(reach, BEYOND * reach, 21)[1:]
    x = np.concatenate([np.linspace(-BEHIND, 0.0, 21), np.linspace(0.0, reach, EXACT_POINTS)[1:], beyond])
    rows = pd.DataFrame({"x": x, "y": rupture.final_slip(place + x), "role": "exact"}).dropna(subset="y")
    if rupture.limit:
        end = {"x": rupture.limit.x - place, "y": rupture.limit.time, "role": "limit"}
        rows = pd.concat([rows, pd.DataFrame([end])])
    return rows


def relaxation_length(x: np.ndarray, y: np.ndarray, steady: float) -> float:
    """Distance beyond a step after which the slip stays within 1 % of the new pulse's; NaN if it never does."""
    beyond = x > 0.0
    off = np.flatnonzero(np.abs(y[beyond] / steady - 1.0) > 0.01)
    if off.size == 0:
        return 0.0
    return float(x[beyond][off[-1] + 1]) if off[-1] + 1 < np.count_nonzero(beyond) else float("nan")


def plot(table: pd.DataFrame) -> Figure:
    """(a) slip across the step, (b) how far from the new steady pulse, (c) largest velocity under imposed stress."""
    figure = new_figure(PAGE, 2.9)
    slip_axes, rest_axes, velocity_axes = figure.subplots(1, 3)
    slip = table[table["role"] == "slip"]
    exact = table[table["role"] == "exact"]
    for level, rows in slip.groupby("level"):
        colour = colour_scale("tau_0").to_rgba(level)
        steady, reach = rows["steady"].iloc[0], rows["memory"].iloc[0]
        line = exact[exact["level"] == level].sort_values("x")
        slip_axes.plot(line["x"], line["y"], color=colour, label=f"{level:g}", gid=f"exact {level:g}")
        shown = rows[rows["x"] < line["x"].max()].iloc[::5]
        slip_axes.plot(
            shown["x"], shown["y"], "o", color=colour, markersize=1.8, markerfacecolor="white", markeredgewidth=0.5,
            gid=f"slip {level:g}",
        )  # fmt: skip
        slip_axes.plot(
            reach, steady, "|", color=colour, markersize=9.0, markeredgewidth=1.2, gid=f"memory {level:g}"
        )
        for part, style, width in ((line, "-", 1.1), (rows, ":", 0.9)):
            beyond = part[part["x"] > 0.0]
            rest = np.maximum(np.abs(beyond["y"] / steady - 1.0), ROUNDING)
            rest_axes.plot(
                beyond["x"] / reach, rest, style, color=colour, linewidth=width,
                gid=f"{'rest' if part is line else 'lattice rest'} {level:g}",
            )  # fmt: skip
    before = slip["before"].iloc[0]
    slip_axes.axvline(0.0, color=GREY, linewidth=0.6, linestyle=":")
    slip_axes.set(xlabel=r"distance beyond the step $x$", ylabel=r"slip left behind $u$")
    slip_axes.set_title(rf"$\Gamma = 1$, $\tau_0 = {before:g}$ before")
    slip_axes.plot([], [], "|", color="0.3", markersize=7.0, label="finite memory")
    dx = slip["dx"].iloc[0]
    slip_axes.plot([], [], "o", color="0.3", markersize=2.0, label=rf"lattice, $\Delta x = {dx:g}$")
    top = float(exact["y"].max())
    slip_axes.set_ylim(None, 1.75 * top)
    slip_axes.legend(
        title=r"exact, $\tau_0$ beyond", loc="upper right", ncols=2, columnspacing=0.8,
        frameon=True, framealpha=1.0, edgecolor="none",
    )  # fmt: skip
    rest_axes.axvline(1.0, color=GREY, linewidth=0.9, linestyle="--")
    for style, label in (("-", "exact"), (":", "lattice")):
        rest_axes.plot([], [], style, color="0.3", label=label)
    rest_axes.set(
        yscale="log",
        xlabel=r"distance / $W_\mathrm{p}/(v - 1)$",
        ylabel="|slip / new steady slip $-$ 1|",
        title=r"$\Gamma = 1$, finite memory",
        xlim=(0.0, BEYOND),
        ylim=(0.3 * ROUNDING, 30.0),
    )
    rest_axes.legend(loc="lower left")
    if (table["role"] == "limit").any():
        slip_axes.text(0.02, 0.02, "exact solution ends early", transform=slip_axes.transAxes, fontsize=7.0)
    velocity = table[table["role"] == "velocity"]
    left = velocity["left"].min()
    shown = velocity[velocity["left"] == left]
    levels = np.sort(shown["level"].unique())
    colours = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.92, levels.size))
    for colour, level in zip(colours, levels, strict=True):
        rows = shown[(shown["level"] == level) & (shown["y"] > 0.0)]
        velocity_axes.plot(
            rows["x"], rows["y"], color=colour, marker="o", markersize=2.0,
            label=setting(level), gid=f"velocity {level:g}",
        )  # fmt: skip
    place = shown["place"].iloc[0]
    velocity_axes.axvline(place, color=GREY, linewidth=0.6, linestyle=":")
    velocity_axes.text(place, 0.02, " step", transform=velocity_axes.get_xaxis_transform(), fontsize=7.0)
    velocity_axes.set(
        yscale="log",
        xlabel=r"time $t$",
        ylabel=r"largest slip velocity, $x > 0$",
        title=rf"$\Gamma = 0$, $\tau = {shown['before'].iloc[0]:g}$ before",
    )
    positive = shown.loc[shown["y"] > 0.0, "y"]
    velocity_axes.set_ylim(max(1e-2, positive.min()), 40.0 * positive.max())
    velocity_axes.legend(title=r"$\tau$ beyond", ncols=3, fontsize=7.0, loc="upper left", columnspacing=0.6)
    for axes, letter in zip((slip_axes, rest_axes, velocity_axes), "abc", strict=True):
        panel_letter(axes, letter)
    return figure
