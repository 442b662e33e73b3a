"""Slip velocity over time and position: a crack that becomes two pulses, and one that becomes one."""

from __future__ import annotations

from collections.abc import Mapping

import matplotlib
import matplotlib.patheffects as effects
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from ..measure.fronts import position_at
from ..sweep import point
from .style import BLACK, GREY, ORANGE, PAGE, VELOCITY_MAP, new_figure, panel_letter

PANELS = (("displacement", "a", 1), ("stress", "b", 0))
PARAMETERS = ("left", "right", "width", "gamma", "damping_ratio", "dx")
# Samples kept along each axis of a map, and blocks along each front.
MAP_SAMPLES, FRONT_POINTS = 201, 300
# Share of the slipped length that is drawn beyond it on each side: room for the arrow of T_trans.
MARGIN = 0.12
STUCK = "#cfcfcf"
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
    length), parameter (value), largest (value: largest slip velocity; where and when), flag (series: the flags).
    """
    parts = []
    for panel, *_ in PANELS:
        name = f"space_time_{panel}"
        run, numbers = point(data[name], 0), measured[name].iloc[0]
        parts += [
            frame.assign(panel=panel)
            for frame in (
                _parameters(run),
                _map(run),
                _prestress(run),
                *_edges(run),
                _transition(run, numbers),
            )
        ]
    columns = ["panel", "role", "series", "time", "position", "value"]
    return pd.concat(parts, ignore_index=True).reindex(columns=columns)


def _limits(run: xr.Dataset) -> tuple[float, float]:
    """Positions that are drawn: what slips and a margin, or as far as samples go where slip goes farther."""
    slipped = run["x"].values[np.isfinite(run["release_time"].values)]
    first, last = run["sample_position"].values[[0, -1]]
    margin = MARGIN * (slipped[-1] - slipped[0])
    lower = slipped[0] - margin if slipped[0] > first else first
    upper = slipped[-1] + margin if slipped[-1] < last else last
    return float(lower), float(upper)


def _thin(size: int, most: int) -> np.ndarray:
    """Regularly spaced indices, at most ``most`` of them."""
    return np.arange(0, size, max(1, int(np.ceil(size / most))))


def _parameters(run: xr.Dataset) -> pd.DataFrame:
    rows = [{"role": "parameter", "series": name, "value": run.attrs[name]} for name in PARAMETERS]
    if run.attrs["flags"]:
        rows.append({"role": "flag", "series": run.attrs["flags"]})
    return pd.DataFrame(rows)


def _map(run: xr.Dataset) -> pd.DataFrame:
    lower, upper = _limits(run)
    x, times = run["sample_position"].values, run["sample_time"].values
    velocity = run["sample_velocity"].values
    inside = np.flatnonzero((x >= lower) & (x <= upper))
    columns, rows = inside[_thin(inside.size, MAP_SAMPLES)], _thin(times.size, MAP_SAMPLES)
    time, position = np.meshgrid(times[rows], x[columns], indexing="ij")
    kept = velocity[np.ix_(rows, columns)]
    # Four digits of the largest velocity are more than a colour shows, and keep the table small.
    digits = 4 - int(np.floor(np.log10(np.max(velocity))))
    grid = pd.DataFrame(
        {
            "role": "map",
            "time": time.ravel(),
            "position": position.ravel(),
            "value": kept.ravel().round(digits),
        }
    )
    at = np.unravel_index(int(np.argmax(velocity)), velocity.shape)
    largest = {"role": "largest", "time": times[at[0]], "position": x[at[1]], "value": velocity[at]}
    return pd.concat([grid, pd.DataFrame([largest])])


def _prestress(run: xr.Dataset) -> pd.DataFrame:
    lower, upper = _limits(run)
    x, tau = run["x"].values, run["prestress"].values
    inside = np.flatnonzero((x >= lower) & (x <= upper))
    kept = np.union1d(inside[_thin(inside.size, 2 * FRONT_POINTS)], np.argmax(tau))
    # The levels go on beyond the lattice, which ends where the fronts do.
    x = np.concatenate([[lower], x[kept], [upper]])
    tau = np.concatenate([[tau[kept[0]]], tau[kept], [tau[kept[-1]]]])
    return pd.DataFrame({"role": "prestress", "position": x, "value": tau})


def _edges(run: xr.Dataset) -> list[pd.DataFrame]:
    x = run["x"].values
    slipped = np.flatnonzero(np.isfinite(run["release_time"].values))
    kept = np.union1d(slipped[_thin(slipped.size, 2 * FRONT_POINTS)], slipped[-1:])
    return [
        pd.DataFrame({"role": role, "position": x[kept], "time": run[edge].values[kept]})
        for role, edge in (("front", "release_time"), ("trailing", "stick_time"))
    ]


def _transition(run: xr.Dataset, numbers: pd.Series) -> pd.DataFrame:
    """Where the fronts are at T_trans: as measured, as the paper estimates it, and at the last release."""
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
    figure = new_figure(PAGE, 3.35)
    figure.get_layout_engine().set(wspace=0.01, w_pad=0.03)
    for side, (panel, letter, boundary) in zip(figure.subfigures(1, 2, wspace=0.03), PANELS, strict=True):
        profile, space_time = side.subplots(1, 2, sharey=True, width_ratios=(0.27, 1.0))
        chosen = table[table["panel"] == panel]
        roles = {role: rows for role, rows in chosen.groupby("role")}
        _draw_profile(profile, roles["prestress"])
        image = _draw_map(space_time, roles)
        _draw_transition(space_time, roles)
        largest = roles["largest"]["value"].iloc[0]
        bar = side.colorbar(image, ax=space_time, location="top", aspect=32, pad=0.02)
        bar.set_label(rf"slip velocity $\dot{{\bar u}}$ (largest {largest:.3f})")
        profile.set_ylabel(r"position $\bar x$")
        panel_letter(profile, letter)
        side.suptitle(_title(roles, boundary), fontsize=8.0)
    return figure


def _title(roles: Mapping[str, pd.DataFrame], boundary: int) -> str:
    value = roles["parameter"].set_index("series")["value"]
    parts = [rf"$\Gamma = {boundary}$"]
    if boundary:
        parts.append(rf"$\bar\gamma = {value['gamma']:g}$")
    if value["left"] == value["right"]:
        parts.append(rf"$\bar\tau_0 = {value['left']:g}$")
    else:
        parts += [rf"$\bar\tau_{{0,l}} = {value['left']:g}$", rf"$\bar\tau_{{0,r}} = {value['right']:g}$"]
    parts.append(rf"$\bar W_{{\bar\tau}} = {value['width']:g}$")
    if "flag" in roles:
        parts.append(f"flagged: {roles['flag']['series'].iloc[0]}")
    return ", ".join(parts)


def _draw_profile(axes, rows: pd.DataFrame) -> None:
    axes.axvline(0.0, color=GREY, linewidth=0.6, linestyle=":")
    axes.plot(rows["value"], rows["position"], color=BLACK)
    axes.set_xlabel(r"$\bar\tau$")
    lower, upper = rows["value"].min(), rows["value"].max()
    axes.set_xlim(min(0.0, lower) - 0.15, upper + 0.15)
    # The levels far away and the peak.
    ticks = sorted({round(float(value), 2) for value in (*rows["value"].iloc[[0, -1]], upper)})
    axes.set_xticks(ticks, [f"{value:g}".replace("-", "\N{MINUS SIGN}") for value in ticks])
    axes.set_ylim(rows["position"].min(), rows["position"].max())


def _draw_map(axes, roles: Mapping[str, pd.DataFrame]):
    rows = roles["map"]
    grid = rows.pivot(index="position", columns="time", values="value")
    times, positions = grid.columns.to_numpy(), grid.index.to_numpy()
    dt, dx = np.diff(times)[0], np.diff(positions)[0]
    extent = (times[0] - dt / 2, times[-1] + dt / 2, positions[0] - dx / 2, positions[-1] + dx / 2)
    image = axes.imshow(
        grid.to_numpy(),
        origin="lower",
        extent=extent,
        aspect="auto",
        interpolation="bilinear",
        cmap=matplotlib.colormaps[VELOCITY_MAP],
        vmin=0.0,
        vmax=roles["largest"]["value"].iloc[0],
    )
    # The front and the trailing edge are known to a block and a fraction of a step: the map is cut along them.
    end = times[-1]
    front, trailing = roles["front"].sort_values("position"), roles["trailing"].sort_values("position")
    x, release = front["position"].to_numpy(), front["time"].to_numpy()
    low, high = roles["prestress"]["position"].min(), roles["prestress"]["position"].max()
    around = np.concatenate([[low, x[0]], x, [x[-1], high]])
    before = np.concatenate([[end, end], release, [end, end]])
    axes.fill_betweenx(around, np.full_like(around, -dt), before, color="white", linewidth=0.0, zorder=1.5)
    axes.plot(release, x, color=BLACK, linewidth=0.8, zorder=2.0, label="front")
    stick = trailing["time"].to_numpy()
    # Single blocks that stick between two releases of an arresting front make no edge.
    if np.any(np.isfinite(stick[1:]) & np.isfinite(stick[:-1])):
        axes.fill_betweenx(
            trailing["position"], stick, np.full_like(stick, end + dt), color=STUCK, linewidth=0.0, zorder=1.4
        )
        axes.plot(
            stick,
            trailing["position"],
            color=BLACK,
            linewidth=0.8,
            linestyle=(0, (3, 1.5)),
            label="trailing edge",
        )
    axes.set_xlim(0.0, end)
    axes.set_xlabel(r"time $\bar t$")
    axes.tick_params(labelleft=False)
    return image


def _draw_transition(axes, roles: Mapping[str, pd.DataFrame]) -> None:
    low = min(rows["position"].min() for rows in (roles["prestress"], roles["map"]))
    level = 0.5 * (low + roles["front"]["position"].min())
    ends = roles["measured"].set_index("series")
    # A run that is too short for its transition has none to draw.
    if np.isfinite(ends["time"]).all():
        _draw_arrows(axes, ends, level)
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
    handles = [line for line in axes.lines if not line.get_label().startswith("_")]
    axes.legend(handles=handles, loc="upper left", handlelength=1.6, borderaxespad=0.3)


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
        label = rf"$\bar {name}_\mathrm{{trans}} = {value:.2f}$"
        axes.text(beside, height, label, va="center", fontsize=7.5, path_effects=HALO, zorder=4.0)
