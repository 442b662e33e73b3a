"""The whole ledger: every claim with its text, in the order of the configuration."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import pandas as pd

from .coverage import places
from .evidence import Evidence
from .formulas import formula_claims
from .ledger import Claim
from .published import published_claims
from .pulses import pulse_claims
from .reading import why_text
from .regimes import regime_claims
from .stress_pulses import stress_pulse_claims
from .transition import transition_claims

# Whose measured numbers, grid studies and coarser tables the claims are computed from.
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


def all_claims(
    evidence: Evidence,
    share: float,
    readings: Mapping,
    study: pd.DataFrame,
    texts: Mapping,
    statements: Sequence[Mapping],
) -> list[Claim]:
    """The ledger.

    Parameters
    ----------
    evidence : measured tables, grid studies and tolerances
    share : share of |x_minus| at which a stress boundary's sweeps were measured
    readings : numbers read off the published space-time figure
    study : what they say together, results/studies/published_figure.csv
    texts : per claim, its statement and the figure that shows it
    statements : sentences of the paper, which name the claims that test them

    Raises
    ------
    ValueError
        If the configuration, the texts and what is computed are not about the same claims.
    """
    claims = [
        *pulse_claims(evidence),
        *transition_claims(evidence, share),
        *regime_claims(evidence),
        *stress_pulse_claims(evidence),
        *published_claims(evidence, readings, study),
        *formula_claims(evidence),
    ]
    found = {claim.id: claim for claim in claims}
    for what, names in (("configuration", evidence.settings), ("texts", texts)):
        if odd := sorted({*names} ^ {*found}):
            raise ValueError(f"claims: {', '.join(odd)}; allowed: the same in the {what} and in the ledger")
    where = places(statements)
    return [
        replace(
            found[id], statement=texts[id]["statement"], figure=texts[id].get("figure", ""),
            figure_or_section=where.get(id, ""), why=why_text(found[id]),
        )
        for id in evidence.settings
    ]  # fmt: skip
