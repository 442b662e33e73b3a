"""Judge claims about the two panels of the published space-time figure.

Numbers that were read off the figure are called readings. The study `published_figure` fits the
exact solution to them. A pull is a fitted value minus the reading, divided by the reading error. A
function that judges a claim takes the evidence and the id of the claim, and returns the result. The
`further` numbers of the result are shown in the table of claims, and sentences quote its
`template_values`.
"""

import math
from collections.abc import Mapping
from typing import Any

from slippulse.measurement.inference import infer_parameters

from .evidence import Evidence
from .kinds import Reading

# Names of the readings of the two arrows in the left panel.
ARROW_READINGS = ("arrow_time", "arrow_length")


def judge_left_panel(evidence: Evidence, id: str) -> Reading:
    """Judge the left panel by the best fit to all readings of it, except its two arrows.

    The sentences of the claim quote the entries of the best fit.
    """
    best = infer_parameters(evidence.tables["published_figure"])["best"]
    return Reading(
        tolerance=evidence.tolerance(id),
        chi_square=best["chi2"],
        degrees_of_freedom=best["dof"],
        further=values_of_our_figure(evidence, "space_time_displacement"),
        template_values=best | numbers_on_shared_errors(evidence, best["pulls"]),
    )


def numbers_on_shared_errors(evidence: Evidence, pulls: Mapping[str, float]) -> dict[str, float]:
    """Return numbers for sentences about the readings of the trailing edge.

    The errors of these readings have two parts: one that all of them share, and one that is
    independent in each.

    The result contains these numbers:

    own_edge_error : the independent part
    independent_chi_square : chi-square of all readings except arrows if no error was shared

    pulls : pull of each reading at the best fit
    """
    own_edge_error, chi_square = math.nan, 0.0
    for name, reading in evidence.readings.items():
        shared_error = reading.get("shared_error", 0.0)
        if shared_error:
            # This is the same for all readings of the trailing edge.
            own_edge_error = math.sqrt(reading["reading_error"] ** 2 - shared_error**2)
        if name in pulls and not reading.get("arrow"):
            chi_square += pulls[name] ** 2
    return {"own_edge_error": own_edge_error, "independent_chi_square": chi_square}


def judge_arrows(evidence: Evidence, id: str) -> Reading:
    """Judge the two arrows of the left panel by the chi-square that they add to the best fit.

    Two template values are added to the readings:

    longer : how much longer each drawn arrow is than in the best fit to all other readings
    apart : distance between the fronts at the time at which the drawn arrow for T_trans ends
    """
    study = evidence.tables["published_figure"]
    # The best fits to all readings of the left panel, with the arrows and without them.
    with_arrows = infer_parameters(study, part="arrows")["best"]
    without_arrows = infer_parameters(study)["best"]
    further: dict[str, float] = {}
    for word, fit in (("with", with_arrows), ("without", without_arrows)):
        for name, excess in excess_lengths(evidence, fit).items():
            arrow = evidence.readings[name]["statement"]
            further[f"{arrow}, drawn value minus value of the best fit {word} arrows"] = excess
    readings = readings_by_name(evidence)
    # The path of the right front in the figure is a straight line.
    front_position = readings["intercept"] + readings["front_speed"] * readings["arrow_time"]
    template_values = readings | {
        "longer": [*excess_lengths(evidence, without_arrows).values()],
        # The left front is as far from x = 0.
        "apart": 2.0 * front_position,
    }
    # The chi-square and the degrees of freedom that the two arrows add.
    return Reading(
        tolerance=evidence.tolerance(id),
        chi_square=with_arrows["chi2"] - without_arrows["chi2"],
        degrees_of_freedom=with_arrows["dof"] - without_arrows["dof"],
        further=further,
        template_values=template_values,
    )


def excess_lengths(evidence: Evidence, fit: Mapping[str, Any]) -> dict[str, float]:
    """Return how much longer the drawn arrows are than those of a fit, by name of the reading.

    fit : a fit of `infer_parameters`, with the pull of each reading
    """
    lengths = {}
    for name in ARROW_READINGS:
        # A pull is in units of the reading error.
        fitted_minus_drawn = fit["pulls"][name] * evidence.readings[name]["reading_error"]
        lengths[name] = -fitted_minus_drawn
    return lengths


def readings_by_name(evidence: Evidence) -> dict[str, Any]:
    """Return the values that were read off the published figure, by name."""
    return {name: entry["value"] for name, entry in evidence.readings.items()}


def judge_right_panel(evidence: Evidence, id: str) -> Reading:
    """Judge the largest velocity of the right panel by the run that deviates most from it.

    This velocity is the only reading of the right panel that is fitted. The panel has a stress
    boundary.
    """
    pulls = evidence.tables["published_figure"].query("part == 'stress'")["pull"]
    return Reading(
        tolerance=evidence.tolerance(id),
        chi_square=float((pulls**2).max()),
        degrees_of_freedom=1,
        further=values_of_our_figure(evidence, "space_time_stress"),
    )


def values_of_our_figure(evidence: Evidence, simulation: str) -> dict[str, float]:
    """Return the values in our own figure that correspond to the readings of one panel.

    The values are means over all runs. The key is what was read, in words, such as "slope of the
    front".

    simulation : name of the simulation of the panel
    """
    runs = evidence.finest(simulation)
    values = {}
    for reading in evidence.readings.values():
        if reading["simulation"] == simulation:
            values[reading["statement"]] = float(runs[reading["quantity"]].mean())
    return values
