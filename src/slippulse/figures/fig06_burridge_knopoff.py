"""Figure 6: the onset of pulses as blocks and springs, from runs at dx = 1."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.ticker import MultipleLocator

from ..measure.fronts import path
from ..sweep import point
from .style import GREEN, ORANGE, PAGE, new_figure, panel_letter

INSTANTS = 5
BLOCK, HEIGHT, PLATE = 0.5, 0.42, 1.25
COLOURS = {"at rest": "#c9d3dd", "sliding": ORANGE, "stuck after sliding": GREEN}
TITLES = {
    "displacement": r"$\Gamma = 1$: leaf springs to a plate that is held; two pulses leave the nucleation",
    "stress": r"$\Gamma = 0$: each block is pushed by its own pre-stress; the left front arrests, one pulse is left",
}


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """State of every block at a few instants of both runs; displacements drawn are slip times one scale."""
    parts = []
    for boundary in ("displacement", "stress"):
        run = point(data[f"burridge_knopoff_{boundary}"], 0)
        times = instants(run)
        x, sampled = run["sample_position"].values, run["sample_time"].values
        release = run["release_time"].interp(x=x, method="nearest", kwargs={"fill_value": np.nan}).values
        level = run["prestress"].interp(x=x, method="nearest", kwargs={"fill_value": "extrapolate"}).values
        stuck_left = float(np.nanmin(np.where(np.isfinite(release), x, np.nan))) - run.attrs["dx"]
        for row, time in enumerate(times):
            at = int(np.argmin(np.abs(sampled - time)))
            velocity, slip = run["sample_velocity"].values[at], run["sample_slip"].values[at]
            state = np.where(
                velocity > 0.0, "sliding", np.where(slip > 0.0, "stuck after sliding", "at rest")
            )
            parts.append(
                pd.DataFrame(
                    {
                        "panel": boundary,
                        "row": row,
                        "time": sampled[at],
                        "x": x,
                        "slip": slip,
                        "slip_velocity": velocity,
                        "prestress": level,
                        "state": state,
                        "arresting_block": (x == stuck_left) & (boundary == "stress"),
                    }
                )
            )
    rows = pd.concat(parts, ignore_index=True)
    # One scale for both runs: the largest slip moves a block by three quarters of a spacing.
    rows["scale"] = 0.75 / float(rows["slip"].max())
    return rows


def instants(run: xr.Dataset) -> np.ndarray:
    """Evenly from early in the crack to the end of the run, the start left out."""
    times = run["sample_time"].values
    released, _ = path(run, "right")
    first = float(released[min(2, released.size - 1)])
    return np.linspace(first, float(times[-1]), INSTANTS)


def plot(table: pd.DataFrame) -> Figure:
    """One panel a boundary condition, time downwards."""
    figure = new_figure(PAGE, 7.2)
    panels = figure.subplots(2, 1, height_ratios=[1.25, 1.0])
    for axes, boundary, letter in zip(panels, TITLES, "ab", strict=True):
        rows = table[table["panel"] == boundary]
        draw_rows(axes, rows, leaf=boundary == "displacement")
        axes.set_title(TITLES[boundary], fontsize=8)
        panel_letter(axes, letter)
    handles = [
        Line2D(
            [],
            [],
            marker="s",
            linestyle="none",
            markersize=6,
            color=colour,
            markeredgecolor="0.2",
            label=name,
        )
        for name, colour in COLOURS.items()
    ]
    handles.append(
        Line2D([], [], marker="s", linestyle="none", markersize=6, markerfacecolor="none", markeredgecolor="black",
               markeredgewidth=1.8, label="block that stops the left front")
    )  # fmt: skip
    scale = float(table["scale"].iloc[0])
    figure.legend(
        handles=handles, loc="outside lower center", ncols=4, title=f"displacement drawn: {scale:.2g} × slip"
    )
    return figure


def draw_rows(axes, rows: pd.DataFrame, leaf: bool) -> None:
    """Blocks, coil springs and leaf springs of one run, one line an instant."""
    touched = rows.loc[rows["slip"] > 0.0, "x"]
    low, high = float(touched.min()) - 1.6, float(touched.max()) + 1.6
    if leaf:
        low, high = -max(-low, high), max(-low, high)
    pitch = 2.0 if leaf else 1.25
    for row, state in rows.groupby("row"):
        state = state[(state["x"] >= low) & (state["x"] <= high)].sort_values("x")
        base = -pitch * row
        centre = (state["x"] + state["scale"] * state["slip"]).to_numpy()
        coils = [coil(a + 0.5 * BLOCK, b - 0.5 * BLOCK, base + 0.5 * HEIGHT) for a, b in pairwise(centre)]
        axes.add_collection(LineCollection(coils, colors="0.35", linewidths=0.6))
        axes.plot([low, high], [base, base], color="black", linewidth=0.8)
        if leaf:
            axes.plot([low, high], [base + PLATE] * 2, color="black", linewidth=1.2)
            bent = [
                bow(x, base + PLATE, now, base + HEIGHT)
                for x, now in zip(state["x"].to_numpy(), centre, strict=True)
            ]
            axes.add_collection(LineCollection(bent, colors="#0072B2", linewidths=0.8))
        for now, block in zip(centre, state.itertuples(), strict=True):
            axes.add_patch(
                Rectangle(
                    (now - 0.5 * BLOCK, base),
                    BLOCK,
                    HEIGHT,
                    facecolor=COLOURS[block.state],
                    edgecolor="black" if block.arresting_block else "0.2",
                    linewidth=1.8 if block.arresting_block else 0.5,
                    zorder=3,
                    gid=block.state,
                )
            )
        axes.text(
            low - 0.2,
            base + 0.5 * HEIGHT,
            rf"$\bar t = {state['time'].iloc[0]:.1f}$",
            ha="right",
            va="center",
        )
    count = rows["row"].nunique()
    axes.set_xlim(low - 2.4, high)
    axes.set_ylim(-pitch * (count - 1) - 0.25, (PLATE if leaf else HEIGHT) + 0.2)
    axes.set_yticks([])
    axes.set_xlabel(r"position at rest $\bar x$ (spacing 1)")
    axes.xaxis.set_major_locator(MultipleLocator(2))
    for side in ("left", "right", "top"):
        axes.spines[side].set_visible(False)


def coil(start: float, end: float, y: float, turns: int = 4, size: float = 0.09) -> np.ndarray:
    """A zigzag from start to end at height y."""
    x = np.linspace(start, end, 2 * turns + 3)
    offset = np.zeros(x.size)
    offset[1:-1] = size * (-1.0) ** np.arange(x.size - 2)
    return np.column_stack([x, y + offset])


def bow(x_top: float, y_top: float, x_bottom: float, y_bottom: float) -> np.ndarray:
    """A leaf spring clamped upright at both ends."""
    share = np.linspace(0.0, 1.0, 15)
    smooth = share**2 * (3.0 - 2.0 * share)
    return np.column_stack([x_top + (x_bottom - x_top) * smooth, y_top + (y_bottom - y_top) * share])
