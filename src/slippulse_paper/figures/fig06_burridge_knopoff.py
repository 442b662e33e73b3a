"""Figure 6: the onset of pulses as blocks and springs, drawn from runs at dx = 1."""

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
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
# Which runs of each simulation the figure can draw, in the words of configuration/drawn.py.
DRAWS = {
    "burridge_knopoff_displacement": "boundary displacement and equal levels above 0",
    "burridge_knopoff_stress": "boundary stress, left level below 0, right level 0 and no steps",
}

# Distance between the rows of blocks of each panel, in spacings.
ROW_DISTANCES = {"displacement": 1.62, "stress": 0.86}
# Blocks in view without the middle one, and those in view beyond the block that stops the front.
VIEW_WIDTH, BLOCKS_BEYOND_ARREST = 18, 2
# Width and height of a block, and height of the plate above the ground, in spacings.
BLOCK_WIDTH, BLOCK_HEIGHT = 0.5, 0.44
PLATE_HEIGHT = 1.12
COIL_SHAPE = np.pad(0.1 * (-1.0) ** np.arange(9), 1)
# Largest drawn displacement in spacings, and shortest drawn spring divided by its length.
MAX_DRAWN_DISPLACEMENT, MIN_DRAWN_SPRING = 0.85, 0.35
# Width of the figure, height of a spacing and height of the strip with the pre-stress, in inches.
# The figure is narrow, so that its text can be read in one column.
FIGURE_WIDTH = 5.4
SPACING_HEIGHT, STRIP_HEIGHT = 0.34, 0.42
# A light, a medium and a dark colour, which differ in greyscale too.
STATE_COLOURS = {"at rest": "#e2e8ee", "sliding": ORANGE, "stuck after sliding": "#00402f"}
TITLES = {
    "displacement": r"$\Gamma = 1$: leaf springs to a held plate, "
    r"$\gamma = {gamma:g}$, $\tau_0 = {left:g}$",
    "stress": r"$\Gamma = 0$: a constant stress on each block, "
    r"$\tau_{{0,l}} = {left:g}$, $\tau_{{0,r}} = {right:g}$",
}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return one row for each panel, instant and block of the first run of each sweep.

    The column x has the position at rest.
    """
    panels = []
    for name in ROW_DISTANCES:
        run = point(data[f"burridge_knopoff_{name}"], 0)
        parts = []
        low, high = window(run)
        # The springs of one more block on each side are partly in view.
        shown = run.sel(sample_position=slice(low - 1.5, high + 1.5))
        x = shown["sample_position"].values
        for row, (instant, sample) in enumerate(instants(run)):
            now = shown.isel(sample_time=sample)
            slip, velocity = now["sample_slip"].values, now["sample_velocity"].values
            frame = pd.DataFrame({"x": x, "slip": slip, "slip_velocity": velocity})
            frame["prestress"] = prestress_from(run.attrs)(x)
            state = np.where(slip > 0.0, "stuck after sliding", "at rest")
            frame["state"] = np.where(velocity > 0.0, "sliding", state)
            parts.append(frame.assign(row=row, instant=instant, time=float(now["sample_time"])))
        rows = pd.concat(parts, ignore_index=True)
        closer = float(-rows.groupby("row")["slip"].diff().min())
        largest = (1.0 - MIN_DRAWN_SPRING) * (1.0 - BLOCK_WIDTH) / closer
        rows["scale"] = min(MAX_DRAWN_DISPLACEMENT / rows["slip"].max(), largest)
        rows["arresting_block"] = (rows["x"] == arresting_block(run)) & (name == "stress")
        parameters = {key: run.attrs[key] for key in ("gamma", "left", "right", "width")}
        panels.append(rows.assign(panel=name, **parameters))
    return pd.concat(panels, ignore_index=True)


def arresting_block(run: xr.Dataset) -> float:
    """Return the position of the first block on the left that was never released."""
    return float(run["x"].values[np.isfinite(run["release_time"].values)].min() - run.attrs["dx"])


def window(run: xr.Dataset) -> tuple[float, float]:
    """Return the positions of the first and last block in view.

    The view is centred on the nucleation, or begins at the arrest of the left front if it stops.
    """
    if run.attrs["left"] == run.attrs["right"]:
        return -0.5 * VIEW_WIDTH, 0.5 * VIEW_WIDTH
    low = arresting_block(run) - BLOCKS_BEYOND_ARREST
    return low, low + VIEW_WIDTH


def instants(run: xr.Dataset) -> list[tuple[str, int]]:
    """Return the name of each drawn instant, and the index of its sample in time.

    The instants are the start, half of the time of the first stick, the first stick, the last
    instant at which no block outside of the view has slipped, and one halfway to it.
    """
    low, high = window(run)
    x, velocity = run["sample_position"].values, run["sample_velocity"].values
    slip = run["sample_slip"].values
    is_outside = (x <= low) | (x >= high)
    slipped_outside = (slip[:, is_outside] > 0.0).any(axis=1)
    last = int(np.flatnonzero(~slipped_outside)[-1])
    stuck = (slip > 0.0) & (velocity <= 0.0)
    # If no block sticks, the run remains a crack until the last instant.
    stick = int(np.argmax(stuck.any(axis=1))) if stuck[: last + 1].any() else last
    last_name = "crack"
    if stuck[last, x == 0.0].all():
        is_sliding = [bool((velocity[last, side] > 0.0).any()) for side in (x < 0.0, x > 0.0)]
        last_name = ("arrested", "pulse", "two pulses")[sum(is_sliding)]
    later = (stick + last) // 2
    # If two instants fall on the same sample, the name of the later one is kept.
    names = {0: "start", stick // 2: "crack", stick: "first stick", later: "later"}
    names[last] = last_name
    return [(name, sample) for sample, name in sorted(names.items())]


def draw(table: pd.DataFrame) -> Figure:
    """Draw one panel for each boundary condition: the pre-stress, and rows of blocks with time
    increasing downwards.
    """
    counts = table.groupby("panel")["row"].nunique()
    ratios: list[float] = []
    for name, pitch in ROW_DISTANCES.items():
        ratios += [STRIP_HEIGHT, SPACING_HEIGHT * (pitch * counts[name] + 0.12)]
    figure = Figure(figsize=(FIGURE_WIDTH, sum(ratios) + 1.75), layout="constrained")
    panels = figure.subplots(4, 1, height_ratios=ratios)
    for name, letter, strip, axes in zip(
        ROW_DISTANCES, "ab", panels[::2], panels[1::2], strict=True
    ):
        rows = table[table["panel"] == name]
        draw_rows(axes, rows, name)
        first = rows[rows["row"] == 0]
        strip.sharex(axes)
        strip.axhline(0.0, color=BLACK, linewidth=0.6)
        strip.bar(first["x"], first["prestress"], width=BLOCK_WIDTH, color=GREY)
        strip.set_ylabel(r"$\tau$", rotation=0, ha="right", va="center")
        lowest, ticks = min(0.0, first["prestress"].min()), {0.0, 1.0, first["left"].iloc[0]}
        strip.set(ylim=(lowest - 0.15, 1.12), yticks=sorted(ticks))
        strip.tick_params(axis="x", length=0, labelbottom=False)
        strip.tick_params(axis="y", labelsize=7)
        strip.spines[["right", "top", "bottom"]].set_visible(False)
        strip.set_title(TITLES[name].format(**rows.iloc[0]), loc="center")
        panel_letter(strip, letter)
    square: Look = {"marker": "s", "markersize": 6.0, "markeredgecolor": "0.2"}
    handles = [
        entry(name, markerfacecolor=colour, **square) for name, colour in STATE_COLOURS.items()
    ]
    square |= {"markerfacecolor": "none", "markeredgecolor": BLACK, "markeredgewidth": 1.8}
    handles.append(entry("never released: stops the left front", **square))
    legend_below(figure, handles, 4)
    return figure


def draw_rows(axes: Axes, rows: pd.DataFrame, name: str) -> None:
    """Draw blocks, coil springs and leaf springs of one run, with one line for each instant."""
    low, high = rows["x"].min() + 0.35, rows["x"].max() - 0.35
    leaf, pitch = name == "displacement", ROW_DISTANCES[name]
    for row, state in rows.groupby("row"):
        state = state.sort_values("x")
        base, rest = -pitch * row, state["x"].to_numpy()
        centre = rest + (state["scale"] * state["slip"]).to_numpy()
        x = np.linspace(
            centre[:-1] + 0.5 * BLOCK_WIDTH, centre[1:] - 0.5 * BLOCK_WIDTH, COIL_SHAPE.size, axis=1
        )
        y = base + 0.5 * BLOCK_HEIGHT + COIL_SHAPE
        axes.plot(x.T, y, color="0.35", linewidth=0.6, gid="coil springs")
        axes.plot([low, high], [base, base], color=BLACK, linewidth=0.8)
        axes.vlines(rest, base - 0.09, base, color="0.4", linewidth=0.6)
        if leaf:
            axes.plot([low, high], [base + PLATE_HEIGHT] * 2, color=BLACK, linewidth=1.8)
            # A leaf spring is clamped vertically at the block, and at the plate above the position
            # at rest.
            along, plate = np.linspace(0.0, 1.0, 15), base + PLATE_HEIGHT
            x = rest[:, None] + (centre - rest)[:, None] * along**2 * (3.0 - 2.0 * along)
            y = plate + (base + BLOCK_HEIGHT - plate) * along
            axes.plot(x.T, y, color=BLUE, linewidth=0.9, gid="leaf springs")
        framed, colours = state["arresting_block"], state["state"].map(STATE_COLOURS)
        look: Look = {"edgecolor": np.where(framed, BLACK, "0.2")}
        look |= {"linewidth": np.where(framed, 1.8, 0.5), "zorder": 3}
        axes.bar(centre, BLOCK_HEIGHT, BLOCK_WIDTH, base, color=colours, **look)
        text = rf"$t = {state['time'].iloc[0]:.1f}$" + "\n" + state["instant"].iloc[0]
        look = {"ha": "right", "va": "center", "linespacing": 0.95}
        axes.text(low - 0.2, base + 0.5 * BLOCK_HEIGHT, text, **look)
    top = (PLATE_HEIGHT if leaf else BLOCK_HEIGHT) + 0.08
    axes.set(xlim=(low, high), ylim=(-pitch * rows["row"].max() - 0.2, top), yticks=[])
    scale = rf"{rows['scale'].iloc[0]:.2g} $\times$ slip $u$"
    axes.set_xlabel(f"position $x$ at rest; displacement drawn: {scale}")
    axes.xaxis.set_major_locator(MultipleLocator(2))
    axes.spines[["left", "right", "top"]].set_visible(False)
