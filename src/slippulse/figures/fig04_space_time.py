"""Slip velocity over time and position: a crack that becomes two pulses, and one that becomes one."""

from __future__ import annotations

from collections.abc import Mapping

import matplotlib.patheffects as effects
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from ..data.points import point
from ..measure.fronts import position_at
from ..predict.exact_rupture import exact_rupture
from .shared.space_time import STUCK, draw_map, draw_profile, edges, prestress_profile, velocity_map
from .style import BLACK, COLUMN, ORANGE, PURPLE, new_figure, panel_letter

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {
    "data": ["space_time_displacement", "space_time_stress"],
    "measured": ["space_time_displacement", "space_time_stress"],
}

PANELS = {"displacement": "a", "stress": "b"}
PARAMETERS = ("left", "right", "width", "gamma", "damping_ratio", "dx")
EXACT_POINTS = 241
HALO = [effects.withStroke(linewidth=2.2, foreground="white")]


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Everything that the figure draws.

    Parameters
    ----------
    data : sweeps space_time_displacement and space_time_stress, of which the first run is drawn
    measured : their measured numbers
    settings : not used, the numbers are measured already

    Returns
    -------
    DataFrame with panel ("displacement" or "stress"), role, series, time, position, value. Roles: map (value: slip
    velocity), prestress (value: tau), front and trailing (time of first release and last stick, NaN where never),
    measured, paper and last_release (transition: its time, where the left and right fronts are then; value: the
    length), exact_front and exact_trailing (of the continuum limit, where it has a trailing edge), limit (where that
    construction ends, if it does), parameter (value), largest (value: largest slip velocity; where
    and when), flag (series: the flags).
    """
    parts = []
    for panel in PANELS:
        name = f"space_time_{panel}"
        run, numbers = point(data[name], 0), measured[name].iloc[0]
        parts += [
            frame.assign(panel=panel)
            for frame in (
                _parameters(run),
                velocity_map(run),
                prestress_profile(run),
                *edges(run),
                _transition(run, numbers),
                _exact_edges(run),
            )
        ]
    columns = ["panel", "role", "series", "time", "position", "value"]
    return pd.concat(parts, ignore_index=True).reindex(columns=columns)


def _parameters(run: xr.Dataset) -> pd.DataFrame:
    rows = [{"role": "parameter", "series": name, "value": run.attrs[name]} for name in PARAMETERS]
    if run.attrs["run_flags"]:
        rows.append({"role": "flag", "series": run.attrs["run_flags"]})
    return pd.DataFrame(rows)


def _exact_edges(run: xr.Dataset) -> pd.DataFrame:
    """Fronts and trailing edge of the exact solution; nothing where nothing sticks."""
    if run.attrs["boundary"] == "stress":
        return pd.DataFrame({"role": []})
    rupture = exact_rupture(run.attrs)
    ends = rupture.front_ends
    x = np.linspace(ends[0][0].x, ends[-1][1].x, EXACT_POINTS)[1:-1]
    parts = [
        pd.DataFrame({"role": role, "position": x, "time": time}).dropna()
        for role, time in (
            ("exact_front", rupture.release_time(x)),
            ("exact_trailing", rupture.stick_time(x)),
        )
    ]
    if rupture.limit:
        parts.append(
            pd.DataFrame([{"role": "limit", "position": rupture.limit.x, "time": rupture.limit.time}])
        )
    return pd.concat(parts)


def _transition(run: xr.Dataset, numbers: pd.Series) -> pd.DataFrame:
    """Where the fronts are at T_trans: as measured, as the paper estimates it, at the last release; if at all."""
    if "transition_time" not in numbers:
        return pd.DataFrame({"role": []})
    time, length = numbers["transition_time"], numbers["transition_length"]
    right = float(position_at(run, time, "right"))
    half = 0.5 * numbers["paper_transition_length"]
    ends = {
        "measured": (time, right - length, right, length),
        "paper": (numbers["paper_transition_time"], -half, half, 2.0 * half),
    }
    if "last_release_time" in numbers:
        distance, length = numbers["last_release_distance"], numbers["last_release_length"]
        ends["last_release"] = (numbers["last_release_time"], -distance, length - distance, length)
    rows = []
    for role, (time, lower, upper, length) in ends.items():
        for series, position in (("left", lower), ("right", upper)):
            rows.append({"role": role, "series": series, "time": time, "position": position, "value": length})
    return pd.DataFrame(rows)


def plot(table: pd.DataFrame) -> Figure:
    """Draw the figure from its table."""
    figure = new_figure(COLUMN, 5.6)
    figure.get_layout_engine().set(wspace=0.01, w_pad=0.03)
    maps = []
    for side, (panel, letter) in zip(figure.subfigures(2, 1), PANELS.items(), strict=True):
        profile, space_time = side.subplots(1, 2, sharey=True, width_ratios=(0.27, 1.0))
        chosen = table[table["panel"] == panel]
        roles = {role: rows for role, rows in chosen.groupby("role")}
        draw_profile(profile, roles["prestress"])
        image = draw_map(space_time, roles)
        _draw_exact(space_time, roles)
        _draw_transition(space_time, roles)
        largest = roles["largest"]["value"].iloc[0]
        bar = side.colorbar(image, ax=space_time, pad=0.02, aspect=22)
        bar.set_label(rf"slip velocity $\dot u$ (largest {largest:#.3g})")
        profile.set_ylabel(r"position $x$")
        panel_letter(profile, letter)
        side.suptitle(_title(roles), fontsize=9.0)
        maps.append(space_time)
    figure.legend(
        handles=_legend(maps), loc="outside lower center", ncols=3, handlelength=1.6, columnspacing=1.0
    )
    return figure


def _title(roles: Mapping[str, pd.DataFrame]) -> str:
    value = roles["parameter"].set_index("series")["value"]
    parts = [rf"$\Gamma = {int(value['gamma'] > 0.0)}$"]
    if value["gamma"] > 0.0:
        parts.append(rf"$\gamma = {value['gamma']:g}$")
    if value["left"] == value["right"]:
        parts.append(rf"$\tau_0 = {value['left']:g}$")
    else:
        parts += [rf"$\tau_{{0,l}} = {value['left']:g}$", rf"$\tau_{{0,r}} = {value['right']:g}$"]
    parts.append(rf"$W = {value['width']:g}$")
    if "flag" in roles:
        parts.append(f"flagged: {roles['flag']['series'].iloc[0]}")
    return ", ".join(parts)


def _draw_exact(axes, roles: Mapping[str, pd.DataFrame]) -> None:
    for role, label in (("exact_front", "exact"), ("exact_trailing", None)):
        if role in roles:
            rows = roles[role].sort_values("position")
            axes.plot(
                rows["time"], rows["position"], color=PURPLE, linewidth=1.1, linestyle=(0, (1, 1)), zorder=2.5,
                label=label, gid=role,
            )  # fmt: skip
    if "limit" in roles:
        axes.text(0.98, 0.02, "exact solution ends early", transform=axes.transAxes, ha="right", fontsize=7.0)


def _draw_transition(axes, roles: Mapping[str, pd.DataFrame]) -> None:
    low = min(rows["position"].min() for rows in (roles["prestress"], roles["map"]))
    level = 0.5 * (low + roles["front"]["position"].min())
    # A run that is too short for its transition has none to draw.
    if "measured" in roles and np.isfinite(roles["measured"]["time"]).all():
        _draw_arrows(axes, roles["measured"].set_index("series"), level)
    marker = {"linestyle": "none", "markeredgewidth": 0.8, "markersize": 4.5, "zorder": 5.0}
    for role, symbol, face, label in (
        ("paper", "D", ORANGE, "paper's estimate"),
        ("last_release", "o", "white", "last release"),
    ):
        if role in roles:
            rows = roles[role]
            rows = rows if role == "paper" else rows[rows["series"] == "left"]
            axes.plot(
                rows["time"],
                rows["position"],
                symbol,
                color=face,
                markeredgecolor=BLACK,
                label=label,
                **marker,
            )


def _legend(panels) -> list:
    """Each line and marker of the panels once, and what white and grey are."""
    handles = {
        line.get_label(): line
        for axes in panels
        for line in axes.lines
        if not line.get_label().startswith("_")
    }
    patches = [
        Patch(facecolor=colour, edgecolor=BLACK, linewidth=0.5, label=label)
        for colour, label in (("white", "not yet slipped"), (STUCK, "stuck again"))
    ]
    return [*handles.values(), *patches]


def _draw_arrows(axes, ends: pd.DataFrame, level: float) -> None:
    time, length = float(ends["time"].iloc[0]), float(ends["value"].iloc[0])
    left, right = float(ends.loc["left", "position"]), float(ends.loc["right", "position"])
    arrow = {"arrowstyle": "<->", "shrinkA": 0.0, "shrinkB": 0.0, "linewidth": 0.9, "mutation_scale": 8.0}
    axes.plot([time, time], [level, left], color=BLACK, linewidth=0.6, linestyle=":", zorder=3.0)
    beside = time + 0.025 * axes.get_xlim()[1]
    for name, value, height, start, stop in (
        ("T", time, level, (0.0, level), (time, level)),
        ("L", length, 0.5 * (left + right), (time, left), (time, right)),
    ):
        axes.annotate("", xy=stop, xytext=start, arrowprops=arrow | {"path_effects": HALO}, zorder=4.0)
        label = rf"${name}_\mathrm{{trans}} = {value:#.3g}$"
        axes.text(beside, height, label, va="center", fontsize=8.5, path_effects=HALO, zorder=4.0)
