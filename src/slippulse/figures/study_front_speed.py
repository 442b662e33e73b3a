"""The exact front speed with damping against simulation: what selects the speed is tau_0 and beta/dx."""

from __future__ import annotations

from collections.abc import Mapping

import matplotlib
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from ..theory.front_law import front_speed, front_speed_undamped, prestress_for_speed
from .style import BLACK, GREY, PAGE, colour_scale, new_figure, panel_letter

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {"measured": ["front_speed", "front_speed_slow"], "settings": ["model.damping_ratio"]}

RULES = ("total", "elastic")
SWEEPS = ("front_speed", "front_speed_slow")
# Pre-stress levels drawn against the damping ratio.
LEVELS = (0.2, 0.5, 0.8)
SPEED_RANGE = (1.0, 300.0)
# Agreement closer than this is drawn here.
CLOSEST = 1e-9
MARKERS = ("o", "s", "^", "D", "v", "P")


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Simulated speeds with theory beside each, theory lines, the limits, and where the paper's figures are.

    Parameters
    ----------
    data : not used
    measured : the simulations in SWEEPS, both release rules
    settings : model (damping_ratio)

    Returns
    -------
    DataFrame of role simulation, theory (over tau_0 or over beta/dx), limit and paper
    """
    parts = []
    sweeps = pd.concat([measured[name] for name in SWEEPS], ignore_index=True)
    for rule in RULES:
        runs = sweeps[sweeps["release"] == rule]
        parts.append(
            pd.DataFrame(
                {
                    "role": "simulation",
                    "release": rule,
                    "tau0": runs["left"],
                    "damping_ratio": runs["damping_ratio"],
                    "speed": runs["front_speed_right"],
                    "theory": front_speed(runs["left"].to_numpy(), runs["damping_ratio"].to_numpy(), rule),
                    "run_flags": runs["run_flags"],
                }
            )
        )
        # The inverse is the cheaper one: lines are drawn over speed.
        speed = 1.0 + np.geomspace(1e-3, SPEED_RANGE[1] - 1.0, 60)
        tau0 = np.linspace(0.02, 0.98, 97)
        for ratio in np.unique(runs["damping_ratio"]):
            level = prestress_for_speed(speed, ratio, rule)
            parts.append(_line("over_prestress", rule, level, ratio, speed))
        ratios = np.geomspace(1e-2, 1e2, 33)
        for level in LEVELS:
            reachable = ratios if rule == "elastic" else ratios[ratios <= 10.0]
            over = front_speed(np.full(reachable.size, level), reachable, rule)
            parts.append(_line("over_damping", rule, level, reachable, over))
        limit = 1.0 / np.sqrt(1.0 - tau0) if rule == "elastic" else 1.0 / (1.0 - tau0)
        # Reached at beta/dx -> infinity (elastic) or at beta/dx = 1 (total).
        parts.append(_line("limit", rule, tau0, np.nan if rule == "elastic" else 1.0, limit))
        parts.append(_line("undamped", rule, tau0, 0.0, front_speed_undamped(tau0)))
    ratio = settings["model"]["damping_ratio"]
    parts.append(pd.DataFrame([{"role": "paper", "damping_ratio": ratio}]))
    return pd.concat(parts, ignore_index=True)


def _line(role: str, rule: str, tau0, ratio, speed) -> pd.DataFrame:
    return pd.DataFrame(
        {"role": role, "release": rule, "tau0": tau0, "damping_ratio": ratio, "speed": speed, "theory": speed}
    )


def plot(table: pd.DataFrame) -> Figure:
    """Columns: against tau_0 under both rules, and against beta/dx; residuals of the simulations below."""
    figure = new_figure(PAGE, 4.6)
    grid = figure.subplots(2, 3, height_ratios=(2.4, 1.0), sharex="col")
    simulated = table[table["role"] == "simulation"]
    ratios = np.unique(simulated["damping_ratio"])
    colours = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.88, ratios.size))
    paper = float(table.loc[table["role"] == "paper", "damping_ratio"].iloc[0])
    for column, rule in enumerate(RULES):
        axes, rest = grid[:, column]
        for ratio, colour, marker in zip(ratios, colours, MARKERS, strict=False):
            line = table[
                (table["role"] == "over_prestress")
                & (table["release"] == rule)
                & (table["damping_ratio"] == ratio)
            ]
            style = {"linewidth": 2.0} if ratio == paper else {}
            axes.plot(line["tau0"], _over(line, rule), color=colour, gid=f"theory {ratio:g}", **style)
            runs = simulated.assign(speed=_over(simulated, rule), theory=_over(simulated, rule, "theory"))
            _points(axes, rest, runs, rule, "damping_ratio", ratio, "tau0", colour, marker, f"{ratio:g}")
        limit = table[(table["role"] == "limit") & (table["release"] == rule)]
        undamped = table[(table["role"] == "undamped") & (table["release"] == rule)]
        label = r"$1/\sqrt{1-\tau_0}$" if rule == "elastic" else r"$1/(1-\tau_0)$"
        axes.plot(limit["tau0"], _over(limit, rule), color=BLACK, linestyle=":", linewidth=1.0, label=label)
        axes.plot(
            undamped["tau0"],
            _over(undamped, rule),
            color=BLACK,
            linestyle="--",
            linewidth=0.8,
            label="paper's formula",
        )
        axes.set_title(f"release: {rule} stress")
        axes.set_xlim(0.0, 1.0)
        rest.set_xlabel(r"pre-stress $\tau_0$")
        axes.legend(
            title=r"$b$",
            ncols=2,
            loc="upper left",
            handlelength=1.2,
            columnspacing=0.8,
        )
    axes, rest = grid[:, 2]
    for level in LEVELS:
        colour = colour_scale("tau_0").to_rgba(level)
        for rule, style, marker in zip(RULES, ("-", "--"), ("o", "s"), strict=True):
            line = table[
                (table["role"] == "over_damping") & (table["release"] == rule) & (table["tau0"] == level)
            ]
            axes.plot(line["damping_ratio"], line["speed"], color=colour, linestyle=style)
            _points(
                axes, rest, simulated, rule, "tau0", level, "damping_ratio", colour, marker,
                rf"{level:g}, {rule}",
            )  # fmt: skip
    axes.axvline(paper, color=GREY, linewidth=0.8, linestyle="-.")
    axes.text(
        paper, 0.35, "the paper's figures", transform=axes.get_xaxis_transform(), fontsize=7.0, rotation=90,
        va="center", ha="right", color=GREY,
    )  # fmt: skip
    axes.set_xscale("log")
    axes.set_title("against damping")
    axes.legend(
        title=r"$\tau_0$, release", loc="upper left", handlelength=1.2,
        frameon=True, framealpha=1.0, edgecolor="none",
    )  # fmt: skip
    rest.set_xlabel(r"damping ratio $b$")
    for axes, letter in zip(grid[0], "abc", strict=True):
        panel_letter(axes, letter)
    for axes in grid[0, ::2]:
        axes.set_yscale("log")
        axes.set_ylim(*SPEED_RANGE)
        axes.set_yticks([1, 2, 5, 10, 20, 50, 100], ["1", "2", "5", "10", "20", "50", "100"])
        axes.yaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
    for rest in grid[1]:
        rest.axhline(CLOSEST, color=GREY, linewidth=0.6, linestyle=":")
        rest.set_yscale("log")
        rest.set_ylim(0.5 * CLOSEST, 1e-1)
    # Elastic speeds are close to one another: over the undamped speed they are not a bundle.
    grid[0, 1].set_ylim(0.97, 1.85)
    grid[0, 0].set_ylabel(r"front speed $v$")
    grid[0, 1].set_ylabel(r"$v\,\sqrt{1-\tau_0^2}$")
    grid[1, 0].set_ylabel("|simulation/theory\n" + r"$-\,1|$", linespacing=0.9)
    return figure


def _over(rows: pd.DataFrame, rule: str, column: str = "speed") -> pd.Series:
    """Speeds as they are drawn over tau_0: under the rule "elastic" in units of the speed without damping."""
    return rows[column] * np.sqrt(1.0 - rows["tau0"] ** 2) if rule == "elastic" else rows[column]


def _points(axes, rest, simulated, rule, key, value, x, colour, marker, label) -> None:
    """Simulated speeds of one line and, below, how far each is from theory; flagged runs open."""
    runs = simulated[(simulated["release"] == rule) & (simulated[key] == value)]
    runs = runs[runs[x] > 0.0] if x == "damping_ratio" else runs
    for flagged, group in runs.groupby(runs["run_flags"].notna()):
        look = {"linestyle": "none", "markersize": 3.0, "marker": marker, "color": colour}
        look |= {"markerfacecolor": "none"} if flagged else {}
        axes.plot(
            group[x], group["speed"], label=None if flagged else label, gid=f"simulation {label}", **look
        )
        rest.plot(group[x], np.maximum(np.abs(group["speed"] / group["theory"] - 1.0), CLOSEST), **look)
