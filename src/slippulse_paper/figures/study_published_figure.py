"""Parameters of the published space-time figure, inferred from readings, and their regions."""

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slippulse.measurement.inference import chi_square_rise, interpolate_fits
from slippulse.plotting.style import (
    BLACK,
    BLUE,
    GREY,
    ORANGE,
    PAGE_WIDTH,
    Look,
    few_ticks,
    new_panels,
)

NEEDS = {
    "studies": ["published_figure"],
    "settings": ["simulations.space_time_displacement", "model.damping_ratio"],
}

RULE_LOOKS = {"total": (BLUE, "o", "total force"), "elastic": (ORANGE, "s", "elastic stress")}
CONFIDENCE_LEVELS = (0.68, 0.95)
# Every how many points of a curve one is kept.
CURVE_STEP = 25
READING_LABELS = {
    "front_speed": "front slope",
    "intercept": "intercept",
    "centre_stick": "centre stops",
    "velocity_displacement": r"largest $\dot u$",
}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the study with three additional parts.

    curve : interpolated fits
    best : residuals of the best fit, divided by the reading error
    ours : parameters of our scene
    """
    study = tables["published_figure"]
    parts, names = [study], ["damping_ratio", "dx", "tau0", "gamma", "chi2"]
    for release, profile in study[study["part"] == "profile"].groupby("release", sort=False):
        line = interpolate_fits(profile)
        best = line.loc[line["chi2"].idxmin()]
        readings = profile.loc[profile["weight"] > 0.0, "reading"].drop_duplicates()
        rows = pd.DataFrame({"reading": readings, "pull": best[readings].to_numpy(float)})
        kept = line.loc[::CURVE_STEP, [*names, "tau0_error", "gamma_error"]]
        parts.append(kept.assign(part="curve", release=release))
        parts.append(rows.assign(part="best", release=release, **best[names]))
    scene = settings["simulations"]["space_time_displacement"]
    ours = {"tau0": scene["left"][0], "gamma": scene["gamma"][0], **settings["model"]}
    ours["part"] = "ours"
    return pd.concat([*parts, pd.DataFrame([ours])], ignore_index=True)


def draw(table: pd.DataFrame) -> Figure:
    """Draw chi-square and confidence regions by damping ratio above, and residuals below."""
    figure, (*upper, pulls) = new_panels(PAGE_WIDTH, 4.7, "abc;ddd", height_ratios=(1.0, 0.8))
    fits = dict(iter(table.groupby(["part", "release"])))
    _draw_chi2(upper[0], table, fits)
    ours = table[table["part"] == "ours"].iloc[0]
    _draw_region(upper[1], fits, ours, "tau0", r"pre-stress $\tau_0$")
    _draw_region(upper[2], fits, ours, "gamma", r"elasticity ratio $\gamma$")
    for level, alpha in zip(CONFIDENCE_LEVELS, (0.6, 0.25), strict=True):
        upper[1].fill_between([], [], color=GREY, alpha=alpha, label=f"{level:.0%}")
    upper[1].legend(loc="upper left")
    for axes in upper:
        axes.set(xscale="log", xlabel=r"damping ratio $b$")
        few_ticks(axes.xaxis, (0.05, 0.1, 0.2, 0.3))
    pulls.axhspan(-1.0, 1.0, color="0.92")
    pulls.axhline(0.0, color=BLACK, linewidth=0.6)
    for (release, (colour, marker, label)), shift in zip(
        RULE_LOOKS.items(), (-0.12, 0.12), strict=True
    ):
        rows = fits["best", release]
        pulls.plot(np.arange(len(rows)) + shift, rows["pull"], marker, color=colour, label=label)
    edges = {name: rf"edge, $t = {name.rpartition('_')[2]}$" for name in rows["reading"]}
    labels = [READING_LABELS.get(name, edge) for name, edge in edges.items()]
    turned: Look = {"rotation": 35, "ha": "right", "rotation_mode": "anchor"}
    pulls.set_xticks(np.arange(len(labels)), labels, **turned)
    pulls.set(ylim=(-2.4, 2.4), ylabel="(fit $-$ drawn) / reading error")
    pulls.legend(title="released by", loc="upper right", ncols=2)
    return figure


def _draw_chi2(axes: Axes, table: pd.DataFrame, fits: Mapping) -> None:
    """Draw the smallest chi-square by damping ratio, as far as a fit is accepted."""
    best = table[table["part"] == "best"]
    dof = best["reading"].nunique() - 3
    accepted = chi_square_rise(CONFIDENCE_LEVELS[1], dof)
    for release, (colour, marker, label) in RULE_LOOKS.items():
        line, best_fit = fits["curve", release], fits["best", release].iloc[0]
        shown = line[line["chi2"] <= accepted]
        axes.plot(shown["damping_ratio"], shown["chi2"], color=colour, gid=release)
        inside = line[line["chi2"] <= line["chi2"].min() + chi_square_rise(CONFIDENCE_LEVELS[1])]
        look: Look = {"color": colour, "alpha": 0.18, "linewidth": 0.0}
        axes.fill_between(inside["damping_ratio"], inside["chi2"], **look)
        label = rf"{label}: $\chi^2 = {best_fit['chi2']:.1f}$"
        axes.plot(best_fit["damping_ratio"], best_fit["chi2"], marker, color=colour, label=label)
    top = 1.9 * accepted
    notebook = table[(table["part"] == "notebook") & (table["weight"] > 0.0)]
    label = rf"notebook, total force: $\chi^2 = {(notebook['pull'] ** 2).sum():.0f}$"
    # The value is far above the top of the axes, where a marker points to it.
    ratio = notebook["damping_ratio"].iloc[0]
    axes.plot(ratio, top, "^", color=RULE_LOOKS["total"][0], label=label, clip_on=False)
    label = f"5 % at {dof} degrees of freedom"
    axes.axhline(accepted, color=BLACK, linewidth=0.7, linestyle=":", label=label)
    axes.set(ylim=(0.0, top), ylabel=r"smallest $\chi^2$")
    axes.legend(loc="upper left", borderaxespad=0.2)


def _draw_region(axes: Axes, fits: Mapping, ours: pd.Series, name: str, label: str) -> None:
    """Draw confidence regions of the damping ratio and one parameter.

    The remaining parameter has its best value at every point.
    """
    for release, (colour, marker, _) in RULE_LOOKS.items():
        line, best = fits["curve", release], fits["best", release].iloc[0]
        for level, alpha in zip(CONFIDENCE_LEVELS[::-1], (0.22, 0.45), strict=True):
            room = chi_square_rise(level, 2) - (line["chi2"] - line["chi2"].min())
            inside = line[room >= 0.0]
            half = np.sqrt(room[room >= 0.0]) * inside[f"{name}_error"]
            look: Look = {"color": colour, "alpha": alpha, "gid": f"{release} {level:g}"}
            low, high = inside[name] - half, inside[name] + half
            axes.fill_between(inside["damping_ratio"], low, high, linewidth=0.0, **look)
        x, y = best[["damping_ratio", name]]
        axes.plot(x, y, marker, color=colour, markeredgecolor="white", markersize=4.5)
    axes.plot(ours["damping_ratio"], ours[name], "x", color=BLACK, label="our scene")
    axes.set(xlim=(0.045, 0.3), ylabel=label)
