"""Polynomials in the time since the start of the step: value, slope, root, Taylor shift."""

import numpy as np

from .arrays import REACH
from .jit import inner

# 1/j, for Taylor polynomials in derivatives.
RECIPROCAL = np.append(0.0, 1.0 / np.arange(1.0, 2.0 * REACH))


@inner()
def taylor_shift(derivatives, lowest, last, top, s):
    """Replace derivatives lowest..last of a polynomial by those a time s later; ``top`` is the highest."""
    for m in range(lowest, last + 1):
        value = derivatives[top]
        for j in range(top - 1, m - 1, -1):
            value = derivatives[j] + s * RECIPROCAL[j - m + 1] * value
        derivatives[m] = value


@inner()
def polynomial(coefficients, degree, h):
    """Value at h of a polynomial, lowest power first."""
    value = coefficients[degree]
    for k in range(degree - 1, -1, -1):
        value = coefficients[k] + h * value
    return value


@inner()
def slope(coefficients, degree, h):
    """Slope at h of a polynomial, lowest power first."""
    value = degree * coefficients[degree]
    for k in range(degree - 1, 0, -1):
        value = k * coefficients[k] + h * value
    return value


@inner()
def crossing(coefficients, degree, lower, upper):
    """Root of a polynomial that changes sign between two times: Newton steps from the secant root, kept by bisection.

    The sign at ``lower`` tells the direction; the one at ``upper`` may be lost to rounding, then ``upper`` is the root.
    """
    start = polynomial(coefficients, degree, lower)
    end = polynomial(coefficients, degree, upper)
    rising = start < 0.0
    root = 0.5 * (lower + upper)
    if (end > 0.0) == rising and end != start:
        root = lower + (upper - lower) * start / (start - end)
    # Newton's steps converge quadratically: after one of 1e-9 the root is exact to rounding.
    close = 1e-9 * upper
    for _ in range(100):
        value = coefficients[degree]
        change = 0.0
        for k in range(degree - 1, -1, -1):
            change = value + root * change
            value = coefficients[k] + root * value
        if (value > 0.0) == rising:
            upper = root
        else:
            lower = root
        candidate = root - value / change if change != 0.0 else upper
        if abs(candidate - root) <= close or upper - lower <= close:
            return min(max(candidate, lower), upper)
        root = candidate if lower < candidate < upper else 0.5 * (lower + upper)
    return root


@inner()
def turning_point(coefficients, slopes, degree, lower, upper):
    """Where a polynomial turns, at the one change of sign of its slope between two times; else ``upper``."""
    for k in range(degree):
        slopes[k] = (k + 1) * coefficients[k + 1]
    if polynomial(slopes, degree - 1, lower) * polynomial(slopes, degree - 1, upper) < 0.0:
        return crossing(slopes, degree - 1, lower, upper)
    return upper


@inner()
def highest_possible(coefficients, degree, h):
    """An upper bound of a polynomial between 0 and h."""
    value = 0.0
    for k in range(degree, 0, -1):
        value = h * (max(coefficients[k], 0.0) + value)
    return coefficients[0] + value
