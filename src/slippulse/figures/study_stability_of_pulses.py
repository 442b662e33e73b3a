"""Pulses sent from one pre-stress into another: held displacement settles, imposed stress grows, decays or keeps."""

from __future__ import annotations

from collections.abc import Mapping

import matplotlib
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from ..data.points import point
from ..measure.pulses import leading_pulse
from ..model.scene import prestress_from
from ..texts.numerals import setting
from ..theory.front_law import front_speed
from ..theory.pulse import steady_pulse
from .style import CYCLE, GREY, PAGE, new_figure, panel_letter

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {"data": ["pulses_across_a_step", "regimes_beyond"], "settings": ["measure.front_window"]}

POINTS = 400


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
    DataFrame of role slip (x: distance beyond the step, y: slip, steady: the new pulse's exact slip), width (of the new
    steady pulse) and velocity (x: time, y: largest slip velocity ahead of the step)
    """
    window = settings["measure"]["front_window"]
    parts = []
    sweep = data["pulses_across_a_step"]
    for index in range(sweep.sizes["point"]):
        run = point(sweep, index)
        profile = prestress_from(run.attrs)
        place, level = profile.steps[-1]
        ratio, gamma = run.attrs["damping_ratio"], run.attrs["gamma"]
        new = steady_pulse(
            level, gamma, run.attrs["beta"], float(front_speed(level, ratio, run.attrs["release"]))
        )
        old_level = run.attrs["right"]
        old = steady_pulse(
            old_level, gamma, run.attrs["beta"], float(front_speed(old_level, ratio, run.attrs["release"]))
        )
        pulse = leading_pulse(run, window)
        x = run["x"].values
        # Up to two widths behind the trailing edge, where blocks have stuck.
        inside = np.flatnonzero((x > place - 10.0) & (x < pulse.front - 1.05 * pulse.width))
        kept = inside[:: max(1, inside.size // POINTS)]
        common = {"before": old_level, "level": level, "gamma": gamma, "flags": run.attrs["flags"]}
        parts.append(
            pd.DataFrame({"x": x[kept] - place, "y": run["slip"].values[kept]}).assign(
                role="slip", steady=new.slip, steady_before=old.slip, width=new.width, **common
            )
        )
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
                flags=run.attrs["flags"],
            )
        )  # fmt: skip
    return pd.concat(parts, ignore_index=True)


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
    for colour, (level, rows) in zip(CYCLE, slip.groupby("level"), strict=False):
        steady = rows["steady"].iloc[0]
        settled = relaxation_length(rows["x"].to_numpy(), rows["y"].to_numpy(), steady)
        slip_axes.plot(rows["x"], rows["y"], color=colour, label=f"{level:g}", gid=f"slip {level:g}")
        slip_axes.plot(
            [0.0, rows["x"].max()],
            [steady] * 2,
            color=colour,
            linewidth=0.7,
            linestyle="--",
            gid=f"steady {level:g}",
        )
        beyond = rows[rows["x"] > 0.0]
        rest_axes.plot(
            beyond["x"] / beyond["width"], np.abs(beyond["y"] / steady - 1.0), color=colour,
            label=f"{level:g}: 1 % after {settled / rows['width'].iloc[0]:.0f}", gid=f"rest {level:g}",
        )  # fmt: skip
    before = slip["before"].iloc[0]
    slip_axes.axvline(0.0, color=GREY, linewidth=0.6, linestyle=":")
    slip_axes.set(xlabel=r"distance beyond the step $\bar x$", ylabel=r"slip left behind $\bar u$")
    slip_axes.set_title(rf"$\Gamma = 1$, $\bar\tau_0 = {before:g}$ before")
    slip_axes.legend(title=r"$\bar\tau_0$ beyond", loc="center right", bbox_to_anchor=(1.0, 0.35))
    rest_axes.axhline(0.01, color=GREY, linewidth=0.6, linestyle=":")
    rest_axes.set(
        yscale="log",
        xlabel="distance / width of the new pulse",
        ylabel="|slip / new steady slip $-$ 1|",
        title=r"$\Gamma = 1$, relaxation",
    )
    rest_axes.legend(fontsize=6.0)
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
    velocity_axes.text(place, 0.02, " step", transform=velocity_axes.get_xaxis_transform(), fontsize=6.0)
    velocity_axes.set(
        yscale="log",
        xlabel=r"time $\bar t$",
        ylabel=r"largest slip velocity, $\bar x > 0$",
        title=rf"$\Gamma = 0$, $\bar\tau = {shown['before'].iloc[0]:g}$ before",
    )
    positive = shown.loc[shown["y"] > 0.0, "y"]
    velocity_axes.set_ylim(max(1e-2, positive.min()), 6.0 * positive.max())
    velocity_axes.legend(
        title=r"$\bar\tau$ beyond", ncols=3, fontsize=5.5, loc="upper left", columnspacing=0.6
    )
    for axes, letter in zip((slip_axes, rest_axes, velocity_axes), "abc", strict=True):
        panel_letter(axes, letter)
    return figure
