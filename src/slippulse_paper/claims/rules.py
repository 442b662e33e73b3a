"""Verdicts, and the rules that turn deviation and uncertainty into one."""

from collections.abc import Iterable, Sequence

import numpy as np

REPRODUCED = "reproduced"
CAVEAT = "reproduced with caveat"
DEPENDS = "depends on an open choice"
UNMET = "premise not met"
BEYOND = "different beyond the paper"
FAILED = "not reproduced"
INCONCLUSIVE = "inconclusive"
NOT_TESTABLE = "not testable"
VERDICTS = (REPRODUCED, CAVEAT, DEPENDS, UNMET, FAILED, BEYOND, INCONCLUSIVE, NOT_TESTABLE)
# The first of these decides among several verdicts; readers look for it first, too.
WORST_FIRST = (FAILED, UNMET, DEPENDS, INCONCLUSIVE, NOT_TESTABLE, BEYOND, CAVEAT, REPRODUCED)
HOLDS = {REPRODUCED: True, CAVEAT: True, FAILED: False, UNMET: False, BEYOND: False}
# A number with its uncertainty.
Uncertain = tuple[float, float]


def within(deviation: float, uncertainty: float, tolerance: float) -> str:
    """Verdict on one number by its deviation from the prediction and by its uncertainty."""
    if not np.isfinite([deviation, uncertainty]).all():
        return NOT_TESTABLE
    if deviation - uncertainty > tolerance:
        return FAILED
    if uncertainty > tolerance:
        return INCONCLUSIVE
    return CAVEAT if deviation + uncertainty > tolerance else REPRODUCED


def worst(verdicts: Iterable[str]) -> str:
    """The worst of several verdicts; "not testable" of none."""
    return min(verdicts, key=WORST_FIRST.index, default=NOT_TESTABLE)


def worst_tested(verdicts: Iterable[str]) -> str:
    """The worst of those that have numbers."""
    return worst(verdict for verdict in verdicts if verdict != NOT_TESTABLE)


def verdict_over_choices(verdicts: Sequence[str]) -> str:
    """Verdict on a claim from those at every admissible combination of open choices."""
    held = {HOLDS.get(verdict) for verdict in verdicts}
    return DEPENDS if {True, False} <= held else worst_tested(verdicts)
