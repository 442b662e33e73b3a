"""Our runs beside the published space-time figure, read off by pixel with a stated reading error."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from .evidence import Evidence
from .ledger import Claim


def published_claims(evidence: Evidence, readings: Mapping) -> list[Claim]:
    """Each number read off the published figure against ours; the tolerance is the reading error.

    Parameters
    ----------
    readings : per name: simulation, quantity, statement, value, reading_error
    """
    claims = []
    for name, reading in readings.items():
        point = evidence.points(reading["simulation"], reading["quantity"]).iloc[0]
        claim = evidence.number(
            f"published_{name}",
            "figure 4 as published",
            reading["statement"],
            reading["value"],
            point["value"],
            point["uncertainty"],
            f"{reading['simulation']}: {reading['quantity']}",
        )
        claims.append(replace(claim, further={"reading error": float(reading["reading_error"])}))
    return claims
