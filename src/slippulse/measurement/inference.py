"""Estimate the parameters of the published space-time figure from what can be read off it.

For each release rule and each of several damping ratios, a study has fitted spacing, pre-stress and
gamma to the readings. `interpolate_fits` interpolates these fits between the damping ratios, and
`infer_parameters` finds the best damping ratio and its confidence regions (profile likelihood).
"""

from functools import partial
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
    """Interpolate the fits of one release rule between damping ratios, cubic in log(beta/dx).

    The result has one row for each of INTERPOLATED_RATIOS damping ratios. Its columns are
    damping_ratio, dx, tau0, gamma, tau0_error, gamma_error, chi2, and the pull of each reading,
    (predicted - drawn)/reading_error. Chi-square is the sum of squares of the independent pulls,
    in which errors that several readings share are taken into account.
    """
    by_reading = partial(profile.pivot, index="damping_ratio", columns="reading")
    pulls = by_reading(values="pull")
    independent = by_reading(values="independent_pull").add_prefix(INDEPENDENT_PREFIX)
    columns = ["dx", "tau0", "gamma", "tau0_error", "gamma_error"]
    # The fit at each studied damping ratio.
    numbers = profile.groupby("damping_ratio")[columns].first()
    studied = pd.concat([pulls, independent, numbers], axis=1)
    studied_log_ratios = np.log(studied.index.to_numpy())
    log_ratios = np.linspace(studied_log_ratios[0], studied_log_ratios[-1], INTERPOLATED_RATIOS)
    values = CubicSpline(studied_log_ratios, studied.to_numpy())(log_ratios)
    fits = pd.DataFrame(values, columns=studied.columns)
    # Only readings with a weight are fitted.
    fitted_readings = profile.loc[profile["weight"] > 0.0, "reading"].unique()
    fitted_pulls = fits[[f"{INDEPENDENT_PREFIX}{name}" for name in fitted_readings]]
    chi_square = (fitted_pulls**2).sum(axis=1)
    fits = fits.drop(columns=independent.columns)
    return fits.assign(chi2=chi_square, damping_ratio=np.exp(log_ratios))


def independent_combinations(errors: np.ndarray, shared_errors: np.ndarray) -> np.ndarray:
    """Return a matrix that turns deviations of readings into independent ones with errors of 1.

    errors : error of each reading
    shared_errors : part of this error that all readings with such a part have in common

    A reading without a shared error is only divided by its error.
    """
    covariance = np.outer(shared_errors, shared_errors) + np.diag(errors**2 - shared_errors**2)
    return np.linalg.inv(np.linalg.cholesky(covariance))


def chi_square_rise(confidence: float, parameters: int = 1) -> float:
    """Return how far chi-square rises above its minimum at the edge of a confidence region."""
    return float(chdtri(parameters, 1.0 - confidence))


def infer_parameters(table: pd.DataFrame, part: str = "profile") -> dict[str, Any]:
    """Return the fit of each release rule to the published figure, and compare the rules.

    The result has a fit for each release rule by its name, the fit with the smallest chi-square as
    "best", and the difference of chi-square between the worst and the best rule as "difference". A
    fit has chi2, dof (degrees of freedom), damping_ratio, dx, tau0, gamma, the pulls by reading,
    and regions: the confidence region of the damping ratio by confidence level, with NaN for an end
    that lies outside the studied damping ratios.

    part : "profile" for fits without the drawn arrows, "arrows" for fits with them

    Source: profile likelihood, where the readings have Gaussian errors.
    """
    fits: dict[str, Any] = {}
    for release, rows in table[table["part"] == part].groupby("release"):
        by_ratio = interpolate_fits(rows)
        best = by_ratio.loc[by_ratio["chi2"].idxmin()]
        names = ("chi2", "damping_ratio", "dx", "tau0", "gamma")
        fit: dict[str, Any] = {name: float(best[name]) for name in names}
        # Three parameters are fitted: tau_0, gamma and the damping ratio.
        dof = rows.loc[rows["weight"] > 0.0, "reading"].nunique() - 3
        fit |= {"release": release, "dof": dof, "regions": {}}
        rise = by_ratio["chi2"] - by_ratio["chi2"].min()
        for confidence in CONFIDENCE_LEVELS:
            inside = chi_square_rise(confidence) - rise >= 0.0
            ends = by_ratio.loc[inside, "damping_ratio"].iloc[[0, -1]]
            # If the region extends to the first or last studied ratio, its end there is unknown.
            is_outermost = ends.index.isin([by_ratio.index[0], by_ratio.index[-1]])
            low, high = ends.where(~is_outermost)
            fit["regions"][confidence] = float(low), float(high)
        fit["pulls"] = {name: float(best[name]) for name in rows["reading"].unique()}
        fits[str(release)] = fit
    best_fit = min(fits.values(), key=lambda fit: fit["chi2"])
    worst_fit = max(fits.values(), key=lambda fit: fit["chi2"])
    return fits | {"best": best_fit, "difference": worst_fit["chi2"] - best_fit["chi2"]}
