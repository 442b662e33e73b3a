"""Figure 6: the onset of pulses on a lattice of blocks and springs, drawn from runs at dx = 1."""

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MultipleLocator

from slippulse.data.point import point
from slippulse.model.prestress import prestress_from
from slippulse.plotting.style import (
    BLACK,
    BLUE,
    GREY,
    ORANGE,
    Look,
    entry,
    legend_below,
    panel_letter,
)

NEEDS = {"data": ["burridge_knopoff_displacement", "burridge_knopoff_stress"]}
# Runs of each simulation that the figure can draw, in the words of configuration/drawn.py.
DRAWS = {
    "burridge_knopoff_displacement": "`boundary: displacement` and equal levels > 0",
    "burridge_knopoff_stress": "`boundary: stress`, left level < 0, right level 0, no steps",
}

# Lengths in the drawing are in block spacings, unless another unit is given.
# Distance between the rows of blocks of each panel.
ROW_DISTANCES = {"displacement": 1.62, "stress": 0.86}
# Distance from the first to the last block in view, and number of blocks in view beyond the block
# that stops the left front.
VIEW_WIDTH = 18
BLOCKS_BEYOND_ARREST = 2
# Width and height of a block, and height of the plate above the ground.
BLOCK_WIDTH = 0.5
BLOCK_HEIGHT = 0.44
PLATE_HEIGHT = 1.12
# Heights of the points of a coil spring: a zigzag with straight ends.
COIL_SHAPE = np.pad(0.1 * (-1.0) ** np.arange(9), 1)
# Largest drawn displacement, and shortest drawn spring divided by its length at rest.
MAX_DRAWN_DISPLACEMENT = 0.85
MIN_DRAWN_SPRING = 0.35
# Width of the figure, height of one spacing and height of the strip with the pre-stress, in inches.
# The figure is narrow, so that its text can be read in one column.
FIGURE_WIDTH = 5.4
SPACING_HEIGHT, STRIP_HEIGHT = 0.34, 0.42
# The colours are light, medium and dark, so that they can be told apart in greyscale, too.
STATE_COLOURS = {"at rest": "#e2e8ee", "sliding": ORANGE, "stuck after sliding": "#00402f"}
TITLES = {
    "displacement": r"$\Gamma = 1$: leaf springs to a held plate, "
    r"$\gamma = {gamma:g}$, $\tau_0 = {left:g}$",
    "stress": r"$\Gamma = 0$: a constant stress on each block, "
    r"$\tau_{{0,l}} = {left:g}$, $\tau_{{0,r}} = {right:g}$",
}


def table(data: dict, tables: dict[str, pd.DataFrame], settings: dict) -> pd.DataFrame:
    """Return one row for each panel, instant and block of the first run of each sweep.

    The column x has the position of a block before it slips, and arresting_block marks the block
    that stops the left front. The column scale has the factor by which slip is multiplied in the
    drawing.
    """
    panels = []
    for boundary in ("displacement", "stress"):
        run = point(data[f"burridge_knopoff_{boundary}"], 0)
        rows = block_states(run)
        rows["scale"] = displacement_scale(rows)
        # Only under a stress boundary, a block stops the left front.
        stops_front = rows["x"] == position_of_arresting_block(run)
        rows["arresting_block"] = stops_front & (boundary == "stress")
        parameters = {key: run.attrs[key] for key in ("gamma", "left", "right", "width")}
        panels.append(rows.assign(panel=boundary, **parameters))
    return pd.concat(panels, ignore_index=True)


def block_states(run: xr.Dataset) -> pd.DataFrame:
    """Return slip, velocity, pre-stress and state of each block in view, at each drawn instant.

    The column row numbers the instants from 0 on, and instant has their names.
    """
    first, last = view(run)
    # The springs of one more block on each side are partly in view.
    shown = run.sel(sample_position=slice(first - 1.5, last + 1.5))
    x = shown["sample_position"].values
    parts = []
    for row, (instant_name, sample) in enumerate(instants(run)):
        at_instant = shown.isel(sample_time=sample)
        slip, velocity = at_instant["sample_slip"].values, at_instant["sample_velocity"].values
        state_without_motion = np.where(slip > 0.0, "stuck after sliding", "at rest")
        blocks = pd.DataFrame({"x": x, "slip": slip, "slip_velocity": velocity})
        blocks["prestress"] = prestress_from(run.attrs)(x)
        blocks["state"] = np.where(velocity > 0.0, "sliding", state_without_motion)
        time = float(at_instant["sample_time"])
        parts.append(blocks.assign(row=row, instant=instant_name, time=time))
    return pd.concat(parts, ignore_index=True)


def displacement_scale(rows: pd.DataFrame) -> float:
    """Return the factor that converts slip to the displacement of a drawn block, in block spacings.

    The result is the largest factor that keeps each block within MAX_DRAWN_DISPLACEMENT of its
    position at rest, and each spring longer than MIN_DRAWN_SPRING times its length at rest.

    rows : blocks at each instant (column row), from left to right
    """
    largest_for_blocks = MAX_DRAWN_DISPLACEMENT / rows["slip"].max()
    # Two neighbouring blocks come closer if the left one slips more than the right one.
    slip_difference = rows.groupby("row")["slip"].diff()
    largest_approach = float(-slip_difference.min())
    length_at_rest = 1.0 - BLOCK_WIDTH
    largest_for_springs = (1.0 - MIN_DRAWN_SPRING) * length_at_rest / largest_approach
    return min(largest_for_blocks, largest_for_springs)


def position_of_arresting_block(run: xr.Dataset) -> float:
    """Return the position of the first block on the left that was never released."""
    is_released = np.isfinite(run["release_time"].values)
    leftmost_released = run["x"].values[is_released].min()
    return float(leftmost_released - run.attrs["dx"])


def view(run: xr.Dataset) -> tuple[float, float]:
    """Return the positions of the first and last block in view.

    If the levels on both sides are equal, the nucleation is in the middle of the view. Otherwise
    the left front stops, and the view begins a little beyond the block that stops it.
    """
    if run.attrs["left"] == run.attrs["right"]:
        return -0.5 * VIEW_WIDTH, 0.5 * VIEW_WIDTH
    first = position_of_arresting_block(run) - BLOCKS_BEYOND_ARREST
    return first, first + VIEW_WIDTH


def instants(run: xr.Dataset) -> list[tuple[str, int]]:
    """Return the name of each drawn instant, and the index of its sample in time.

    The instants are the start, the middle between the start and the first stick, the first stick,
    the middle between the first stick and the last instant, and the last instant. The last instant
    is the last sample at which the rupture still lies within the view.
    """
    first_in_view, last_in_view = view(run)
    x = run["sample_position"].values
    # These arrays have one row for each sampled time and one column for each position.
    slip, velocity = run["sample_slip"].values, run["sample_velocity"].values
    is_outside_view = (x <= first_in_view) | (x >= last_in_view)
    has_slip_outside = (slip[:, is_outside_view] > 0.0).any(axis=1)
    last = int(np.flatnonzero(~has_slip_outside)[-1])
    is_stuck = (slip > 0.0) & (velocity <= 0.0)
    samples_with_stuck_blocks = np.flatnonzero(is_stuck[: last + 1].any(axis=1))
    # If no block sticks, the run remains a crack until the last instant.
    first_stick = int(samples_with_stuck_blocks[0]) if samples_with_stuck_blocks.size else last
    # If two instants fall on the same sample, the name of the later one replaces the other.
    name_of_sample = {
        0: "start",
        first_stick // 2: "crack",
        first_stick: "first stick",
        (first_stick + last) // 2: "later",
        last: rupture_name(x, velocity[last], is_stuck[last]),
    }
    return [(name, sample) for sample, name in sorted(name_of_sample.items())]


def rupture_name(x: np.ndarray, velocity: np.ndarray, is_stuck: np.ndarray) -> str:
    """Return "crack", "two pulses", "pulse" or "arrested" for the blocks at one instant.

    x, velocity, is_stuck : position of each block, its slip velocity, and whether it has stuck
        after sliding
    """
    centre_has_stuck = is_stuck[x == 0.0].all()
    if not centre_has_stuck:
        return "crack"
    # A pulse runs on each side on which blocks slide.
    left_slides = (velocity[x < 0.0] > 0.0).any()
    right_slides = (velocity[x > 0.0] > 0.0).any()
    if left_slides and right_slides:
        return "two pulses"
    return "pulse" if left_slides or right_slides else "arrested"


def draw(table: pd.DataFrame) -> Figure:
    """Draw one panel for each boundary condition: the pre-stress, and below it rows of blocks.

    There is one row for each instant; time increases downwards.
    """
    row_counts = table.groupby("panel")["row"].nunique()
    # Each panel has a strip with the pre-stress, and below it axes with the rows of blocks. These
    # are their heights in inches, from top to bottom. The figure also has room for titles, axis
    # labels and the legend.
    heights: list[float] = []
    for name, row_distance in ROW_DISTANCES.items():
        rows_height = SPACING_HEIGHT * (row_distance * row_counts[name] + 0.12)
        heights += [STRIP_HEIGHT, rows_height]
    figure = Figure(figsize=(FIGURE_WIDTH, sum(heights) + 1.75), layout="constrained")
    all_axes = figure.subplots(4, 1, height_ratios=heights)
    strips, axes_of_rows = all_axes[::2], all_axes[1::2]
    for name, letter, strip, axes in zip(ROW_DISTANCES, "ab", strips, axes_of_rows, strict=True):
        rows = table[table["panel"] == name]
        draw_rows(axes, rows, name)
        strip.sharex(axes)
        draw_prestress_strip(strip, rows[rows["row"] == 0])
        strip.set_title(TITLES[name].format(**rows.iloc[0]), loc="center")
        panel_letter(strip, letter)
    legend_below(figure, legend_entries(), columns=4)
    return figure


def legend_entries() -> list[Line2D]:
    """Return a legend entry for each state of a block, and for the block that stops the front."""
    square: Look = {"marker": "s", "markersize": 6.0, "markeredgecolor": "0.2"}
    handles = [
        entry(name, markerfacecolor=colour, **square) for name, colour in STATE_COLOURS.items()
    ]
    frame: Look = {"markerfacecolor": "none", "markeredgecolor": BLACK, "markeredgewidth": 1.8}
    handles.append(entry("never released: stops the left front", **(square | frame)))
    return handles


def draw_prestress_strip(axes: Axes, blocks: pd.DataFrame) -> None:
    """Draw the pre-stress of each block as a bar, with a tick at the level on the left."""
    prestress, left_level = blocks["prestress"], blocks["left"].iloc[0]
    axes.axhline(0.0, color=BLACK, linewidth=0.6)
    axes.bar(blocks["x"], prestress, width=BLOCK_WIDTH, color=GREY)
    axes.set_ylabel(r"$\tau$", rotation=0, ha="right", va="center")
    bottom, top = min(0.0, prestress.min()) - 0.15, 1.12
    ticks = [0.0, 1.0]
    # The level on the left has a tick if its number does not overlap that of 0 or 1.
    if min(abs(left_level), abs(left_level - 1.0)) > 0.2 * (top - bottom):
        ticks.append(left_level)
    axes.set(ylim=(bottom, top), yticks=ticks)
    axes.tick_params(axis="x", length=0, labelbottom=False)
    axes.tick_params(axis="y", labelsize=7)
    axes.spines[["right", "top", "bottom"]].set_visible(False)


def draw_rows(axes: Axes, rows: pd.DataFrame, name: str) -> None:
    """Draw the blocks of one run in a row for each instant, with their springs.

    Distances are in spacings. The ground of row n lies n row distances below 0.

    name : the boundary condition; with the displacement held, there are leaf springs
    """
    # The panel ends inside of the outermost blocks, so that their springs are cut.
    low, high = rows["x"].min() + 0.35, rows["x"].max() - 0.35
    has_leaf_springs, row_distance = name == "displacement", ROW_DISTANCES[name]
    for row, blocks in rows.groupby("row"):
        ground = -row_distance * row
        draw_row(axes, blocks.sort_values("x"), (low, high), ground, has_leaf_springs)
        first = blocks.iloc[0]
        text = rf"$t = {first['time']:.1f}$" + "\n" + first["instant"]
        look: Look = {"ha": "right", "va": "center", "linespacing": 0.95}
        axes.text(low - 0.2, ground + 0.5 * BLOCK_HEIGHT, text, **look)
    top = (PLATE_HEIGHT if has_leaf_springs else BLOCK_HEIGHT) + 0.08
    bottom = -row_distance * rows["row"].max() - 0.2
    axes.set(xlim=(low, high), ylim=(bottom, top), yticks=[])
    scale = rf"{rows['scale'].iloc[0]:.2g} $\times$ slip $u$"
    axes.set_xlabel(f"position $x$ at rest; displacement drawn: {scale}")
    axes.xaxis.set_major_locator(MultipleLocator(2))
    axes.spines[["left", "right", "top"]].set_visible(False)


def draw_row(
    axes: Axes,
    blocks: pd.DataFrame,
    ends: tuple[float, float],
    ground: float,
    has_leaf_springs: bool,
) -> None:
    """Draw the blocks at one instant, displaced by their scaled slip, and their springs.

    ends : horizontal positions of the ends of the ground, and of the plate above the blocks
    ground : height of the ground
    """
    positions_at_rest = blocks["x"].to_numpy()
    centres = positions_at_rest + (blocks["scale"] * blocks["slip"]).to_numpy()
    draw_coil_springs(axes, centres, ground)
    axes.plot(ends, [ground, ground], color=BLACK, linewidth=0.8)
    # A tick on the ground marks the position at rest.
    axes.vlines(positions_at_rest, ground - 0.09, ground, color="0.4", linewidth=0.6)
    if has_leaf_springs:
        plate = ground + PLATE_HEIGHT
        axes.plot(ends, [plate, plate], color=BLACK, linewidth=1.8)
        draw_leaf_springs(axes, positions_at_rest, centres, ground)
    # The block that stops the left front has a thick frame.
    is_framed = blocks["arresting_block"]
    look: Look = {"edgecolor": np.where(is_framed, BLACK, "0.2")}
    look |= {"linewidth": np.where(is_framed, 1.8, 0.5), "zorder": 3}
    look["color"] = blocks["state"].map(STATE_COLOURS)
    axes.bar(centres, BLOCK_HEIGHT, BLOCK_WIDTH, ground, **look)


def draw_coil_springs(axes: Axes, centres: np.ndarray, ground: float) -> None:
    """Draw a coil spring between each pair of neighbouring blocks, at half of their height.

    centres : horizontal positions of the centres of the blocks
    ground : height of the ground on which the blocks stand
    """
    begin, end = centres[:-1] + 0.5 * BLOCK_WIDTH, centres[1:] - 0.5 * BLOCK_WIDTH
    # One row for each spring, and one column for each point of the zigzag.
    x = np.linspace(begin, end, COIL_SHAPE.size, axis=1)
    y = ground + 0.5 * BLOCK_HEIGHT + COIL_SHAPE
    axes.plot(x.T, y, color="0.35", linewidth=0.6, gid="coil springs")


def draw_leaf_springs(
    axes: Axes, positions_at_rest: np.ndarray, centres: np.ndarray, ground: float
) -> None:
    """Draw the leaf spring of each block, from the plate above its position at rest to the block.

    The spring is clamped vertically at both ends.

    centres : horizontal positions of the centres of the blocks
    ground : height of the ground on which the blocks stand
    """
    # The fraction of the height from the plate down to the block.
    fraction = np.linspace(0.0, 1.0, 15)
    plate, top_of_block = ground + PLATE_HEIGHT, ground + BLOCK_HEIGHT
    # One row for each spring, and one column for each point of it. The shape is a cubic polynomial
    # that is vertical at both ends.
    displacement = (centres - positions_at_rest)[:, np.newaxis]
    x = positions_at_rest[:, np.newaxis] + displacement * fraction**2 * (3.0 - 2.0 * fraction)
    y = plate + (top_of_block - plate) * fraction
    axes.plot(x.T, y, color=BLUE, linewidth=0.9, gid="leaf springs")
