"""Judge claims about the two panels of the published space-time figure.

Positions were read off the figure. The study `published_figure` fits the exact solution to them.
"""

import math
from collections.abc import Mapping
from typing import Any

from slippulse.measurement.inference import infer_parameters

from .evidence import Evidence
from .kinds import Reading

# Names of the readings of the two arrows in the left panel.
ARROW_READINGS = ("arrow_time", "arrow_length")


def left(evidence: Evidence, id: str) -> Reading:
    """Judge the left panel by the best fit to all its readings except the arrows."""
    best = infer_parameters(evidence.tables["published_figure"])["best"]
    further = read_off(evidence, "space_time_displacement")
    fit = {"chi_square": best["chi2"], "degrees_of_freedom": best["dof"]}
    template_values = best | shares_of_errors(evidence, best["pulls"])
    return Reading(
        tolerance=evidence.tolerance(id), **fit, further=further, template_values=template_values
    )


def shares_of_errors(evidence: Evidence, pulls: Mapping[str, float]) -> dict[str, float]:
    """Return the error of an edge reading that is its own, and chi-square if no error were shared.

    ``pulls`` has the deviation of each reading over its error.
    """
    own, independent = math.nan, 0.0
    for name, reading in evidence.readings.items():
        shared = reading.get("shared_error", 0.0)
        if shared:
            own = math.sqrt(reading["reading_error"] ** 2 - shared**2)
        if name in pulls and not reading.get("arrow"):
            independent += pulls[name] ** 2
    return {"own_edge_error": own, "independent_chi_square": independent}


def arrows(evidence: Evidence, id: str) -> Reading:
    """Judge the two arrows of the left panel by how much they raise the chi-square."""
    study = evidence.tables["published_figure"]
    fits = {
        "with": infer_parameters(study, part="arrows")["best"],
        "without": infer_parameters(study)["best"],
    }
    further = {}
    for words, fit in fits.items():
        longer = []
        for name in ARROW_READINGS:
            entry = evidence.readings[name]
            longer.append(-fit["pulls"][name] * entry["reading_error"])
            further[f"{entry['statement']}, longer than at the fit {words} arrows by"] = longer[-1]
    template_values = readings_by_name(evidence)
    # The loop ends with the fit without arrows.
    template_values["longer"] = longer
    template_values["apart"] = 2.0 * (
        template_values["intercept"]
        + template_values["front_speed"] * template_values["arrow_time"]
    )
    return Reading(
        tolerance=evidence.tolerance(id),
        chi_square=fits["with"]["chi2"] - fits["without"]["chi2"],
        degrees_of_freedom=fits["with"]["dof"] - fits["without"]["dof"],
        further=further,
        template_values=template_values,
    )


def readings_by_name(evidence: Evidence) -> dict[str, Any]:
    """Return the values that were read off the published figure, by name."""
    return {name: entry["value"] for name, entry in evidence.readings.items()}


def right(evidence: Evidence, id: str) -> Reading:
    """Judge the largest velocity of the right panel by the run that fits it worst."""
    pulls = evidence.tables["published_figure"].query("part == 'stress'")["pull"]
    further = read_off(evidence, "space_time_stress")
    fit: dict[str, Any] = {"chi_square": float((pulls**2).max()), "degrees_of_freedom": 1}
    return Reading(tolerance=evidence.tolerance(id), **fit, further=further)


def read_off(evidence: Evidence, simulation: str) -> dict[str, float]:
    """Return the values that our own figure has for the readings of one panel."""
    entries = [one for one in evidence.readings.values() if one["simulation"] == simulation]
    runs = evidence.finest(simulation)
    return {one["statement"]: float(runs[one["quantity"]].mean()) for one in entries}
