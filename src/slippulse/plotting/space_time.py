"""The space-time map of a run: slip velocity, front, trailing edge and pre-stress.

The first half of the module makes a table of everything that is drawn. The column role of this
table decides what is drawn from a row, for example a map or a front; the other columns are series,
position, time and value. The second half draws such a table after `style.by_role` has split it into
one table for each role.
"""

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from ..model.prestress import prestress_from
from ..model.recorded_law import read_recorded_law
from .selection import spaced_indices
from .si_tables import with_unit
from .style import BLACK, GREY, SMALL_TEXT, TEXT_OUTLINE, Look, conditions

# Largest number of samples along each axis of a map.
MAP_SAMPLES = 121
# Largest number of blocks along each front.
FRONT_POINTS = 400
# Largest number of points of a table of pre-stress.
TABLE_POINTS = 1000
# A jump of the pre-stress is drawn as a line from closely before it to closely beyond it. Both
# distances are this fraction of the drawn range of positions.
JUMP_WIDTH = 1e-6
# The panel extends beyond the slipped part by this fraction of it on each side, which leaves room
# for an arrow.
MARGIN_FRACTION = 0.12
STUCK_COLOUR = "#cfcfcf"
MAP_STYLE: Look = {"rasterized": True, "vmin": 0.0}
PARAMETERS = ("left", "right", "width", "gamma", "damping_ratio", "dx")


def run_table(run: xr.Dataset) -> pd.DataFrame:
    """Return the table that `draw_profile`, `draw_map` and `run_title` need.

    For the title, it has rows with the parameters of the run (role parameter), and with its table
    of pre-stress, its law of friction and its flags (roles table, friction and flag), if any.
    """
    rows = [{"role": "parameter", "series": name, "value": run.attrs[name]} for name in PARAMETERS]
    points = prestress_from(run.attrs).points
    if points:
        rows.append({"role": "table", "series": f"pre-stress through {len(points)} points"})
    law = read_recorded_law(run.attrs)["law"]
    if law != "coulomb":
        rows.append({"role": "friction", "series": law.replace("_", " ")})
    if run.attrs["run_flags"]:
        rows.append({"role": "flag", "series": run.attrs["run_flags"]})
    return pd.concat([pd.DataFrame(rows), velocity_rows(run), prestress_rows(run), *edge_rows(run)])


def run_title(rows_by_role: dict[str, pd.DataFrame]) -> str:
    """Return a title with the boundary, pre-stress, damping and flags of a run.

    The law of friction is named if it is not that of the paper.

    rows_by_role : rows of the table of the figure; only tables in SI units have the role "unit"
    """
    if "unit" in rows_by_role:
        return _append_remarks(_title_in_si(rows_by_role["parameter"]), rows_by_role)
    parameters = rows_by_role["parameter"].set_index("series")["value"]
    held = parameters["gamma"] > 0.0
    names = ["gamma"] if held else []
    # The levels far away do not describe a table of pre-stress.
    if "table" not in rows_by_role:
        has_equal_levels = parameters["left"] == parameters["right"]
        names += ["tau_0"] if has_equal_levels else ["left", "right"]
        parameters["tau_0"] = parameters["left"]
    names += ["width", "damping_ratio", "dx"]
    # The width is NaN if the pre-stress has no Gaussian.
    finite_names = [name for name in names if np.isfinite(parameters[name])]
    return _append_remarks(conditions(held, **parameters[finite_names]), rows_by_role)


def _title_in_si(parameters: pd.DataFrame) -> str:
    """Return a title with the condition on top, thickness, elasticity, damping and spacing.

    parameters : one row for each parameter, with its name (series), value and unit (or NaN)
    """
    rows = parameters.fillna({"unit": ""}).set_index("series")
    text = {name: f"{row['value']:.4g} {row['unit']}".strip() for name, row in rows.iterrows()}
    condition_on_top = "stress held on top"
    if rows["value"]["gamma"] > 0.0:
        condition_on_top = rf"displacement held on top, $\gamma = {text['gamma']}$"
    ratio, dx = text["damping_ratio"], text["dx"]
    return rf"$H =$ {text['thickness']}, {condition_on_top}, $b = {ratio}$, $\Delta x =$ {dx}"


def _append_remarks(title: str, rows_by_role: dict[str, pd.DataFrame]) -> str:
    """Append the remarks of a run to a title: its table of pre-stress, friction law and flags.

    A remark is a row with the role table, friction or flag, whose column series has the text. Most
    runs have none.
    """
    if "table" in rows_by_role:
        title += f", {rows_by_role['table']['series'].iloc[0]}"
    if "friction" in rows_by_role:
        title += f", {rows_by_role['friction']['series'].iloc[0]}"
    if "flag" in rows_by_role:
        title += f", flagged: {rows_by_role['flag']['series'].iloc[0]}".replace("_", " ")
    return title


def drawn_range(run: xr.Dataset) -> tuple[float, float]:
    """Return the lowest and highest position to draw.

    The range encloses the released blocks (all blocks if none was released) with a margin. On a
    side where the samples end before these blocks, the range ends at the outermost sample.
    """
    released = run["x"].values[np.isfinite(run["release_time"].values)]
    drawn = released if released.size else run["x"].values
    lowest, highest = drawn[0], drawn[-1]
    margin = max(MARGIN_FRACTION * (highest - lowest), run.attrs["dx"])
    sample_count = run.sizes.get("sample_position", 0)
    if sample_count < 2:
        # A single sample covers no range.
        return float(lowest - margin), float(highest + margin)
    first_sample, last_sample = run["sample_position"].values[[0, -1]]
    # The margin is at least three intervals between samples wide, so that it contains samples.
    margin = max(margin, 3.0 * (last_sample - first_sample) / (sample_count - 1))
    lower = lowest - margin if first_sample < lowest else first_sample
    upper = highest + margin if last_sample > highest else last_sample
    return float(lower), float(upper)


def velocity_rows(run: xr.Dataset) -> pd.DataFrame:
    """Return the sampled slip velocity (role map), and its largest value (role largest).

    At most MAP_SAMPLES positions and times are kept, and most samples that are 0 are left out.
    """
    lower, upper = drawn_range(run)
    x, times = run["sample_position"].values, run["sample_time"].values
    velocity = run["sample_velocity"].values
    in_range = np.flatnonzero((x >= lower) & (x <= upper))
    kept_positions = in_range[spaced_indices(in_range.size, MAP_SAMPLES)]
    kept_times = spaced_indices(times.size, MAP_SAMPLES)
    # These three arrays have one row for each time and one column for each position.
    time, position = np.meshgrid(times[kept_times], x[kept_positions], indexing="ij")
    # Rounding to five digits of the largest velocity keeps the table small. A colour shows fewer.
    largest_velocity = np.nanmax(velocity)
    decimals = 0
    if largest_velocity > 0.0:
        decimals = 4 - int(np.floor(np.log10(largest_velocity)))
    rounded_velocity = velocity[np.ix_(kept_times, kept_positions)].round(decimals)
    # The first row and the first column are written in full, because they define the grid.
    is_written = rounded_velocity != 0.0
    is_written[0, :] = True
    is_written[:, 0] = True
    samples = pd.DataFrame(
        {
            "role": "map",
            "time": time[is_written],
            "position": position[is_written],
            "value": rounded_velocity[is_written],
        }
    )
    largest = pd.DataFrame([{"role": "largest", "value": largest_velocity}])
    return pd.concat([samples, largest])


def prestress_rows(run: xr.Dataset) -> pd.DataFrame:
    """Return the pre-stress at the positions that are drawn (role prestress)."""
    # The blocks of a run end near its fronts. The pre-stress is computed from its profile, which is
    # known everywhere.
    lower, upper = drawn_range(run)
    x = np.linspace(lower, upper, FRONT_POINTS)
    # The nucleation at x = 0 may be narrower than the distance between these points.
    if lower < 0.0 < upper:
        x = np.union1d(x, 0.0)
    profile = prestress_from(run.attrs)
    if profile.points:
        # The pre-stress is piecewise linear, so up to TABLE_POINTS of its corners are drawn. It may
        # jump at a corner, so the values closely before and after each of them are drawn, too.
        positions = np.unique([position for position, _ in profile.points])
        positions = positions[(positions > lower) & (positions < upper)]
        positions = positions[spaced_indices(positions.size, TABLE_POINTS)]
        offset = JUMP_WIDTH * (upper - lower)
        x = np.unique(np.concatenate([x, positions - offset, positions, positions + offset]))
    tau = profile(x)
    return pd.DataFrame({"role": "prestress", "position": x, "value": tau})


def edge_rows(run: xr.Dataset) -> list[pd.DataFrame]:
    """Return when blocks were first released (role front) and when they last stuck (role trailing).

    The stick time is NaN for blocks that did not stick, and both times are NaN for blocks between
    two ruptures that were not released.
    """
    blocks = released = np.flatnonzero(np.isfinite(run["release_time"].values))
    if released.size:
        blocks = np.arange(released[0], released[-1] + 1)
    # The last block is kept as well, so that the front is drawn to its end.
    kept = np.union1d(blocks[spaced_indices(blocks.size, FRONT_POINTS)], blocks[-1:])
    x = run["x"].values[kept]
    release, stick = run["release_time"].values[kept], run["stick_time"].values[kept]
    return [
        pd.DataFrame({"role": "front", "position": x, "time": release}),
        pd.DataFrame({"role": "trailing", "position": x, "time": stick}),
    ]


def draw_profile(axes: Axes, rows_by_role: dict[str, pd.DataFrame]) -> None:
    """Draw the pre-stress on the horizontal axis and the position on the vertical axis."""
    rows, in_si = rows_by_role["prestress"], "unit" in rows_by_role
    if in_si:
        _mark_strengths(axes, rows_by_role["strength"])
    else:
        # Kinetic friction is at 0.
        axes.axvline(0.0, color=GREY, linewidth=0.6, linestyle=":")
    axes.plot(rows["value"], rows["position"], color=BLACK)
    axes.margins(x=0.12)
    axes.xaxis.set_major_locator(MaxNLocator(2, integer=not in_si))
    label = with_unit("stress" if in_si else r"$\tau$", rows_by_role, "stress")
    axes.set(xlabel=label, ylabel=with_unit(r"position $x$", rows_by_role, "position"))
    axes.set_ylim(rows["position"].min(), rows["position"].max())


def _mark_strengths(axes: Axes, rows: pd.DataFrame) -> None:
    """Mark static and kinetic friction by vertical lines on the axis of stresses.

    rows : the two rows with the role strength
    """
    look: Look = {
        "rotation": 90,
        "color": GREY,
        "fontsize": SMALL_TEXT,
        "path_effects": TEXT_OUTLINE,
        "transform": axes.get_xaxis_transform(),
    }
    # Both names are written between the two lines: kinetic friction at the top of its line, and
    # static friction at the bottom.
    kinetic_look = look | {"y": 0.98, "ha": "left", "va": "top"}
    static_look = look | {"y": 0.02, "ha": "right", "va": "bottom"}
    kinetic, static = rows.sort_values("value").itertuples()
    for strength, text_look in ((kinetic, kinetic_look), (static, static_look)):
        axes.axvline(strength.value, color=GREY, linewidth=0.6, linestyle=":")
        axes.text(x=strength.value, s=strength.series, **text_look)


def draw_map(axes: Axes, rows_by_role: dict[str, pd.DataFrame]) -> None:
    """Draw the slip velocity in colour between the front and the trailing edge."""
    # Samples that are 0 are not in the table.
    grid = rows_by_role["map"].pivot(index="position", columns="time", values="value").fillna(0.0)
    largest = rows_by_role["largest"]["value"].iloc[0]
    look = MAP_STYLE | {"shading": "gouraud", "vmax": largest}
    image = axes.pcolormesh(grid.columns, grid.index, grid, **look)
    draw_edges(axes, rows_by_role, grid.columns[-1])
    label = with_unit(r"slip velocity $\dot u$", rows_by_role, "slip_velocity")
    largest_text = f"{largest:#.3g}".rstrip(".")
    label = f"{label} (largest {largest_text})"
    axes.figure.colorbar(image, ax=axes, pad=0.02, aspect=25).set_label(label)


def add_map_legend(axes: Axes) -> None:
    """Add a legend to the map: below a rupture that runs mainly to the left, else above.

    There the map is free at early times. If the legend still covers a part of the rupture, its pale
    ground keeps it readable.
    """
    lowest, highest = axes.get_ylim()
    runs_to_the_left = -lowest > 1.2 * highest
    look: Look = {"frameon": True, "edgecolor": "none"}
    axes.legend(loc="lower left" if runs_to_the_left else "upper left", **look)


def draw_halves(axes: Axes, rows: pd.DataFrame, half: str) -> None:
    """Draw one map of slip velocity above x = 0 and another one below.

    rows : position, time and slip_velocity of the samples of both maps
    half : name of the column whose two values distinguish the two maps
    """
    look = MAP_STYLE | {"shading": "nearest", "vmax": rows["slip_velocity"].max()}
    for _, samples in rows.groupby(half):
        # Positions at rest stay white.
        grid = samples.pivot(index="position", columns="time", values="slip_velocity")
        image = axes.pcolormesh(grid.columns, grid.index, grid.where(grid > 0.0), **look)
    axes.axhline(0.0, color=BLACK, linewidth=0.6, linestyle=":")
    axes.figure.colorbar(image, ax=axes, pad=0.02).set_label(r"slip velocity $\dot u$")
    axes.set(xlabel=r"time $t$", ylabel=r"position $x$")


def draw_edges(axes: Axes, rows_by_role: dict[str, pd.DataFrame], end: float) -> None:
    """Draw the front and the trailing edge as lines on the map.

    The map is covered in white before the front arrives, and in grey after the trailing edge.

    end : the time at the right end of the axis
    """
    front = rows_by_role["front"].sort_values("position")
    trailing = rows_by_role["trailing"].sort_values("position")
    axes.set(xlim=(0.0, end), xlabel=with_unit(r"time $t$", rows_by_role, "time"))
    axes.tick_params(labelleft=False)
    if front.empty:
        return
    positions = rows_by_role["prestress"]["position"]
    # Beyond the front, and between two ruptures (NaN), blocks are at rest until the end.
    release = np.interp(positions, front["position"], front["time"], left=end, right=end)
    release = np.nan_to_num(release, nan=end)
    # With this zorder, white lies above the map and below the lines.
    axes.fill_betweenx(positions, 0.0, release, color="white", linewidth=0.0, zorder=1.5)
    axes.plot(front["time"], front["position"], color=BLACK, linewidth=0.8, label="front")
    x, stick = trailing["position"], trailing["time"].to_numpy()
    # Near an arresting front, single blocks stick between two releases. A trailing edge has two or
    # more neighbouring blocks that have stuck.
    if np.any(np.isfinite(stick[1:]) & np.isfinite(stick[:-1])):
        axes.fill_betweenx(x, stick, end, color=STUCK_COLOUR, linewidth=0.0, label="stuck again")
        axes.plot(stick, x, "--", color=BLACK, linewidth=0.8, label="trailing edge")
