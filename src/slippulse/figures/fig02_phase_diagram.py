"""Figure 2: which regime a rupture ends in, by boundary and pre-stress."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from ..data.numerals import setting
from ..measure.regime import REGIMES
from ..model.prestress import Prestress
from . import style
from .style import BLACK, GREY, Look, entry, legend_below, new_figure, panel_letter

NEEDS = {
    "measured": [
        "regimes_displacement",
        "regimes_displacement_asymmetric",
        "regimes_stress",
        "regimes_beyond",
    ],
    "predicted": [
        "regimes_displacement",
        "regimes_displacement_asymmetric",
        "regimes_stress",
        "regimes_beyond",
    ],
    "coarser": [
        "regimes_displacement",
        "regimes_displacement_asymmetric",
        "regimes_stress",
        "regimes_beyond",
    ],
    "settings": ["measure.steady_tolerance"],
}


class Diagram(NamedTuple):
    """A panel: the sweep, columns of its axes and their labels, its title, and a pre-stress as an example."""

    sweep: str
    x: str
    y: str
    labels: tuple[str, str]
    title: str
    example: Prestress


LEFT, RIGHT = r"$\tau_{0,l}$ (left)", r"$\tau_{0,r}$ (right)"
DIAGRAMS = {
    "a": Diagram(
        "regimes_displacement", "left", "gamma", (r"$\tau_0$ (both sides)", r"$\gamma$"), r"$\Gamma = 1$, symmetric",
        Prestress(0.4, 0.4),
    ),
    # Each line of cells is one gamma and one level on the left.
    "b": Diagram(
        "regimes_displacement_asymmetric", "right", "line", (RIGHT, r"$\gamma$"), r"$\Gamma = 1$, asymmetric",
        Prestress(-0.5, 0.4),
    ),
    "c": Diagram("regimes_stress", "right", "left", (RIGHT, LEFT), r"$\Gamma = 0$", Prestress(-0.5, 0.3)),
    "d": Diagram(
        "regimes_beyond", "beyond", "left", (r"$\tau$ beyond a step", LEFT), r"$\Gamma = 0$, $\tau_{0,r} = 0$",
        Prestress(-0.5, 0.0, steps=((6.0, 0.3),)),
    ),
}  # fmt: skip
# Colour and marker of each regime; markers alone tell them apart in grey.
LOOKS = {
    "arrested": (GREY, "X"),
    "crack-like, two-way": (style.BLUE, "s"),
    "crack-like, one-way": (style.SKY, "D"),
    "pulses, two-way": (style.ORANGE, "*"),
    "pulse, one-way, growing": (style.PURPLE, "^"),
    "pulse, one-way, steady": (style.YELLOW, "o"),
    "pulse, one-way, decaying": (style.GREEN, "v"),
}
SIZES = {"*": 5.0, "s": 3.4, "D": 3.0}
RING: Look = {
    "marker": "o", "markersize": 6.0, "markerfacecolor": "none", "markeredgecolor": BLACK, "markeredgewidth": 0.5,
}  # fmt: skip
HATCH = "//////"


def table(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Every run of the sweeps of DIAGRAMS with its regimes.

    Returns
    -------
    panel, x, y (its axes), left, right, beyond, gamma, run_flags; exact: the regime that the rupture ends in by the
    exact solution (none where that does not say), run: at the end of the run, regime: the one drawn, exact or else of
    the run; coarser: on how many coarser lattices the run ends in another regime
    """
    tolerance = settings["measure"]["steady_tolerance"]
    parts = []
    for letter, diagram in DIAGRAMS.items():
        runs = tables[diagram.sweep]
        at_end = regime_of_run(runs, letter, tolerance)
        exact = runs["exact_regime"].where(runs["exact_regime"].isin(REGIMES))
        lattices = tables[f"coarser/{diagram.sweep}"].groupby("factor")
        others = [regime_of_run(rows.reset_index(), letter, tolerance) != at_end for _, rows in lattices]
        found = runs[["left", "right", "beyond", "gamma", "run_flags"]].assign(
            line=runs.groupby(["left", "gamma"]).ngroup(), panel=letter, exact=exact, run=at_end
        )
        found["regime"], found["coarser"] = exact.fillna(at_end), np.sum(others, axis=0)
        parts.append(found.assign(x=found[diagram.x], y=found[diagram.y]))
    return pd.concat(parts, ignore_index=True).drop(columns="line")


def regime_of_run(runs: pd.DataFrame, letter: str, tolerance: float) -> pd.Series:
    """The regime at the end of each run; in (d) what the pulse did, whether it died or a crack came of it."""
    if letter != "d":
        return runs["regime"]
    change = runs["largest_velocity_change"]
    names = np.select([change > tolerance, change < -tolerance], ["growing", "decaying"], "steady")
    return pd.Series([f"pulse, one-way, {name}" for name in names], index=runs.index)


def plot(table: pd.DataFrame) -> Figure:
    """Above each diagram an example of its pre-stress."""
    figure = new_figure(style.COLUMN, 6.6)
    figure.set_layout_engine("constrained", w_pad=0.02, h_pad=0.02, hspace=0.02)
    grid = figure.add_gridspec(4, 2, height_ratios=(0.25, 1.3, 0.25, 1.15))
    for index, letter in enumerate(DIAGRAMS):
        row, column = divmod(index, 2)
        strip = figure.add_subplot(grid[2 * row, column])
        draw_example(strip, letter)
        draw_diagram(figure.add_subplot(grid[2 * row + 1, column]), table[table["panel"] == letter], letter)
    legend_below(figure, handles(table), 2)
    return figure


def draw_example(axes: Axes, letter: str) -> None:
    """A pre-stress of the diagram over position."""
    x = np.linspace(-6.0, 12.0 if letter == "d" else 6.0, 401)
    axes.axhline(0.0, color=GREY, linewidth=0.5, linestyle=":")
    axes.plot(x, DIAGRAMS[letter].example(x), color=BLACK, linewidth=0.9)
    axes.set(xlim=x[[0, -1]], ylim=(-0.7, 1.1), yticks=[0.0, 1.0], xticks=[])
    axes.set_ylabel(r"$\tau(x)$", fontsize=8.0, labelpad=1.0)
    axes.tick_params(labelsize=7.0, length=2.0, pad=2.0)
    axes.set_title(DIAGRAMS[letter].title, loc="right", fontsize=8.0)
    panel_letter(axes, letter)


def draw_diagram(axes: Axes, runs: pd.DataFrame, letter: str) -> None:
    """A cell and a marker for each run, on axes of equally spaced levels."""
    columns, lines = np.unique(runs["x"]), np.unique(runs["y"])
    runs = runs.assign(i=np.searchsorted(columns, runs["x"]), j=np.searchsorted(lines, runs["y"]))
    runs["flagged"], runs["unsaid"] = runs["run_flags"].notna(), runs["exact"].isna()
    runs["early"] = runs["run"] != runs["regime"]
    for (regime, unsaid), some in runs[~runs["flagged"]].groupby(["regime", "unsaid"]):
        edge: Look = {"edgecolor": GREY, "hatch": HATCH} if unsaid else {"edgecolor": "white"}
        corners = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
        places = some[["i", "j"]].to_numpy()[:, None, :] + corners
        cells = PolyCollection(places, facecolor=tint(LOOKS[regime][0]), linewidth=0.4, **edge)
        axes.add_collection(cells)
    for (regime, flagged, early), some in runs.groupby(["regime", "flagged", "early"]):
        look = marker(regime)
        if flagged or early:
            look |= {"markerfacecolor": "none", "color": GREY} if flagged else {"markerfacecolor": "white"}
        axes.plot(some["i"], some["j"], linestyle="none", gid="flagged" if flagged else regime, **look)
    ringed = runs[runs["coarser"] > 0]
    axes.plot(ringed["i"], ringed["j"], linestyle="none", gid="ring", **RING)
    if letter == "b":
        group_lines(axes, runs)
    names = runs.groupby("j")["gamma"].first() if letter == "b" else lines
    axes.set_xticks(
        np.arange(columns.size), [setting(value) for value in columns], rotation=0 if letter == "b" else 90
    )
    axes.set_yticks(np.arange(lines.size), [setting(value) for value in names])
    axes.tick_params(length=0.0, labelsize=7.0, pad=2.0)
    axes.set(xlim=(-0.5, columns.size - 0.5), ylim=(-0.5, lines.size - 0.5))
    axes.set_xlabel(DIAGRAMS[letter].labels[0], fontsize=8.0, labelpad=1.5)
    axes.set_ylabel(DIAGRAMS[letter].labels[1], fontsize=8.0, labelpad=1.5)


def group_lines(axes: Axes, runs: pd.DataFrame) -> None:
    """The level on the left of each group of lines."""
    text: Look = {"rotation": 90, "va": "center", "transform": axes.get_yaxis_transform()}
    for level, lines in runs.groupby("left")["j"]:
        axes.axhline(lines.max() + 0.5, color=BLACK, linewidth=0.8)
        axes.text(1.02, lines.mean(), setting(level), fontsize=7.0, **text)
    axes.text(1.12, runs["j"].mean(), LEFT, fontsize=8.0, **text)


def tint(colour: str) -> tuple[float, ...]:
    """A light shade of a colour, for the cell behind a marker."""
    return tuple(1.0 - 0.22 * (1.0 - part) for part in to_rgb(colour))


def marker(regime: str) -> Look:
    """Marker of a regime."""
    colour, symbol = LOOKS[regime]
    return {"marker": symbol, "color": colour, "markersize": SIZES.get(symbol, 3.8), "markeredgewidth": 0.6}


def handles(table: pd.DataFrame) -> list:
    """Regimes, and what markers and cells tell besides, as far as there is any."""
    flagged = table["run_flags"].notna()
    found: list = [entry(name, **marker(name)) for name in REGIMES if (table["regime"] == name).any()]
    if (~flagged & (table["run"] != table["regime"])).any():
        look = marker("pulse, one-way, steady") | {"markerfacecolor": "white", "color": BLACK}
        found.append(entry("open: run ends before", **look))
    if (table["coarser"] > 0).any():
        found.append(entry("ringed: other on a coarser lattice", **RING))
    if (~flagged & table["exact"].isna()).any():
        found.append(Patch(facecolor="white", edgecolor=GREY, hatch=HATCH, label="hatched: by the run alone"))
    if flagged.any():
        look = marker("crack-like, two-way") | {"markerfacecolor": "none", "color": GREY}
        found.append(entry(f"flagged: open, unshaded ({flagged.sum()})", **look))
    return found
