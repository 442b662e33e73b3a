"""Estimate the parameters of the published space-time figure from readings.

A reading is a number that was read off the figure, such as the slope of the front. For each release
rule and each of several damping ratios, a study has fitted the pre-stress tau_0 and gamma to the
readings. `interpolate_fits` interpolates these fits between the damping ratios. `infer_parameters`
finds the damping ratio that fits best, and its confidence regions (profile likelihood).
"""

from typing import Any

import numpy as np
import pandas as pd
from scipy.interpolate import CubicSpline
from scipy.special import chdtri

# Number of damping ratios at which the fits are interpolated.
INTERPOLATED_RATIOS = 4001
CONFIDENCE_LEVELS = (0.68, 0.95)
INDEPENDENT_PREFIX = "independent "


def interpolate_fits(profile: pd.DataFrame) -> pd.DataFrame:
    """Interpolate the fits of one release rule between damping ratios.

    The interpolation is a cubic spline in log(beta/dx).

    profile : table of the fits, with one row for each studied damping ratio and reading

    The result has one row for each of INTERPOLATED_RATIOS damping ratios. Its columns are
    damping_ratio, dx, tau0, gamma, tau0_error, gamma_error, chi2, and one column for each reading
    with its pull, which is (predicted - drawn)/reading_error.
    """
    # Every column of this table is interpolated.
    studied = _one_row_per_ratio(profile)
    studied_log_ratios = np.log(studied.index.to_numpy())
    log_ratios = np.linspace(studied_log_ratios[0], studied_log_ratios[-1], INTERPOLATED_RATIOS)
    values = CubicSpline(studied_log_ratios, studied.to_numpy())(log_ratios)
    fits = pd.DataFrame(values, columns=studied.columns)
    # Several readings share a part of their errors, and so their pulls are correlated. Chi-square
    # is the sum of the squares of independent combinations of the pulls, which are the columns with
    # INDEPENDENT_PREFIX. Readings of weight 0 were not fitted.
    fitted_readings = profile.loc[profile["weight"] > 0.0, "reading"].unique()
    fitted_pulls = fits[[f"{INDEPENDENT_PREFIX}{name}" for name in fitted_readings]]
    chi_square = (fitted_pulls**2).sum(axis=1)
    independent_columns = [name for name in fits if name.startswith(INDEPENDENT_PREFIX)]
    fits = fits.drop(columns=independent_columns)
    return fits.assign(chi2=chi_square, damping_ratio=np.exp(log_ratios))


def _one_row_per_ratio(profile: pd.DataFrame) -> pd.DataFrame:
    """Return the fits with one row for each studied damping ratio.

    Each reading has a column with its pull, which is the deviation of the fit from the reading
    divided by the reading error. A second column, whose name begins with INDEPENDENT_PREFIX, has a
    combination of pulls that is not correlated with those of the other readings (see
    `independent_combinations`).

    profile : table of the fits, with one row for each studied damping ratio and reading
    """
    pulls = profile.pivot(index="damping_ratio", columns="reading", values="pull")
    independent = profile.pivot(
        index="damping_ratio", columns="reading", values="independent_pull"
    ).add_prefix(INDEPENDENT_PREFIX)
    # These columns have the same values in all rows of a damping ratio.
    columns = ["dx", "tau0", "gamma", "tau0_error", "gamma_error"]
    numbers = profile.groupby("damping_ratio")[columns].first()
    return pd.concat([pulls, independent, numbers], axis=1)


def independent_combinations(errors: np.ndarray, shared_errors: np.ndarray) -> np.ndarray:
    """Return a matrix that turns deviations of readings into independent ones with errors of 1.

    errors : error of each reading
    shared_errors : the part of this error that the readings have in common; 0 for a reading that
        shares no error with others, whose deviation is only divided by its error

    The matrix is the inverse of the Cholesky factor of the covariance of the readings.
    """
    covariance = np.outer(shared_errors, shared_errors) + np.diag(errors**2 - shared_errors**2)
    return np.linalg.inv(np.linalg.cholesky(covariance))


def chi_square_rise(confidence: float, parameters: int = 1) -> float:
    """Return how far chi-square rises from its minimum to the edge of a confidence region.

    confidence : probability that the region contains the true parameters, such as 0.95
    parameters : number of parameters that the region limits
    """
    return float(chdtri(parameters, 1.0 - confidence))


def infer_parameters(table: pd.DataFrame, part: str = "profile") -> dict[str, Any]:
    """Return the fit of each release rule to the published figure, and compare the rules.

    The result maps the name of each release rule to its fit (see `_fit_of_rule`), "best" to the fit
    with the smallest chi-square, and "difference" to the difference of chi-square between the worst
    and the best rule.

    table : the table of the study published_figure
    part : "profile" for fits without the drawn arrows, "arrows" for fits with them

    Source: profile likelihood, where the readings have Gaussian errors.
    """
    fits: dict[str, Any] = {}
    for release, rows in table[table["part"] == part].groupby("release"):
        fits[str(release)] = _fit_of_rule(rows) | {"release": release}
    best_fit = min(fits.values(), key=lambda fit: fit["chi2"])
    worst_fit = max(fits.values(), key=lambda fit: fit["chi2"])
    return fits | {"best": best_fit, "difference": worst_fit["chi2"] - best_fit["chi2"]}


def _fit_of_rule(rows: pd.DataFrame) -> dict[str, Any]:
    """Return the best fit of one release rule: the one at the damping ratio with the least chi2.

    Its keys are chi2, dof (degrees of freedom), damping_ratio, dx, tau0, gamma, "regions" (the
    confidence regions of the damping ratio), and "pulls" (for each reading, its deviation from the
    fit divided by its error).

    rows : table of the fits, with one row for each studied damping ratio and reading
    """
    fits = interpolate_fits(rows)
    best = fits.loc[fits["chi2"].idxmin()]
    names = ("chi2", "damping_ratio", "dx", "tau0", "gamma")
    fit: dict[str, Any] = {name: float(best[name]) for name in names}
    # Three parameters are fitted: tau_0, gamma and the damping ratio. Readings with the weight 0
    # are compared with the fit, but not fitted.
    fit["dof"] = rows.loc[rows["weight"] > 0.0, "reading"].nunique() - 3
    fit["regions"] = confidence_regions(fits)
    fit["pulls"] = {name: float(best[name]) for name in rows["reading"].unique()}
    return fit


def confidence_regions(fits: pd.DataFrame) -> dict[float, tuple[float, float]]:
    """Return the lowest and the highest damping ratio in the region of each confidence level.

    Either is NaN if it lies outside the studied damping ratios. The levels are CONFIDENCE_LEVELS.

    fits : table with the columns damping_ratio, in ascending order, and chi2
    """
    ratios = fits["damping_ratio"].to_numpy()
    rises = (fits["chi2"] - fits["chi2"].min()).to_numpy()
    regions = {}
    for confidence in CONFIDENCE_LEVELS:
        inside = np.flatnonzero(rises <= chi_square_rise(confidence))
        first, last = inside[0], inside[-1]
        # If the region extends to the first or last studied ratio, its end there is unknown.
        low = float(ratios[first]) if first > 0 else np.nan
        high = float(ratios[last]) if last < ratios.size - 1 else np.nan
        regions[confidence] = low, high
    return regions
