"""Define the verdicts, and the rules by which a deviation and its uncertainty give a verdict."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

REPRODUCED = "reproduced"
CAVEAT = "reproduced with caveat"
DEPENDS = "depends on an open choice"
UNMET = "premise not met"
FAILED = "not reproduced"
INCONCLUSIVE = "inconclusive"
NOT_TESTABLE = "not testable"
# Verdicts on claims that the paper does not make.
HOLDS_BEYOND = "holds beyond the paper"
HOLDS_BEYOND_WITH_CAVEAT = "holds beyond the paper with caveat"
BEYOND = "different beyond the paper"
VERDICTS_ON_THE_PAPER = (REPRODUCED, CAVEAT, DEPENDS, UNMET, FAILED, INCONCLUSIVE, NOT_TESTABLE)
VERDICTS = (*VERDICTS_ON_THE_PAPER, HOLDS_BEYOND, HOLDS_BEYOND_WITH_CAVEAT, BEYOND)
# Of several verdicts on one claim, the first one in this list decides. Pages use the same order.
WORST_FIRST = (
    FAILED,
    UNMET,
    DEPENDS,
    INCONCLUSIVE,
    NOT_TESTABLE,
    BEYOND,
    CAVEAT,
    HOLDS_BEYOND_WITH_CAVEAT,
    REPRODUCED,
    HOLDS_BEYOND,
)
# Verdict on a claim that the paper does not make, by the verdict that it would have as a claim of
# the paper.
VERDICTS_BEYOND = {REPRODUCED: HOLDS_BEYOND, CAVEAT: HOLDS_BEYOND_WITH_CAVEAT, FAILED: BEYOND}
# A claim with one of these verdicts needs no reason.
WITHOUT_RESERVATION = (REPRODUCED, HOLDS_BEYOND)
# Whether the claim holds, by its verdict. The other verdicts leave this open.
HOLDS_BY_VERDICT = {REPRODUCED: True, CAVEAT: True, FAILED: False, UNMET: False, BEYOND: False}


class Uncertain(NamedTuple):
    """A number with its uncertainty."""

    value: float
    uncertainty: float


class Spread(NamedTuple):
    """The median and the largest of some deviations."""

    median: float
    largest: float


def verdict_on_number(deviation: float, uncertainty: float, tolerance: float) -> str:
    """Return the verdict on one number, from its deviation and its uncertainty.

    The true deviation lies between ``deviation`` minus ``uncertainty`` and ``deviation`` plus
    ``uncertainty``. The claim fails if this whole interval is above the tolerance, and holds if it
    is below it. If the tolerance lies inside the interval, the claim holds with a caveat, or is
    inconclusive if the uncertainty alone is larger than the tolerance.
    """
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
    """Return one verdict on a claim from its verdicts at all combinations of open choices.

    The verdict is "depends on an open choice" if the claim holds at one combination and fails at
    another. Otherwise it is the worst verdict.
    """
    # True, False, or None if a verdict leaves open whether the claim holds.
    holds = [HOLDS_BY_VERDICT.get(verdict) for verdict in verdicts]
    return DEPENDS if True in holds and False in holds else worst_tested(verdicts)
