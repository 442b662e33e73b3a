"""Conversion of numbers to plain text with Unicode signs, for the report, pages and figures."""

import math

# Numbers outside this range are written with a power of ten.
SMALLEST_PLAIN, LARGEST_PLAIN = 1e-3, 1e5
# Largest number of significant digits without and with an uncertainty.
MAX_DIGITS, MAX_DIGITS_WITH_UNCERTAINTY = 5, 6
MISSING = "not measured"
SUPERSCRIPT = str.maketrans("-0123456789", "\N{SUPERSCRIPT MINUS}⁰¹²³⁴⁵⁶⁷⁸⁹")


def number(value: float | None, digits: int = 3) -> str:
    """Write a number with some significant digits, at most `MAX_DIGITS`.

    A whole number is written with all its digits.
    """
    if value is None or math.isnan(value):
        return MISSING
    if math.isinf(value):
        return _minus("∞" if value > 0 else "-∞")
    if value == 0.0:
        return "0"
    digits = min(digits, MAX_DIGITS)
    if not SMALLEST_PLAIN <= abs(value) < LARGEST_PLAIN:
        return _power_of_ten(f"{value:.{digits - 1}e}")
    if float(value).is_integer():
        return _minus(f"{value:.0f}")
    # Use the magnitude of the rounded value: 0.9996 with three digits is 1.00.
    magnitude = int(f"{value:.{digits - 1}e}".partition("e")[2])
    decimals = max(0, digits - 1 - magnitude)
    return _minus(f"{value:.{decimals}f}")


def setting(value: float | None) -> str:
    """Write a number of the configuration with at most six digits, without zeros at its end."""
    if value is None or math.isnan(value):
        return MISSING
    # The format g has at most six digits, and an exponent if the number is very small or large.
    return _power_of_ten(f"{value:g}")


def rounded(value: float | None, digits: int = 4) -> str:
    """Write a number to some significant digits, without zeros at its end."""
    return setting(None if value is None else float(f"{value:.{digits}g}"))


def percent(value: float | None, digits: int = 2) -> str:
    """Write a fraction as a percentage, such as 12 % for 0.12.

    A fraction is written as it is if the percentage is so small that it needs a power of ten.
    """
    if value is None or math.isnan(value):
        return MISSING
    if 0.0 < 100.0 * abs(value) < SMALLEST_PLAIN:
        return number(value, digits)
    return f"{number(100.0 * value, digits)} %"


def with_uncertainty(value: float | None, uncertainty: float | None, unknown: str = "") -> str:
    """Write a value with the uncertainty of its last digits, as in 1.476(13).

    Value and uncertainty are rounded by the rule of the Particle Data Group, which keeps one or two
    digits of the uncertainty. A value gets at most `MAX_DIGITS_WITH_UNCERTAINTY` digits: a smaller
    uncertainty is rounded up to one in the last of them. A value with the uncertainty 0 is exact.
    ``unknown`` is appended to a value whose uncertainty is not known.
    """
    if value is None or not math.isfinite(value) or uncertainty == 0.0:
        return number(value, MAX_DIGITS)
    if uncertainty is None or not math.isfinite(uncertainty):
        return number(value, MAX_DIGITS) + unknown
    from uncertainties import ufloat

    # The formats give the short form with parentheses (S) and powers of ten in Unicode (P). The
    # format .1u keeps one digit of the uncertainty.
    if value:
        magnitude = math.floor(math.log10(abs(value)))
        last_digit = 10.0 ** (magnitude + 1 - MAX_DIGITS_WITH_UNCERTAINTY)
        if abs(uncertainty) < last_digit:
            return _minus(f"{ufloat(value, last_digit):.1uSP}")
    return _minus(f"{ufloat(value, abs(uncertainty)):SP}")


def short(value: object, longest: int = 80) -> str:
    """Write a value of the configuration in at most ``longest`` characters, and None as a dash."""
    text = "\N{EN DASH}" if value is None else str(value)
    return text if len(text) <= longest else text[: longest - 3] + "..."


# Functions that templates use as filters, by name.
FILTERS = {
    write.__name__: write for write in (number, percent, rounded, setting, short, with_uncertainty)
}


def _power_of_ten(text: str) -> str:
    """Replace the exponent of a number such as 1.5e-05 by a power of ten, as in 1.5×10⁻⁵."""
    mantissa, _, exponent = text.partition("e")
    if not exponent:
        return _minus(text)
    power = "10" + str(int(exponent)).translate(SUPERSCRIPT)
    return power if mantissa in ("1", "1.0") else _minus(f"{mantissa}×{power}")


def _minus(text: str) -> str:
    """Replace hyphens by minus signs."""
    return text.replace("-", "\N{MINUS SIGN}")
