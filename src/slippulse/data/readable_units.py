"""SI units with prefixes, such as mm, µs and MPa, for the numbers of a figure or a page."""

import math
from typing import NamedTuple

import numpy as np

from ..model.si_quantities import UNITS

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


class ReadableUnit(NamedTuple):
    """The text of a unit, and its value in SI."""

    text: str
    value: float


def readable_unit(quantity: str, numbers: object) -> ReadableUnit:
    """Return the unit in which the largest of some numbers is between 1 and 1000.

    numbers : in SI units

    The unit has no prefix if all numbers are 0, or if they would need a prefix that is not listed.
    """
    unit, values = UNITS[quantity], np.abs(np.asarray(numbers, dtype=float))
    largest = float(np.max(values, initial=0.0, where=np.isfinite(values)))
    if unit in WITHOUT_PREFIX or largest == 0.0:
        return ReadableUnit(TEXTS[unit], 1.0)
    # A round number such as 1e-3 must not fall below 1 mm by rounding.
    power = 3 * math.floor(math.log10(largest * (1.0 + 1e-12)) / 3.0)
    if power not in PREFIXES:
        return ReadableUnit(TEXTS[unit], 1.0)
    return ReadableUnit(PREFIXES[power] + TEXTS[unit], 10.0**power)
