"""Allowed ranges (domains) of the arguments of formulas, and checks of them."""

from typing import Any

import numpy as np

from ..model.checks import as_numbers, check_number

# The largest damping ratio: with tau_0 as near to 1 as floating point allows, products of speed and
# damping ratio would overflow beyond it.
DOMAINS: dict[str, dict[str, Any]] = {
    "tau0": {"above": 0.0, "below": 1.0},
    "gamma": {"above": 0.0},
    "beta": {"at_least": 0.0},
    "dx": {"above": 0.0},
    "speed": {"above": 1.0, "at_most": 1e100},
    "damping_ratio": {"at_least": 0.0, "at_most": 1e100},
    "rate_strengthening": {},
    "duration": {"at_least": 1e-9},
}


def check_domains(**values: Any) -> None:
    """Raise ValueError if an argument is outside of its range in DOMAINS."""
    for key, value in values.items():
        check_number(key, value, **DOMAINS[key])


def broadcast_numbers(**values: Any) -> tuple[np.ndarray, ...]:
    """Return values as arrays that are broadcast to each other.

    Raise ValueError if a value is outside of its range in DOMAINS.
    """
    arrays = {key: as_numbers(key, value, **DOMAINS.get(key, {})) for key, value in values.items()}
    try:
        return np.broadcast_arrays(*arrays.values())
    except ValueError:
        shapes = " and ".join(str(array.shape) for array in arrays.values())
        text = f"{', '.join(arrays)}: shapes {shapes}; allowed: shapes that broadcast"
        raise ValueError(text) from None
