"""One form for every refusal: the key, the value it had, and what is allowed."""

import difflib
import math
import re
from collections.abc import Iterable
from numbers import Integral, Real
from typing import Any

import numpy as np

# What arguments of formulas may be. Beyond this damping ratio, with tau_0 as near 1 as floating point comes,
# products of speed and damping would overflow.
DOMAINS: dict[str, dict[str, Any]] = {
    "tau0": {"above": 0.0, "below": 1.0},
    "gamma": {"above": 0.0},
    "dx": {"above": 0.0},
    "damping_ratio": {"at_least": 0.0, "at_most": 1e100},
}


class ConfigError(ValueError):
    """What is wrong with a configuration: one line a problem, each naming the key, the value and what is allowed."""


def short_repr(value: object) -> str:
    """A value as a refusal prints it: on one line, and short."""
    if isinstance(value, str) and re.fullmatch(r"[\w.:+-]{1,60}", value, re.ASCII):
        return repr(value)
    text = " ".join((repr(value) if not isinstance(value, int | float) else str(value)).split())
    return text if len(text) <= 60 else text[:57] + "..."


def nearest(name: object, known: Iterable[str]) -> str:
    """A hint at the known name that was probably meant; empty where none is near."""
    near = difflib.get_close_matches(str(name)[:80], list(known), n=1)
    return f" (did you mean {near[0]!r}?)" if near else ""


def check_number(
    key: str, value: Any, *, above: float | None = None, at_least: float | None = None, at_most: float | None = None,
    below: float | None = None, whole: bool = False,
) -> None:  # fmt: skip
    """Refuse anything but a finite number in the stated range, or a whole one."""
    number = type(value) is float or (isinstance(value, Real) and not isinstance(value, (bool, np.bool_)))
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
    kind = "whole" if whole else "finite"
    raise ValueError(f"{key}: {short_repr(value)}; allowed: a {kind} number{bounds}")


def check_domains(**values: Any) -> None:
    """Refuse arguments of formulas, by name, that are outside DOMAINS."""
    for key, value in values.items():
        check_number(key, value, **DOMAINS[key])


def check_runaway(gamma: float, alpha: float) -> None:
    """Refuse a rate weakening so strong that uniform slip, d2u/dt2 = tau - gamma u - alpha du/dt, grows for ever.

    Raises ValueError: where alpha < 0 and alpha^2 >= 4 gamma; then no velocity ever returns to 0.
    """
    if alpha < 0.0 and alpha * alpha >= 4.0 * gamma:
        least = f"> -2 sqrt(gamma) = {-2.0 * math.sqrt(gamma):.6g}"
        bound = least if gamma > 0.0 else ">= 0 without leaf springs"
        raise ValueError(f"rate_strengthening: {alpha!r}; allowed: {bound}, or slip runs away")


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


def of_one_shape(**arrays: np.ndarray) -> tuple[np.ndarray, ...]:
    """Arrays broadcast to each other."""
    try:
        return np.broadcast_arrays(*arrays.values())
    except ValueError:
        shapes = " and ".join(str(array.shape) for array in arrays.values())
        raise ValueError(f"{', '.join(arrays)}: shapes {shapes}; allowed: shapes that broadcast") from None


def check_kind(key: str, value: object, kind: type) -> None:
    """Refuse anything that is not of a class."""
    if not isinstance(value, kind):
        raise ValueError(f"{key}: {short_repr(value)}; allowed: a {kind.__name__}")


def check_choice(key: str, value: object, choices: tuple) -> None:
    """Refuse anything that is not one of ``choices``."""
    if not isinstance(value, str | int | float) or isinstance(value, bool) or value not in choices:
        raise ValueError(f"{key}: {short_repr(value)}; allowed: {', '.join(map(str, choices))}")
