"""Figure 2: crack-like, pulse-like, growing, decaying and arrested ruptures, classified from simulations."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ..measure.regime import REGIMES
from ..sweep import point
from .style import BLUE, GREEN, GREY, ORANGE, PAGE, PURPLE, SKY, YELLOW, new_figure, panel_letter

# Colour and marker of each regime: either alone tells them apart.
LOOKS = dict(
    zip(
        REGIMES,
        [(GREY, "x"), (ORANGE, "s"), (YELLOW, "D"), (BLUE, "o"), (PURPLE, "^"), (GREEN, ">"), (SKY, "v")],
        strict=True,
    )
)
PANELS = {
    "regimes_displacement": ("left", "gamma"),
    "regimes_stress": ("left", "right"),
    "regimes_beyond": ("left", "beyond"),
}
LABELS = {
    "gamma": r"$\bar\gamma$",
    "right": r"$\bar\tau_{0,r}$",
    "beyond": r"$\bar\tau$ met by the pulse",
}
TITLES = {
    "regimes_displacement": r"$\Gamma = 1$, symmetric",
    "regimes_stress": r"$\Gamma = 0$",
    "regimes_beyond": r"$\Gamma = 0$, pulse meets a step",
}
# Examples: of the runs of a sweep in a regime the middle one.
EXAMPLES = [
    ("regimes_displacement", "crack-like, two-way"),
    ("regimes_displacement", "pulses, two-way"),
    ("regimes_stress", "crack-like, one-way"),
    ("regimes_stress", "pulse, one-way, steady"),
    ("regimes_beyond", "pulse, one-way, growing"),
    ("regimes_beyond", "pulse, one-way, decaying"),
]
POINTS = 400


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Regime of every run, the predicted boundary of panel (a), and the fields of the examples."""
    parts = []
    for name, (first, second) in PANELS.items():
        runs = measured[name]
        parts.append(
            pd.DataFrame(
                {
                    "panel": name,
                    "role": "run",
                    "run": np.arange(len(runs)),
                    "x": runs[first],
                    "y": runs[second],
                    "regime": runs["regime"],
                    "flags": runs["flags"],
                }
            )
        )
    displacement = measured["regimes_displacement"]
    # The transition is seen where pi/sqrt(gamma) is shorter than the run.
    boundary = (np.pi / float(displacement["duration"].iloc[0])) ** 2
    ends = [float(displacement["left"].min()), float(displacement["left"].max())]
    parts.append(
        pd.DataFrame({"panel": "regimes_displacement", "role": "boundary", "x": ends, "y": boundary})
    )
    for letter, (name, regime) in zip("ABCDEF", EXAMPLES, strict=True):
        runs = measured[name]
        # Where two mirrored runs show the same, the one that goes to the right.
        chosen = runs.index[(runs["regime"] == regime) & (runs["left"] <= runs["right"])]
        if len(chosen):
            parts.append(example_rows(data[name], int(chosen[len(chosen) // 2]), name, regime, letter))
    return pd.concat(parts, ignore_index=True)


def example_rows(sweep: xr.Dataset, index: int, name: str, regime: str, letter: str) -> pd.DataFrame:
    """Pre-stress and slip velocity at the end of one run, thinned."""
    run = point(sweep, index)
    step = max(1, run.sizes["x"] // POINTS)
    x = run["x"].values[::step]
    rows = [
        pd.DataFrame({"role": role, "x": x, "y": run[variable].values[::step]})
        for role, variable in (("prestress", "prestress"), ("velocity", "slip_velocity"))
    ]
    return pd.concat(rows, ignore_index=True).assign(panel=name, run=index, regime=regime, letter=letter)


def plot(table: pd.DataFrame) -> Figure:
    """Three diagrams above, six examples below, one legend."""
    figure = new_figure(PAGE, 5.6)
    top, bottom = figure.subfigures(2, 1, height_ratios=[1.75, 1.0])
    diagrams = top.subplots(1, 3)
    examples = table[table["role"].isin(["prestress", "velocity"])]
    for axes, name, letter in zip(diagrams, PANELS, "abc", strict=True):
        rows = table[(table["panel"] == name) & (table["role"] == "run")]
        marked = examples[examples["panel"] == name].groupby("letter")["run"].first()
        draw_diagram(axes, rows, name, marked)
        axes.set_title(TITLES[name], fontsize=7.5)
        panel_letter(axes, letter)
    line = table[table["role"] == "boundary"]
    diagrams[0].plot(line["x"], line["y"], color="black", linewidth=0.8, linestyle="--", gid="boundary")
    diagrams[0].set_yscale("log")
    handles = [
        Line2D([], [], color=colour, marker=marker, linestyle="none", markersize=5, label=regime)
        for regime, (colour, marker) in LOOKS.items()
    ]
    handles.append(
        Line2D(
            [], [], color="black", linewidth=0.8, linestyle="--", label=r"$\pi/\sqrt{\bar\gamma}$ = duration"
        )
    )
    if table["flags"].notna().any():
        handles.append(
            Line2D(
                [],
                [],
                color="black",
                marker="o",
                markerfacecolor="none",
                linestyle="none",
                label="flagged run",
            )
        )
    top.legend(handles=handles, loc="outside lower center", ncols=4, columnspacing=1.2, handletextpad=0.3)
    draw_examples(bottom, examples)
    return figure


def draw_diagram(axes, rows: pd.DataFrame, name: str, marked: pd.Series) -> None:
    """One marker a run; levels on an even scale, since they are crowded around 0."""
    even = name != "regimes_displacement"
    xs, ys = np.sort(rows["x"].unique()), np.sort(rows["y"].unique())
    place_x = dict(zip(xs, np.arange(xs.size) if even else xs, strict=True))
    place_y = dict(zip(ys, np.arange(ys.size) if even else ys, strict=True))
    for regime, (colour, marker) in LOOKS.items():
        chosen = rows[rows["regime"] == regime]
        axes.scatter(
            chosen["x"].map(place_x), chosen["y"].map(place_y), color=colour, marker=marker, s=16, linewidths=1.0,
            gid=regime,
        )  # fmt: skip
    flagged = rows[rows["flags"].notna()]
    axes.scatter(
        flagged["x"].map(place_x), flagged["y"].map(place_y), facecolors="none", edgecolors="black", s=40,
        linewidths=0.4, gid="flagged",
    )  # fmt: skip
    by_run = rows.set_index("run")
    for letter, run in marked.items():
        row = by_run.loc[run]
        axes.annotate(
            letter, (place_x[row["x"]], place_y[row["y"]]), xytext=(4, 4), textcoords="offset points",
            fontsize=7, fontweight="bold",
        )  # fmt: skip
        axes.scatter(
            [place_x[row["x"]]],
            [place_y[row["y"]]],
            facecolors="none",
            edgecolors="black",
            s=55,
            linewidths=0.9,
        )
    if even:
        axes.set_xticks(range(xs.size), [f"{value:g}" for value in xs], rotation=90, fontsize=6)
        axes.set_yticks(range(ys.size), [f"{value:g}" for value in ys], fontsize=6)
        axes.margins(0.08)
    axes.set_xlabel(r"$\bar\tau_0$" if name == "regimes_displacement" else r"$\bar\tau_{0,l}$")
    axes.set_ylabel(LABELS[PANELS[name][1]])


def draw_examples(figure, rows: pd.DataFrame) -> None:
    """Pre-stress above and slip velocity below for each example."""
    letters = list(rows["letter"].unique())
    panels = figure.subplots(2, len(letters), height_ratios=[1.0, 1.3], squeeze=False)
    for column, letter in enumerate(letters):
        example = rows[rows["letter"] == letter]
        colour, _ = LOOKS[example["regime"].iloc[0]]
        for row, (role, shade) in enumerate((("prestress", "black"), ("velocity", colour))):
            axes = panels[row, column]
            curve = example[example["role"] == role]
            axes.plot(curve["x"], curve["y"], color=shade, linewidth=0.9, gid=role)
            axes.tick_params(labelsize=5.5, length=2)
            axes.locator_params(nbins=3)
            if row == 0:
                axes.set_title(letter, fontsize=7.5, fontweight="bold", pad=2)
                axes.tick_params(labelbottom=False)
                axes.axhline(0.0, color="0.7", linewidth=0.5, zorder=0)
            else:
                axes.set_xlabel(r"$\bar x$", labelpad=1)
    panels[0, 0].set_ylabel(r"$\bar\tau$")
    panels[1, 0].set_ylabel(r"$\dot{\bar u}$")
