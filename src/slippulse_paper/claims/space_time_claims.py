"""Claims about the two panels of the published space-time figure."""

from typing import Any

from slippulse.measurement.inference import infer_parameters

from .evidence import Evidence
from .kinds import Reading

# The arrows and the fitted parameters of the left panel.
ARROWS = ("arrow_time", "arrow_length")


def left(evidence: Evidence, id: str) -> Reading:
    """The left panel at the best fit of all its readings but the arrows."""
    best = infer_parameters(evidence.tables["published_figure"])["best"]
    further = read_off(evidence, "space_time_displacement")
    fit = {"chi_square": best["chi2"], "degrees_of_freedom": best["dof"]}
    return Reading(tolerance=evidence.tolerance(id), **fit, further=further, told=best)


def arrows(evidence: Evidence, id: str) -> Reading:
    """The two arrows of the left panel: how much they raise chi-square at the best fit of all."""
    study = evidence.tables["published_figure"]
    fits = {
        "with": infer_parameters(study, part="arrows")["best"],
        "without": infer_parameters(study)["best"],
    }
    further = {}
    for words, fit in fits.items():
        longer = []
        for name in ARROWS:
            entry = evidence.readings[name]
            longer.append(-fit["pulls"][name] * entry["reading_error"])
            further[f"{entry['statement']}, longer than at the fit {words} arrows by"] = longer[-1]
    told = drawn(evidence)
    # The last fit is the one without arrows.
    told["longer"] = longer
    told["apart"] = 2.0 * (told["intercept"] + told["front_speed"] * told["arrow_time"])
    return Reading(
        tolerance=evidence.tolerance(id),
        chi_square=fits["with"]["chi2"] - fits["without"]["chi2"],
        degrees_of_freedom=fits["with"]["dof"] - fits["without"]["dof"],
        further=further,
        told=told,
    )


def drawn(evidence: Evidence) -> dict[str, Any]:
    """What was read off the published figure, by name."""
    return {name: entry["value"] for name, entry in evidence.readings.items()}


def right(evidence: Evidence, id: str) -> Reading:
    """The largest velocity of the right panel, by the run that fits it worst."""
    pulls = evidence.tables["published_figure"].query("part == 'stress'")["pull"]
    further = read_off(evidence, "space_time_stress")
    fit: dict[str, Any] = {"chi_square": float((pulls**2).max()), "degrees_of_freedom": 1}
    return Reading(tolerance=evidence.tolerance(id), **fit, further=further)


def read_off(evidence: Evidence, simulation: str) -> dict[str, float]:
    """The readings of one panel as our own figure has them, by what they are."""
    entries = [one for one in evidence.readings.values() if one["simulation"] == simulation]
    runs = evidence.finest(simulation)
    return {one["statement"]: float(runs[one["quantity"]].mean()) for one in entries}
