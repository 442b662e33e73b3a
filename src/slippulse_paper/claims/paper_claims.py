"""Judge every claim of manuscript/claims.yaml, and return the results for claims.json.

A claim is judged by a rule in the YAML file, or by a function that `JUDGES_BY_CLAIM` lists. The
texts of a claim may contain expressions, which this module evaluates.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

from ..text.prose import fill
from . import (
    friction_claims as friction_laws,
)
from . import (
    layer_claims as layer,
)
from . import (
    pulse_claims as pulses,
)
from . import (
    rough_claims as rough,
)
from . import (
    space_time_claims as space_time_figure,
)
from . import (
    transition_claims as transition,
)
from .claim_texts import places_of
from .evidence import Evidence
from .kinds import Claim
from .ledger import with_texts
from .rules import NOT_TESTABLE, VERDICTS_BEYOND

# Simulations that the claims use, each with the topics of the predictions with which it is
# compared.
SIMULATIONS = {
    "any_prestress": ["pulse"],
    "arrest_profiles": [],
    "burridge_knopoff_chain": [],
    "burridge_knopoff_speed": ["front"],
    "burridge_knopoff_stress": [],
    "damping_displacement": [],
    "damping_stress": [],
    "front_speed_undamped": ["front"],
    "nucleation_widths": [],
    "pulses_across_a_step": [],
    "pulses_across_wide_steps": [],
    "pulses_perturbed_elsewhere": [],
    "regimes_beyond": [],
    "regimes_displacement": ["final_regime"],
    "regimes_displacement_asymmetric": ["final_regime"],
    "regimes_stress": ["final_regime", "transition"],
    "scaling_displacement": ["transition"],
    "scaling_stress": ["transition"],
    "space_time_displacement": ["pulse"],
    "space_time_stress": [],
    "speed_against_gamma": ["front"],
    "steady_displacement": ["front", "pulse"],
    "steady_elsewhere": [],
    "stress_pulses": ["transition"],
    "undamped_pulses": ["pulse"],
}
# Functions that judge a claim by the rule in its entry, by kind of claim.
JUDGES_BY_KIND: dict[str, Callable[..., Claim]] = {
    "exact": pulses.equation,
    "qualitative": pulses.always,
}
# Functions that judge the claims without a rule, by claim id.
JUDGES_BY_CLAIM: dict[str, Callable[[Evidence, str], Claim]] = {
    "zero_net_stress_change": pulses.zero_net_stress_change,
    "front_speed_moderate_gamma": pulses.front_speed_moderate_gamma,
    "front_arrest_position": transition.front_arrest_position,
    "T_trans_displacement": partial(transition.displacement_transition, quantity="time"),
    "L_trans_displacement": partial(transition.displacement_transition, quantity="length"),
    "T_trans_stress": partial(transition.stress_transition, quantity="time"),
    "L_trans_stress": partial(transition.stress_transition, quantity="length"),
    "transition_scaling_displacement": partial(transition.scaling, boundary="displacement"),
    "transition_scaling_stress": partial(transition.scaling, boundary="stress"),
    "stress_front_speeds_near_one": transition.stress_front_speeds_near_one,
    "displacement_pulse_unique": pulses.displacement_pulse_unique,
    "perturbed_pulses_settle": pulses.perturbed_pulses_settle,
    "rough_pulses_go_on": rough.rough_pulses_go_on,
    "rough_stress_pulses_change": rough.rough_stress_pulses_change,
    "stress_pulse_not_unique": pulses.stress_pulse_not_unique,
    "stress_pulse_set_by_prestress": pulses.stress_pulse_set_by_prestress,
    "transition_diverges": transition.transition_diverges,
    "shorter_transition_low_prestress": transition.shorter_transition_low_prestress,
    "pulses_widen_with_prestress": transition.pulses_widen_with_prestress,
    "thin_layer": pulses.thin_layer,
    "layer_regimes": layer.layer_regimes,
    "layer_regimes_stress": layer.layer_regimes_stress,
    "layer_width": layer.layer_width,
    "layer_stability": layer.layer_stability,
    "layer_pressure": layer.layer_pressure,
    "layer_free_top": layer.layer_free_top,
    "T_trans_stress_underestimate": transition.transition_time_underestimated,
    "burridge_knopoff_pulses": friction_laws.burridge_knopoff_pulses,
    "published_space_time_figure": space_time_figure.judge_left_panel,
    "published_arrows": space_time_figure.judge_arrows,
    "published_space_time_figure_right": space_time_figure.judge_right_panel,
    "pulses_for_many_friction_laws": friction_laws.pulses_for_many_friction_laws,
    "stress_pulse_other_laws": friction_laws.stress_pulse_other_laws,
    "other_laws_change_pulses": friction_laws.other_laws_change_pulses,
}
# Keys of an entry that are not copied to claims.json.
TEXTS_NOT_WRITTEN = ("sentences", "doubt", "rule")
# Fields of every claim in claims.json, with the values used if neither entry nor result sets them.
DEFAULT_FIELDS: dict[str, Any] = {
    "figure": "",
    "follows_from": [],
    "note": "",
    "source": "",
    "further": {},
    "why": "",
    "caveat": "",
    "choices": [],
    "choice": "",
    "combinations": 0,
    "holds_at": 0,
    "beyond": False,
    "remark": False,
    "flips_at": [],
    "at_earlier": "",
    "asked": "",
    "predicted": None,
    "measured": None,
    "uncertainty": None,
    "deviation": None,
}


def all_claims(
    evidence: Evidence, explanations: Mapping[str, str], sentences: Sequence[Mapping]
) -> list[dict]:
    """Return all claims with their results and texts, as in claims.json.

    Raises ValueError if a claim exists only in the texts or only in the code.

    explanations : for each verdict a sentence that explains it, for claims that are judged at all
        combinations of open choices
    sentences : sentences of the paper with their places, from manuscript/statements.yaml
    """
    # A claim whose entry has no rule is judged by a function.
    without_rule = {id for id, entry in evidence.entries.items() if "rule" not in entry}
    in_only_one = without_rule.symmetric_difference(JUDGES_BY_CLAIM)
    if in_only_one:
        names = ", ".join(sorted(in_only_one))
        raise ValueError(f"claims: {names}; allowed: the same claims in the texts and in the code")
    # In this simulation pulses enter another pre-stress. Two new columns, which the rules of claims
    # use, show whether each pulse grows or decays.
    evidence.assign("regimes_beyond", pulses.growth_signs)
    places = places_of(evidence.entries, sentences)
    results = []
    for id, entry in evidence.entries.items():
        claim = judge_claim(evidence, id)
        result = fields_of_claim(id, claim, entry, places[id], explanations)
        if result["verdict"] == NOT_TESTABLE:
            # The reason may be that runs are flagged.
            sentence_on_flags = evidence.sentence_on_flags(result["source"])
            result["why"] = f"{result['why']} {sentence_on_flags}".rstrip()
        results.append(result)
    return results


def judge_claim(evidence: Evidence, id: str) -> Claim:
    """Judge one claim by the rule of its entry or by its function.

    Raises ValueError, with the id of the claim, if its rule cannot be evaluated.
    """
    entry = evidence.entries[id]
    if "rule" not in entry:
        return JUDGES_BY_CLAIM[id](evidence, id)
    try:
        return JUDGES_BY_KIND[entry["kind"]](evidence, id, **entry["rule"])
    except (AttributeError, LookupError, NameError, SyntaxError, TypeError) as error:
        allowed = "the keys of a rule of its kind, and expressions of column names as values"
        raise ValueError(f"claims: rule of {id}: {error}; allowed: {allowed}") from error


def fields_of_claim(
    id: str, claim: Claim, entry: Mapping, place: str, explanations: Mapping[str, str] = {}
) -> dict:
    """Return the fields of one claim in claims.json: its texts, its numbers and its verdict.

    claim : result about the claim
    entry : texts of the claim in manuscript/claims.yaml
    place : sections and figures of the paper with the claim; empty if there is none
    explanations : a sentence for each verdict, for claims that are judged at many combinations of
        choices
    """
    written = {name: value for name, value in entry.items() if name not in TEXTS_NOT_WRITTEN}
    fields = DEFAULT_FIELDS | written
    if entry["kind"] == "approximate":
        # Only estimates have these fields. They are None if the result does not set them.
        fields |= dict.fromkeys(("ninety", "largest", "exact_median", "exact_largest"))
    fields |= {"id": id} | claim.json_fields()
    if fields["beyond"]:
        # A claim that the paper does not make has verdicts with other names.
        fields["verdict"] = VERDICTS_BEYOND.get(fields["verdict"], fields["verdict"])
    fields["figure_or_section"] = place or "beyond the paper"
    # A claim also does not count if it follows from others, or is a remark on a drawing.
    fields["counted"] = not (fields["follows_from"] or fields["beyond"] or fields["remark"])
    if "earlier_tolerance" in entry:
        fields["at_earlier"] = claim.verdict(float(entry["earlier_tolerance"]))
    fields = finite(fields)
    return fields | final_texts(fields, claim, entry, explanations)


def final_texts(
    fields: Mapping[str, Any], claim: Claim, entry: Mapping, explanations: Mapping[str, str]
) -> dict[str, str]:
    """Return the note of a claim and the reason for its verdict (why), as final texts.

    fields : all fields of the claim. Its note and reason still contain expressions in braces.
    claim : result about the claim
    entry : texts of the claim in manuscript/claims.yaml
    explanations : a sentence for each verdict, for claims that are judged at many combinations of
        choices
    """
    # The expressions may use all fields, and some values that are not written to claims.json.
    values = {**fields, **claim.sentence_values()}
    note = fill_in_one_line(fields["note"], values)
    why = fill_in_one_line(fields["why"], values)
    if fields["choices"] and fields["verdict"] in explanations:
        # The explanation of this verdict, which all claims share, takes the place of the reason. It
        # may quote the reason and the doubt of this claim.
        doubt = fill_in_one_line(entry.get("doubt", ""), values)
        explanation = explanations[fields["verdict"]]
        why = fill_in_one_line(explanation, {**values, "why": why, "doubt": doubt})
    # If the reason is still empty, the claim gets one from its numbers.
    ledger_entry = with_texts({**fields, "why": why})
    return {"note": note, "why": ledger_entry.why_text()}


def fill_in_one_line(text: str, values: Mapping) -> str:
    """Replace each ``{{ expression }}`` over the values in a text, and join the lines to one."""
    return " ".join(fill(text, values).split())


def finite(value):
    """Convert a value to plain Python objects, with None for NaN and infinity."""
    text = json.dumps(value, default=lambda number: number.item())
    return json.loads(text, parse_constant=lambda _: None)
