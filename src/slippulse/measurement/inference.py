"""The parameters that the readings of the published space-time figure make likely."""

from typing import Any

import numpy as np
import pandas as pd
from scipy.interpolate import CubicSpline
from scipy.special import chdtri

# The number of points of a curve over the damping ratio.
FINE = 4001
CONFIDENCE = (0.68, 0.95)


def curve(profile: pd.DataFrame) -> pd.DataFrame:
    """Best trials of one release rule over the damping ratio, cubic in its logarithm.

    Columns are dx, tau0, gamma, their errors, chi2, and the pull of each reading,
    (predicted - drawn)/reading_error.
    """
    pulls = profile.pivot(index="damping_ratio", columns="reading", values="pull")
    columns = ["dx", "tau0", "gamma", "tau0_error", "gamma_error"]
    nodes = pd.concat([pulls, profile.groupby("damping_ratio")[columns].first()], axis=1)
    log_ratio = np.log(nodes.index.to_numpy())
    fine = np.linspace(log_ratio[0], log_ratio[-1], FINE)
    out = pd.DataFrame(CubicSpline(log_ratio, nodes.to_numpy())(fine), columns=nodes.columns)
    fitted = profile.loc[profile["weight"] > 0.0, "reading"].unique()
    return out.assign(chi2=(out[fitted] ** 2).sum(axis=1), damping_ratio=np.exp(fine))


def likely(confidence: float, parameters: int = 1) -> float:
    """The rise of chi-square above its smallest value at the edge of a confidence region."""
    return float(chdtri(parameters, 1.0 - confidence))


def inference(table: pd.DataFrame, part: str = "profile") -> dict[str, Any]:
    """The parameters of the published figure, by release rule, and those of the "best" rule.

    Each has chi2, dof, damping_ratio, dx, tau0, gamma, pulls by reading, and confidence regions of
    the damping ratio, with NaN for an open end. The part "profile" is without the drawn arrows, the
    part "arrows" with them. Source: profile likelihood; the readings have independent Gaussian
    errors.
    """
    fits: dict[str, Any] = {}
    for release, rows in table[table["part"] == part].groupby("release"):
        line = curve(rows)
        best = line.loc[line["chi2"].idxmin()]
        names = ("chi2", "damping_ratio", "dx", "tau0", "gamma")
        fit: dict[str, Any] = {name: float(best[name]) for name in names}
        # Three parameters are fitted: tau_0, gamma and the damping ratio.
        dof = rows.loc[rows["weight"] > 0.0, "reading"].nunique() - 3
        fit |= {"release": release, "dof": dof, "regions": {}}
        for confidence in CONFIDENCE:
            inside = likely(confidence) - (line["chi2"] - line["chi2"].min()) >= 0.0
            ends = line.loc[inside, "damping_ratio"].iloc[[0, -1]]
            low, high = ends.where(~ends.index.isin([line.index[0], line.index[-1]]))
            fit["regions"][confidence] = float(low), float(high)
        fit["pulls"] = {name: float(best[name]) for name in rows["reading"].unique()}
        fits[str(release)] = fit
    order = sorted(fits.values(), key=lambda fit: fit["chi2"])
    return fits | {"best": order[0], "difference": order[-1]["chi2"] - order[0]["chi2"]}
