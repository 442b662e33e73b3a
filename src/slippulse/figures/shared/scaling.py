"""The collapses of L_trans and T_trans: one row a run, drawn with two colours a marker."""

from __future__ import annotations

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, Normalize
from matplotlib.ticker import LogLocator, NullFormatter

from ..style import FACE_MAP, GREY, RIM_MAP

QUANTITIES = {
    "length": ("transition_length", "paper_transition_length"),
    "time": ("transition_time", "paper_transition_time"),
}
# The paper's own definition, or what it draws, per boundary and quantity.
PAPER_DEFINITION = {
    ("displacement", "length"): "slip_length_background",
    ("displacement", "time"): "slip_time_background",
    ("stress", "length"): "last_release_length",
    ("stress", "time"): "last_release_time",
}
SYMBOLS = {"length": r"\bar L_\mathrm{trans}", "time": r"\bar T_\mathrm{trans}"}
# What the paper predicts, per panel.
PREDICTIONS = {
    "displacement_length": r"$2\pi/\sqrt{\bar\gamma(1-\bar\tau_0^2)}$",
    "displacement_time": r"$\pi/\sqrt{\bar\gamma}$",
    "stress_length": r"$2|\bar x_-|$",
    "stress_time": r"$|\bar x_-|$",
}
# Face and rim of a marker: column, label, whether the scale is logarithmic.
COLOURS = {
    "displacement": (("left", r"$\bar\tau_0$", False), ("gamma", r"$\bar\gamma$", True)),
    "stress": (("left", r"$\bar\tau_{0,l}$", False), ("width", r"$\bar W_{\bar\tau}$", True)),
}


def collapse_rows(measured: pd.DataFrame, boundary: str) -> pd.DataFrame:
    """One row a run and quantity: prediction, measurement and the paper's own definition beside it.

    Parameters
    ----------
    measured : measured table of a sweep, one row a run
    boundary : "displacement" or "stress"
    """
    parts = []
    for quantity, (column, prediction) in QUANTITIES.items():
        parts.append(
            pd.DataFrame(
                {
                    "panel": f"{boundary}_{quantity}",
                    "role": "marker",
                    "x": measured[prediction],
                    "y": measured[column],
                    "paper_definition": measured[PAPER_DEFINITION[boundary, quantity]],
                    "left": measured["left"],
                    "width": measured["width"],
                    "gamma": measured["gamma"],
                    "damping_ratio": measured["damping_ratio"],
                    "beta": measured["beta"],
                    "dx": measured["dx"],
                    "run_flags": measured["run_flags"],
                }
            )
        )
    return pd.concat(parts, ignore_index=True)


def deviations(rows: pd.DataFrame) -> tuple[int, float, float]:
    """Number of sound runs, median and largest relative deviation from the prediction."""
    sound = rows[rows["run_flags"].isna() & rows["y"].notna()]
    if sound.empty:
        return 0, float("nan"), float("nan")
    relative = np.abs(sound["y"] / sound["x"] - 1.0)
    return len(sound), float(relative.median()), float(relative.max())


def norms(rows: pd.DataFrame, boundary: str) -> list[Normalize]:
    """Colour scales of face and rim over all rows."""
    out = []
    for column, _, logarithmic in COLOURS[boundary]:
        low, high = float(rows[column].min()), float(rows[column].max())
        out.append(LogNorm(low, high) if logarithmic else Normalize(low, high))
    return out


def draw_collapse(
    axes, rows: pd.DataFrame, boundary: str, scales: list[Normalize], size: float = 20.0, paper: bool = True
) -> None:
    """Markers with face and rim colours, flagged runs open, the 1:1 line, the paper's definition as crosses.

    Parameters
    ----------
    axes : where to draw
    rows : rows of one panel
    boundary : "displacement" or "stress"
    scales : colour scales of face and rim
    size : marker area (points^2)
    paper : whether to show the paper's own definition
    """
    maps = [matplotlib.colormaps[name] for name in (FACE_MAP, RIM_MAP)]
    (face, _, _), (rim, _, _) = COLOURS[boundary]
    sound = rows[rows["run_flags"].isna()]
    flagged = rows[rows["run_flags"].notna()]
    if paper and rows["paper_definition"].notna().any():
        axes.scatter(
            rows["x"], rows["paper_definition"], marker="x", s=0.45 * size, linewidths=0.5, color="0.65",
            label="as defined or drawn in the paper", zorder=1, gid="paper definition",
        )  # fmt: skip
    axes.scatter(
        sound["x"], sound["y"], s=size, c=maps[0](scales[0](sound[face])), edgecolors=maps[1](scales[1](sound[rim])),
        linewidths=0.9, zorder=3, gid="runs",
    )  # fmt: skip
    if not flagged.empty:
        axes.scatter(
            flagged["x"], flagged["y"], s=size, facecolors="none", edgecolors=GREY, linewidths=0.7, zorder=2,
            label="flagged: not resolved", gid="flagged",
        )  # fmt: skip
    axes.set_xscale("log")
    axes.set_yscale("log")
    values = rows[["x", "y", "paper_definition"] if paper else ["x", "y"]].to_numpy(float).ravel()
    values = values[np.isfinite(values)]
    ends = np.array([values.min() / 1.4, values.max() * 1.4])
    axes.plot(ends, ends, color="black", linewidth=0.8, zorder=0, label="1:1", gid="one to one")
    axes.set_xlim(*ends)
    axes.set_ylim(*ends)


def colour_bars(figure, axes, boundary: str, scales: list[Normalize], **options) -> list:
    """One bar for the faces and one for the rims."""
    bars = []
    for (_, label, _), scale, name, part in zip(
        COLOURS[boundary], scales, (FACE_MAP, RIM_MAP), ("face", "rim"), strict=True
    ):
        bar = figure.colorbar(ScalarMappable(scale, name), ax=axes, **options)
        bar.set_label(f"{label} ({part})")
        if isinstance(scale, LogNorm):
            bar.ax.xaxis.set_minor_formatter(NullFormatter())
            if scale.vmax / scale.vmin < 100.0:
                # Too short for decades: the ends and the powers of two between them are what was simulated.
                ticks = 2.0 ** np.arange(np.ceil(np.log2(scale.vmin)), np.floor(np.log2(scale.vmax)) + 1.0)
                bar.set_ticks(ticks, labels=[f"{tick:g}" for tick in ticks])
        bars.append(bar)
    return bars


def damping_rows(measured: pd.DataFrame, boundary: str) -> pd.DataFrame:
    """Rows of one panel for each damping ratio and quantity, with a summary row each."""
    rows = collapse_rows(measured, boundary)
    rows["panel"] = [
        f"{panel}_{ratio:g}" for panel, ratio in zip(rows["panel"], rows["damping_ratio"], strict=True)
    ]
    parts = [rows]
    for panel, group in rows.groupby("panel", sort=False):
        count, median, largest = deviations(group)
        betas = np.unique(group["beta"])
        summary = {"panel": panel, "role": "summary", "runs": count, "median": median, "largest": largest}
        summary |= {
            "damping_ratio": group["damping_ratio"].iloc[0],
            "beta_from": betas.min(),
            "beta_to": betas.max(),
        }
        parts.append(pd.DataFrame([summary]))
    return pd.concat(parts, ignore_index=True)


def draw_damping(figure, table: pd.DataFrame, boundary: str, predictions: dict[str, str]) -> np.ndarray:
    """Two rows (L_trans, T_trans) by one column a damping ratio; axes are shared along a row."""
    markers = table[table["role"] == "marker"]
    summaries = table[table["role"] == "summary"]
    ratios = np.sort(markers["damping_ratio"].unique())
    scales = norms(markers, boundary)
    grid = figure.subplots(2, ratios.size, squeeze=False)
    for row, quantity in enumerate(QUANTITIES):
        chosen = markers["panel"].str.startswith(f"{boundary}_{quantity}")
        ends = []
        for column, ratio in enumerate(ratios):
            axes = grid[row, column]
            name = f"{boundary}_{quantity}_{ratio:g}"
            draw_collapse(axes, markers[markers["panel"] == name], boundary, scales, size=11.0, paper=False)
            summary = summaries[summaries["panel"] == name].iloc[0]
            axes.text(
                0.96, 0.04, f"median {summary['median']:.0%}\nlargest {summary['largest']:.0%}",
                transform=axes.transAxes, ha="right", va="bottom", fontsize=6.0,
            )  # fmt: skip
            if row == 0:
                axes.set_title(damping_title(summary), fontsize=6.5)
            if column:
                axes.tick_params(labelleft=False)
        values = markers.loc[chosen, ["x", "y"]].to_numpy(float).ravel()
        values = values[np.isfinite(values)]
        ends = (values.min() / 1.4, values.max() * 1.4)
        for axes in grid[row]:
            axes.set_xlim(*ends)
            axes.set_ylim(*ends)
            axes.lines[0].set_data(ends, ends)
            axes.tick_params(labelsize=6.0)
            axes.xaxis.set_major_locator(LogLocator(base=10.0, numticks=4))
            axes.yaxis.set_major_locator(LogLocator(base=10.0, numticks=4))
            # Twelve panels of minor ticks are half of the time that the figure takes.
            axes.minorticks_off()
        grid[row, 0].set_ylabel(f"measured ${SYMBOLS[quantity]}$")
        grid[row, ratios.size // 2].set_xlabel(
            f"predicted ${SYMBOLS[quantity]}$ = {predictions[f'{boundary}_{quantity}']}", x=-0.05
        )
    colour_bars(
        figure, list(grid.ravel()), boundary, scales, location="bottom", aspect=50, shrink=0.5, pad=0.02
    )
    return grid


def damping_title(summary: pd.Series) -> str:
    """beta/dx of a column, and beta or its range below."""
    title = rf"$\bar\beta/\mathrm{{d}}\bar x = {summary['damping_ratio']:g}$"
    low, high = summary["beta_from"], summary["beta_to"]
    if high == 0.0:
        return title + "\nno damping"
    power = int(np.floor(np.log10(high)))
    scaled = [f"{value / 10.0**power:.1f}" for value in (low, high)]
    # A non-breaking en dash: a range, not a difference.
    span = scaled[0] if low == high else f"{scaled[0]}\u2013{scaled[1]}"
    return title + "\n" + rf"$\bar\beta =$ {span}$\,\times 10^{{{power}}}$"
