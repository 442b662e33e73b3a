"""The whole ledger."""

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


def all_claims(evidence: Evidence, share: float, readings: dict) -> list[Claim]:
    """The whole ledger, in the order of the paper.

    Parameters
    ----------
    evidence : measured tables, grid studies and tolerances
    share : share of |x_minus| that defines T_trans under a stress boundary
    readings : numbers read off the published space-time figure
    """
    return [
        *pulse_claims(evidence),
        *transition_claims(evidence, share),
        *regime_claims(evidence),
        *formula_claims(evidence),
        *published_claims(evidence, readings),
    ]
