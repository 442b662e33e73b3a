"""Which regime a rupture ends in, by boundary and by symmetric or asymmetric pre-stress, with examples."""

from __future__ import annotations

import json
from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle

from ..data.numerals import setting
from ..data.points import point
from ..measure.regime import REGIMES
from ..predict.final_regime import UNDECIDED, final_regime, growth_beyond
from .shared.regime_examples import EARLIER_DASHES, draw_examples, profiles
from .style import BLACK, BLUE, COLUMN, GREEN, GREY, ORANGE, PURPLE, SKY, YELLOW, new_figure, panel_letter

# What is drawn: data, measured numbers (on coarser lattices too) and studies by name, and keys of the configuration.
NEEDS = {
    "data": ["regimes_displacement", "regimes_displacement_asymmetric", "regimes_stress", "regimes_beyond"],
    "measured": [
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
    "settings": ["measure.still", "measure.steady_tolerance"],
}

# Panel letter, simulation, and the columns of its axes in the measured table; "line" numbers the pairs of gamma and the
# level on the left, and "" is a single row.
DIAGRAMS = (
    ("a", "regimes_displacement", "left", "gamma"),
    ("b", "regimes_displacement_asymmetric", "right", "line"),
    ("c", "regimes_stress", "left", ""),
    ("d", "regimes_stress", "right", "left"),
    ("e", "regimes_beyond", "beyond", "left"),
)
# Colour and marker of each regime; markers alone tell them apart in grey.
LOOKS = {
    "arrested": (GREY, "X"),
    "crack-like, two-way": (BLUE, "s"),
    "crack-like, one-way": (SKY, "D"),
    "pulses, two-way": (ORANGE, "*"),
    "pulse, one-way, growing": (PURPLE, "^"),
    "pulse, one-way, steady": (YELLOW, "o"),
    "pulse, one-way, decaying": (GREEN, "v"),
}
# Diagrams and regimes with an example, in the order of their letters.
EXAMPLES = (
    ("a", "pulses, two-way"),
    ("b", "pulse, one-way, steady"),
    ("c", "crack-like, two-way"),
    ("d", "pulse, one-way, steady"),
    ("e", "pulse, one-way, growing"),
    ("e", "pulse, one-way, decaying"),
)
# What the table tells of each run beside its place and its regimes.
KEPT = ("left", "right", "beyond", "gamma", "duration", "centre_velocity_share", "largest_velocity_change")
HATCH = "//////"


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Everything that the figure draws.

    Parameters
    ----------
    data : the sweeps of DIAGRAMS
    measured : their measured numbers, with the regime of each run, and those on coarser lattices (coarser/NAME)
    settings : measure (still, steady_tolerance)

    Returns
    -------
    DataFrame with panel, role and x, y. Roles: marker (a run, with its parameters and flags; regime: the one drawn,
    final: by the exact solution, run: by the run, end: the rule of `measure.regime`, coarser: on how many coarser
    lattices run is another),
    step (x: where the level beyond begins), example (letter and place of the run that an example shows) and, with the
    example's letter as panel, profile (series prestress, velocity_before or velocity_end, at ``time``).
    """
    parts, letters = [], iter("ABCDEFG")
    markers = {}
    for letter, name, x, y in DIAGRAMS:
        rows = _classified(letter, measured[name], measured[f"coarser/{name}"], settings["measure"])
        markers[letter] = _markers(letter, rows, x, y).assign(simulation=name)
    parts += list(markers.values())
    steps = [json.loads(text)["steps"] for text in data["regimes_beyond"]["steps_and_bumps"].values]
    parts.append(
        pd.DataFrame([{"panel": "e", "role": "step", "x": step[-1][0]} for step in steps if step][:1])
    )
    for letter, regime in EXAMPLES:
        chosen = inmost(markers[letter], regime)
        if chosen is None:
            continue
        label = next(letters)
        row = markers[letter].iloc[chosen]
        parts.append(pd.DataFrame([{**row, "role": "example", "series": label}]))
        run = point(data[row["simulation"]], int(row["point"]))
        parts.append(profiles(run).assign(panel=label, role="profile", regime=regime))
    every = pd.concat([part for part in parts if len(part)], ignore_index=True)
    # Without an example there is none to give the column.
    return every if "series" in every else every.assign(series="")


def _classified(letter: str, measured: pd.DataFrame, coarser: pd.DataFrame, measure: Mapping) -> pd.DataFrame:
    """Runs of one diagram with their regime by the exact solution, at the end of the run, and as drawn."""
    table = measured.assign(point=np.arange(len(measured)))
    runs = [_at_the_end(letter, table, measure)]
    for _, other in coarser.groupby("factor"):
        runs.append(_at_the_end(letter, other.reset_index(drop=True), measure))
    if letter == "e":
        final = [growth_beyond(level) for level in table["beyond"]]
    else:
        keys = ("left", "right", "gamma", "damping_ratio", "release")
        # Without leaf springs gamma is 0 in the table.
        final = [
            final_regime(*values, measure["still"])
            for values in zip(*(table[key] for key in keys), strict=True)
        ]
    table["final"], table["run"], table["end"] = final, runs[0].to_numpy(), measured["regime"]
    table["regime"] = np.where(table["final"] == UNDECIDED, table["run"], table["final"])
    table["coarser"] = np.sum([other.to_numpy() != table["run"] for other in runs[1:]], axis=0)
    if letter == "c":
        return table[table["left"] == table["right"]]
    if letter == "d":
        return table[table["left"] < 0.0]
    if letter == "b":
        return table.assign(line=table.groupby(["left", "gamma"]).ngroup())
    return table


def _at_the_end(letter: str, runs: pd.DataFrame, measure: Mapping) -> pd.Series:
    """The regime at the end of each run; in (e) what the pulse did, be it that it died or that a crack came of it."""
    if letter != "e":
        return runs["regime"]
    change = runs["largest_velocity_change"]
    tolerance = measure["steady_tolerance"]
    return pd.Series([growth_beyond(level) for level in np.where(np.abs(change) <= tolerance, 0.0, change)])


def _markers(letter: str, rows: pd.DataFrame, x: str, y: str) -> pd.DataFrame:
    return pd.DataFrame(
        {
            "panel": letter,
            "role": "marker",
            "x": rows[x],
            "y": rows[y] if y else 0,
            **{
                name: rows[name]
                for name in ("point", "regime", "final", "run", "end", "coarser", "run_flags", *KEPT)
            },
        }
    ).reset_index(drop=True)


def inmost(markers: pd.DataFrame, regime: str) -> int | None:
    """The run deepest inside a regime: farthest, in grid steps, from runs of other regimes and from the rim.

    Parameters
    ----------
    markers : runs of one diagram, with x, y, regime and flags
    regime : one of REGIMES

    Returns
    -------
    row number; of equals the one nearest the middle of the regime's runs; None if no sound run ends in the
    regime on every lattice
    """
    column = markers["x"].rank(method="dense").to_numpy() - 1.0
    line = markers["y"].rank(method="dense").to_numpy() - 1.0
    shown = (markers["regime"] == regime) & (markers["end"] == regime) & (markers["coarser"] == 0)
    shown &= ~is_flagged(markers)
    own = shown.to_numpy()
    if not own.any():
        return None
    others = np.column_stack([column[~own], line[~own]])
    middle = np.array([column[own].mean(), line[own].mean()])
    best = []
    for index in np.flatnonzero(own):
        here = np.array([column[index], line[index]])
        rim = min(*(here + 1.0), column.max() - here[0] + 1.0, line.max() - here[1] + 1.0)
        depth = min(rim, *np.max(np.abs(others - here), axis=1)) if len(others) else rim
        best.append((-depth, float(np.hypot(*(here - middle))), int(index)))
    return min(best)[2]


def is_flagged(rows: pd.DataFrame) -> pd.Series:
    """Whether each run carries a flag; empty text is missing after a CSV file."""
    return rows["run_flags"].astype(object).fillna("").astype(str).str.len() > 0


def plot(table: pd.DataFrame) -> Figure:
    """Draw the figure from its table."""
    figure = new_figure(COLUMN, 7.8)
    figure.get_layout_engine().set(w_pad=0.02, h_pad=0.02, hspace=0.03)
    upper, lower = figure.subfigures(2, 1, height_ratios=(5.1, 2.7))
    # Rows by boundary, columns by symmetric and asymmetric pre-stress; all that is symmetric under stress is one line.
    grid = upper.add_gridspec(4, 2, height_ratios=(11.0, 1.1, 2.4, 4.4))
    places = {"a": grid[0, 0], "b": grid[0, 1], "c": grid[1, 0], "d": grid[1:3, 1], "e": grid[3, 1]}
    for letter, place in places.items():
        _draw_diagram(upper.add_subplot(place), table[table["panel"] == letter], letter)
    _draw_legend(upper, table)
    if (table["role"] == "example").any():
        draw_examples(lower, table, {regime: look[0] for regime, look in LOOKS.items()})
    return figure


def place(values, levels: np.ndarray) -> np.ndarray:
    """Where values stand on an axis of equally spaced levels; between two levels, in proportion (log if all > 0)."""
    scale = np.log if levels[0] > 0.0 else np.asarray
    return np.interp(scale(np.asarray(values, dtype=float)), scale(levels), np.arange(levels.size))


def _draw_diagram(axes, rows: pd.DataFrame, letter: str) -> None:
    runs = rows[rows["role"] == "marker"]
    levels = {name: np.unique(runs[name]) for name in ("x", "y")}
    runs = runs.assign(
        i=place(runs["x"], levels["x"]),
        j=place(runs["y"], levels["y"]),
        flagged=is_flagged(runs),
        undecided=runs["final"] == UNDECIDED,
        early=runs["run"] != runs["regime"],
    )
    for (regime, flagged, undecided), some in runs.groupby(["regime", "flagged", "undecided"]):
        if not flagged:
            look = {"edgecolor": GREY, "hatch": HATCH} if undecided else {"edgecolor": "white"}
            cells = PolyCollection(_cells(some), facecolor=tint(LOOKS[regime][0]), linewidth=0.4, **look)
            axes.add_collection(cells)
    for (regime, flagged, early), some in runs.groupby(["regime", "flagged", "early"]):
        colour, symbol = LOOKS[regime]
        look = _marker(symbol)
        if flagged:
            look |= {"markerfacecolor": "none", "markeredgecolor": GREY}
        elif early:
            look |= {"markerfacecolor": "white"}
        label = f"flagged: {regime}" if flagged else regime
        axes.plot(some["i"], some["j"], symbol, color=colour, label=label, **look)
    ringed = runs[runs["coarser"] > 0]
    axes.plot(ringed["i"], ringed["j"], "o", **RING, gid="ring")
    for _, row in rows[rows["role"] == "example"].iterrows():
        i, j = place([row["x"]], levels["x"])[0], place([row["y"]], levels["y"])[0]
        look = {"facecolor": tint(LOOKS[row["regime"]][0]), "edgecolor": BLACK, "linewidth": 0.7}
        axes.add_patch(Rectangle((i - 0.5, j - 0.5), 1.0, 1.0, **look, zorder=3.0))
        text = {"ha": "center", "va": "center_baseline", "fontsize": 7.0, "fontweight": "bold", "zorder": 4.0}
        axes.text(i, j, row["series"], **text)
    axes.set_xticks(np.arange(levels["x"].size), [setting(value) for value in levels["x"]])
    axes.tick_params("x", rotation=0 if letter == "b" else 90)
    # Of a line of (b), its gamma.
    lines = runs.groupby("y")["gamma"].first() if letter == "b" else levels["y"]
    axes.set_yticks(
        np.arange(levels["y"].size), [""] if letter == "c" else [setting(value) for value in lines]
    )
    axes.set(xlim=(-0.5, levels["x"].size - 0.5), ylim=(-0.5, levels["y"].size - 0.5))
    axes.tick_params(length=0.0, labelsize=7.0, pad=2.0)
    panel_letter(axes, letter)
    _label(axes, rows, letter)


def _cells(runs: pd.DataFrame) -> np.ndarray:
    """Corners of the cell of each run."""
    corners = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
    return runs[["i", "j"]].to_numpy()[:, None, :] + corners


def _label(axes, rows: pd.DataFrame, letter: str) -> None:
    title = {
        "a": r"$\Gamma = 1$, symmetric",
        "b": r"$\Gamma = 1$, asymmetric",
        "c": r"$\Gamma = 0$, symmetric",
    }
    text = {"fontsize": 8.0, "labelpad": 1.5}
    both, left, right = r"$\tau_0$ (both sides)", r"$\tau_{0,l}$ (left)", r"$\tau_{0,r}$ (right)"
    axes.set_title(title.get(letter, r"$\Gamma = 0$, asymmetric"), loc="right", fontsize=8.0)
    axes.set_xlabel(both if letter in "ac" else right, **text)
    if letter in "ab":
        axes.set_ylabel(r"$\gamma$", **text)
    elif letter in "de":
        axes.set_ylabel(left, **text)
    if letter == "b":
        _write_groups(axes, rows[rows["role"] == "marker"])
    step = rows.loc[rows["role"] == "step", "x"]
    if len(step):
        inner = rows.loc[rows["role"] == "marker", "right"].iloc[0]
        axes.set_title(rf"$\Gamma = 0,\ \tau_{{0,r}} = {inner:g}$", loc="right", fontsize=8.0)
        axes.set_xlabel(rf"$\tau$ beyond $x = {step.iloc[0]:g}$", **text)


def _write_groups(axes, runs: pd.DataFrame) -> None:
    """The level on the left of each group of lines, beside it."""
    lines = np.unique(runs["y"])
    groups = runs.groupby("left")["y"].agg(["min", "max"]).sort_values("min")
    for level in groups["max"].iloc[:-1]:
        axes.axhline(place([level], lines)[0] + 0.5, color=BLACK, linewidth=0.8)
    text = {"fontsize": 7.0, "rotation": 90, "va": "center", "transform": axes.get_yaxis_transform()}
    for level, ends in groups.iterrows():
        axes.text(1.02, place(ends, lines).mean(), setting(level), **text)
    axes.text(1.11, place(lines, lines).mean(), r"$\tau_{0,l}$ (left)", **text | {"fontsize": 8.0})


def tint(colour: str) -> tuple[float, ...]:
    """A light shade of a colour, for the cell behind a marker."""
    return tuple(1.0 - 0.22 * (1.0 - part) for part in to_rgb(colour))


RING = {
    "linestyle": "none", "markersize": 6.8, "markerfacecolor": "none", "markeredgecolor": BLACK, "markeredgewidth": 0.5,
}  # fmt: skip


def _marker(symbol: str) -> dict:
    size = {"*": 4.6, "s": 3.2, "D": 2.9}.get(symbol, 3.7)
    return {"linestyle": "none", "markersize": size, "markeredgewidth": 0.6}


def _draw_legend(figure, table: pd.DataFrame) -> None:
    runs = table[table["role"] == "marker"]
    flagged = is_flagged(runs)
    handles = []
    for regime in REGIMES:
        if (runs["regime"] == regime).any():
            colour, symbol = LOOKS[regime]
            handles.append(Line2D([], [], marker=symbol, color=colour, label=regime, **_marker(symbol)))
    open_look = _marker("o") | {"markerfacecolor": "white", "markeredgecolor": BLACK}
    if (~flagged & (runs["run"] != runs["regime"])).any():
        handles.append(Line2D([], [], marker="o", label="open: not yet so\nwhen the run ends", **open_look))
    if (runs["coarser"] > 0).any():
        handles.append(Line2D([], [], marker="o", label="ringed: other on a\ncoarser lattice", **RING))
    if (~flagged & (runs["final"] == UNDECIDED)).any():
        handles.append(
            Patch(facecolor="white", edgecolor=GREY, hatch=HATCH, label="hatched: by the run alone")
        )
    if flagged.any():
        look = _marker("s") | {"markerfacecolor": "none"}
        label = f"flagged: open, unshaded ({flagged.sum()})"
        handles.append(Line2D([], [], marker="s", color=GREY, label=label, **look))
    examples = table.loc[table["role"] == "example", "series"].tolist()
    if examples:
        look = {"linestyle": "none", "markersize": 6.0, "markerfacecolor": "white", "markeredgewidth": 0.8}
        label = f"{examples[0]} to {examples[-1]}: run shown below"
        handles.append(Line2D([], [], marker="s", color=BLACK, label=label, **look))
        label = "dashed: at 2/3 of the time"
        handles.append(Line2D([], [], color=GREY, linewidth=0.8, linestyle=EARLIER_DASHES, label=label))
    legend = figure.legend(
        handles=handles,
        loc="lower left",
        labelspacing=0.25,
        handlelength=1.6,
        fontsize=7.5,
        borderaxespad=0.0,
    )
    # Beneath (c), where there is room for it.
    legend.set_in_layout(False)
    for text in legend.get_texts():
        text.set_linespacing(0.9)
