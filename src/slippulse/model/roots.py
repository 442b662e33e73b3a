"""Roots of functions of one float."""

from collections.abc import Callable


def root_between(
    function: Callable[[float], float], lower: float, upper: float, xtol: float = 2e-12, rtol: float = 1e-15
) -> float:
    """Root of a continuous function whose signs differ between lower and upper, to xtol + rtol |root|.

    Raises ValueError: if the signs at both ends are equal, or a value is not a number.

    Source: Brent's method, of scipy.
    """
    # Slow to load.
    from scipy.optimize import brentq

    return float(brentq(function, lower, upper, xtol=xtol, rtol=rtol))
