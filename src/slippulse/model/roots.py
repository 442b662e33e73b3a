"""Roots of functions of one float."""

from collections.abc import Callable


def root_between(
    function: Callable[[float], float],
    lower: float,
    upper: float,
    xtol: float = 2e-12,
    rtol: float = 1e-15,
) -> float:
    """Root of a continuous function whose signs differ between two floats, to xtol + rtol |root|; else ValueError."""
    # Slow to load.
    from scipy.optimize import brentq

    return float(brentq(function, lower, upper, xtol=xtol, rtol=rtol))
