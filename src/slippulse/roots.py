"""Roots of functions. Scipy's optimisers take longer to load than all else that a simulation needs: only on demand."""

from __future__ import annotations

from collections.abc import Callable


def root_between(function: Callable[[float], float], lower: float, upper: float, **tolerances) -> float:
    """Root of a continuous function that changes sign between lower and upper (Brent's method).

    Parameters
    ----------
    function : of one float
    lower, upper : where its signs differ
    tolerances : xtol, rtol of scipy.optimize.brentq

    Raises
    ------
    ValueError
        If the signs at both ends are equal.
    """
    from scipy.optimize import brentq

    return float(brentq(function, lower, upper, **tolerances))
