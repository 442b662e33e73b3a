"""Define the verdicts, and the rules that turn a deviation and its uncertainty into a verdict."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

REPRODUCED = "reproduced"
CAVEAT = "reproduced with caveat"
DEPENDS = "depends on an open choice"
UNMET = "premise not met"
BEYOND = "different beyond the paper"
HOLDS_BEYOND = "holds beyond the paper"
HOLDS_BEYOND_WITH_CAVEAT = "holds beyond the paper with caveat"
FAILED = "not reproduced"
INCONCLUSIVE = "inconclusive"
NOT_TESTABLE = "not testable"
VERDICTS_ON_THE_PAPER = (REPRODUCED, CAVEAT, DEPENDS, UNMET, FAILED, INCONCLUSIVE, NOT_TESTABLE)
VERDICTS = (*VERDICTS_ON_THE_PAPER, HOLDS_BEYOND, HOLDS_BEYOND_WITH_CAVEAT, BEYOND)
# Among several verdicts the one that comes first in this list decides; pages use the same order.
WORST_FIRST = (
    *(FAILED, UNMET, DEPENDS, INCONCLUSIVE, NOT_TESTABLE),
    *(BEYOND, CAVEAT, HOLDS_BEYOND_WITH_CAVEAT, REPRODUCED, HOLDS_BEYOND),
)
# The paper does not make a claim that is beyond it, so that it is not reproduced but holds.
VERDICTS_BEYOND = {REPRODUCED: HOLDS_BEYOND, CAVEAT: HOLDS_BEYOND_WITH_CAVEAT, FAILED: BEYOND}
# A claim with one of these verdicts needs no reason.
WITHOUT_RESERVATION = (REPRODUCED, HOLDS_BEYOND)
HOLDS_BY_VERDICT = {REPRODUCED: True, CAVEAT: True, FAILED: False, UNMET: False, BEYOND: False}


class Uncertain(NamedTuple):
    """A number with its uncertainty."""

    value: float
    uncertainty: float


class Spread(NamedTuple):
    """The median and the largest of some deviations."""

    median: float
    largest: float


def within(deviation: float, uncertainty: float, tolerance: float) -> str:
    """Return the verdict on one number, from its deviation and its uncertainty."""
    if not np.isfinite([deviation, uncertainty]).all():
        return NOT_TESTABLE
    if deviation - uncertainty > tolerance:
        return FAILED
    if uncertainty > tolerance:
        return INCONCLUSIVE
    return CAVEAT if deviation + uncertainty > tolerance else REPRODUCED


def worst(verdicts: Iterable[str]) -> str:
    """Return the worst of several verdicts; "not testable" if there is none."""
    return min(verdicts, key=WORST_FIRST.index, default=NOT_TESTABLE)


def worst_tested(verdicts: Iterable[str]) -> str:
    """Return the worst verdict, not counting "not testable"."""
    return worst(verdict for verdict in verdicts if verdict != NOT_TESTABLE)


def verdict_over_choices(verdicts: Sequence[str]) -> str:
    """Return the verdict on a claim from its verdicts at all combinations of open choices."""
    held = {HOLDS_BY_VERDICT.get(verdict) for verdict in verdicts}
    return DEPENDS if {True, False} <= held else worst_tested(verdicts)
