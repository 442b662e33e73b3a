"""What the paper says, what was measured, and the verdict, computed."""

from .evidence import Evidence
from .formulas import formula_claims
from .ledger import Claim, judge
from .published import published_claims
from .pulse import pulse_claims
from .regimes import regime_claims
from .transition import transition_claims

__all__ = ["Claim", "Evidence", "all_claims", "judge"]


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
