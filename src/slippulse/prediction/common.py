"""Numbers from which every prediction starts, and numbers that theory may lack."""

import math
from collections.abc import Callable
from typing import TypeVar

from ..model.run import Run

Result = TypeVar("Result")
SIDES = {"left": -1e300, "right": 1e300}


def level(run: Run, side: str) -> float:
    """Pre-stress far from the nucleation point on one of SIDES."""
    return float(run.prestress.level(SIDES[side]))


def ratio(run: Run) -> float:
    """beta/dx, rounded so that runs of one ratio have one number, whatever their dx."""
    return float(f"{run.damping_ratio:.12g}")


def known(find: Callable[[], Result], missing: Result) -> Result:
    """Result of the theory, or another outside of its domain or where its numbers overflow."""
    try:
        return find()
    except (ValueError, ArithmeticError):
        return missing


def or_nan(find: Callable[[], float]) -> float:
    """Number of the theory, or NaN outside of its domain."""
    return float(known(find, math.nan))
