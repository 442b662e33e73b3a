"""Claims about the two panels of the published space-time figure."""

from collections.abc import Mapping
from typing import Any

from ..data.numerals import number, rounded
from .evidence import Evidence
from .inference import inference, right_panel
from .kinds import Reading

# The fitted parameters of the left panel.
FITTED = {"tau0": r"$\tau_0$", "gamma": r"$\gamma$", "damping_ratio": r"$\beta/\Delta x$"}


def read_off(evidence: Evidence, simulation: str) -> dict[str, float]:
    """The readings of one panel as our own figure has them, by what they are."""
    run = evidence.finest(simulation).iloc[0]
    return {
        entry["statement"]: float(run[entry["quantity"]])
        for entry in evidence.readings.values()
        if entry["simulation"] == simulation
    }


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
    """The left panel at the best fit of all its readings, those of its arrows included."""
    study = evidence.tables["published_figure"]
    fits = {"with": inference(study, part="arrows")["best"], "without": inference(study)["best"]}
    best = fits["with"]
    arrows = {
        name: entry["statement"] for name, entry in evidence.readings.items() if entry.get("arrow")
    }
    further = read_off(evidence, "space_time_displacement")
    for words, fit in fits.items():
        further[f"chi-square {words} the arrows"] = fit["chi2"]
        for name, text in arrows.items():
            further[f"pull of the {text} at the fit {words} the arrows"] = fit["pulls"][name]
    parameters = ", ".join(f"{tex} = {rounded(best[name], 3)}" for name, tex in FITTED.items())
    note = "chi-square of all readings of the panel, its arrows among them, at their best fit, "
    note += f"{parameters}, release rule `{best['release']}`; then the readings in our own figure"
    why = arrow_sentence(fits, list(arrows)) if arrows else ""
    return fitted(evidence, id, best, further=further, why=why, note=note)


def arrow_sentence(fits: Mapping[str, Mapping], arrows: list[str]) -> str:
    """One sentence on the fits with and without the arrows."""
    clauses = []
    for words, fit in fits.items():
        pulls = " and ".join(number(fit["pulls"][name], 2) for name in arrows)
        p = number(fit["p_value"], 2)
        clauses.append(f"{words} its arrows p is {p} and they are off by {pulls}")
    return f"Fitted {'; '.join(clauses)} reading errors."


def right(evidence: Evidence, id: str) -> Reading:
    """The right panel, of which one reading is left."""
    fit = right_panel(evidence.tables["published_figure"])
    further = read_off(evidence, "space_time_stress")
    why = "One reading is left when its pre-stress is read off."
    note = "chi-square of its one reading, the pre-stress being read off; "
    note += "then the readings in our own figure"
    return fitted(evidence, id, fit, further=further, why=why, note=note)
