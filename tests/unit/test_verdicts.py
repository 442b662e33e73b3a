"""The rule of each kind of claim, on made-up numbers, before anything was measured by it."""

import pytest

from slippulse.claims import rules
from slippulse.claims.rules import VERDICTS, WORST_FIRST

YES, CAVEAT, DEPENDS, NO, OPEN, NONE = VERDICTS
NAN = float("nan")


def test_every_verdict_has_its_rank():
    assert sorted(WORST_FIRST) == sorted(VERDICTS)
    assert rules.worst([YES, OPEN, CAVEAT]) == OPEN and rules.worst([YES, NO, OPEN]) == NO
    assert rules.worst([]) == NONE


# By rule its arguments, with a tolerance where it takes one, and the verdict.
CASES = {
    rules.within: [
        ((0.001, 0.0001, 0.01), YES),
        ((0.0095, 0.001, 0.01), CAVEAT),
        ((0.0105, 0.001, 0.01), CAVEAT),
        ((0.02, 0.001, 0.01), NO),
        # Known too badly to tell, unless even so it is too far off.
        ((0.001, 0.02, 0.01), OPEN),
        ((0.025, 0.02, 0.01), OPEN),
        ((0.05, 0.02, 0.01), NO),
        ((NAN, 0.001, 0.01), NONE),
        ((0.001, NAN, 0.01), NONE),
        # A formula.
        ((2e-16, 0.0, 1e-12), YES),
        ((0.5, 0.0, 1e-12), NO),
    ],
    # An equation leaves no run out, and says which decides.
    rules.exact: [
        (([0.001, 0.02, 0.03], [1e-4] * 3, 0.01), (NO, 2)),
        (([0.001, 0.002], [0.02, 1e-4], 0.01), (OPEN, 0)),
        # A run that is known badly does not hide one that fails.
        (([0.001, 0.02], [0.5, 1e-4], 0.01), (NO, 1)),
        (([NAN, 0.002], [1e-4, 1e-4], 0.01), (YES, 1)),
        (([NAN], [1e-4], 0.01), (NONE, None)),
    ],
    # Median and exponent, each with its uncertainty.
    rules.approximate: [
        (((0.1, 0.01), 0.2, (1.05, 0.02), 0.1), YES),
        (((0.1, 0.01), 0.2, None, 0.1), YES),
        (((0.19, 0.02), 0.2, (1.0, 0.01), 0.1), CAVEAT),
        (((0.1, 0.01), 0.2, (0.91, 0.02), 0.1), CAVEAT),
        (((0.3, 0.01), 0.2, (1.0, 0.01), 0.1), NO),
        (((0.1, 0.01), 0.2, (1.2, 0.02), 0.1), NO),
        (((0.1, 0.25), 0.2, (1.0, 0.01), 0.1), OPEN),
        (((0.1, 0.01), 0.2, (1.0, 0.2), 0.1), OPEN),
        (((NAN, NAN), 0.2, (1.0, 0.01), 0.1), NONE),
    ],
    # At every admissible combination of what the paper leaves open.
    rules.over_choices: [
        (([YES, YES, YES],), YES),
        (([YES, CAVEAT, NONE],), CAVEAT),
        (([YES, YES, NO],), DEPENDS),
        (([CAVEAT, NO, OPEN],), DEPENDS),
        (([NO, NO, OPEN],), NO),
        (([OPEN, YES],), OPEN),
        (([NONE, NONE],), NONE),
    ],
    # Runs that hold, fail and are undecided, and whether under a condition: one decided run contradicts every.
    rules.qualitative: [
        ((40, 0, 0, False), YES),
        ((40, 0, 0, True), CAVEAT),
        ((36, 0, 4, False), CAVEAT),
        ((35, 0, 5, False), OPEN),
        ((39, 1, 0, False), NO),
        ((10, 1, 29, False), NO),
        ((0, 0, 3, False), OPEN),
        ((0, 0, 0, False), NONE),
    ],
    rules.reading: [
        ((0.5, 7, 0.05), YES),
        ((0.04, 7, 0.05), CAVEAT),
        ((0.001, 7, 0.05), NO),
        ((0.5, 1, 0.05), OPEN),
        ((NAN, 7, 0.05), NONE),
    ],
}


@pytest.mark.parametrize(
    ("rule", "arguments", "verdict"), [(rule, *case) for rule, cases in CASES.items() for case in cases]
)
def test_the_verdict_of_each_rule(rule, arguments, verdict):
    assert rule(*arguments) == verdict
