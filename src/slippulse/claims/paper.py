"""The whole ledger: every claim with its text, in the order of manuscript/claims.yaml."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import SimpleNamespace

from .entries import positions
from .evidence import Claim, Evidence
from .published import published_figure
from .pulses import pulse_claims
from .reading import why_text
from .regimes import regime_claims
from .transition import transition_claims

# Whose measured numbers, grid studies, coarser tables and predictions the claims are computed from.
SIMULATIONS = [
    "any_prestress",
    "arrest_profiles",
    "burridge_knopoff_chain",
    "burridge_knopoff_speed",
    "burridge_knopoff_stress",
    "damping_displacement",
    "damping_stress",
    "front_speed_undamped",
    "nucleation_widths",
    "pulses_across_a_step",
    "pulses_across_wide_steps",
    "regimes_beyond",
    "regimes_displacement",
    "regimes_displacement_asymmetric",
    "regimes_stress",
    "scaling_displacement",
    "scaling_stress",
    "space_time_displacement",
    "space_time_stress",
    "speed_against_gamma",
    "steady_displacement",
    "stress_pulses",
]


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
    claims = [
        *pulse_claims(evidence),
        *transition_claims(evidence),
        *regime_claims(evidence),
        published_figure(evidence, readings),
    ]
    found = {claim.id: claim for claim in claims}
    if odd := sorted({*evidence.entries} ^ {*found}):
        raise ValueError(f"claims: {', '.join(odd)}; allowed: the same in the texts and in the code")
    where = positions(evidence.entries, sentences)
    return [written(found[id], entry, where[id]) for id, entry in evidence.entries.items()]


def written(claim: Claim, entry: Mapping, where: str) -> dict:
    """One claim with its text, as JSON has it."""
    out = {
        "figure": "", "follows_from": [], **entry, **vars(claim), **claim.numbers, "figure_or_section": where,
        "counted": "follows_from" not in entry, "note": claim.note or entry.get("note", ""),
        "source": claim.source or entry.get("source", ""),
    }  # fmt: skip
    del out["numbers"], out["sentences"]
    out["why"] = why_text(SimpleNamespace(**out))
    return finite(out)


def finite(value):
    """Builtins with None for every number that JSON does not have."""
    if isinstance(value, Mapping):
        return {key: finite(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [finite(entry) for entry in value]
    if hasattr(value, "item"):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value
