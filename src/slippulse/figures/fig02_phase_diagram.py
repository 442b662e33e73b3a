"""Which regime a rupture is in, over pre-stress and elasticity: classified runs, and one example of each regime."""

from __future__ import annotations

import json
from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from ..data.points import point
from ..measure.regime import REGIMES
from ..texts.numerals import setting
from .style import BLACK, BLUE, GREEN, GREY, ORANGE, PAGE, PURPLE, SKY, YELLOW, new_figure, panel_letter

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {
    "data": ["regimes_displacement", "regimes_stress", "regimes_beyond"],
    "measured": ["regimes_displacement", "regimes_stress", "regimes_beyond"],
}

# Panel letter, simulation, and the columns of its axes in the measured table.
DIAGRAMS = (
    ("a", "regimes_displacement", "left", "gamma"),
    ("b", "regimes_stress", "right", "left"),
    ("c", "regimes_beyond", "beyond", "left"),
)
# Colour and marker of each regime; markers alone tell them apart in grey.
LOOKS = {
    "arrested": (GREY, "x"),
    "crack-like, two-way": (BLUE, "s"),
    "crack-like, one-way": (SKY, "D"),
    "pulses, two-way": (ORANGE, "*"),
    "pulse, one-way, growing": (PURPLE, "^"),
    "pulse, one-way, steady": (YELLOW, "o"),
    "pulse, one-way, decaying": (GREEN, "v"),
}
# Regimes with an example, and the diagram that it is taken from.
EXAMPLES = {
    "crack-like, two-way": "a",
    "pulses, two-way": "a",
    "crack-like, one-way": "b",
    "pulse, one-way, growing": "c",
    "pulse, one-way, steady": "c",
    "pulse, one-way, decaying": "c",
}
# What the table tells of each run beside its place and its regime.
KEPT = ("left", "right", "beyond", "gamma", "duration", "centre_velocity_share", "largest_velocity_change")
# Points kept of each example's profile.
PROFILE_POINTS = 500
THEORY_DASHES, EARLIER_DASHES = (0, (4, 1.5)), (0, (3, 1.2))


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Everything that the figure draws.

    Parameters
    ----------
    data : sweeps regimes_displacement, regimes_stress and regimes_beyond
    measured : their measured numbers, with the regime of each run
    settings : not used, the runs are classified already

    Returns
    -------
    DataFrame with panel, role and x, y. Roles: marker (a run, with its parameters, regime and flags), line (where
    pi/sqrt(gamma) equals the observation time), step (x: where the level beyond begins), example (letter, regime and
    place of the run that an example shows) and, with the example's letter as panel, profile (series prestress,
    velocity_before or velocity_end, at ``time``).
    """
    parts, letters = [], iter("ABCDEFG")
    markers = {
        letter: _markers(letter, measured[name], x, y).assign(simulation=name)
        for letter, name, x, y in DIAGRAMS
    }
    parts += list(markers.values())
    for letter, name, *_ in DIAGRAMS:
        parts.append(pd.DataFrame(_lines(letter, markers[letter], data[name])))
    for regime, letter in EXAMPLES.items():
        chosen = inmost(markers[letter], regime)
        if chosen is None:
            continue
        label = next(letters)
        row = markers[letter].iloc[chosen]
        parts.append(pd.DataFrame([{**row, "role": "example", "series": label}]))
        run = point(data[row["simulation"]], int(row["point"]))
        parts.append(_profiles(run).assign(panel=label, role="profile", regime=regime))
    every = pd.concat([part for part in parts if len(part)], ignore_index=True)
    # Without an example there is none to give the column.
    return every if "series" in every else every.assign(series="")


def _markers(letter: str, measured: pd.DataFrame, x: str, y: str) -> pd.DataFrame:
    return pd.DataFrame(
        {
            "panel": letter,
            "role": "marker",
            "point": np.arange(len(measured)),
            "x": measured[x],
            "y": measured[y],
            "regime": measured["regime"],
            "run_flags": measured["run_flags"],
            **{name: measured[name] for name in KEPT},
        }
    )


def _lines(letter: str, markers: pd.DataFrame, sweep: xr.Dataset) -> list[dict]:
    rows = []
    positive = markers.loc[markers["x"] > 0.0, "x"]
    if letter == "a" and len(positive) and markers["duration"].nunique() == 1:
        # Slip at the nucleation point would return to rest after half a period of the leaf springs.
        duration = float(markers["duration"].iloc[0])
        gamma = (np.pi / duration) ** 2
        for x in (positive.min(), positive.max()):
            rows.append({"panel": letter, "role": "line", "x": x, "y": gamma, "duration": duration})
    if letter == "c":
        steps = [json.loads(text)["steps"] for text in sweep["steps_and_bumps"].values]
        rows += [{"panel": letter, "role": "step", "x": step[-1][0]} for step in steps if step][:1]
    return rows


def inmost(markers: pd.DataFrame, regime: str) -> int | None:
    """The run deepest inside a regime: farthest, in grid steps, from runs of other regimes and from the rim.

    Parameters
    ----------
    markers : runs of one diagram, with x, y, regime and flags
    regime : one of REGIMES

    Returns
    -------
    row number; of equals the one nearest the middle of the regime's runs; None if no sound run is in the regime
    """
    column = markers["x"].rank(method="dense").to_numpy() - 1.0
    line = markers["y"].rank(method="dense").to_numpy() - 1.0
    own = ((markers["regime"] == regime) & ~is_flagged(markers)).to_numpy()
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


def _profiles(run: xr.Dataset) -> pd.DataFrame:
    """Pre-stress, and slip velocity at two thirds of the duration and at the end, where anything slipped."""
    x, released = run["x"].values, np.isfinite(run["release_time"].values)
    margin = 0.08 * (x[released][-1] - x[released][0])
    lower, upper = x[released][0] - margin, x[released][-1] + margin
    at, times = run["sample_position"].values, run["sample_time"].values
    before = int(np.argmin(np.abs(times - 2.0 / 3.0 * times[-1])))
    # The levels go on beyond the lattice, which ends where the fronts do.
    tau = run["prestress"].values
    wide, tau = np.concatenate([[lower], x, [upper]]), np.concatenate([tau[:1], tau, tau[-1:]])
    curves = [("prestress", np.nan, wide, tau)]
    for series, index in (("velocity_before", before), ("velocity_end", -1)):
        curves.append((series, times[index], at, run["sample_velocity"].values[index]))
    frames = []
    for series, time, position, value in curves:
        inside = np.flatnonzero((position >= lower) & (position <= upper))
        kept = inside[:: max(1, int(np.ceil(inside.size / PROFILE_POINTS)))]
        # Regular thinning may step over a peak.
        kept = np.union1d(kept, [inside[np.argmax(value[inside])], inside[-1]])
        order = kept[np.argsort(position[kept], kind="stable")]
        frames.append(pd.DataFrame({"series": series, "time": time, "x": position[order], "y": value[order]}))
    return pd.concat(frames)


def plot(table: pd.DataFrame) -> Figure:
    """Draw the figure from its table."""
    figure = new_figure(PAGE, 4.55)
    figure.get_layout_engine().set(w_pad=0.05)
    upper, lower = figure.subfigures(2, 1, height_ratios=(2.75, 1.8))
    grid = upper.add_gridspec(2, 3, width_ratios=(11, 11, 9.6), height_ratios=(5, 6))
    places = {"a": grid[:, 0], "b": grid[:, 1], "c": grid[0, 2]}
    for letter, place in places.items():
        _draw_diagram(upper.add_subplot(place), table[table["panel"] == letter], letter)
    legend = upper.add_subplot(grid[1, 2])
    legend.set_axis_off()
    _draw_legend(legend, table)
    if (table["role"] == "example").any():
        _draw_examples(lower, table)
    return figure


def place(values, levels: np.ndarray) -> np.ndarray:
    """Where values stand on an axis of equally spaced levels; between two levels, in proportion (log if all > 0)."""
    scale = np.log if levels[0] > 0.0 else np.asarray
    return np.interp(scale(np.asarray(values, dtype=float)), scale(levels), np.arange(levels.size))


def _draw_diagram(axes, rows: pd.DataFrame, letter: str) -> None:
    runs = rows[rows["role"] == "marker"]
    levels = {name: np.unique(runs[name]) for name in ("x", "y")}
    axes.set_aspect("equal", anchor="N")
    flagged = is_flagged(runs)
    for regime in REGIMES:
        colour, symbol = LOOKS[regime]
        chosen = runs[runs["regime"] == regime]
        x, y = place(chosen["x"], levels["x"]), place(chosen["y"], levels["y"])
        sound = ~flagged[chosen.index].to_numpy()
        for i, j in zip(x[sound], y[sound], strict=True):
            cell = Rectangle(
                (i - 0.5, j - 0.5), 1.0, 1.0, facecolor=tint(colour), edgecolor="white", linewidth=0.4
            )
            axes.add_patch(cell)
        if sound.any():
            axes.plot(x[sound], y[sound], symbol, color=colour, label=regime, **_marker(symbol))
        if not sound.all():
            open_marker = _marker(symbol) | {"markerfacecolor": "none", "markeredgecolor": GREY}
            axes.plot(x[~sound], y[~sound], symbol, label=f"flagged: {regime}", **open_marker)
    line = rows[rows["role"] == "line"]
    # Outside the levels there is no place for it.
    if len(line) and levels["y"][0] <= line["y"].iloc[0] <= levels["y"][-1]:
        x = place(line["x"], levels["x"]) + np.array([-0.5, 0.5])
        y = place(line["y"], levels["y"])
        axes.plot(x, y, color=BLACK, linewidth=1.2, linestyle=THEORY_DASHES, label="theory")
    for _, row in rows[rows["role"] == "example"].iterrows():
        i, j = place([row["x"]], levels["x"])[0], place([row["y"]], levels["y"])[0]
        face = tint(LOOKS[row["regime"]][0])
        cell = Rectangle(
            (i - 0.5, j - 0.5), 1.0, 1.0, facecolor=face, edgecolor=BLACK, linewidth=0.8, zorder=3.0
        )
        axes.add_patch(cell)
        text = {"ha": "center", "va": "center_baseline", "fontsize": 6.5, "fontweight": "bold", "zorder": 4.0}
        axes.text(i, j, row["series"], **text)
    for name, set_ticks, set_limits in (
        ("x", axes.set_xticks, axes.set_xlim),
        ("y", axes.set_yticks, axes.set_ylim),
    ):
        labels = [setting(value) for value in levels[name]]
        set_ticks(np.arange(levels[name].size), labels, **({"rotation": 90} if name == "x" else {}))
        set_limits(-0.5, levels[name].size - 0.5)
    axes.tick_params(length=0.0)
    panel_letter(axes, letter)
    _label(axes, rows, letter)


def _label(axes, rows: pd.DataFrame, letter: str) -> None:
    if letter == "a":
        axes.set(title=r"$\Gamma = 1$", xlabel=r"$\bar\tau_0$ (both sides)", ylabel=r"$\bar\gamma$")
        return
    axes.set(title=r"$\Gamma = 0$", ylabel=r"$\bar\tau_{0,l}$ (left)", xlabel=r"$\bar\tau_{0,r}$ (right)")
    step = rows.loc[rows["role"] == "step", "x"]
    if len(step):
        position = step.iloc[0]
        inner = rows.loc[rows["role"] == "marker", "right"].iloc[0]
        axes.set(
            title=rf"$\Gamma = 0,\ \bar\tau_{{0,r}} = {inner:g}$",
            xlabel=rf"$\bar\tau$ beyond $\bar x = {position:g}$",
        )


def tint(colour: str) -> tuple[float, ...]:
    """A light shade of a colour, for the cell behind a marker."""
    return tuple(1.0 - 0.22 * (1.0 - part) for part in to_rgb(colour))


def _marker(symbol: str) -> dict:
    size = {"*": 6.0, "s": 4.0, "D": 3.6, "x": 4.2}.get(symbol, 4.6)
    return {"linestyle": "none", "markersize": size, "markeredgewidth": 1.0 if symbol == "x" else 0.6}


def _draw_legend(axes, table: pd.DataFrame) -> None:
    runs = table[table["role"] == "marker"]
    handles = []
    for regime in REGIMES:
        if (runs["regime"] == regime).any():
            colour, symbol = LOOKS[regime]
            handles.append(Line2D([], [], marker=symbol, color=colour, label=regime, **_marker(symbol)))
    flagged = int(is_flagged(runs).sum())
    if flagged:
        look = _marker("s") | {"markerfacecolor": "none"}
        handles.append(
            Line2D([], [], marker="s", color=GREY, label=f"flagged: open, unshaded ({flagged})", **look)
        )
    line = table[table["role"] == "line"]
    if len(line):
        label = rf"$\pi/\sqrt{{\bar\gamma}} = {line['duration'].iloc[0]:g}$, when runs end"
        handles.append(Line2D([], [], color=BLACK, linewidth=1.2, linestyle=THEORY_DASHES, label=label))
    examples = table.loc[table["role"] == "example", "series"].tolist()
    if examples:
        look = {"linestyle": "none", "markersize": 6.0, "markerfacecolor": "white", "markeredgewidth": 0.8}
        label = f"{examples[0]} to {examples[-1]}: run shown below"
        handles.append(Line2D([], [], marker="s", color=BLACK, label=label, **look))
        label = "below: at two thirds of the time"
        handles.append(Line2D([], [], color=GREY, linewidth=0.8, linestyle=EARLIER_DASHES, label=label))
    axes.legend(
        handles=handles, loc="upper left", bbox_to_anchor=(-0.16, 1.0), labelspacing=0.38, handlelength=1.8
    )


def _draw_examples(figure, table: pd.DataFrame) -> None:
    examples = table[table["role"] == "example"]
    panels = figure.subplots(2, len(examples), sharex="col", height_ratios=(0.7, 1.0), squeeze=False)
    for index, (_, example) in enumerate(examples.iterrows()):
        stress, velocity = panels[:, index]
        rows = table[(table["role"] == "profile") & (table["panel"] == example["series"])]
        curves = {series: part for series, part in rows.groupby("series")}
        before, end = curves["velocity_before"], curves["velocity_end"]
        stress.axhline(0.0, color=GREY, linewidth=0.5, linestyle=":")
        stress.plot(curves["prestress"]["x"], curves["prestress"]["y"], color=BLACK)
        _write_levels(stress, example)
        velocity.plot(before["x"], before["y"], color=GREY, linewidth=0.8, linestyle=EARLIER_DASHES)
        velocity.plot(end["x"], end["y"], color=LOOKS[example["regime"]][0])
        kind, _, rest = example["regime"].rpartition(", ")
        title = rf"$\bf{{{example['series']}}}$  {kind}," + f"\n     {rest}"
        stress.set_title(title, loc="left", fontsize=6.5, linespacing=1.1)
        stress.set_ylim(-1.2, 1.2)
        stress.set_yticks([0.0, 1.0], ["0", "1"] if index == 0 else ["", ""])
        velocity.set_xlim(curves["prestress"]["x"].min(), curves["prestress"]["x"].max())
        velocity.set_ylim(0.0, 1.15 * max(before["y"].max(), end["y"].max()))
        velocity.locator_params(nbins=3)
        velocity.set_xlabel(r"$\bar x$")
        for axes in (stress, velocity):
            axes.tick_params(labelsize=6.0)
        stress.tick_params(bottom=False)
    panels[0, 0].set_ylabel(r"$\bar\tau$")
    panels[1, 0].set_ylabel(r"$\dot{\bar u}$")


def _write_levels(axes, example: pd.Series) -> None:
    """The levels far to the left and right, which may be too close to 0 to see."""
    left, right = example["left"], example["beyond"]
    text = {"fontsize": 5.5, "transform": axes.get_yaxis_transform()}
    for level, x, side in ((left, 0.03, "left"), (right, 0.97, "right")):
        if side == "right" or left != right:
            offset, anchor = (-0.12, "top") if level < 0.0 else (0.1, "bottom")
            label = setting(level)
            axes.text(x, level + offset, label, ha=side, va=anchor, **text)
