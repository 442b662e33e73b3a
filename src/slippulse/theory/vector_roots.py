"""Roots of many functions at once, with array operations.

The functions are given as a single one, ``function(x, which)``. It returns, for each i, the value
at x[i] of the function with the number which[i].
"""

from collections.abc import Callable

import numpy as np

Functions = Callable[[np.ndarray, np.ndarray], np.ndarray]
# The most secants of `increasing_roots`, which is sufficient for any function that is nearly
# linear.
MAX_SECANTS = 200


@np.errstate(divide="ignore", invalid="ignore")
def roots_between(
    function: Functions,
    lower: np.ndarray,
    upper: np.ndarray,
    at_lower: np.ndarray,
    at_upper: np.ndarray,
    xtol: float,
) -> np.ndarray:
    """Return the roots of many functions, each between a lower and an upper bound.

    It is Chandrupatla's method, which is similar to Brent's but has only one decision for each
    step: inverse quadratic interpolation or bisection. at_lower and at_upper are the values at the
    bounds, and xtol is the error of a root.
    """
    if np.any(at_lower * at_upper > 0.0):
        raise ValueError("lower, upper: values of equal signs; allowed: values of different signs")
    # x1 is the newest end of the bracket, x2 the other end, and x3 the end that x1 has replaced.
    # f1, f2 and f3 are the values there.
    x1, f1 = lower, at_lower
    x2, f2 = upper, at_upper
    best = np.array(upper)
    # Numbers of the functions whose roots have not been found yet.
    alive = np.arange(upper.size)
    # The next point lies at this fraction of the way from x1 to x2.
    fraction = at_lower / (at_lower - at_upper)
    while alive.size:
        x = x1 + fraction * (x2 - x1)
        f = function(x, alive)
        keeps_sign = (f > 0.0) == (f1 > 0.0)
        x3, x2 = np.where(keeps_sign, (x1, x2), (x2, x1))
        f3, f2 = np.where(keeps_sign, (f1, f2), (f2, f1))
        best[alive] = np.where(np.abs(f2) < np.abs(f), x2, x)
        # The tolerance is at least the spacing of floating-point numbers.
        tolerance = np.maximum(xtol, 4.0 * np.finfo(float).eps * np.abs(x))
        min_fraction = tolerance / np.abs(x2 - x)
        going = (min_fraction < 0.5) & (f != 0.0)
        alive = alive[going]
        x1, x2, x3 = np.array([x, x2, x3])[:, going]
        f1, f2, f3 = np.array([f, f2, f3])[:, going]
        # The parabola x(f) through the three points is monotonic between x1 and x2, and so stays in
        # the bracket, under these two conditions. Otherwise the next point is the middle.
        xi = (x1 - x2) / (x3 - x2)
        phi = (f1 - f2) / (f3 - f2)
        stays_inside = (phi**2 < xi) & ((1.0 - phi) ** 2 < 1.0 - xi)
        term_of_x2 = f1 / (f2 - f1) * f3 / (f2 - f3)
        term_of_x3 = (x3 - x1) / (x2 - x1) * f1 / (f3 - f1) * f2 / (f3 - f2)
        fraction = np.where(stays_inside, term_of_x2 + term_of_x3, 0.5)
        fraction = np.clip(fraction, min_fraction[going], 1.0 - min_fraction[going])
    return best


def increasing_roots(
    function: Functions, guess: np.ndarray, lower: np.ndarray, upper: np.ndarray
) -> np.ndarray:
    """Return the roots of many increasing functions that are nearly linear.

    lower and upper bracket each root, and guess is where its search starts. Each step is that of a
    secant, or leads to the middle of the bracket if the secant leaves it.
    """
    low, high = np.array(lower), np.array(upper)
    # Numbers of the functions whose roots have not been found yet.
    alive = np.arange(guess.size)
    x_before = np.array(guess)
    value_before = function(x_before, alive)
    # The first step assumes a slope of 1, and is at most 2 long.
    x = np.clip(x_before - np.clip(value_before, -2.0, 2.0), low, high)
    for _ in range(MAX_SECANTS):
        value = function(x[alive], alive)
        high[alive] = np.where(value > 0.0, np.minimum(high[alive], x[alive]), high[alive])
        low[alive] = np.where(value < 0.0, np.maximum(low[alive], x[alive]), low[alive])
        change = value - value_before[alive]
        is_flat = change == 0.0
        last_step = x[alive] - x_before[alive]
        step = np.where(is_flat, 0.0, -value * last_step / np.where(is_flat, 1.0, change))
        x_next = x[alive] + step
        is_outside = (x_next <= low[alive]) | (x_next >= high[alive])
        # The error of a secant step is the product of the last two steps, up to a factor of order
        # 1.
        error = np.abs(step) * np.minimum(np.abs(last_step), 1.0)
        is_tiny = error <= 1e-15 * (1.0 + np.abs(x[alive]))
        middle = 0.5 * (low[alive] + high[alive])
        x_before[alive] = x[alive]
        value_before[alive] = value
        x[alive] = np.where(is_outside & ~is_tiny, middle, x_next)
        is_narrow = high[alive] - low[alive] <= 1e-13 * (1.0 + np.abs(x[alive]))
        is_root = value == 0.0
        alive = alive[~(is_tiny | is_narrow | is_root)]
        if alive.size == 0:
            return x
    raise ArithmeticError(f"no root of an increasing function was found near {x[alive[0]]!r}")
