"""The exact front speed with leaf springs and damping together, on lattices of any spacing and in the continuum."""

from __future__ import annotations

from collections.abc import Mapping

import matplotlib
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from ..theory.front_law import continuum_front_speed, lattice_front_speed
from ..theory.wiener_hopf import log_prestress
from .style import BLACK, BLUE, CYCLE, GREEN, ORANGE, PAGE, PURPLE, new_figure, panel_letter

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {"measured": ["front_speed_springs", "front_speed_fixed_beta"]}

RULES = ("total", "elastic")
# gamma dx^2 of the lines, and speeds between which they are found.
SPRINGS = np.concatenate([np.geomspace(3e-3, 0.3, 8), np.geomspace(0.34, 6.0, 34)])
EXCESS = np.geomspace(1e-4, 30.0, 49)
# Narrower pulses stick within the layer of lattice waves at their front, which theory leaves out.
FEWEST_BLOCKS = 4.0
# Agreement closer than this is drawn here.
CLOSEST = 1e-8
COLOURS = dict(zip((0.0, 0.1, 0.3, 1.0), (BLUE, GREEN, ORANGE, PURPLE), strict=True))


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Simulated speeds with theory beside each, and lines of theory.

    Parameters
    ----------
    data, settings : not used
    measured : front_speed_springs (fixed beta/dx), front_speed_fixed_beta

    Returns
    -------
    DataFrame of part (springs or fixed_beta) and role simulation (speed, theory, flags: why theory may not hold),
    theory (lines, over springs = gamma dx^2 or over dx) and continuum (fixed_beta: the closed form for dx -> 0)
    """
    runs = measured["front_speed_springs"]
    parts = [_simulations(runs).assign(part="springs")]
    for rule in RULES:
        for ratio in np.unique(runs["damping_ratio"]):
            parts.append(_lines(rule, ratio, np.unique(runs["left"])))
    runs = measured["front_speed_fixed_beta"]
    parts.append(_simulations(runs).assign(part="fixed_beta"))
    rows = []
    for (tau0, gamma, beta), group in runs.groupby(["left", "gamma", "beta"]):
        common = {"part": "fixed_beta", "release": "elastic", "tau0": tau0, "gamma": gamma, "beta": beta}
        speed = continuum_front_speed(tau0, gamma, beta)
        rows.append(common | {"role": "continuum", "dx": 0.0, "speed": speed})
        for dx in np.geomspace(0.3 * group["dx"].min(), group["dx"].max(), 9):
            speed = lattice_front_speed(tau0, gamma, dx, beta / dx, "elastic")
            rows.append(common | {"role": "theory", "dx": dx, "speed": speed})
    return pd.concat([*parts, pd.DataFrame(rows)], ignore_index=True)


def _simulations(runs: pd.DataFrame) -> pd.DataFrame:
    rows = []
    for _, run in runs.iterrows():
        scene = run["left"], run["gamma"], run["dx"], run["damping_ratio"], run["release"]
        rows.append(
            {
                "role": "simulation", "release": run["release"], "tau0": run["left"], "gamma": run["gamma"],
                "beta": run["beta"], "damping_ratio": run["damping_ratio"], "dx": run["dx"],
                "springs": run["gamma"] * run["dx"] ** 2, "speed": run["front_speed_right"], "theory": _speed(*scene),
                "run_flags": _flags(run),
            }
        )  # fmt: skip
    return pd.DataFrame(rows)


def _speed(*scene) -> float:
    """The lattice's exact front speed; NaN where no front outruns the waves."""
    try:
        return lattice_front_speed(*scene)
    except ValueError:
        return np.nan


def _flags(run: pd.Series) -> str:
    """Flags of a run, and whether its pulse is too narrow for theory."""
    found = [] if pd.isna(run["run_flags"]) else [run["run_flags"]]
    if run["pulse_state"] != "steady":
        found.append(str(run["pulse_state"]))
    if not run["pulse_width"] >= FEWEST_BLOCKS * run["dx"]:
        found.append("narrow")
    return ", ".join(found)


def _lines(rule: str, ratio: float, levels: np.ndarray) -> pd.DataFrame:
    """Speed over gamma dx^2, on the branch where it grows with tau_0, by interpolation of the pre-stress over speed."""
    # Slow to load, and needed here only.
    from scipy.interpolate import PchipInterpolator

    rows = []
    for springs in SPRINGS:
        level = log_prestress(EXCESS, np.full(EXCESS.size, ratio), springs, rule)
        least = int(np.argmin(level))
        branch = PchipInterpolator(level[least:], np.log(EXCESS[least:]), extrapolate=False)
        speeds = 1.0 + np.exp(branch(np.log(levels)))
        rows += [
            {"springs": springs, "tau0": tau0, "speed": v} for tau0, v in zip(levels, speeds, strict=True)
        ]
    return pd.DataFrame(rows).assign(part="springs", role="theory", release=rule, damping_ratio=ratio)


def plot(table: pd.DataFrame) -> Figure:
    """Columns: both rules over gamma dx^2, and fixed damping over dx; below, residuals of the simulations."""
    figure = new_figure(PAGE, 4.6)
    grid = figure.subplots(2, 3, height_ratios=(2.4, 1.0), sharex="col")
    springs = table[table["part"] == "springs"]
    for column, rule in enumerate(RULES):
        _draw_springs(*grid[:, column], springs[springs["release"] == rule])
        grid[0, column].set_title(f"release: {rule} stress", loc="right")
    _draw_fixed_beta(*grid[:, 2], table[table["part"] == "fixed_beta"])
    grid[0, 2].set_title(r"fixed $\beta$, elastic", loc="right")
    grid[0, 0].set_ylabel(r"front speed $v$")
    grid[1, 0].set_ylabel("|simulation/theory\n" + r"$-\,1|$", linespacing=0.9)
    for rest in grid[1]:
        rest.set(yscale="log", ylim=(0.5 * CLOSEST, 5e-2))
    for axes, letter in zip(grid[0], "abc", strict=True):
        panel_letter(axes, letter)
    return figure


def _draw_springs(axes, rest, rows: pd.DataFrame) -> None:
    runs = rows[rows["role"] == "simulation"]
    for (ratio, tau0), line in rows[rows["role"] == "theory"].groupby(["damping_ratio", "tau0"]):
        style = "-" if tau0 == rows["tau0"].max() else "--"
        colour = COLOURS.get(ratio, BLACK)
        axes.plot(
            line["springs"],
            line["speed"],
            style,
            color=colour,
            linewidth=0.9,
            gid=f"theory {ratio:g} {tau0:g}",
        )
        known = line.dropna(subset="speed")
        if len(known) and known["springs"].iloc[-1] < 0.9 * line["springs"].iloc[-1]:
            axes.plot(known["springs"].iloc[-1], known["speed"].iloc[-1], "x", color=colour, markersize=4.0)
        chosen = runs[(runs["damping_ratio"] == ratio) & (runs["tau0"] == tau0)]
        _points(axes, rest, chosen, "springs", colour, "o" if tau0 == rows["tau0"].max() else "s")
    for ratio in np.unique(runs["damping_ratio"]):
        axes.plot([], [], color=COLOURS.get(ratio, BLACK), label=rf"$b = {ratio:g}$")
    for tau0 in np.unique(runs["tau0"])[::-1]:
        look = ("-", "o") if tau0 == rows["tau0"].max() else ("--", "s")
        axes.plot(
            [], [], look[0], marker=look[1], markersize=3.0, color="0.3", label=rf"$\tau_0 = {tau0:g}$"
        )  # fmt: skip
    axes.plot([], [], "x", color="0.3", markersize=4.0, label="line ends")
    axes.set(xscale="log", yscale="log")
    _speed_axis(axes, float(np.nanmax(rows["speed"])))
    axes.legend(loc="upper left", ncols=2, columnspacing=0.8, handlelength=1.8, labelspacing=0.2)
    rest.set_xlabel(r"leaf springs $\gamma\,\Delta x^2$")


def _draw_fixed_beta(axes, rest, rows: pd.DataFrame) -> None:
    closed = rows[rows["role"] == "continuum"]
    for colour, (_, row) in zip(CYCLE, closed.iterrows(), strict=False):
        same = (rows["tau0"] == row["tau0"]) & (rows["beta"] == row["beta"])
        line = rows[same & (rows["role"] == "theory")]
        name = f"{row['tau0']:g} {row['beta']:g}"
        axes.plot(line["dx"], line["speed"], color=colour, linewidth=0.9, gid=f"theory {name}")
        axes.axhline(row["speed"], color=colour, linewidth=0.8, linestyle=":", gid=f"closed form {name}")
        _points(axes, rest, rows[same & (rows["role"] == "simulation")], "dx", colour, "o")
        axes.plot([], [], color=colour, marker="o", markersize=3.0, label=f"{row['tau0']:g}, {row['beta']:g}")
    axes.plot([], [], color="0.3", linestyle=":", label="closed form")
    axes.set(xscale="log", yscale="log")
    _speed_axis(axes, float(np.nanmax(rows["speed"])))
    axes.legend(
        title=r"$\tau_0,\ \beta$ ($\gamma = 1$)", loc="upper right", ncols=2, columnspacing=0.8,
        labelspacing=0.2,
    )  # fmt: skip
    ticks = [0.01, 0.02, 0.05, 0.1]
    rest.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    rest.xaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
    rest.set_xlabel(r"spacing $\Delta x$")


def _speed_axis(axes, top: float) -> None:
    """Room for a legend above the fastest front."""
    axes.set_ylim(0.98, top * (top + 0.3) ** 0.5)
    ticks = [tick for tick in (1.0, 1.2, 1.5, 2.0, 3.0, 5.0) if tick <= 1.01 * top]
    axes.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.yaxis.set_minor_locator(matplotlib.ticker.NullLocator())


def _points(axes, rest, runs: pd.DataFrame, x: str, colour: str, marker: str) -> None:
    """Simulated speeds and, below, how far each is from theory; open where theory may not hold."""
    for sound, group in runs.groupby(runs["run_flags"].isna() | (runs["run_flags"] == "")):
        look = {
            "linestyle": "none",
            "markersize": 3.0,
            "marker": marker,
            "color": colour,
            "markeredgewidth": 0.7,
        }
        look |= {} if sound else {"markerfacecolor": "none"}
        axes.plot(group[x], group["speed"], gid="simulation" if sound else "flagged", **look)
        rest.plot(group[x], np.maximum(np.abs(group["speed"] / group["theory"] - 1.0), CLOSEST), **look)
