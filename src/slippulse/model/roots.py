"""Root of a function of one number."""

from collections.abc import Callable


def root_between(
    function: Callable[[float], float], lower: float, upper: float, xtol: float = 2e-12
) -> float:
    """Root between two ends of different signs, to xtol + 1e-15 |root|, by Brent's method."""
    # Slow to load.
    from scipy.optimize import brentq

    return float(brentq(function, lower, upper, xtol=xtol, rtol=1e-15))
