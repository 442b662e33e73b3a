"""The published space-time figure, all its readings as one claim."""

from __future__ import annotations

from collections.abc import Mapping

from scipy.special import chdtrc

from ..data.numerals import rounded
from . import rules
from .evidence import Claim, Evidence
from .inference import inference, right_panel

# Fitted parameters of the left panel.
FITTED = {"tau0": r"$\tau_0$", "gamma": r"$\gamma$", "damping_ratio": r"$\beta/\Delta x$"}
ID = "published_space_time_figure"


def published_figure(evidence: Evidence, readings: Mapping) -> Claim:
    """Is there a run of this model that the published figure may show?

    Parameters
    ----------
    readings : per name: simulation, quantity, statement, value, reading_error
    """
    study = evidence.tables["published_figure"]
    left, right = inference(study)["best"], right_panel(study)
    chi_square, degrees = left["chi2"] + right["chi2"], left["dof"] + right["dof"]
    p = float(chdtrc(degrees, chi_square)) if degrees > 0 else float("nan")
    fit = ", ".join(f"{tex} = {rounded(left[name], 3)}" for name, tex in FITTED.items())
    ours = {
        entry["statement"]: float(evidence.points(entry["simulation"], entry["quantity"])["value"].iloc[0])
        for entry in readings.values()
    }
    return Claim(
        ID,
        rules.reading(p, degrees, evidence.tolerance(ID)),
        predicted=float(degrees),
        measured=chi_square,
        deviation=p,
        note=f"chi-square of all readings of both panels at the best fit of the left one, {fit}, release rule"
        f" `{left['release']}`; then the readings in our own figure",
        further=ours,
    )
