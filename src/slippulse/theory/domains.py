"""Allowed ranges (domains) of the arguments of formulas, and checks of them."""

from typing import Any

import numpy as np

from ..model.checks import as_numbers, check_number

# Allowed range of each argument, as keywords of `check_number`. Beyond the largest damping ratio,
# products of speed and damping ratio would overflow if tau_0 is as near to 1 as a float can be.
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
        names = ", ".join(arrays)
        raise ValueError(f"{names}: shapes {shapes}; allowed: shapes that broadcast") from None
