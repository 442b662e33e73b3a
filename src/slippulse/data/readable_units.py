"""SI units with prefixes, such as mm, µs and MPa, for the numbers of a figure or a page."""

import math
from typing import NamedTuple

import numpy as np

from ..model.si_quantities import UNITS

# Prefix of a unit for each exponent of ten.
PREFIXES = {
    -12: "p",
    -9: "n",
    -6: "\N{MICRO SIGN}",
    -3: "m",
    0: "",
    3: "k",
    6: "M",
    9: "G",
}
# Text of each unit. A prefix can be written in front of it, except in front of a square.
TEXTS = {unit: unit for unit in UNITS.values()}
TEXTS |= {"m s-1": "m/s", "m s-2": "m/s\N{SUPERSCRIPT TWO}", "J m-1": "J/m"}
TEXTS["m2 s-1"] = "m\N{SUPERSCRIPT TWO}/s"
WITHOUT_PREFIX = ("m2 s-1",)
# A number that is smaller than a power of ten by at most this relative amount counts as equal to
# it.
ROUNDING_TOLERANCE = 1e-12


class ReadableUnit(NamedTuple):
    """The text of a unit, and its value in SI."""

    text: str
    value: float


def readable_unit(quantity: str, numbers: object) -> ReadableUnit:
    """Return the unit in which the largest of some numbers is between 1 and 1000.

    The unit has no prefix if all numbers are 0, or if they would need a prefix that is not listed.

    numbers : numbers of a quantity in SI units
    """
    unit, magnitudes = UNITS[quantity], np.abs(np.asarray(numbers, dtype=float))
    largest = float(np.max(magnitudes, initial=0.0, where=np.isfinite(magnitudes)))
    if unit in WITHOUT_PREFIX or largest == 0.0:
        return ReadableUnit(TEXTS[unit], 1.0)
    # The exponent of ten is a multiple of 3. Rounding must not turn 1 mm into 1000 micrometres.
    exponent = 3 * math.floor(math.log10(largest * (1.0 + ROUNDING_TOLERANCE)) / 3.0)
    if exponent not in PREFIXES:
        return ReadableUnit(TEXTS[unit], 1.0)
    return ReadableUnit(PREFIXES[exponent] + TEXTS[unit], 10.0**exponent)
