"""Slip velocity over time and position, with the fronts and where blocks stick: tables and drawing."""

from __future__ import annotations

from collections.abc import Mapping

import matplotlib
import numpy as np
import pandas as pd
import xarray as xr

from ...data.numerals import setting
from ..style import BLACK, GREY, VELOCITY_MAP

# Samples kept along each axis of a map, and blocks along each front.
MAP_SAMPLES, FRONT_POINTS = 201, 300
# Share of the slipped length that is drawn beyond it on each side: room for an arrow.
MARGIN = 0.12
STUCK = "#cfcfcf"
# Width of a label on the axis of the narrow pre-stress panel, as a share of the axis.
LABEL = 0.5


def limits(run: xr.Dataset) -> tuple[float, float]:
    """Positions that are drawn: what slips and a margin, or as far as samples go where slip goes farther."""
    slipped = run["x"].values[np.isfinite(run["release_time"].values)]
    if "sample_position" not in run:
        margin = MARGIN * (slipped[-1] - slipped[0])
        return float(slipped[0] - margin), float(slipped[-1] + margin)
    first, last = run["sample_position"].values[[0, -1]]
    spacing = (last - first) / max(1, run.sizes["sample_position"] - 1)
    margin = max(MARGIN * (slipped[-1] - slipped[0]), 3.0 * spacing)
    lower = slipped[0] - margin if slipped[0] > first else first
    upper = slipped[-1] + margin if slipped[-1] < last else last
    return float(lower), float(upper)


def thin(size: int, most: int) -> np.ndarray:
    """Regularly spaced indices, at most ``most`` of them."""
    return np.arange(0, size, max(1, int(np.ceil(size / most))))


def velocity_map(run: xr.Dataset) -> pd.DataFrame:
    """Sampled slip velocity, role "map", and the largest sample, role "largest"."""
    lower, upper = limits(run)
    x, times = run["sample_position"].values, run["sample_time"].values
    velocity = run["sample_velocity"].values
    inside = np.flatnonzero((x >= lower) & (x <= upper))
    columns, rows = inside[thin(inside.size, MAP_SAMPLES)], thin(times.size, MAP_SAMPLES)
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


def prestress_profile(run: xr.Dataset) -> pd.DataFrame:
    """Pre-stress over the positions that are drawn, role "prestress"."""
    lower, upper = limits(run)
    x, tau = run["x"].values, run["prestress"].values
    inside = np.flatnonzero((x >= lower) & (x <= upper))
    kept = np.union1d(inside[thin(inside.size, 2 * FRONT_POINTS)], np.argmax(tau))
    # The levels go on beyond the lattice, which ends where the fronts do.
    x = np.concatenate([[lower], x[kept], [upper]])
    tau = np.concatenate([[tau[kept[0]]], tau[kept], [tau[kept[-1]]]])
    return pd.DataFrame({"role": "prestress", "position": x, "value": tau})


def edges(run: xr.Dataset) -> list[pd.DataFrame]:
    """Times of first release (role "front") and last stick (role "trailing", NaN where none) over position."""
    x = run["x"].values
    slipped = np.flatnonzero(np.isfinite(run["release_time"].values))
    kept = np.union1d(slipped[thin(slipped.size, 2 * FRONT_POINTS)], slipped[-1:])
    return [
        pd.DataFrame({"role": role, "position": x[kept], "time": run[edge].values[kept]})
        for role, edge in (("front", "release_time"), ("trailing", "stick_time"))
    ]


def draw_profile(axes, rows: pd.DataFrame) -> None:
    """Pre-stress to the right, position upwards."""
    axes.axvline(0.0, color=GREY, linewidth=0.6, linestyle=":")
    axes.plot(rows["value"], rows["position"], color=BLACK)
    axes.set_xlabel(r"$\tau$")
    lower, upper = rows["value"].min(), rows["value"].max()
    axes.set_xlim(min(0.0, lower) - 0.15, upper + 0.15)
    # The peak and the levels far away, the right one only where its label has room.
    left, right = rows["value"].iloc[[0, -1]]
    shown = [upper, left] if abs(right - left) < LABEL * (upper - min(0.0, lower)) else [upper, left, right]
    ticks = sorted({round(float(value), 2) for value in shown})
    axes.set_xticks(ticks, [setting(value) for value in ticks])
    axes.set_ylim(rows["position"].min(), rows["position"].max())


def draw_map(axes, roles: Mapping[str, pd.DataFrame]):
    """Slip velocity in colour, cut along the front and the trailing edge. Returns the image."""
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
    draw_edges(axes, roles, times[-1])
    return image


def draw_edges(axes, roles: Mapping[str, pd.DataFrame], end: float) -> None:
    """The front and the trailing edge, known to a block and a fraction of a step; what is stuck is hidden."""
    beyond = 0.01 * end
    front, trailing = roles["front"].sort_values("position"), roles["trailing"].sort_values("position")
    x, release = front["position"].to_numpy(), front["time"].to_numpy()
    low, high = roles["prestress"]["position"].min(), roles["prestress"]["position"].max()
    around = np.concatenate([[low, x[0]], x, [x[-1], high]])
    before = np.concatenate([[end, end], release, [end, end]])
    axes.fill_betweenx(
        around, np.full_like(around, -beyond), before, color="white", linewidth=0.0, zorder=1.5
    )
    axes.plot(release, x, color=BLACK, linewidth=0.8, zorder=2.0, label="front")
    stick = trailing["time"].to_numpy()
    # Single blocks that stick between two releases of an arresting front make no edge.
    if np.any(np.isfinite(stick[1:]) & np.isfinite(stick[:-1])):
        axes.fill_betweenx(
            trailing["position"],
            stick,
            np.full_like(stick, end + beyond),
            color=STUCK,
            linewidth=0.0,
            zorder=1.4,
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
    axes.set_xlabel(r"time $t$")
    axes.tick_params(labelleft=False)
