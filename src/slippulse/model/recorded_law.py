"""The friction law that a data file records, read without importing the laws themselves."""

import json
from collections.abc import Mapping
from typing import Any

from .checks import check_that


def read_recorded_law(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Return the name ("law") and the parameters of a run's friction law.

    Older files record either ``rate_strengthening``, which is the law "linear_rate", or nothing,
    which is "coulomb".
    """
    if "friction" in attributes:
        text = attributes["friction"]
        try:
            law = json.loads(text)
        except (TypeError, ValueError):
            # The value is no JSON text, so that the check below refuses it.
            law = None
        has_name = isinstance(law, dict) and isinstance(law.get("law"), str)
        check_that(has_name, "friction", text, "a JSON object with a law and its parameters")
        return law
    alpha = attributes.get("rate_strengthening", 0.0)
    return {"law": "linear_rate", "alpha": alpha} if alpha else {"law": "coulomb"}
