"""What every prediction starts from, and numbers that theory may not have."""

from collections.abc import Callable
from typing import TypeVar

from ..model.scene import Scene

Found = TypeVar("Found")
NAN = float("nan")
SIDES = {"left": -1e300, "right": 1e300}


def level(scene: Scene, side: str) -> float:
    """Pre-stress far away on one of SIDES."""
    return float(scene.prestress.level(SIDES[side]))


def ratio(scene: Scene) -> float:
    """beta/dx; equal ones to the last digit, whatever dx."""
    return float(f"{scene.damping_ratio:.12g}")


def known(find: Callable[[], Found]) -> Found | None:
    """What theory has; None outside the domain that it states by a ValueError, or where numbers are too large."""
    try:
        return find()
    except (ValueError, ArithmeticError):
        return None


def or_nan(find: Callable[[], float]) -> float:
    """A number that theory has; NaN where it says that it has none."""
    found = known(find)
    return NAN if found is None else float(found)
