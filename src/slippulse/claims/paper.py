"""The whole ledger: every claim, in the order of the paper."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from .evidence import Evidence
from .formulas import formula_claims
from .ledger import Claim
from .published import published_claims
from .pulse import pulse_claims
from .regimes import regime_claims
from .transition import transition_claims

# Whose measured numbers, grid studies and coarser tables the claims are computed from.
SIMULATIONS = [
    "any_prestress",
    "burridge_knopoff_speed",
    "damping_displacement",
    "damping_stress",
    "pulses_across_a_step",
    "regimes_beyond",
    "regimes_displacement",
    "regimes_stress",
    "scaling_displacement",
    "scaling_stress",
    "space_time_displacement",
    "space_time_stress",
    "speed_against_gamma",
    "steady_displacement",
    "steady_stress",
]
# The figure that shows what a claim is judged by, per simulation; of a claim without one, by its id.
SHOWN_IN = {
    "any_prestress": "fig03_steady_state",
    "burridge_knopoff_speed": "fig06_burridge_knopoff",
    "damage_zone_limit": "fig07_damage_zone",
    "damping_displacement": "fig10_damping_displacement",
    "damping_stress": "fig11_damping_stress",
    "pulses_across_a_step": "study_stability_of_pulses",
    "regimes_beyond": "fig02_phase_diagram",
    "regimes_displacement": "fig02_phase_diagram",
    "regimes_stress": "fig02_phase_diagram",
    "scaling_displacement": "fig05_scaling",
    "scaling_stress": "fig05_scaling",
    "space_time_displacement": "fig04_space_time",
    "space_time_stress": "fig04_space_time",
    "speed_against_gamma": "study_front_speed",
    "steady_displacement": "fig03_steady_state",
    "steady_stress": "fig03_steady_state",
}


def all_claims(evidence: Evidence, share: float, readings: Mapping) -> list[Claim]:
    """The ledger.

    Parameters
    ----------
    evidence : measured tables, grid studies and tolerances
    share : share of |x_minus| that defines T_trans under a stress boundary
    readings : numbers read off the published space-time figure
    """
    claims = [
        *pulse_claims(evidence),
        *transition_claims(evidence, share),
        *regime_claims(evidence),
        *formula_claims(evidence),
        *published_claims(evidence, readings),
    ]
    return [replace(claim, figure=_figure(claim)) for claim in claims]


def _figure(claim: Claim) -> str:
    return SHOWN_IN.get(claim.source.partition(":")[0], SHOWN_IN.get(claim.id, ""))
