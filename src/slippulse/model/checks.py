"""One form for every refusal: the key, the value it had, and what is allowed."""

import math
import re
from numbers import Integral, Real
from typing import Any

import numpy as np


def short_repr(value: object) -> str:
    """A value as a refusal prints it: on one line, and short."""
    if isinstance(value, str) and re.fullmatch(r"[\w.:+-]{1,60}", value, re.ASCII):
        return repr(value)
    text = " ".join((repr(value) if not isinstance(value, int | float) else str(value)).split())
    return text if len(text) <= 60 else text[:57] + "..."


def check_number(
    key: str, value: Any, *, above: float | None = None, at_least: float | None = None, at_most: float | None = None,
    below: float | None = None, whole: bool = False,
) -> None:  # fmt: skip
    """Refuse anything but a finite number in the stated range, or a whole one."""
    number = type(value) is float or (
        isinstance(value, Real) and not isinstance(value, (bool, np.bool_))
    )
    if (
        number
        and (not whole or isinstance(value, Integral))
        and _finite(value)
        and (above is None or value > above)
        and (at_least is None or value >= at_least)
        and (at_most is None or value <= at_most)
        and (below is None or value < below)
    ):
        return
    signs = ((">", above), (">=", at_least), ("<=", at_most), ("<", below))
    bounds = "".join(f" and {sign} {bound:.10g}" for sign, bound in signs if bound is not None)
    raise ValueError(
        f"{key}: {short_repr(value)}; allowed: a {'whole' if whole else 'finite'} number{bounds}"
    )


def check_runaway(gamma: float, alpha: float) -> None:
    """Refuse alpha < 0 by which uniform slip, d2u/dt2 = tau - gamma u - alpha du/dt, never slows down again."""
    if alpha < 0.0 and alpha * alpha >= 4.0 * gamma:
        least = (
            f"> -2 sqrt(gamma) = {-2.0 * math.sqrt(gamma):.6g}"
            if gamma
            else ">= 0 without leaf springs"
        )
        raise ValueError(f"rate_strengthening: {alpha!r}; allowed: {least}, or slip runs away")


def _finite(value: Any) -> bool:
    try:
        return math.isfinite(value)
    except OverflowError:
        return False


def as_numbers(key: str, value: object, **bounds: Any) -> np.ndarray:
    """An array of finite numbers within the bounds of `check_number`.

    Raises ValueError: naming the key, the value and what is allowed.
    """
    if isinstance(value, Real):
        check_number(key, value, **bounds)
        return np.asarray(float(value))
    try:
        array = np.asarray(value)
    except (TypeError, ValueError, OverflowError):
        array = np.asarray(None)
    if array.dtype.kind not in "iuf":
        raise ValueError(f"{key}: {short_repr(value)}; allowed: finite numbers")
    numbers = array.astype(float, copy=False)
    if numbers.size:
        # They stand for all; one that is not a number is both.
        for extreme in (numbers.min(), numbers.max()):
            check_number(key, float(extreme), **bounds)
    return numbers


def check_kind(key: str, value: object, kind: type) -> None:
    """Refuse anything that is not of a class."""
    if not isinstance(value, kind):
        raise ValueError(f"{key}: {short_repr(value)}; allowed: a {kind.__name__}")


def check_choice(key: str, value: object, choices: tuple) -> None:
    """Refuse anything that is not one of ``choices``."""
    if not isinstance(value, str | int | float) or isinstance(value, bool) or value not in choices:
        raise ValueError(f"{key}: {short_repr(value)}; allowed: {', '.join(map(str, choices))}")
