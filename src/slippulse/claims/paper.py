"""The whole ledger: every claim with its text, in the order of manuscript/claims.yaml."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from types import SimpleNamespace

from ..data.numerals import number, rounded
from . import rules
from .entries import positions
from .evidence import Claim, Evidence
from .inference import inference, right_panel
from .pulses import pulse_claims
from .rate import rate_claims
from .reading import why_text
from .regimes import regime_claims
from .transition import transition_claims

# The claims about the two panels of the published figure.
LEFT, RIGHT = "published_space_time_figure", "published_space_time_figure_right"
# Fitted parameters of the left panel of the published figure.
FITTED = {"tau0": r"$\tau_0$", "gamma": r"$\gamma$", "damping_ratio": r"$\beta/\Delta x$"}
# Whose measured numbers, grid studies and coarser tables the claims are computed from.
SIMULATIONS = [
    "any_prestress", "arrest_profiles", "burridge_knopoff_chain", "burridge_knopoff_speed",
    "burridge_knopoff_stress", "damping_displacement", "damping_stress", "front_speed_undamped",
    "nucleation_widths", "pulses_across_a_step", "pulses_across_wide_steps", "pulses_perturbed_elsewhere",
    "regimes_beyond", "regimes_displacement", "regimes_displacement_asymmetric", "regimes_stress",
    "scaling_displacement", "scaling_stress", "space_time_displacement", "space_time_stress",
    "speed_against_gamma", "steady_displacement", "steady_elsewhere", "stress_pulses", "undamped_pulses",
]  # fmt: skip
# Of these and of front speeds at one level, the predictions are compared.
PREDICTED = [
    "any_prestress", "burridge_knopoff_speed", "front_speed", "front_speed_undamped", "regimes_displacement",
    "regimes_displacement_asymmetric", "regimes_stress", "scaling_displacement", "scaling_stress",
    "space_time_displacement", "speed_against_gamma", "steady_displacement", "steady_elsewhere",
    "stress_pulses", "undamped_pulses",
]  # fmt: skip


def all_claims(evidence: Evidence, readings: Mapping, sentences: Sequence[Mapping]) -> list[dict]:
    """The ledger, as in claims.json: of each claim its entry in manuscript/claims.yaml and what was found.

    Parameters
    ----------
    readings : numbers read off the published space-time figure
    sentences : of the paper, as in manuscript/statements.yaml

    Raises
    ------
    ValueError
        If the entries and what is computed are not about the same claims.
    """
    claims = [*pulse_claims(evidence), *transition_claims(evidence), *regime_claims(evidence)]
    claims += rate_claims(evidence)
    found = {claim["id"]: claim for claim in [*claims, *published_figure(evidence, readings)]}
    if odd := sorted({*evidence.entries} ^ {*found}):
        raise ValueError(f"claims: {', '.join(odd)}; allowed: the same in the texts and in the code")
    where = positions(evidence.entries, sentences)
    return [written(found[id], entry, where[id]) for id, entry in evidence.entries.items()]


def published_figure(evidence: Evidence, readings: Mapping) -> list[Claim]:
    """The published space-time figure, a claim a panel: is there a run of this model that it may show?

    The left one at the best fit of its readings, the drawn arrows among them; the right one without a fit.
    """
    study = evidence.tables["published_figure"]
    left, right = inference(study, part="arrows")["best"], right_panel(study)
    arrows = {name: entry["statement"] for name, entry in readings.items() if entry.get("arrow")}
    further, why = {}, []
    for fit, found in {"with": left, "without": inference(study)["best"]}.items():
        further[f"chi-square {fit} the arrows"] = found["chi2"]
        further |= {
            f"pull of the {text} at the fit {fit} the arrows": found["pulls"][name]
            for name, text in arrows.items()
        }
        pulls = " and ".join(number(found["pulls"][name], 2) for name in arrows)
        why.append(f"{fit} its arrows p is {number(found['p_value'], 2)} and they are off by {pulls}")

    def claim(id: str, sweep: str, found: Mapping, of: str, why: str, **further: float) -> Claim:
        p, degrees, run = found["p_value"], found["dof"], evidence.lattices(sweep)[0].iloc[0]
        of_panel = [entry for entry in readings.values() if entry["simulation"] == sweep]
        ours = {entry["statement"]: float(run[entry["quantity"]]) for entry in of_panel}
        return {
            "id": id, "verdict": rules.reading(p, degrees, evidence.tolerance(id)), "predicted": float(degrees),
            "measured": found["chi2"], "deviation": p, "further": ours | further,
            "note": f"chi-square of {of}; then the readings in our own figure",
            "why": why, "at": partial(rules.reading, p, degrees),
        }  # fmt: skip

    fit = ", ".join(f"{tex} = {rounded(left[name], 3)}" for name, tex in FITTED.items())
    return [
        claim(
            LEFT, "space_time_displacement", left,
            f"all readings of the panel, its arrows among them, at their best fit, {fit}, release rule"
            f" `{left['release']}`",
            f"Fitted {'; '.join(why)} reading errors." if arrows else "", **further,
        ),
        claim(
            RIGHT, "space_time_stress", right, "its one reading, the pre-stress being read off",
            "One reading is left when its pre-stress is read off.",
        ),
    ]  # fmt: skip


def written(claim: Claim, entry: Mapping, where: str) -> dict:
    """One claim with its text, as JSON has it."""
    numbers = dict.fromkeys(("predicted", "measured", "uncertainty", "deviation"))
    out = {
        "figure": "", "follows_from": [], "note": "", "source": "", "further": {}, "why": "", "caveat": "",
        "choices": [], "choice": "", "combinations": 0, "holds_at": 0, "flips_at": [], **numbers, **entry, **claim,
        "figure_or_section": where, "counted": "follows_from" not in entry,
    }  # fmt: skip
    if at := out.pop("at", None):
        out["flips_at"] = rules.flips(at, out["tolerance"])
    # A stated condition or an erratum leaves no claim simply reproduced.
    if out["caveat"] and out["verdict"] == "reproduced":
        out |= {"verdict": "reproduced with caveat", "why": out["why"] or out["caveat"]}
    del out["sentences"]
    out = finite(out)
    return out | {"why": why_text(SimpleNamespace(**out))}


def finite(value):
    """Builtins with None for every number that JSON does not have."""
    if isinstance(value, Mapping):
        return {key: finite(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [finite(entry) for entry in value]
    if hasattr(value, "item"):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value
