"""The published space-time figure, all its readings as one claim."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd
from scipy.special import chdtrc

from ..claims.inference import inference, right_panel
from ..data.numerals import rounded
from . import rules
from .evidence import Evidence
from .ledger import Claim

# Fitted parameters of the left panel.
FITTED = {"tau0": r"$\tau_0$", "gamma": r"$\gamma$", "damping_ratio": r"$\beta/\Delta x$"}
ID = "published_space_time_figure"


def published_claims(evidence: Evidence, readings: Mapping, study: pd.DataFrame) -> list[Claim]:
    """One claim from all readings: is there a run of this model that the published figure may show?

    Parameters
    ----------
    readings : per name: simulation, quantity, statement, value, reading_error
    study : results/studies/published_figure.csv
    """
    left, right = inference(study)["best"], right_panel(study)
    chi_square, degrees = left["chi2"] + right["chi2"], left["dof"] + right["dof"]
    p = float(chdtrc(degrees, chi_square)) if degrees > 0 else float("nan")
    fit = ", ".join(f"{tex} = {rounded(left[name], 3)}" for name, tex in FITTED.items())
    return [
        evidence.claim(
            ID, "studies.published_figure; space_time_displacement, space_time_stress",
            rules.reading(p, degrees, evidence.tolerance(ID)), predicted=float(degrees), measured=chi_square,
            deviation=p,
            note=f"chi-square of all readings of both panels at the best fit of the left one, {fit}, release rule"
            f" `{left['release']}`; then the readings in our own figure",
            further=in_our_runs(evidence, readings),
        )
    ]  # fmt: skip


def in_our_runs(evidence: Evidence, readings: Mapping) -> dict[str, float]:
    """Of each reading what the runs of our figure have, by what was read off."""
    return {
        reading["statement"]: float(
            evidence.points(reading["simulation"], reading["quantity"])["value"].iloc[0]
        )
        for reading in readings.values()
    }
