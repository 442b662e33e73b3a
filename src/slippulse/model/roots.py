"""Root of a function of one variable."""

from collections.abc import Callable


def root_between(
    function: Callable[[float], float], lower: float, upper: float, xtol: float = 2e-12
) -> float:
    """Return the root between ``lower`` and ``upper`` by Brent's method.

    The function must have opposite signs at the two ends. The root is accurate to
    xtol + 1e-15 |root|.
    """
    # The import is slow and only some callers need it.
    from scipy.optimize import brentq

    return float(brentq(function, lower, upper, xtol=xtol, rtol=1e-15))
