"""Slip velocity over time and position, with the fronts and where blocks stick: tables and drawing."""

from itertools import pairwise

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.image import AxesImage

from ...data.numerals import setting
from ..style import BLACK, GREY, VELOCITY_MAP, Look

# Samples kept along each axis of a map, and blocks along each front.
MAP_SAMPLES, FRONT_POINTS = 121, 400
# What is drawn beyond the slipped part on each side, as a fraction of it: room for an arrow.
MARGIN = 0.12
STUCK = "#cfcfcf"
# Width of a label on the axis of the narrow pre-stress panel, as a fraction of the axis.
LABEL = 0.5
PARAMETERS = ("left", "right", "width", "gamma", "damping_ratio", "dx")


def run_rows(run: xr.Dataset) -> pd.DataFrame:
    """Role, series, time, position and value of all that a map shows: parameter (series: its name), flag (series: the
    flags), and the roles of the parts below.
    """
    rows = [{"role": "parameter", "series": name, "value": run.attrs[name]} for name in PARAMETERS]
    if run.attrs["run_flags"]:
        rows.append({"role": "flag", "series": run.attrs["run_flags"]})
    return pd.concat([pd.DataFrame(rows), velocity_map(run), prestress_profile(run), *edges(run)])


def description(roles: dict[str, pd.DataFrame]) -> str:
    """Boundary, pre-stress and damping of a run, and its flags."""
    value = roles["parameter"].set_index("series")["value"]
    parts = [
        rf"$\Gamma = 1$, $\gamma = {value['gamma']:g}$" if value["gamma"] > 0.0 else r"$\Gamma = 0$"
    ]
    if value["left"] == value["right"]:
        parts.append(rf"$\tau_0 = {value['left']:g}$")
    else:
        parts.append(rf"$\tau_{{0,l}} = {value['left']:g}$, $\tau_{{0,r}} = {value['right']:g}$")
    parts.append(rf"$W = {value['width']:g}$, $b = {value['damping_ratio']:g}$")
    if "flag" in roles:
        parts.append(f"flagged: {roles['flag']['series'].iloc[0]}".replace("_", " "))
    return ", ".join(parts)


def limits(run: xr.Dataset) -> tuple[float, float]:
    """Positions that are drawn: what slips and a margin, or as far as samples go where slip goes farther."""
    slipped = run["x"].values[np.isfinite(run["release_time"].values)]
    slipped = slipped if slipped.size else run["x"].values
    margin = max(MARGIN * (slipped[-1] - slipped[0]), run.attrs["dx"])
    if run.sizes.get("sample_position", 0) < 2:
        return float(slipped[0] - margin), float(slipped[-1] + margin)
    first, last = run["sample_position"].values[[0, -1]]
    margin = max(margin, 3.0 * (last - first) / max(1, run.sizes["sample_position"] - 1))
    lower = slipped[0] - margin if slipped[0] > first else first
    upper = slipped[-1] + margin if slipped[-1] < last else last
    return float(lower), float(upper)


def thin(size: int, most: int) -> np.ndarray:
    """Regularly spaced indices, at most ``most`` of them."""
    return np.arange(0, size, max(1, int(np.ceil(size / most))))


def velocity_map(run: xr.Dataset) -> pd.DataFrame:
    """Sampled slip velocity where it is not 0, role "map", and the largest sample, role "largest"."""
    lower, upper = limits(run)
    x, times, velocity = (
        run[name].values for name in ("sample_position", "sample_time", "sample_velocity")
    )
    inside = np.flatnonzero((x >= lower) & (x <= upper))
    columns, rows = inside[thin(inside.size, MAP_SAMPLES)], thin(times.size, MAP_SAMPLES)
    time, position = np.meshgrid(times[rows], x[columns], indexing="ij")
    # Four digits of the largest velocity are more than a colour shows, and keep the table small.
    kept = velocity[np.ix_(rows, columns)].round(4 - int(np.floor(np.log10(np.nanmax(velocity)))))
    # What is left out is 0; the first of each row and column says where it is.
    written = kept != 0.0
    written[0], written[:, 0] = True, True
    grid = {"time": time[written], "position": position[written], "value": kept[written]}
    largest = pd.DataFrame([{"role": "largest", "value": np.nanmax(velocity)}])
    return pd.concat([pd.DataFrame({"role": "map", **grid}), largest])


def prestress_profile(run: xr.Dataset) -> pd.DataFrame:
    """Pre-stress over the positions that are drawn, role "prestress"."""
    lower, upper = limits(run)
    x, tau = run["x"].values, run["prestress"].values
    inside = np.flatnonzero((x >= lower) & (x <= upper))
    kept = np.union1d(inside[thin(inside.size, FRONT_POINTS)], np.argmax(tau))
    # The levels go on beyond the lattice, which ends where the fronts do.
    x = np.concatenate([[lower], x[kept], [upper]])
    tau = np.concatenate([[tau[kept[0]]], tau[kept], [tau[kept[-1]]]])
    return pd.DataFrame({"role": "prestress", "position": x, "value": tau})


def edges(run: xr.Dataset) -> list[pd.DataFrame]:
    """Times of first release (role "front") and last stick (role "trailing", NaN where none) over position."""
    x = run["x"].values
    slipped = np.flatnonzero(np.isfinite(run["release_time"].values))
    kept = np.union1d(slipped[thin(slipped.size, FRONT_POINTS)], slipped[-1:])
    return [
        pd.DataFrame({"role": role, "position": x[kept], "time": run[edge].values[kept]})
        for role, edge in (("front", "release_time"), ("trailing", "stick_time"))
    ]


def draw_profile(axes: Axes, rows: pd.DataFrame) -> None:
    """Pre-stress to the right, position upwards."""
    axes.axvline(0.0, color=GREY, linewidth=0.6, linestyle=":")
    axes.plot(rows["value"], rows["position"], color=BLACK)
    lower, upper = min(0.0, rows["value"].min()), rows["value"].max()
    # The peak and the levels far away, the right one only where its label has room.
    left, right = rows["value"].iloc[[0, -1]]
    shown = [upper, left] if abs(right - left) < LABEL * (upper - lower) else [upper, left, right]
    ticks = sorted({round(float(value), 2) for value in (*shown, 0.0)})
    axes.set_xticks(ticks, [setting(value) for value in ticks])
    # Two that are near each other have their labels on their outer sides.
    near = [abs(one - other) < LABEL * (upper - lower) for one, other in pairwise(ticks)]
    for label, after, before in zip(
        axes.get_xticklabels(), [*near, False], [False, *near], strict=True
    ):
        label.set_horizontalalignment("center" if after == before else "right" if after else "left")
    axes.set(xlabel=r"$\tau$", xlim=(lower - 0.15, upper + 0.15))
    axes.set(ylabel=r"position $x$", ylim=(rows["position"].min(), rows["position"].max()))


def draw_map(axes: Axes, roles: dict[str, pd.DataFrame]) -> AxesImage:
    """Slip velocity in colour, cut along the front and the trailing edge. Returns the image."""
    grid = roles["map"].pivot(index="position", columns="time", values="value").fillna(0.0)
    times, positions = grid.columns.to_numpy(), grid.index.to_numpy()
    dt, dx = np.diff(times)[0], np.diff(positions)[0]
    extent = (times[0] - dt / 2, times[-1] + dt / 2, positions[0] - dx / 2, positions[-1] + dx / 2)
    look: Look = {
        "origin": "lower",
        "extent": extent,
        "interpolation": "bilinear",
        "aspect": "auto",
    }
    image = axes.imshow(
        grid, VELOCITY_MAP, vmin=0.0, vmax=roles["largest"]["value"].iloc[0], **look
    )
    draw_edges(axes, roles, times[-1])
    return image


def draw_edges(axes: Axes, roles: dict[str, pd.DataFrame], end: float) -> None:
    """The front and the trailing edge, known to a block and a fraction of a step; what is stuck is hidden."""
    beyond = 0.01 * end
    front, trailing = (
        roles["front"].sort_values("position"),
        roles["trailing"].sort_values("position"),
    )
    x, release = front["position"].to_numpy(), front["time"].to_numpy()
    axes.set(xlim=(0.0, end), xlabel=r"time $t$")
    axes.tick_params(labelleft=False)
    if not x.size:
        return
    around = np.concatenate([[-np.inf, x[0]], x, [x[-1], np.inf]])
    around = np.clip(
        around, roles["prestress"]["position"].min(), roles["prestress"]["position"].max()
    )
    before = np.concatenate([[end, end], release, [end, end]])
    axes.fill_betweenx(around, -beyond, before, color="white", linewidth=0.0, zorder=1.5)
    axes.plot(release, x, color=BLACK, linewidth=0.8, zorder=2.0, label="front")
    x, stick = trailing["position"], trailing["time"].to_numpy()
    # Single blocks that stick between two releases of an arresting front make no edge.
    if np.any(np.isfinite(stick[1:]) & np.isfinite(stick[:-1])):
        axes.fill_betweenx(x, stick, end + beyond, color=STUCK, linewidth=0.0, zorder=1.4)
        axes.plot(
            stick, x, color=BLACK, linewidth=0.8, linestyle=(0, (3, 1.5)), label="trailing edge"
        )
