"""How a number is written in prose and tables."""

from __future__ import annotations

import math
import re

# Smaller or larger than this, a number is written with a power of ten.
SMALL, LARGE = 1e-3, 1e5
MISSING = "not measured"


def number(value: float | None, digits: int = 3) -> str:
    """A number as Markdown, with a stated count of significant digits.

    Parameters
    ----------
    value : None and NaN are written as not measured
    digits : significant digits; trailing zeros are kept only where they stand for a measured digit
    """
    if value is None or math.isnan(value):
        return MISSING
    if math.isinf(value):
        return r"$\infty$" if value > 0 else r"$-\infty$"
    if value == 0.0:
        return "0"
    if not SMALL <= abs(value) < LARGE:
        mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
        return power_of_ten(mantissa, int(exponent))
    if isinstance(value, int) or float(value).is_integer():
        return _minus(f"{value:.0f}")
    places = max(0, digits - 1 - math.floor(math.log10(abs(value))))
    return _minus(f"{value:.{places}f}")


def setting(value: float) -> str:
    """A number of the configuration, all its digits and no more."""
    return _minus(f"{value:g}") if SMALL <= abs(value) < LARGE or value == 0.0 else scientific(f"{value:g}")


def percent(value: float | None, digits: int = 2) -> str:
    """A share as a percentage."""
    if value is None or math.isnan(value):
        return MISSING
    scaled = 100.0 * value
    return number(int(scaled) if scaled.is_integer() else scaled, digits) + " %"


def with_uncertainty(value: float | None, uncertainty: float | None) -> str:
    """value ± uncertainty, the uncertainty with two digits and the value to the same place."""
    if value is None or uncertainty is None or not math.isfinite(value) or not math.isfinite(uncertainty):
        return number(value, 4)
    uncertainty = abs(uncertainty)
    if uncertainty == 0.0:
        return f"{number(value, 4)} ± 0"
    largest = max(abs(value), uncertainty)
    if uncertainty < 1e-9 * largest:
        return f"{number(value, 6)} ± {number(uncertainty, 1)}"
    exponent = math.floor(math.log10(largest))
    scale = exponent if not SMALL <= largest < LARGE else 0
    places = max(0, 1 - math.floor(math.log10(uncertainty)) + scale)
    pair = (
        f"{_minus(f'{value / 10.0**scale:.{places}f}')} ± {_minus(f'{uncertainty / 10.0**scale:.{places}f}')}"
    )
    return pair if scale == 0 else f"({pair}) {power_of_ten('', scale)}"


def power_of_ten(mantissa: str, exponent: int) -> str:
    """A mantissa times a power of ten as TeX; without a mantissa, the factor alone."""
    if mantissa in ("1", "1.0"):
        return f"$10^{{{exponent}}}$"
    return f"${mantissa}\\times 10^{{{exponent}}}$" if mantissa else f"$\\times\\, 10^{{{exponent}}}$"


def scientific(text: str) -> str:
    """Powers of ten that Python wrote as 1e-05, as TeX."""

    def replace(match: re.Match) -> str:
        return power_of_ten(match[1], int(match[2]))

    return re.sub(r"(?<![\w.])(-?\d+(?:\.\d+)?)e([-+]?\d+)\b", replace, text)


def _minus(text: str) -> str:
    """A true minus sign."""
    return text.replace("-", "−")
