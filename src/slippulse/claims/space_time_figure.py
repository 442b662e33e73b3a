"""Claims about the two panels of the published space-time figure."""

from collections.abc import Mapping
from typing import Any

from scipy.special import chdtrc

from ..data.numerals import number, rounded
from .evidence import Evidence
from .inference import inference, right_panel
from .kinds import Reading

# The fitted parameters of the left panel.
FITTED = {"tau0": r"$\tau_0$", "gamma": r"$\gamma$", "damping_ratio": r"$\beta/\Delta x$"}


def read_off(evidence: Evidence, simulation: str) -> dict[str, float]:
    """The readings of one panel as our own figure has them, by what they are."""
    entries = [one for one in evidence.readings.values() if one["simulation"] == simulation]
    runs = evidence.finest(simulation)
    return {one["statement"]: float(runs[one["quantity"]].mean()) for one in entries}


def fitted(evidence: Evidence, id: str, fit: Mapping, **texts: Any) -> Reading:
    """A claim about one panel, from a fit to its readings."""
    return Reading(
        tolerance=evidence.tolerance(id),
        chi_square=fit["chi2"],
        degrees_of_freedom=fit["dof"],
        p_value=fit["p_value"],
        **texts,
    )


def left(evidence: Evidence, id: str) -> Reading:
    """The left panel at the best fit of all its readings but the arrows."""
    best = inference(evidence.tables["published_figure"])["best"]
    parameters = ", ".join(f"{tex} = {rounded(best[name], 3)}" for name, tex in FITTED.items())
    note = "chi-square of all readings of the panel but its arrows, at their best fit, "
    note += f"{parameters}, release rule `{best['release']}`; then the readings in our own figure"
    further = read_off(evidence, "space_time_displacement")
    return fitted(evidence, id, best, further=further, note=note)


def arrows(evidence: Evidence, id: str) -> Reading:
    """The two arrows of the left panel: how much they raise chi-square at the best fit of all."""
    study = evidence.tables["published_figure"]
    fits = {"with": inference(study, part="arrows")["best"], "without": inference(study)["best"]}
    names = [name for name, entry in evidence.readings.items() if name in fits["with"]["pulls"]]
    drawn = {
        name: evidence.readings[name] for name in names if evidence.readings[name].get("arrow")
    }
    rise = fits["with"]["chi2"] - fits["without"]["chi2"]
    degrees = fits["with"]["dof"] - fits["without"]["dof"]
    further = {}
    for words, fit in fits.items():
        for name, entry in drawn.items():
            longer = -fit["pulls"][name] * entry["reading_error"]
            further[f"{entry['statement']}, longer than at the fit {words} arrows by"] = longer
    p_value = float(chdtrc(degrees, rise)) if degrees else float("nan")
    fit = {"chi2": rise, "dof": degrees, "p_value": p_value}
    longer = " and ".join(number(value, 2) for value in [*further.values()][-len(drawn) :])
    why = f"They are longer by {longer} than in the run that meets all other readings of the panel "
    why += "best. They show what the symbols mean; no number of the paper rests on them."
    return fitted(evidence, id, fit, further=further, why=why)


def right(evidence: Evidence, id: str) -> Reading:
    """The right panel, of which one reading is left."""
    fit = right_panel(evidence.tables["published_figure"])
    further = read_off(evidence, "space_time_stress")
    why = "One reading is left when its pre-stress is read off."
    note = "chi-square of its one reading, the pre-stress being read off; "
    note += "then the readings in our own figure"
    return fitted(evidence, id, fit, further=further, why=why, note=note)
