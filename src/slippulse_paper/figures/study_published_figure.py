"""Parameters of the published space-time figure and their confidence regions.

A reading is a number that was read off the published figure. For each damping ratio b and release
rule, tau_0 and gamma are fitted to the readings. A residual is fitted minus read value, and
chi-square is the sum of the squares of residuals divided by reading errors.
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

# Colour, marker and name of each release rule.
RULE_LOOKS = {"total": (BLUE, "o", "total force"), "elastic": (ORANGE, "s", "elastic stress")}
CONFIDENCE_LEVELS = (0.68, 0.95)
# An interpolated curve keeps one in this number of its points.
CURVE_STEP = 25
READING_LABELS = {
    "front_speed": "front slope",
    "intercept": "intercept",
    "centre_stick": "centre stops",
    "velocity_displacement": r"largest $\dot u$",
}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the rows of the study published_figure, and three more parts.

    curve : fits interpolated between the damping ratios of the study, for each release rule
    best : the residual of each reading at the best fit, divided by the reading error
    ours : parameters of the scene that we draw in place of the published figure
    """
    study = tables["published_figure"]
    parts = [study]
    fit_columns = ["damping_ratio", "dx", "tau0", "gamma", "chi2"]
    for release, profile in study[study["part"] == "profile"].groupby("release", sort=False):
        curve = interpolate_fits(profile)
        kept = curve.loc[::CURVE_STEP, [*fit_columns, "tau0_error", "gamma_error"]]
        parts.append(kept.assign(part="curve", release=release))
        best = curve.loc[curve["chi2"].idxmin()]
        fitted_readings = profile.loc[profile["weight"] > 0.0, "reading"].drop_duplicates()
        pulls = best[fitted_readings].to_numpy(float)
        rows = pd.DataFrame({"reading": fitted_readings, "pull": pulls})
        parts.append(rows.assign(part="best", release=release, **best[fit_columns]))
    scene = settings["simulations"]["space_time_displacement"]
    ours = {"tau0": scene["left"][0], "gamma": scene["gamma"][0], **settings["model"]}
    ours["part"] = "ours"
    return pd.concat([*parts, pd.DataFrame([ours])], ignore_index=True)


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a) chi-square and (b, c) confidence regions by damping ratio, and (d) residuals."""
    figure, panels = new_panels(PAGE_WIDTH, 4.7, "abc;ddd", height_ratios=(1.0, 0.8))
    chi2_axes, tau0_axes, gamma_axes, pull_axes = panels
    # The rows of the parts that belong to a release rule, by part and rule.
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
    rules = zip(RULE_LOOKS.items(), shifts, strict=True)
    for (release, (colour, marker, label)), shift in rules:
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
    """Draw the smallest chi-square as a function of the damping ratio, for each release rule.

    A curve is drawn where its fit is accepted. The shaded range below it is the confidence interval
    of the damping ratio.
    """
    best = table[table["part"] == "best"]
    # Three parameters are fitted: tau_0, gamma and the damping ratio.
    dof = best["reading"].nunique() - 3
    confidence = CONFIDENCE_LEVELS[1]
    # A fit is accepted if its chi-square is below this quantile of the chi-square distribution.
    largest_accepted = chi_square_rise(confidence, dof)
    for release, (colour, marker, rule_name) in RULE_LOOKS.items():
        curve, best_fit = fits["curve", release], fits["best", release].iloc[0]
        accepted = curve[curve["chi2"] <= largest_accepted]
        axes.plot(accepted["damping_ratio"], accepted["chi2"], color=colour, gid=release)
        largest_in_interval = curve["chi2"].min() + chi_square_rise(confidence)
        interval = curve[curve["chi2"] <= largest_in_interval]
        look: Look = {"color": colour, "alpha": 0.18, "linewidth": 0.0}
        axes.fill_between(interval["damping_ratio"], interval["chi2"], **look)
        label = rf"{rule_name}: $\chi^2 = {best_fit['chi2']:.1f}$"
        axes.plot(best_fit["damping_ratio"], best_fit["chi2"], marker, color=colour, label=label)
    top = 1.9 * largest_accepted
    # The settings of the authors' public notebook fit much worse.
    notebook = table[(table["part"] == "notebook") & (table["weight"] > 0.0)]
    notebook_chi2 = (notebook["independent_pull"] ** 2).sum()
    label = rf"notebook, total force: $\chi^2 = {notebook_chi2:.0f}$"
    # This chi-square is far above the top of the axes, where a marker points to it.
    ratio = notebook["damping_ratio"].iloc[0]
    axes.plot(ratio, top, "^", color=RULE_LOOKS["total"][0], label=label, clip_on=False)
    label = f"5 % at {dof} degrees of freedom"
    axes.axhline(largest_accepted, color=BLACK, linewidth=0.7, linestyle=":", label=label)
    axes.set(ylim=(0.0, top), ylabel=r"smallest $\chi^2$")
    axes.legend(loc="upper left", borderaxespad=0.2)


def _draw_region(axes: Axes, fits: Mapping, ours: pd.Series, name: str, label: str) -> None:
    """Draw confidence regions of the damping ratio and one of the parameters tau_0 and gamma.

    At every point of a region, the other parameter has its best value.

    fits : rows by part and release rule
    ours : parameters of our scene
    name, label : column and axis label of the parameter
    """
    for release, (colour, marker, _) in RULE_LOOKS.items():
        curve, best = fits["curve", release], fits["best", release].iloc[0]
        for level, alpha in zip(CONFIDENCE_LEVELS[::-1], (0.22, 0.45), strict=True):
            # Chi-square rises by a given amount from its minimum to the edge of the region. Along
            # the curve, a part of this rise is used up. The parameter may move away from its best
            # value until chi-square has risen by the rest.
            rise_along_curve = curve["chi2"] - curve["chi2"].min()
            remaining_rise = chi_square_rise(level, 2) - rise_along_curve
            is_inside = remaining_rise >= 0.0
            region = curve[is_inside]
            half_width = np.sqrt(remaining_rise[is_inside]) * region[f"{name}_error"]
            low, high = region[name] - half_width, region[name] + half_width
            look: Look = {"color": colour, "alpha": alpha, "gid": f"{release} {level:g}"}
            axes.fill_between(region["damping_ratio"], low, high, linewidth=0.0, **look)
        look = {"color": colour, "markeredgecolor": "white", "markersize": 4.5}
        axes.plot(best["damping_ratio"], best[name], marker, **look)
    axes.plot(ours["damping_ratio"], ours[name], "x", color=BLACK, label="our scene")
    axes.set(xlim=(0.045, 0.3), ylabel=label)
