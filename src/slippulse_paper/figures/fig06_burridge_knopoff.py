"""Figure 6: the onset of pulses as blocks and springs, from runs at dx = 1."""

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
# A run of each simulation that the figure can draw, in words of configuration/drawn.py.
DRAWS = {
    "burridge_knopoff_displacement": "boundary displacement and equal levels above 0",
    "burridge_knopoff_stress": "boundary stress, left level below 0, right level 0 and no steps",
}

# Panels, with the distance between their rows of blocks in spacings.
PITCH = {"displacement": 1.62, "stress": 0.86}
# Blocks shown besides the middle one, and blocks shown beyond the one that stops the left front.
SHOWN, BEYOND = 18, 2
# Width and height of a block, and height of the plate above the ground, in spacings.
BLOCK, HEIGHT = 0.5, 0.44
PLATE = 1.12
COIL = np.pad(0.1 * (-1.0) ** np.arange(9), 1)
# Largest drawn displacement over a spacing, and shortest spring over its length.
FARTHEST, SHORTEST = 0.85, 0.35
# Inches of the width, of a spacing's height and of the strip with the pre-stress. The width is
# small, so that the text can be read in one column.
WIDTH = 5.4
UNIT, STRIP = 0.34, 0.42
# Light, middle and dark, so that grey tells them apart too.
COLOURS = {"at rest": "#e2e8ee", "sliding": ORANGE, "stuck after sliding": "#00402f"}
TITLES = {
    "displacement": r"$\Gamma = 1$: leaf springs to a held plate, "
    r"$\gamma = {gamma:g}$, $\tau_0 = {left:g}$",
    "stress": r"$\Gamma = 0$: a constant stress on each block, "
    r"$\tau_{{0,l}} = {left:g}$, $\tau_{{0,r}} = {right:g}$",
}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """First run of each sweep, one row a panel, instant and block; x is the position at rest."""
    panels = []
    for name in PITCH:
        run = point(data[f"burridge_knopoff_{name}"], 0)
        parts = []
        low, high = window(run)
        # The springs of one more block on each side reach into view.
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
        largest = (1.0 - SHORTEST) * (1.0 - BLOCK) / closer
        rows["scale"] = min(FARTHEST / rows["slip"].max(), largest)
        rows["arresting_block"] = (rows["x"] == arresting_block(run)) & (name == "stress")
        parameters = {key: run.attrs[key] for key in ("gamma", "left", "right", "width")}
        panels.append(rows.assign(panel=name, **parameters))
    return pd.concat(panels, ignore_index=True)


def arresting_block(run: xr.Dataset) -> float:
    """Position of the first block on the left that was never released."""
    return float(run["x"].values[np.isfinite(run["release_time"].values)].min() - run.attrs["dx"])


def window(run: xr.Dataset) -> tuple[float, float]:
    """Positions of the first and last block shown: about the nucleation, or the arrest if any."""
    if run.attrs["left"] == run.attrs["right"]:
        return -0.5 * SHOWN, 0.5 * SHOWN
    low = arresting_block(run) - BEYOND
    return low, low + SHOWN


def instants(run: xr.Dataset) -> list[tuple[str, int]]:
    """Names and samples drawn: start, first stick, half of its time, two more with all in view."""
    low, high = window(run)
    x, velocity = run["sample_position"].values, run["sample_velocity"].values
    slip = run["sample_slip"].values
    in_view = ~(slip[:, (x <= low) | (x >= high)] > 0.0).any(axis=1)
    last = int(np.flatnonzero(in_view)[-1])
    stuck = (slip > 0.0) & (velocity <= 0.0)
    # A run in which nothing sticks stays a crack to the end.
    stick = int(np.argmax(stuck.any(axis=1))) if stuck[: last + 1].any() else last
    sides = sum(bool((velocity[last, side] > 0.0).any()) for side in (x < 0.0, x > 0.0))
    ending = ("arrested", "pulse", "two pulses")[sides] if stuck[last, x == 0.0].all() else "crack"
    later = (stick + last) // 2
    # Instants that are the same sample keep the last name.
    names = {0: "start", stick // 2: "crack", stick: "first stick", later: "later", last: ending}
    return [(name, sample) for sample, name in sorted(names.items())]


def draw(table: pd.DataFrame) -> Figure:
    """Draw a panel a boundary condition: pre-stress, and rows of blocks with time downwards."""
    counts = table.groupby("panel")["row"].nunique()
    ratios: list[float] = []
    for name, pitch in PITCH.items():
        ratios += [STRIP, UNIT * (pitch * counts[name] + 0.12)]
    figure = Figure(figsize=(WIDTH, sum(ratios) + 1.75), layout="constrained")
    panels = figure.subplots(4, 1, height_ratios=ratios)
    for name, letter, strip, axes in zip(PITCH, "ab", panels[::2], panels[1::2], strict=True):
        rows = table[table["panel"] == name]
        draw_rows(axes, rows, name)
        first = rows[rows["row"] == 0]
        strip.sharex(axes)
        strip.axhline(0.0, color=BLACK, linewidth=0.6)
        strip.bar(first["x"], first["prestress"], width=BLOCK, color=GREY)
        strip.set_ylabel(r"$\tau$", rotation=0, ha="right", va="center")
        lowest, ticks = min(0.0, first["prestress"].min()), {0.0, 1.0, first["left"].iloc[0]}
        strip.set(ylim=(lowest - 0.15, 1.12), yticks=sorted(ticks))
        strip.tick_params(axis="x", length=0, labelbottom=False)
        strip.tick_params(axis="y", labelsize=7)
        strip.spines[["right", "top", "bottom"]].set_visible(False)
        strip.set_title(TITLES[name].format(**rows.iloc[0]), loc="center")
        panel_letter(strip, letter)
    square: Look = {"marker": "s", "markersize": 6.0, "markeredgecolor": "0.2"}
    handles = [entry(name, markerfacecolor=colour, **square) for name, colour in COLOURS.items()]
    square |= {"markerfacecolor": "none", "markeredgecolor": BLACK, "markeredgewidth": 1.8}
    handles.append(entry("never released: stops the left front", **square))
    legend_below(figure, handles, 4)
    return figure


def draw_rows(axes: Axes, rows: pd.DataFrame, name: str) -> None:
    """Draw blocks, coil springs and leaf springs of one run, one line an instant."""
    low, high = rows["x"].min() + 0.35, rows["x"].max() - 0.35
    leaf, pitch = name == "displacement", PITCH[name]
    for row, state in rows.groupby("row"):
        state = state.sort_values("x")
        base, rest = -pitch * row, state["x"].to_numpy()
        centre = rest + (state["scale"] * state["slip"]).to_numpy()
        x = np.linspace(centre[:-1] + 0.5 * BLOCK, centre[1:] - 0.5 * BLOCK, COIL.size, axis=1)
        y = base + 0.5 * HEIGHT + COIL
        axes.plot(x.T, y, color="0.35", linewidth=0.6, gid="coil springs")
        axes.plot([low, high], [base, base], color=BLACK, linewidth=0.8)
        axes.vlines(rest, base - 0.09, base, color="0.4", linewidth=0.6)
        if leaf:
            axes.plot([low, high], [base + PLATE] * 2, color=BLACK, linewidth=1.8)
            # A leaf is clamped upright at the plate above the position at rest, and at the block.
            along, plate = np.linspace(0.0, 1.0, 15), base + PLATE
            x = rest[:, None] + (centre - rest)[:, None] * along**2 * (3.0 - 2.0 * along)
            y = plate + (base + HEIGHT - plate) * along
            axes.plot(x.T, y, color=BLUE, linewidth=0.9, gid="leaf springs")
        framed, colours = state["arresting_block"], state["state"].map(COLOURS)
        look: Look = {"edgecolor": np.where(framed, BLACK, "0.2")}
        look |= {"linewidth": np.where(framed, 1.8, 0.5), "zorder": 3}
        axes.bar(centre, HEIGHT, BLOCK, base, color=colours, **look)
        text = rf"$t = {state['time'].iloc[0]:.1f}$" + "\n" + state["instant"].iloc[0]
        look = {"ha": "right", "va": "center", "linespacing": 0.95}
        axes.text(low - 0.2, base + 0.5 * HEIGHT, text, **look)
    top = (PLATE if leaf else HEIGHT) + 0.08
    axes.set(xlim=(low, high), ylim=(-pitch * rows["row"].max() - 0.2, top), yticks=[])
    scale = rf"{rows['scale'].iloc[0]:.2g} $\times$ slip $u$"
    axes.set_xlabel(f"position $x$ at rest; displacement drawn: {scale}")
    axes.xaxis.set_major_locator(MultipleLocator(2))
    axes.spines[["left", "right", "top"]].set_visible(False)
