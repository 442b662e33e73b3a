"""Roots of functions of one float."""

from __future__ import annotations

import math
from collections.abc import Callable


def root_between(
    function: Callable[[float], float], lower: float, upper: float, xtol: float = 2e-12, rtol: float = 4e-16
) -> float:
    """Root of a continuous function that changes sign between lower and upper, by Chandrupatla's method.

    Inverse quadratic interpolation through the last three points where it is safe, bisection elsewhere. Scipy has
    it too, but loading scipy's optimisers takes longer than all that most jobs of the pipeline compute.

    Parameters
    ----------
    function : of one float
    lower, upper : where its signs differ
    xtol, rtol : the root is within xtol + rtol |root|

    Raises
    ------
    ValueError
        If the signs at both ends are equal, or a value is not a number.

    Source: T. R. Chandrupatla, Adv. Eng. Softw. 28, 145 (1997).
    """
    a, b = float(upper), float(lower)
    fa, fb = float(function(a)), float(function(b))
    if fa == 0.0:
        return a
    if fb == 0.0:
        return b
    if not fa * fb < 0.0:
        raise ValueError(f"no change of sign between {lower!r} and {upper!r}: {fb!r}, {fa!r}")
    # Where the next point lies between a, the newest, and b, on the other side of the root.
    share = 0.5
    while True:
        x = a + share * (b - a)
        fx = float(function(x))
        if math.isnan(fx):
            raise ValueError(f"not a number at {x!r}, between {lower!r} and {upper!r}")
        if (fx > 0.0) == (fa > 0.0):
            c, fc = a, fa
        else:
            c, b, fc, fb = b, a, fb, fa
        a, fa = x, fx
        best, value = (a, fa) if abs(fa) < abs(fb) else (b, fb)
        nearest = (xtol + rtol * abs(best)) / abs(b - a)
        if value == 0.0 or nearest > 0.5:
            return best
        place = (a - b) / (c - b)
        height = (fa - fb) / (fc - fb)
        share = 0.5
        if height**2 < place and (1.0 - height) ** 2 < 1.0 - place:
            share = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        share = min(1.0 - nearest, max(nearest, share))


def roots_between(function, lower, upper, at_lower, at_upper, xtol: float = 1e-12):
    """Roots of many functions at once, each between its own ends, by Chandrupatla's method.

    Parameters
    ----------
    function : takes the numbers of the functions that are still wanted and one argument for each
    lower, upper : arrays of ends
    at_lower, at_upper : the values there, of different signs
    xtol : each root is within this

    Source: as `root_between`.
    """
    import numpy as np

    a, b, fa, fb = (np.array(values, dtype=float) for values in (upper, lower, at_upper, at_lower))
    out = np.where(np.abs(fa) < np.abs(fb), a, b)
    c, fc = b.copy(), fb.copy()
    share = np.full(a.shape, 0.5)
    going = np.flatnonzero((np.abs(b - a) > xtol) & (fa != 0.0) & (fb != 0.0))
    while going.size:
        x = a[going] + share[going] * (b[going] - a[going])
        fx = function(going, x)
        same = np.sign(fx) == np.sign(fa[going])
        same_side, other = going[same], going[~same]
        c[same_side], fc[same_side] = a[same_side], fa[same_side]
        c[other], fc[other] = b[other], fb[other]
        b[other], fb[other] = a[other], fa[other]
        a[going], fa[going] = x, fx
        out[going] = np.where(np.abs(fa[going]) < np.abs(fb[going]), a[going], b[going])
        wide = np.abs(b[going] - a[going])
        nearest = xtol / np.maximum(wide, 1e-300)
        done = (nearest > 0.5) | (fx == 0.0)
        going, nearest = going[~done], nearest[~done]
        place = (a[going] - b[going]) / (c[going] - b[going])
        height = (fa[going] - fb[going]) / (fc[going] - fb[going])
        safe = (height**2 < place) & ((1.0 - height) ** 2 < 1.0 - place)
        with np.errstate(divide="ignore", invalid="ignore"):
            inverse = fa[going] / (fb[going] - fa[going]) * fc[going] / (fb[going] - fc[going]) + (
                c[going] - a[going]
            ) / (b[going] - a[going]) * fa[going] / (fc[going] - fa[going]) * fb[going] / (
                fc[going] - fb[going]
            )
        share[going] = np.clip(np.where(safe, inverse, 0.5), nearest, 1.0 - nearest)
    return out
