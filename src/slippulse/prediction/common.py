"""Functions that all predictions share: inputs of the theory, and a value where it has none."""

import math
from collections.abc import Callable
from typing import TypeVar

from ..model.run import Run

Result = TypeVar("Result")
# Positions far from the nucleation point, one on each side.
FAR_POSITIONS = {"left": -1e300, "right": 1e300}


def far_level(run: Run, side: str) -> float:
    """Return the pre-stress far from the nucleation point, on the side "left" or "right"."""
    return float(run.prestress.level(FAR_POSITIONS[side]))


def rounded_damping_ratio(run: Run) -> float:
    """Return the damping ratio beta/dx of a run, rounded to 12 digits.

    Runs with the same ratio but different dx then have equal numbers, and share cached results.
    """
    return float(f"{run.damping_ratio:.12g}")


def value_or(compute: Callable[[], Result], missing: Result) -> Result:
    """Return the result of a function of the theory, or ``missing`` if it cannot be computed.

    The theory raises ValueError outside its domain, and ArithmeticError if numbers overflow.
    """
    try:
        return compute()
    except (ValueError, ArithmeticError):
        return missing


def value_or_nan(compute: Callable[[], float]) -> float:
    """Return the result of a function of the theory as a number, or NaN if there is none."""
    return float(value_or(compute, math.nan))
