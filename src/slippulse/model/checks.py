"""Checks of input values, which raise ValueError with a message of one form.

The message is one line, "key: value; allowed: ...".
"""

import math
import operator
import re
from numbers import Integral, Real
from typing import Any

import numpy as np

# Sign of each kind of limit, and the comparison that it stands for.
LIMIT_KINDS = {
    "above": (">", operator.gt),
    "at_least": (">=", operator.ge),
    "at_most": ("<=", operator.le),
    "below": ("<", operator.lt),
}


def short_repr(value: object) -> str:
    """Return a value as text for a message: on one line, with at most 60 characters."""
    if isinstance(value, str) and re.fullmatch(r"[\w.:+-]{1,60}", value, re.ASCII):
        return repr(value)
    text = str(value) if isinstance(value, int | float) else repr(value)
    text = " ".join(text.split())
    return text if len(text) <= 60 else text[:57] + "..."


def refusal(key: str, value: object, allowed: str) -> ValueError:
    """Return the error about a value that is not allowed."""
    return ValueError(f"{key}: {short_repr(value)}; allowed: {allowed}")


def check_that(holds: bool, key: str, value: object, allowed: str) -> None:
    """Raise ValueError about a value unless a condition holds."""
    if not holds:
        raise refusal(key, value, allowed)


def first_true(mask: np.ndarray) -> int | None:
    """Return the index of the first element that is True; None if there is none."""
    return int(np.argmax(mask)) if np.any(mask) else None


def check_number(key: str, value: Any, integer: bool = False, **limits: float) -> None:
    """Raise ValueError unless a value is a finite number (or an integer) within the limits.

    limits : any of ``above``, ``at_least``, ``at_most`` and ``below``
    """
    number_type, word = (Integral, "whole") if integer else (Real, "finite")
    try:
        is_number = isinstance(value, number_type) and not isinstance(value, bool)
        valid = is_number and math.isfinite(value)
    except OverflowError:
        valid = False
    # A limit may be too large for single precision.
    number = float(value) if valid and not integer else value
    if valid and all(LIMIT_KINDS[name][1](number, limit) for name, limit in limits.items()):
        return
    text = "".join(f" and {LIMIT_KINDS[name][0]} {limit:.10g}" for name, limit in limits.items())
    raise ValueError(f"{key}: {short_repr(value)}; allowed: a {word} number{text}")


def as_numbers(key: str, value: object, **bounds: Any) -> np.ndarray:
    """Convert a value to an array of finite numbers within the bounds of `check_number`."""
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
        # All numbers lie between these two. If any number is NaN, both are NaN.
        for extreme in (numbers.min(), numbers.max()):
            check_number(key, float(extreme), **bounds)
    return numbers


def as_positions(key: str, value: object) -> np.ndarray:
    """Convert a value to an array of floats, which may be infinite or NaN."""
    try:
        return np.asarray(value, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{key}: {short_repr(value)}; allowed: numbers") from None


def check_kind(key: str, value: object, kind: type) -> None:
    """Raise ValueError unless a value is an instance of a class."""
    check_that(isinstance(value, kind), key, value, f"a {kind.__name__}")


def check_choice(key: str, value: object, choices: tuple) -> None:
    """Raise ValueError unless a value is one of ``choices``."""
    is_text_or_number = isinstance(value, str | Real) and not isinstance(value, bool)
    is_choice = is_text_or_number and value in choices
    check_that(is_choice, key, value, ", ".join(map(str, choices)))
