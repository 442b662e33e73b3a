"""Parameters of the published space-time figure, inferred from readings, and their regions.

For each damping ratio b and release rule, tau_0 and gamma are fitted to the readings. Chi-square is
the sum of the squared residuals divided by the reading errors.
"""

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
# One in this number of points of an interpolated curve is kept.
CURVE_STEP = 25
READING_LABELS = {
    "front_speed": "front slope",
    "intercept": "intercept",
    "centre_stick": "centre stops",
    "velocity_displacement": r"largest $\dot u$",
}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the study with three additional parts.

    curve : fits interpolated between the damping ratios of the study
    best : residuals of the best fit, divided by the reading error
    ours : parameters of our scene
    """
    study = tables["published_figure"]
    parts = [study]
    names = ["damping_ratio", "dx", "tau0", "gamma", "chi2"]
    for release, profile in study[study["part"] == "profile"].groupby("release", sort=False):
        curve = interpolate_fits(profile)
        kept = curve.loc[::CURVE_STEP, [*names, "tau0_error", "gamma_error"]]
        parts.append(kept.assign(part="curve", release=release))
        best = curve.loc[curve["chi2"].idxmin()]
        fitted_readings = profile.loc[profile["weight"] > 0.0, "reading"].drop_duplicates()
        pulls = best[fitted_readings].to_numpy(float)
        rows = pd.DataFrame({"reading": fitted_readings, "pull": pulls})
        parts.append(rows.assign(part="best", release=release, **best[names]))
    scene = settings["simulations"]["space_time_displacement"]
    ours = {"tau0": scene["left"][0], "gamma": scene["gamma"][0], **settings["model"]}
    ours["part"] = "ours"
    return pd.concat([*parts, pd.DataFrame([ours])], ignore_index=True)


def draw(table: pd.DataFrame) -> Figure:
    """Draw chi-square and confidence regions by damping ratio above, and residuals below."""
    figure, panels = new_panels(PAGE_WIDTH, 4.7, "abc;ddd", height_ratios=(1.0, 0.8))
    chi2_axes, tau0_axes, gamma_axes, pull_axes = panels
    # Rows by part and release rule.
    fits = dict(iter(table.groupby(["part", "release"])))
    _draw_chi2(chi2_axes, table, fits)
    ours = table[table["part"] == "ours"].iloc[0]
    _draw_region(tau0_axes, fits, ours, "tau0", r"pre-stress $\tau_0$")
    _draw_region(gamma_axes, fits, ours, "gamma", r"elasticity ratio $\gamma$")
    for level, alpha in zip(CONFIDENCE_LEVELS, (0.6, 0.25), strict=True):
        tau0_axes.fill_between([], [], color=GREY, alpha=alpha, label=f"{level:.0%}")
    tau0_axes.legend(loc="upper left")
    for axes in (chi2_axes, tau0_axes, gamma_axes):
        axes.set(xscale="log", xlabel=r"damping ratio $b$")
        few_ticks(axes.xaxis, (0.05, 0.1, 0.2, 0.3))
    _draw_pulls(pull_axes, fits)
    return figure


def _draw_pulls(axes: Axes, fits: Mapping) -> None:
    """Draw the residuals of the best fit of each rule, divided by the reading errors."""
    axes.axhspan(-1.0, 1.0, color="0.92")
    axes.axhline(0.0, color=BLACK, linewidth=0.6)
    # The two rules are drawn beside each other.
    shifts = (-0.12, 0.12)
    for (release, look), shift in zip(RULE_LOOKS.items(), shifts, strict=True):
        colour, marker, label = look
        rows = fits["best", release]
        axes.plot(np.arange(len(rows)) + shift, rows["pull"], marker, color=colour, label=label)
    # Both rules have the same readings.
    labels = []
    for name in rows["reading"]:
        _, _, time = name.rpartition("_")
        labels.append(READING_LABELS.get(name, rf"edge, $t = {time}$"))
    turned: Look = {"rotation": 35, "ha": "right", "rotation_mode": "anchor"}
    axes.set_xticks(np.arange(len(labels)), labels, **turned)
    axes.set(ylim=(-2.4, 2.4), ylabel="(fit $-$ drawn) / reading error")
    axes.legend(title="released by", loc="upper right", ncols=2)


def _draw_chi2(axes: Axes, table: pd.DataFrame, fits: Mapping) -> None:
    """Draw the smallest chi-square by damping ratio, as far as a fit is accepted.

    The shaded range of each rule is the confidence interval of its damping ratio.
    """
    best = table[table["part"] == "best"]
    # Three parameters are fitted: tau_0, gamma and the damping ratio.
    dof = best["reading"].nunique() - 3
    confidence = CONFIDENCE_LEVELS[1]
    accepted = chi_square_rise(confidence, dof)
    for release, (colour, marker, rule_name) in RULE_LOOKS.items():
        curve, best_fit = fits["curve", release], fits["best", release].iloc[0]
        shown = curve[curve["chi2"] <= accepted]
        axes.plot(shown["damping_ratio"], shown["chi2"], color=colour, gid=release)
        highest = curve["chi2"].min() + chi_square_rise(confidence)
        inside = curve[curve["chi2"] <= highest]
        look: Look = {"color": colour, "alpha": 0.18, "linewidth": 0.0}
        axes.fill_between(inside["damping_ratio"], inside["chi2"], **look)
        label = rf"{rule_name}: $\chi^2 = {best_fit['chi2']:.1f}$"
        axes.plot(best_fit["damping_ratio"], best_fit["chi2"], marker, color=colour, label=label)
    top = 1.9 * accepted
    notebook = table[(table["part"] == "notebook") & (table["weight"] > 0.0)]
    notebook_chi2 = (notebook["pull"] ** 2).sum()
    label = rf"notebook, total force: $\chi^2 = {notebook_chi2:.0f}$"
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

    name, label : column and axis label of the parameter
    """
    for release, (colour, marker, _) in RULE_LOOKS.items():
        curve, best = fits["curve", release], fits["best", release].iloc[0]
        for level, alpha in zip(CONFIDENCE_LEVELS[::-1], (0.22, 0.45), strict=True):
            # Chi-square rises by this amount from its minimum to the edge of the region. At each
            # damping ratio, the parameter may move away from its best value until it has risen by
            # what is left of this amount.
            rise_at_edge = chi_square_rise(level, 2)
            left_over = rise_at_edge - (curve["chi2"] - curve["chi2"].min())
            inside = curve[left_over >= 0.0]
            half_width = np.sqrt(left_over[left_over >= 0.0]) * inside[f"{name}_error"]
            low, high = inside[name] - half_width, inside[name] + half_width
            look: Look = {"color": colour, "alpha": alpha, "gid": f"{release} {level:g}"}
            axes.fill_between(inside["damping_ratio"], low, high, linewidth=0.0, **look)
        look = {"color": colour, "markeredgecolor": "white", "markersize": 4.5}
        axes.plot(best["damping_ratio"], best[name], marker, **look)
    axes.plot(ours["damping_ratio"], ours[name], "x", color=BLACK, label="our scene")
    axes.set(xlim=(0.045, 0.3), ylabel=label)
