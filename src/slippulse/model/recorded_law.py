"""The law of friction that a data file names; what only reads it does not depend on any law."""

import json
from collections.abc import Mapping
from typing import Any

from .checks import check_that


def law_of(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Name and parameters of a run's law; older files have the linear one alone, or none."""
    if "friction" in attributes:
        text = attributes["friction"]
        try:
            law = json.loads(text)
        except (TypeError, ValueError):
            law = None
        known = isinstance(law, dict) and isinstance(law.get("law"), str)
        check_that(known, "friction", text, "a JSON object with a law and its parameters")
        return law
    alpha = attributes.get("rate_strengthening", 0.0)
    return {"law": "linear_rate", "alpha": alpha} if alpha else {"law": "coulomb"}
