"""The rule of each kind of claim, on made-up numbers."""

import pytest

from slippulse.claims import rules
from slippulse.claims.rules import VERDICTS, WORST_FIRST

YES, CAVEAT, DEPENDS, NO, OPEN, NONE = VERDICTS
NAN = float("nan")
# By rule and verdict the arguments that lead to it, with a tolerance where the rule takes one.
CASES = {
    rules.within: {
        # A formula has no uncertainty.
        YES: [(0.001, 0.0001, 0.01), (2e-16, 0.0, 1e-12)],
        CAVEAT: [(0.0095, 0.001, 0.01), (0.0105, 0.001, 0.01)],
        # Known too badly to tell, unless even so it is too far off.
        OPEN: [(0.001, 0.02, 0.01), (0.025, 0.02, 0.01)],
        NO: [(0.02, 0.001, 0.01), (0.05, 0.02, 0.01), (0.5, 0.0, 1e-12)],
        NONE: [(NAN, 0.001, 0.01), (0.001, NAN, 0.01)],
    },
    # An equation leaves no run out, and says which decides; a run that is known badly does not hide one that fails.
    rules.exact: {
        (NO, 2): [([0.001, 0.02, 0.03], [1e-4] * 3, 0.01)],
        (NO, 1): [([0.001, 0.02], [0.5, 1e-4], 0.01)],
        (OPEN, 0): [([0.001, 0.002], [0.02, 1e-4], 0.01)],
        (YES, 1): [([NAN, 0.002], [1e-4, 1e-4], 0.01)],
        (NONE, None): [([NAN], [1e-4], 0.01)],
    },
    # Median and exponent, each with its uncertainty.
    rules.approximate: {
        YES: [((0.1, 0.01), 0.2, (1.05, 0.02), 0.1), ((0.1, 0.01), 0.2, None, 0.1)],
        CAVEAT: [((0.19, 0.02), 0.2, (1.0, 0.01), 0.1), ((0.1, 0.01), 0.2, (0.91, 0.02), 0.1)],
        NO: [((0.3, 0.01), 0.2, (1.0, 0.01), 0.1), ((0.1, 0.01), 0.2, (1.2, 0.02), 0.1)],
        OPEN: [((0.1, 0.25), 0.2, (1.0, 0.01), 0.1), ((0.1, 0.01), 0.2, (1.0, 0.2), 0.1)],
        NONE: [((NAN, NAN), 0.2, (1.0, 0.01), 0.1)],
    },
    # At every admissible combination of what the paper leaves open.
    rules.over_choices: {
        YES: [([YES, YES, YES],)],
        CAVEAT: [([YES, CAVEAT, NONE],)],
        DEPENDS: [([YES, YES, NO],), ([CAVEAT, NO, OPEN],)],
        NO: [([NO, NO, OPEN],)],
        OPEN: [([OPEN, YES],)],
        NONE: [([NONE, NONE],)],
    },
    # Runs that hold, fail and are undecided, and whether under a condition: one decided run contradicts every.
    rules.qualitative: {
        YES: [(40, 0, 0, False)],
        CAVEAT: [(40, 0, 0, True), (36, 0, 4, False)],
        OPEN: [(35, 0, 5, False), (0, 0, 3, False)],
        NO: [(39, 1, 0, False), (10, 1, 29, False)],
        NONE: [(0, 0, 0, False)],
    },
    rules.reading: {
        YES: [(0.5, 7, 0.05)],
        CAVEAT: [(0.04, 7, 0.05)],
        NO: [(0.001, 7, 0.05)],
        OPEN: [(0.5, 1, 0.05)],
        NONE: [(NAN, 7, 0.05)],
    },
    rules.worst: {OPEN: [([YES, OPEN, CAVEAT],)], NO: [([YES, NO, OPEN],)], NONE: [([],)]},
}


@pytest.mark.parametrize(
    ("rule", "arguments", "verdict"),
    [(rule, case, verdict) for rule in CASES for verdict, cases in CASES[rule].items() for case in cases],
)
def test_the_verdict_of_each_rule(rule, arguments, verdict):
    assert rule(*arguments) == verdict


def test_every_verdict_has_its_rank():
    assert sorted(WORST_FIRST) == sorted(VERDICTS)
