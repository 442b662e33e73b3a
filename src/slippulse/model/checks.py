"""One form for every refusal: the key, the value it had, and what is allowed."""

import math
import operator
import re
from numbers import Integral, Real
from typing import Any

import numpy as np

# Sign of each limit of a number, and the comparison that it stands for.
LIMITS = {
    "above": (">", operator.gt),
    "at_least": (">=", operator.ge),
    "at_most": ("<=", operator.le),
    "below": ("<", operator.lt),
}


def short_repr(value: object) -> str:
    """A value as a refusal prints it: on one line, and short."""
    if isinstance(value, str) and re.fullmatch(r"[\w.:+-]{1,60}", value, re.ASCII):
        return repr(value)
    text = str(value) if isinstance(value, int | float) else repr(value)
    text = " ".join(text.split())
    return text if len(text) <= 60 else text[:57] + "..."


def check_that(holds: bool, key: str, value: object, allowed: str) -> None:
    """Refuse a value unless a condition on it holds."""
    if not holds:
        raise ValueError(f"{key}: {short_repr(value)}; allowed: {allowed}")


def check_number(key: str, value: Any, integer: bool = False, **limits: float) -> None:
    """Refuse anything but a finite number, or an integer, within some of LIMITS."""
    kind, word = (Integral, "whole") if integer else (Real, "finite")
    try:
        known = isinstance(value, kind) and not isinstance(value, bool) and math.isfinite(value)
    except OverflowError:
        known = False
    if known and all(LIMITS[name][1](value, limit) for name, limit in limits.items()):
        return
    text = "".join(f" and {LIMITS[name][0]} {limit:.10g}" for name, limit in limits.items())
    raise ValueError(f"{key}: {short_repr(value)}; allowed: a {word} number{text}")


def as_numbers(key: str, value: object, **bounds: Any) -> np.ndarray:
    """An array of finite numbers within the bounds of `check_number`."""
    if isinstance(value, Real):
        check_number(key, value, **bounds)
        return np.asarray(float(value))
    try:
        array = np.asarray(value)
    except (TypeError, ValueError, OverflowError):
        array = np.asarray(None)
    check_that(array.dtype.kind in "iuf", key, value, "finite numbers")
    numbers = array.astype(float, copy=False)
    if numbers.size:
        # All numbers lie between these two; where one is NaN, both are.
        for extreme in (numbers.min(), numbers.max()):
            check_number(key, float(extreme), **bounds)
    return numbers


def as_positions(key: str, value: object) -> np.ndarray:
    """An array of floats, of which any may be infinite or NaN."""
    try:
        return np.asarray(value, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{key}: {short_repr(value)}; allowed: numbers") from None


def check_kind(key: str, value: object, kind: type) -> None:
    """Refuse anything that is not of a class."""
    check_that(isinstance(value, kind), key, value, f"a {kind.__name__}")


def check_choice(key: str, value: object, choices: tuple) -> None:
    """Refuse anything that is not one of ``choices``."""
    plain = isinstance(value, str | Real) and not isinstance(value, bool)
    check_that(plain and value in choices, key, value, ", ".join(map(str, choices)))
