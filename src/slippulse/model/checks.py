"""Checks of input values, which raise ValueError with a message of one form.

The message is one line, "key: value; allowed: ...".
"""

import math
import operator
import re
from numbers import Integral, Real
from typing import Any

import numpy as np

# For each keyword of `check_number`: the comparison of a value with its limit, and the sign that
# stands for it in a message.
COMPARISONS = {
    "above": operator.gt,
    "at_least": operator.ge,
    "at_most": operator.le,
    "below": operator.lt,
}
SIGNS = {"above": ">", "at_least": ">=", "at_most": "<=", "below": "<"}
# A longer text of a value is cut in a message.
MAX_TEXT_LENGTH = 60


def short_repr(value: object) -> str:
    """Return a value as text for a message: on one line, and cut if it is long."""
    # A name, such as that of a law, is shown in full.
    is_name = isinstance(value, str) and re.fullmatch(r"[\w.:+-]{1,60}", value, re.ASCII)
    if is_name:
        return repr(value)
    # The repr of a NumPy number would contain its type.
    text = str(value) if isinstance(value, int | float) else repr(value)
    on_one_line = " ".join(text.split())
    if len(on_one_line) <= MAX_TEXT_LENGTH:
        return on_one_line
    return on_one_line[: MAX_TEXT_LENGTH - 3] + "..."


def refusal(key: str, value: object, allowed: str) -> ValueError:
    """Return the error about a value that is not allowed."""
    return ValueError(f"{key}: {short_repr(value)}; allowed: {allowed}")


def check_that(holds: bool, key: str, value: object, allowed: str) -> None:
    """Raise ValueError about a value unless a condition holds."""
    if not holds:
        raise refusal(key, value, allowed)


def index_of_first_true(mask: np.ndarray) -> int | None:
    """Return the index of the first element that is True; None if there is none."""
    return int(np.argmax(mask)) if np.any(mask) else None


def check_number(key: str, value: Any, integer: bool = False, **limits: float) -> None:
    """Raise ValueError unless a value is a finite number within its limits.

    key : name of the value in the message
    integer : True if the number must be an integer
    limits : any of ``above``, ``at_least``, ``at_most`` and ``below``
    """
    number_type, adjective = (Integral, "whole") if integer else (Real, "finite")
    try:
        # For Python a bool is an integer, but it is refused here.
        is_number = isinstance(value, number_type) and not isinstance(value, bool)
        is_finite = is_number and math.isfinite(value)
    except OverflowError:
        # The value is an integer that is too large for a float.
        is_finite = False
    # A number of single precision is converted, because a limit may be too large for its type.
    number = float(value) if is_finite and not integer else value
    if is_finite and all(COMPARISONS[name](number, limit) for name, limit in limits.items()):
        return
    conditions = "".join(f" and {SIGNS[name]} {limit:.10g}" for name, limit in limits.items())
    raise refusal(key, value, f"a {adjective} number{conditions}")


def as_numbers(key: str, value: object, **bounds: Any) -> np.ndarray:
    """Convert a value to an array of finite numbers within the bounds of `check_number`."""
    if isinstance(value, Real):
        check_number(key, value, **bounds)
        return np.asarray(float(value))
    try:
        array = np.asarray(value)
    except (TypeError, ValueError, OverflowError):
        # An array of another type than numbers, so that the check below refuses the value.
        array = np.asarray(None)
    check_that(array.dtype.kind in "iuf", key, value, "finite numbers")
    numbers = array.astype(float, copy=False)
    if numbers.size:
        # If the lowest and the highest number are allowed, all are. If any number is NaN, both of
        # these are NaN.
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
    """Raise ValueError unless a value is one of ``choices``, which are texts or numbers."""
    # Values of other types are not compared: True equals 1, and an array has no single answer.
    is_text_or_number = isinstance(value, str | Real) and not isinstance(value, bool)
    is_choice = is_text_or_number and value in choices
    check_that(is_choice, key, value, ", ".join(map(str, choices)))
