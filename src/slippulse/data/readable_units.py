"""SI units with the prefixes that a figure or a page writes, such as mm, µs and MPa."""

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
# Text of a unit, to which a prefix is added in front; a square takes none.
TEXTS = {unit: unit for unit in UNITS.values()}
TEXTS |= {"m s-1": "m/s", "m s-2": "m/s\N{SUPERSCRIPT TWO}", "J m-1": "J/m"}
TEXTS["m2 s-1"] = "m\N{SUPERSCRIPT TWO}/s"
WITHOUT_PREFIX = ("m2 s-1",)


class ReadableUnit(NamedTuple):
    """A unit as it is written, and its value in SI."""

    text: str
    value: float


def readable_unit(quantity: str, numbers: object) -> ReadableUnit:
    """Return the unit in which the largest of some numbers, in SI, is between 1 and 1000.

    It has no prefix if the numbers need a rarer one, or are all 0.
    """
    unit, values = UNITS[quantity], np.abs(np.asarray(numbers, dtype=float))
    largest = float(np.max(values, initial=0.0, where=np.isfinite(values)))
    if unit in WITHOUT_PREFIX or largest == 0.0:
        return ReadableUnit(TEXTS[unit], 1.0)
    # The largest number is often a round one, which must not fall below 1 by rounding.
    power = 3 * math.floor(math.log10(largest * (1.0 + 1e-12)) / 3.0)
    if power not in PREFIXES:
        return ReadableUnit(TEXTS[unit], 1.0)
    return ReadableUnit(PREFIXES[power] + TEXTS[unit], 10.0**power)
