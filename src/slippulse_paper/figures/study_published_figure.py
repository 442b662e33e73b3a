"""Parameters of the published space-time figure and their confidence regions.

A reading is a number that was read off the published figure. For each damping ratio b and release
rule, tau_0 and gamma are fitted to the readings. The pull of a reading is its residual (fitted
minus read value) divided by its reading error. Some readings share a part of their errors, so
chi-square is the sum of the squares of independent combinations of the pulls.
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


def table(data: dict, tables: dict[str, pd.DataFrame], settings: dict) -> pd.DataFrame:
    """Return the rows of the study published_figure, and three more parts.

    curve : fits interpolated between the damping ratios of the study, for each release rule
    best : the pull of each reading at the best of these fits, for each release rule. A pull is the
        difference between fit and reading, divided by the reading error
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
        # Readings without a weight, such as the lengths of arrows, were not fitted.
        fitted_readings = profile.loc[profile["weight"] > 0.0, "reading"].drop_duplicates()
        # An interpolated fit has the pull of each reading in a column with the name of the reading.
        pulls = best[fitted_readings].to_numpy(float)
        rows = pd.DataFrame({"reading": fitted_readings, "pull": pulls})
        parts.append(rows.assign(part="best", release=release, **best[fit_columns]))
    scene = settings["simulations"]["space_time_displacement"]
    ours = {
        "part": "ours",
        "tau0": scene["left"][0],
        "gamma": scene["gamma"][0],
        "damping_ratio": settings["model"]["damping_ratio"],
    }
    return pd.concat([*parts, pd.DataFrame([ours])], ignore_index=True)


def draw(table: pd.DataFrame) -> Figure:
    """Draw chi-square (a) and confidence regions (b, c), and the pulls of the best fits (d).

    The horizontal axis of (a) to (c) is the damping ratio. Panel (a) also marks the fit with the
    settings of the authors' public notebook.
    """
    figure, panels = new_panels(PAGE_WIDTH, 4.7, "abc;ddd", height_ratios=(1.0, 0.8))
    chi2_axes, tau0_axes, gamma_axes, pull_axes = panels
    # The interpolated fits and the best fit of each release rule.
    curves = dict(iter(table[table["part"] == "curve"].groupby("release")))
    best_fits = dict(iter(table[table["part"] == "best"].groupby("release")))
    # The weight is 0 for readings that were not fitted.
    notebook = table[(table["part"] == "notebook") & (table["weight"] > 0.0)]
    _draw_chi2(chi2_axes, curves, best_fits, notebook)
    our_scene = table[table["part"] == "ours"].iloc[0]
    for axes, parameter in ((tau0_axes, "tau0"), (gamma_axes, "gamma")):
        _draw_region(axes, curves, best_fits, parameter)
        look: Look = {"color": BLACK, "label": "our scene"}
        axes.plot(our_scene["damping_ratio"], our_scene[parameter], "x", **look)
    tau0_axes.set_ylabel(r"pre-stress $\tau_0$")
    gamma_axes.set_ylabel(r"elasticity ratio $\gamma$")
    # Nothing is filled here. The legend gets one grey entry for each confidence level.
    for level, alpha in zip(CONFIDENCE_LEVELS, (0.6, 0.25), strict=True):
        tau0_axes.fill_between([], [], color=GREY, alpha=alpha, label=f"{level:.0%}")
    tau0_axes.legend(loc="upper left")
    for axes in (chi2_axes, tau0_axes, gamma_axes):
        axes.set(xscale="log", xlabel=r"damping ratio $b$")
        few_ticks(axes.xaxis, (0.05, 0.1, 0.2, 0.3))
    _draw_pulls(pull_axes, best_fits)
    return figure


def _draw_pulls(axes: Axes, best_fits: Mapping[str, pd.DataFrame]) -> None:
    """Draw the pulls of the best fit of each release rule, in one column for each reading.

    A pull is the difference between the fit and the reading, divided by the reading error.
    """
    axes.axhspan(-1.0, 1.0, color="0.92")
    axes.axhline(0.0, color=BLACK, linewidth=0.6)
    # The two rules are drawn beside each other.
    shifts = (-0.12, 0.12)
    rules = zip(RULE_LOOKS.items(), shifts, strict=True)
    for (release, (colour, marker, label)), shift in rules:
        rows = best_fits[release]
        axes.plot(np.arange(len(rows)) + shift, rows["pull"], marker, color=colour, label=label)
    # Both rules have the same readings. Those without a label are named trailing_edge_TIME.
    labels = []
    for name in rows["reading"]:
        time = name.removeprefix("trailing_edge_")
        labels.append(READING_LABELS.get(name, rf"edge, $t = {time}$"))
    turned: Look = {"rotation": 35, "ha": "right", "rotation_mode": "anchor"}
    axes.set_xticks(np.arange(len(labels)), labels, **turned)
    axes.set(ylim=(-2.4, 2.4), ylabel="(fit $-$ drawn) / reading error")
    axes.legend(title="released by", loc="upper right", ncols=2)


def _draw_chi2(
    axes: Axes,
    curves: Mapping[str, pd.DataFrame],
    best_fits: Mapping[str, pd.DataFrame],
    notebook: pd.DataFrame,
) -> None:
    """Draw the smallest chi-square as a function of the damping ratio, for each release rule.

    A curve is drawn where its fit is accepted. The shaded range below it is the confidence interval
    of the damping ratio.

    curves, best_fits : interpolated fits, and pulls of the best fit, by release rule
    notebook : the fit with the settings of the authors' public notebook, with one row per reading
    """
    # Three parameters are fitted: tau_0, gamma and the damping ratio. The readings are the same for
    # both release rules.
    dof = best_fits["total"]["reading"].nunique() - 3
    confidence = CONFIDENCE_LEVELS[1]
    # A fit is accepted if its chi-square is below this quantile of the chi-square distribution.
    largest_accepted = chi_square_rise(confidence, dof)
    for release, (colour, marker, rule_name) in RULE_LOOKS.items():
        curve, best_fit = curves[release], best_fits[release].iloc[0]
        accepted = curve[curve["chi2"] <= largest_accepted]
        axes.plot(accepted["damping_ratio"], accepted["chi2"], color=colour, gid=release)
        # The interval limits one parameter, the damping ratio.
        largest_in_interval = curve["chi2"].min() + chi_square_rise(confidence, parameters=1)
        interval = curve[curve["chi2"] <= largest_in_interval]
        look: Look = {"color": colour, "alpha": 0.18, "linewidth": 0.0}
        axes.fill_between(interval["damping_ratio"], interval["chi2"], **look)
        label = rf"{rule_name}: $\chi^2 = {best_fit['chi2']:.1f}$"
        axes.plot(best_fit["damping_ratio"], best_fit["chi2"], marker, color=colour, label=label)
    top = 1.9 * largest_accepted
    _point_to_notebook(axes, notebook, top)
    label = f"5 % at {dof} degrees of freedom"
    axes.axhline(largest_accepted, color=BLACK, linewidth=0.7, linestyle=":", label=label)
    axes.set(ylim=(0.0, top), ylabel=r"smallest $\chi^2$")
    axes.legend(loc="upper left", borderaxespad=0.2)


def _point_to_notebook(axes: Axes, notebook: pd.DataFrame, top: float) -> None:
    """Mark the damping ratio of the authors' notebook, which uses the rule of the total force.

    The chi-square of the notebook is far above the top of the axes, so that a marker at the top
    points upwards.

    notebook : the fit with the settings of the notebook, with one row per reading
    """
    chi2 = (notebook["independent_pull"] ** 2).sum()
    label = rf"notebook, total force: $\chi^2 = {chi2:.0f}$"
    colour, _, _ = RULE_LOOKS["total"]
    axes.plot(notebook["damping_ratio"].iloc[0], top, "^", color=colour, label=label, clip_on=False)


def _draw_region(
    axes: Axes,
    curves: Mapping[str, pd.DataFrame],
    best_fits: Mapping[str, pd.DataFrame],
    parameter: str,
) -> None:
    """Draw the confidence regions of the damping ratio and a parameter, and the best fits.

    A region is a band around the best value of the parameter as a function of the damping ratio. At
    every point of it, the other parameter has its best value.

    curves, best_fits : interpolated fits, and the best fit, by release rule
    parameter : "tau0" or "gamma"
    """
    for release, (colour, marker, _) in RULE_LOOKS.items():
        curve, best_fit = curves[release], best_fits[release].iloc[0]
        rise_along_curve = curve["chi2"] - curve["chi2"].min()
        for level, alpha in zip(CONFIDENCE_LEVELS[::-1], (0.22, 0.45), strict=True):
            # In the region, chi-square lies above its minimum by at most this amount.
            largest_rise = chi_square_rise(level, parameters=2)
            is_inside = rise_along_curve <= largest_rise
            region = curve[is_inside]
            # Away from the best value of the parameter, chi-square rises by the square of the
            # distance in units of the parameter's error.
            distance_in_errors = np.sqrt(largest_rise - rise_along_curve[is_inside])
            half_width = distance_in_errors * region[f"{parameter}_error"]
            low, high = region[parameter] - half_width, region[parameter] + half_width
            look: Look = {"color": colour, "alpha": alpha, "gid": f"{release} {level:g}"}
            axes.fill_between(region["damping_ratio"], low, high, linewidth=0.0, **look)
        look = {"color": colour, "markeredgecolor": "white", "markersize": 4.5}
        axes.plot(best_fit["damping_ratio"], best_fit[parameter], marker, **look)
    axes.set_xlim(0.045, 0.3)
