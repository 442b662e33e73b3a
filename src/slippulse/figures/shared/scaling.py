"""T_trans and L_trans of every run beside the paper's predictions and exact theory: rows, and how they are drawn."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

from ...comparison.exact_transition import exact_transition
from ..style import BLACK, GREY, colour_scale, panel_letter

QUANTITIES = {
    "length": ("transition_length", "paper_transition_length"),
    "time": ("transition_time", "paper_transition_time"),
}
# The literal definition of the paper's text, or what its figure shows, per boundary and quantity.
PAPER_DEFINITION = {
    ("displacement", "length"): "slip_length_background",
    ("displacement", "time"): "slip_time_background",
    ("stress", "length"): "last_release_length",
    ("stress", "time"): "last_release_time",
}
SYMBOLS = {"length": r"L_\mathrm{trans}", "time": r"T_\mathrm{trans}"}
# What colours and markers tell: the level, and what else varies.
LEVELS = {"displacement": ("tau_0", r"$\tau_0$"), "stress": ("tau_l", r"$\tau_{0,l}$")}
OTHERS = {"displacement": ("gamma", r"$\gamma$"), "stress": ("width", r"$W$")}
MARKERS = "os^Dv<>pP*hX"


def collapse_rows(measured: pd.DataFrame, boundary: str) -> pd.DataFrame:
    """One row a run and quantity: prediction x, measurement y and the paper's literal definition beside it.

    Parameters
    ----------
    measured : measured table of a sweep, one row a run
    boundary : "displacement" or "stress"
    """
    kept = ["left", "width", "gamma", "damping_ratio", "beta", "dx", "run_flags"]
    parts = []
    for quantity, (column, prediction) in QUANTITIES.items():
        rows = pd.DataFrame({"panel": f"{boundary}_{quantity}", "role": "marker", "x": measured[prediction]})
        rows["y"], rows["paper_definition"] = measured[column], measured[PAPER_DEFINITION[boundary, quantity]]
        parts.append(rows.join(measured[kept]))
    return pd.concat(parts, ignore_index=True)


def exact_rows(measured: pd.DataFrame, boundary: str, share: float = 1.0) -> pd.DataFrame:
    """Rows of role "exact" for runs of a sweep: the paper's prediction x, and exact theory y.

    Parameters
    ----------
    measured : the runs wanted, as rows of a measured table
    boundary : "displacement" or "stress"
    share : under a stress boundary, that of |x_minus| which the left front covers at T_trans
    """
    rows = []
    for _, run in measured.iterrows():
        found = exact_transition(run, share)
        for quantity, (_, prediction) in QUANTITIES.items():
            row = {"panel": f"{boundary}_{quantity}", "role": "exact"}
            row |= {"x": run[prediction], "y": getattr(found, quantity)}
            rows.append(row | {name: run[name] for name in ("left", "width", "gamma", "damping_ratio")})
    return pd.DataFrame(rows)


def chosen(measured: pd.DataFrame, **most: int) -> pd.DataFrame:
    """Runs at so many values of a column at most, from the smallest to the largest."""
    for column, count in most.items():
        values = np.sort(measured[column].unique())
        kept = values[np.unique(np.linspace(0, values.size - 1, count).round().astype(int))]
        measured = measured[measured[column].isin(kept)]
    return measured


def deviations(rows: pd.DataFrame) -> tuple[int, float, float]:
    """Number of sound runs, median and largest relative deviation from the prediction."""
    sound = rows[rows["run_flags"].isna() & rows["y"].notna()]
    if sound.empty:
        return 0, float("nan"), float("nan")
    relative = np.abs(sound["y"] / sound["x"] - 1.0)
    return len(sound), float(relative.median()), float(relative.max())


def summaries(rows: pd.DataFrame, by: tuple[str, ...] = ("panel",)) -> pd.DataFrame:
    """Rows of role "summary": number of runs, median and largest deviation of each group of markers."""
    found = []
    for key, group in rows.groupby(list(by), sort=False):
        count, median, largest = deviations(group)
        found.append(
            dict(zip(by, key, strict=True))
            | {"role": "summary", "runs": count, "median": median, "largest": largest}
        )
    return pd.DataFrame(found)


def draw_collapse(axes, rows: pd.DataFrame, boundary: str) -> None:
    """The paper's collapse: measured against predicted on logarithmic axes, lengths as circles, times as triangles."""
    scale = colour_scale(LEVELS[boundary][0])
    for quantity, marker in (("length", "o"), ("time", "^")):
        part = rows[rows["panel"] == f"{boundary}_{quantity}"]
        axes.scatter(
            part["x"], part["paper_definition"], marker="x", s=5.0, linewidths=0.4, color="0.7", zorder=1,
            gid="paper definition",
        )  # fmt: skip
        _scatter(axes, part, part["x"], part["y"], marker, scale)
    axes.set_xscale("log")
    axes.set_yscale("log")
    values = rows[["x", "y", "paper_definition"]].to_numpy(float).ravel()
    ends = np.array([np.nanmin(values) / 1.4, np.nanmax(values) * 1.4])
    axes.plot(ends, ends, color=BLACK, linewidth=0.8, zorder=0, gid="one to one")
    axes.set_xlim(*ends)
    axes.set_ylim(*ends)


def draw_ratio(axes, table: pd.DataFrame, panel: str, across: str, several: str | None = None) -> None:
    """Measured over predicted on a linear axis, with exact theory as a line for each level.

    Parameters
    ----------
    axes : where to draw
    table : rows of role marker and exact
    panel : such as "stress_time"
    across : column of the horizontal axis, on a logarithmic scale that has a place for 0
    several : column that markers tell; one marker where there is none
    """
    boundary = panel.split("_")[0]
    scale = colour_scale(LEVELS[boundary][0])
    rows = table[table["panel"] == panel]
    axes.axhline(1.0, color=BLACK, linewidth=0.8, zorder=0, gid="one to one")
    for level, line in rows[rows["role"] == "exact"].groupby("left"):
        line, colour = line.sort_values(across), scale.to_rgba(level)
        axes.plot(
            line[across], line["y"] / line["x"], color=colour, linewidth=0.8, zorder=2, gid=f"exact {level:g}"
        )
    markers = rows[rows["role"] == "marker"]
    groups = markers.groupby(several) if several else [(None, markers)]
    for marker, (_, part) in zip(MARKERS, groups, strict=False):
        _scatter(axes, part, part[across], part["y"] / part["x"], marker, scale)
    values = np.sort(markers[across].unique())
    if values[0] == 0.0:
        axes.set_xscale("symlog", linthresh=values[1], linscale=0.5)
        axes.set_xticks(values, [f"{value:g}" for value in values])
        axes.set_xlim(-0.3 * values[1], 1.5 * values[-1])
    else:
        axes.set_xscale("log")
    axes.minorticks_off()


def _scatter(axes, rows: pd.DataFrame, x: pd.Series, y: pd.Series, marker: str, scale) -> None:
    """Runs in the colour of their level, flagged ones open and grey."""
    sound = rows["run_flags"].isna()
    axes.scatter(
        x[sound], y[sound], s=9.0, marker=marker, c=scale.to_rgba(rows.loc[sound, "left"]), linewidths=0.0, zorder=3,
        alpha=0.85, gid="runs",
    )  # fmt: skip
    if not sound.all():
        axes.scatter(
            x[~sound], y[~sound], s=9.0, marker=marker, facecolors="none", edgecolors=GREY, linewidths=0.6, zorder=2,
            gid="flagged",
        )  # fmt: skip


def level_bar(figure, axes, boundary: str, **options) -> None:
    """The colours of the levels."""
    quantity, label = LEVELS[boundary]
    figure.colorbar(colour_scale(quantity), ax=axes, **options).set_label(label)


def draw_damping(figure, table: pd.DataFrame, boundary: str) -> None:
    """L_trans and T_trans over the paper's predictions against beta/dx."""
    several, label = OTHERS[boundary]
    panels = figure.subplots(1, 2)
    for axes, quantity, letter in zip(panels, QUANTITIES, "ab", strict=True):
        draw_ratio(axes, table, f"{boundary}_{quantity}", "damping_ratio", several)
        panel_letter(axes, letter)
        axes.set_xlabel(r"damping ratio $b$")
        axes.set_ylabel(f"measured over predicted ${SYMBOLS[quantity]}$")
    level_bar(figure, list(panels), boundary, pad=0.01, aspect=30)
    values = np.sort(table.loc[table["role"] == "marker", several].unique())
    handles = [
        Line2D(
            [], [], color=GREY, marker=marker, linestyle="none", markersize=3.5, label=f"{label} = {value:g}"
        )
        for marker, value in zip(MARKERS, values, strict=False)
    ]
    shown = table.loc[table["role"] == "exact", several].iloc[0]
    handles.append(Line2D([], [], color=GREY, linewidth=0.8, label=f"exact theory, {label} = {shown:g}"))
    figure.legend(
        handles=handles, loc="outside lower center", ncols=len(handles), columnspacing=0.9, handletextpad=0.6
    )
