"""Roots of many functions at once."""

from collections.abc import Callable

import numpy as np


@np.errstate(divide="ignore", invalid="ignore")
def roots_between(function: Callable, lower, upper, at_lower, at_upper, xtol: float) -> np.ndarray:
    """Roots of many functions at once, whose values at lower and upper, given, differ in sign, to xtol.

    function(x, which) has the values at x of those numbered by which; all are flat arrays.

    Raises ValueError: if the signs at both ends of one are equal.

    Source: Chandrupatla's method, which is Brent's without branches; begun by a secant.
    """
    if np.any(at_lower * at_upper > 0.0):
        raise ValueError("lower, upper: values of equal signs; allowed: values of different signs")
    x1, x2, f1, f2 = lower, upper, at_lower, at_upper
    out, alive, part = np.array(upper), np.arange(upper.size), at_lower / (at_lower - at_upper)
    while alive.size:
        x = x1 + part * (x2 - x1)
        f = function(x, alive)
        same = (f > 0.0) == (f1 > 0.0)
        (x3, x2), (f3, f2) = np.where(same, (x1, x2), (x2, x1)), np.where(same, (f1, f2), (f2, f1))
        out[alive] = np.where(np.abs(f2) < np.abs(f), x2, x)
        # No finer than floating point.
        least = np.maximum(xtol, 4.0 * np.finfo(float).eps * np.abs(x)) / np.abs(x2 - x)
        going = (least < 0.5) & (f != 0.0)
        alive, x1, x2, x3, f1, f2, f3, least = (
            values[going] for values in (alive, x, x2, x3, f, f2, f3, least)
        )
        xi, phi = (x1 - x2) / (x3 - x2), (f1 - f2) / (f3 - f2)
        quadratic = f1 / (f2 - f1) * f3 / (f2 - f3) + (x3 - x1) / (x2 - x1) * f1 / (f3 - f1) * f2 / (f3 - f2)
        part = np.where((phi**2 < xi) & ((1.0 - phi) ** 2 < 1.0 - xi), quadratic, 0.5)
        part = np.clip(part, least, 1.0 - least)
    return out
