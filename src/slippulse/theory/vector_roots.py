"""Roots of many functions at once, with array operations.

The functions are numbered, and given as a single one, ``function(x, which)``: element i of its
result is the value of function number which[i] at x[i].
"""

from collections.abc import Callable

import numpy as np

Functions = Callable[[np.ndarray, np.ndarray], np.ndarray]
# The most secant steps of `increasing_roots`. A function that is nearly linear needs far fewer.
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

    at_lower and at_upper are the values of the functions at the bounds, which have different signs.
    xtol is the error of a root.

    The roots are found by Chandrupatla's method. Like Brent's method, this method shrinks a bracket
    around each root, by interpolation or by bisection.
    """
    if np.any(at_lower * at_upper > 0.0):
        problem = "a function has the same sign at both bounds"
        raise ValueError(f"lower, upper: {problem}; allowed: bounds with different signs")
    # x1 is the newest end of the bracket, x2 the other end, and x3 the former end that x1 has
    # replaced. f1, f2 and f3 are the values there.
    x1, f1 = lower, at_lower
    x2, f2 = upper, at_upper
    best = np.array(upper)
    # Numbers of the functions whose roots have not been found yet. All other arrays in the loop
    # have one element for each of these.
    unsolved = np.arange(upper.size)
    # The next point lies at this fraction of the way from x1 to x2.
    fraction = at_lower / (at_lower - at_upper)
    while unsolved.size:
        x = x1 + fraction * (x2 - x1)
        f = function(x, unsolved)
        # The new point replaces the end of the bracket where the value has the same sign.
        replaces_x1 = (f > 0.0) == (f1 > 0.0)
        x3, x2 = np.where(replaces_x1, (x1, x2), (x2, x1))
        f3, f2 = np.where(replaces_x1, (f1, f2), (f2, f1))
        # The end of the bracket with the smaller value is the best root so far.
        best[unsolved] = np.where(np.abs(f2) < np.abs(f), x2, x)
        # The tolerance is at least the spacing of floating-point numbers. The search ends when the
        # bracket is shorter than two tolerances.
        tolerance = np.maximum(xtol, 4.0 * np.finfo(float).eps * np.abs(x))
        min_fraction = tolerance / np.abs(x2 - x)
        goes_on = (min_fraction < 0.5) & (f != 0.0)
        unsolved = unsolved[goes_on]
        x1, x2, x3 = np.array([x, x2, x3])[:, goes_on]
        f1, f2, f3 = np.array([f, f2, f3])[:, goes_on]
        # The root is estimated by a parabola x(f) through the three points. Under these two
        # conditions the parabola is monotonic between x1 and x2, so that the estimate is in the
        # bracket. Otherwise the next point is the middle of the bracket.
        xi = (x1 - x2) / (x3 - x2)
        phi = (f1 - f2) / (f3 - f2)
        is_monotonic = (phi**2 < xi) & ((1.0 - phi) ** 2 < 1.0 - xi)
        term_of_x2 = f1 / (f2 - f1) * f3 / (f2 - f3)
        term_of_x3 = (x3 - x1) / (x2 - x1) * f1 / (f3 - f1) * f2 / (f3 - f2)
        fraction = np.where(is_monotonic, term_of_x2 + term_of_x3, 0.5)
        fraction = np.clip(fraction, min_fraction[goes_on], 1.0 - min_fraction[goes_on])
    return best


def increasing_roots(
    function: Functions, guess: np.ndarray, lower: np.ndarray, upper: np.ndarray
) -> np.ndarray:
    """Return the roots of many increasing functions that are nearly linear.

    Each root lies in the bracket from lower to upper, and its search starts at guess. A secant
    through the last two points gives the next one. If the secant leaves the bracket, the next point
    is the middle of the bracket. The search ends when the error of the last step or the bracket is
    as small as rounding errors.
    """
    low, high = np.array(lower), np.array(upper)
    # Numbers of the functions whose roots have not been found yet.
    unsolved = np.arange(guess.size)
    x_before = np.array(guess)
    value_before = function(x_before, unsolved)
    # The first step assumes a slope of 1, and is at most 2 long.
    x = np.clip(x_before - np.clip(value_before, -2.0, 2.0), low, high)
    for _ in range(MAX_SECANTS):
        x_now = x[unsolved]
        value = function(x_now, unsolved)
        # The point becomes the end of the bracket on its side of the root.
        high[unsolved] = np.where(value > 0.0, np.minimum(high[unsolved], x_now), high[unsolved])
        low[unsolved] = np.where(value < 0.0, np.maximum(low[unsolved], x_now), low[unsolved])
        # The zero of the secant. No step is made if the last two values are equal: the quotient
        # with the divisor 1 is then not used.
        change = value - value_before[unsolved]
        is_flat = change == 0.0
        divisor = np.where(is_flat, 1.0, change)
        last_step = x_now - x_before[unsolved]
        step = np.where(is_flat, 0.0, -value * last_step / divisor)
        x_next = x_now + step
        is_outside = (x_next <= low[unsolved]) | (x_next >= high[unsolved])
        # The error of a secant step is about the product of the last two steps.
        error = np.abs(step) * np.minimum(np.abs(last_step), 1.0)
        is_tiny = error <= 1e-15 * (1.0 + np.abs(x_now))
        middle = 0.5 * (low[unsolved] + high[unsolved])
        x_before[unsolved] = x_now
        value_before[unsolved] = value
        x[unsolved] = np.where(is_outside & ~is_tiny, middle, x_next)
        is_narrow = high[unsolved] - low[unsolved] <= 1e-13 * (1.0 + np.abs(x[unsolved]))
        is_root = value == 0.0
        unsolved = unsolved[~(is_tiny | is_narrow | is_root)]
        if unsolved.size == 0:
            return x
    raise ArithmeticError(f"no root of an increasing function was found near {x[unsolved[0]]!r}")
