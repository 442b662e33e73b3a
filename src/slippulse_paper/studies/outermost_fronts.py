"""Find the last points of the outermost fronts of an exact rupture.

A rupture with several nucleations has several connected parts, and each part has two fronts. The
studies need the left front of the leftmost part and the right front of the rightmost one.
"""

from typing import NamedTuple

from slippulse.theory.rupture import FrontEnd, Rupture


class OutermostFronts(NamedTuple):
    """Last points of two fronts: where each of them stops, or where it is at the end."""

    left: FrontEnd
    right: FrontEnd


def outermost_fronts(rupture: Rupture) -> OutermostFronts:
    """Return the last points of the leftmost and the rightmost front of a rupture."""
    # There is one pair (left end, right end) for each connected part, from left to right.
    pairs = rupture.front_ends
    left_of_first_part, _ = pairs[0]
    _, right_of_last_part = pairs[-1]
    return OutermostFronts(left_of_first_part, right_of_last_part)
