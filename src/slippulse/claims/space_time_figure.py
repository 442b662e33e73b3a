"""Claims about the two panels of the published space-time figure."""

from typing import Any

from ..data.numerals import number, percent, rounded, setting
from ..measurement.inference import inference
from .evidence import Evidence
from .kinds import Reading

# The arrows and the fitted parameters of the left panel.
ARROWS = ("arrow_time", "arrow_length")
SYMBOLS = {"tau0": r"$\tau_0$", "gamma": r"$\gamma$", "damping_ratio": r"$\beta/\Delta x$"}


def left(evidence: Evidence, id: str) -> Reading:
    """The left panel at the best fit of all its readings but the arrows."""
    best = inference(evidence.tables["published_figure"])["best"]
    parameters = ", ".join(f"{tex} = {rounded(best[name], 3)}" for name, tex in SYMBOLS.items())
    note = "chi-square of all readings of the panel but its arrows, at their best fit, "
    note += f"{parameters}, release rule `{best['release']}`; then the readings in our own figure"
    further = read_off(evidence, "space_time_displacement")
    fit = {"chi_square": best["chi2"], "degrees_of_freedom": best["dof"]}
    return Reading(tolerance=evidence.tolerance(id), **fit, further=further, note=note)


def arrows(evidence: Evidence, id: str) -> Reading:
    """The two arrows of the left panel: how much they raise chi-square at the best fit of all."""
    study = evidence.tables["published_figure"]
    fits = {"with": inference(study, part="arrows")["best"], "without": inference(study)["best"]}
    further = {}
    for words, fit in fits.items():
        longer = []
        for name in ARROWS:
            entry = evidence.readings[name]
            longer.append(-fit["pulls"][name] * entry["reading_error"])
            further[f"{entry['statement']}, longer than at the fit {words} arrows by"] = longer[-1]
    # The last fit is the one without arrows.
    lengths = " and ".join(number(excess, 2) for excess in longer)
    why = f"They are longer by {lengths} than in the run that meets all other readings of the "
    why += f"panel best. {arrow_and_stick(evidence)} The arrow of the length ends at that instant: "
    drawn = {name: entry["value"] for name, entry in evidence.readings.items()}
    apart = 2.0 * (drawn["intercept"] + drawn["front_speed"] * drawn["arrow_time"])
    why += f"it is {setting(drawn['arrow_length'])} long, and the drawn fronts are then "
    why += f"{number(apart)} apart. The caption calls the arrows definitions; no number of the "
    why += "paper rests on them, and the verdict is on the drawing alone."
    return Reading(
        tolerance=evidence.tolerance(id),
        chi_square=fits["with"]["chi2"] - fits["without"]["chi2"],
        degrees_of_freedom=fits["with"]["dof"] - fits["without"]["dof"],
        further=further,
        why=why,
    )


def arrow_and_stick(evidence: Evidence) -> str:
    """Where the arrow of the time and the slip at the nucleation point end, in the left panel."""
    stick, arrow = (evidence.readings[name]["value"] for name in ("centre_stick", "arrow_time"))
    text = f"In figure 4, left, the first stick is at {setting(stick)}, and the arrow of the time "
    return text + f"ends at {setting(arrow)}, {percent(arrow / stick - 1.0)} later."


def right(evidence: Evidence, id: str) -> Reading:
    """The largest velocity of the right panel, by the run that fits it worst."""
    pulls = evidence.tables["published_figure"].query("part == 'stress'")["pull"]
    further = read_off(evidence, "space_time_stress")
    why = "One reading is left when its pre-stress is read off."
    note = "chi-square of its one reading, the pre-stress being read off; "
    note += "then the readings in our own figure"
    fit: dict[str, Any] = {"chi_square": float((pulls**2).max()), "degrees_of_freedom": 1}
    return Reading(tolerance=evidence.tolerance(id), **fit, further=further, why=why, note=note)


def read_off(evidence: Evidence, simulation: str) -> dict[str, float]:
    """The readings of one panel as our own figure has them, by what they are."""
    entries = [one for one in evidence.readings.values() if one["simulation"] == simulation]
    runs = evidence.finest(simulation)
    return {one["statement"]: float(runs[one["quantity"]].mean()) for one in entries}
