"""A run over time and position: slip velocity, front and trailing edge; their table and drawing."""

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from ..model.prestress import prestress_from
from ..model.recorded_law import read_recorded_law
from .selection import spaced_indices
from .si_tables import with_unit
from .style import BLACK, GREY, HALO, SMALL, Look, conditions

# Samples kept along each axis of a map, and blocks along each front.
MAP_SAMPLES, FRONT_POINTS = 121, 400
# Points of a table that are drawn, and the part of the height within which a jump is drawn.
TABLE_POINTS, JUMP = 1000, 1e-6
# The panel is wider than the slipped part by this fraction of it on each side, for an arrow.
MARGIN = 0.12
STUCK = "#cfcfcf"
MAP: Look = {"rasterized": True, "vmin": 0.0}
PARAMETERS = ("left", "right", "width", "gamma", "damping_ratio", "dx")


def run_rows(run: xr.Dataset) -> pd.DataFrame:
    """Rows of all that `draw_profile` and `draw_map` show; series names a parameter or flags."""
    rows = [{"role": "parameter", "series": name, "value": run.attrs[name]} for name in PARAMETERS]
    points = prestress_from(run.attrs).points
    if points:
        rows.append({"role": "table", "series": f"pre-stress through {len(points)} points"})
    law = read_recorded_law(run.attrs)["law"]
    if law != "coulomb":
        rows.append({"role": "friction", "series": law.replace("_", " ")})
    if run.attrs["run_flags"]:
        rows.append({"role": "flag", "series": run.attrs["run_flags"]})
    return pd.concat([pd.DataFrame(rows), velocity_map(run), prestress_profile(run), *edges(run)])


def description(roles: dict[str, pd.DataFrame]) -> str:
    """Boundary, pre-stress, damping, another friction and flags of a run, as a title."""
    if "unit" in roles:
        return _with_remarks(_description_in_si(roles["parameter"]), roles)
    value = roles["parameter"].set_index("series")["value"]
    value["tau_0"], held = value["left"], value["gamma"] > 0.0
    levels = ["tau_0"] if value["left"] == value["right"] else ["left", "right"]
    if "table" in roles:
        # Levels far away do not describe a table.
        levels = []
    names = [*(["gamma"] if held else []), *levels, "width", "damping_ratio", "dx"]
    title = conditions(held, **value[[name for name in names if np.isfinite(value[name])]])
    return _with_remarks(title, roles)


def _description_in_si(parameters: pd.DataFrame) -> str:
    """Condition on top, thickness, elasticity, damping and spacing, as a title."""
    rows = parameters.fillna({"unit": ""}).set_index("series")
    height, gamma, ratio, dx = (
        f"{rows['value'][name]:.4g} {rows['unit'][name]}".strip()
        for name in ("thickness", "gamma", "damping_ratio", "dx")
    )
    held = rows["value"]["gamma"] > 0.0
    top = rf"displacement held on top, $\gamma = {gamma}$" if held else "stress held on top"
    return rf"$H =$ {height}, {top}, $b = {ratio}$, $\Delta x =$ {dx}"


def _with_remarks(title: str, roles: dict[str, pd.DataFrame]) -> str:
    """Add another friction and flags to a title."""
    if "table" in roles:
        title += f", {roles['table']['series'].iloc[0]}"
    if "friction" in roles:
        title += f", {roles['friction']['series'].iloc[0]}"
    if "flag" in roles:
        title += f", flagged: {roles['flag']['series'].iloc[0]}".replace("_", " ")
    return title


def limits(run: xr.Dataset) -> tuple[float, float]:
    """Lowest and highest position drawn: the slipped part and a margin, within the samples."""
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


def velocity_map(run: xr.Dataset) -> pd.DataFrame:
    """Sampled slip velocity where it is not 0 (role map), and its largest value (role largest)."""
    lower, upper = limits(run)
    x, times = run["sample_position"].values, run["sample_time"].values
    velocity = run["sample_velocity"].values
    inside = np.flatnonzero((x >= lower) & (x <= upper))
    columns = inside[spaced_indices(inside.size, MAP_SAMPLES)]
    rows = spaced_indices(times.size, MAP_SAMPLES)
    time, position = np.meshgrid(times[rows], x[columns], indexing="ij")
    # Four digits of the largest velocity are more than a colour shows, and keep the table small.
    kept = velocity[np.ix_(rows, columns)].round(4 - int(np.floor(np.log10(np.nanmax(velocity)))))
    # A sample that is left out is 0; the first of each row and column keeps the grid complete.
    written = kept != 0.0
    written[0], written[:, 0] = True, True
    grid = {"time": time[written], "position": position[written], "value": kept[written]}
    largest = pd.DataFrame([{"role": "largest", "value": np.nanmax(velocity)}])
    return pd.concat([pd.DataFrame({"role": "map", **grid}), largest])


def prestress_profile(run: xr.Dataset) -> pd.DataFrame:
    """Pre-stress over the positions that are drawn (role prestress)."""
    # The lattice ends where the fronts do, and the pre-stress does not.
    lower, upper = limits(run)
    x = np.union1d(np.linspace(lower, upper, FRONT_POINTS), 0.0)
    profile = prestress_from(run.attrs)
    if profile.points:
        # The lines end at the points. At a jump both values are drawn.
        positions = np.unique([position for position, _ in profile.points])
        positions = positions[(positions > lower) & (positions < upper)]
        positions = positions[spaced_indices(positions.size, TABLE_POINTS)]
        nearby = JUMP * (upper - lower)
        x = np.unique(np.concatenate([x, positions - nearby, positions, positions + nearby]))
    tau = profile(x)
    return pd.DataFrame({"role": "prestress", "position": x, "value": tau})


def edges(run: xr.Dataset) -> list[pd.DataFrame]:
    """Times of first release (role front) and of last stick (role trailing; NaN where none)."""
    x = run["x"].values
    slipped = np.flatnonzero(np.isfinite(run["release_time"].values))
    kept = np.union1d(slipped[spaced_indices(slipped.size, FRONT_POINTS)], slipped[-1:])
    return [
        pd.DataFrame({"role": role, "position": x[kept], "time": run[edge].values[kept]})
        for role, edge in (("front", "release_time"), ("trailing", "stick_time"))
    ]


def draw_profile(axes: Axes, roles: dict[str, pd.DataFrame]) -> None:
    """Draw the pre-stress to the right and the position upwards."""
    rows, in_si = roles["prestress"], "unit" in roles
    if in_si:
        _mark_strengths(axes, roles["strength"])
    else:
        axes.axvline(0.0, color=GREY, linewidth=0.6, linestyle=":")
    axes.plot(rows["value"], rows["position"], color=BLACK)
    axes.margins(x=0.12)
    axes.xaxis.set_major_locator(MaxNLocator(2, integer=not in_si))
    label = with_unit("stress" if in_si else r"$\tau$", roles, "stress")
    axes.set(xlabel=label, ylabel=with_unit(r"position $x$", roles, "position"))
    axes.set_ylim(rows["position"].min(), rows["position"].max())


def _mark_strengths(axes: Axes, rows: pd.DataFrame) -> None:
    """Mark static and kinetic friction on the axis of stresses."""
    look: Look = {"rotation": 90, "color": GREY, "fontsize": SMALL, "path_effects": HALO}
    look["transform"] = axes.get_xaxis_transform()
    # Both names stand between the two lines, at different heights.
    places: list[Look] = [
        {"y": 0.98, "ha": "left", "va": "top"},
        {"y": 0.02, "ha": "right", "va": "bottom"},
    ]
    for strength, place in zip(rows.sort_values("value").itertuples(), places, strict=True):
        axes.axvline(strength.value, color=GREY, linewidth=0.6, linestyle=":")
        axes.text(x=strength.value, s=strength.series, **place, **look)


def draw_map(axes: Axes, roles: dict[str, pd.DataFrame]) -> None:
    """Draw the slip velocity in colour, cut along both edges."""
    grid = roles["map"].pivot(index="position", columns="time", values="value").fillna(0.0)
    look = MAP | {"shading": "gouraud", "vmax": roles["largest"]["value"].iloc[0]}
    image = axes.pcolormesh(grid.columns, grid.index, grid, **look)
    draw_edges(axes, roles, grid.columns[-1])
    label = with_unit(r"slip velocity $\dot u$", roles, "slip_velocity")
    largest = f"{look['vmax']:#.3g}".rstrip(".")
    label = f"{label} (largest {largest})"
    axes.figure.colorbar(image, ax=axes, pad=0.02, aspect=25).set_label(label)


def draw_halves(axes: Axes, rows: pd.DataFrame, half: str) -> None:
    """Draw two maps, one above x = 0 and one below, of the values of a column."""
    look = MAP | {"shading": "nearest", "vmax": rows["slip_velocity"].max()}
    for _, part in rows.groupby(half):
        # Positions that do not slide stay white.
        grid = part.pivot(index="position", columns="time", values="slip_velocity")
        image = axes.pcolormesh(grid.columns, grid.index, grid.where(grid > 0.0), **look)
    axes.axhline(0.0, color=BLACK, linewidth=0.6, linestyle=":")
    axes.figure.colorbar(image, ax=axes, pad=0.02).set_label(r"slip velocity $\dot u$")
    axes.set(xlabel=r"time $t$", ylabel=r"position $x$")


def draw_edges(axes: Axes, roles: dict[str, pd.DataFrame], end: float) -> None:
    """Draw both edges, and hide what the map has before the release and after the stick."""
    front = roles["front"].sort_values("position")
    trailing = roles["trailing"].sort_values("position")
    axes.set(xlim=(0.0, end), xlabel=with_unit(r"time $t$", roles, "time"))
    axes.tick_params(labelleft=False)
    if front.empty:
        return
    drawn = roles["prestress"]["position"]
    release = np.interp(drawn, front["position"], front["time"], left=end, right=end)
    axes.fill_betweenx(drawn, 0.0, release, color="white", linewidth=0.0, zorder=1.5)
    axes.plot(front["time"], front["position"], color=BLACK, linewidth=0.8, label="front")
    x, stick = trailing["position"], trailing["time"].to_numpy()
    # Single blocks that stick between two releases of an arresting front make no edge.
    if np.any(np.isfinite(stick[1:]) & np.isfinite(stick[:-1])):
        axes.fill_betweenx(x, stick, end, color=STUCK, linewidth=0.0, label="stuck again")
        axes.plot(stick, x, "--", color=BLACK, linewidth=0.8, label="trailing edge")
