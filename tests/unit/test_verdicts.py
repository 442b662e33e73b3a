"""The rule of each kind of claim, on made-up numbers, before anything was measured by it."""

from __future__ import annotations

import pytest

from slippulse.claims.rules import (
    VERDICTS,
    WORST_FIRST,
    approximate,
    arithmetic,
    at_fractions,
    exact,
    existence,
    qualitative,
    reading,
    within,
    worst,
)

YES, CAVEAT, NO, OPEN, NONE = VERDICTS
NAN = float("nan")


def test_every_verdict_has_its_rank():
    assert sorted(WORST_FIRST) == sorted(VERDICTS)
    assert worst([YES, OPEN, CAVEAT]) == OPEN and worst([YES, NO, OPEN]) == NO and worst([]) == NONE


@pytest.mark.parametrize(
    ("deviation", "uncertainty", "verdict"),
    [
        (0.001, 0.0001, YES),
        (0.0095, 0.001, CAVEAT),
        (0.0105, 0.001, CAVEAT),
        (0.02, 0.001, NO),
        # Known too badly to tell, unless even so it is too far off.
        (0.001, 0.02, OPEN),
        (0.025, 0.02, OPEN),
        (0.05, 0.02, NO),
        (NAN, 0.001, NONE),
        (0.001, NAN, NONE),
    ],
)
def test_one_number(deviation, uncertainty, verdict):
    assert within(deviation, uncertainty, 0.01) == verdict


def test_an_equation_leaves_no_run_out():
    assert exact([0.001, 0.02, 0.03], [1e-4] * 3, 0.01) == (NO, 2)
    assert exact([0.001, 0.002], [0.02, 1e-4], 0.01) == (OPEN, 0)
    # A run that is known badly does not hide one that fails.
    assert exact([0.001, 0.02], [0.5, 1e-4], 0.01) == (NO, 1)
    assert exact([NAN, 0.002], [1e-4, 1e-4], 0.01) == (YES, 1)
    assert exact([NAN], [1e-4], 0.01) == (NONE, None)


@pytest.mark.parametrize(
    ("median", "exponent", "verdict"),
    [
        ((0.1, 0.01), (1.05, 0.02), YES),
        ((0.1, 0.01), None, YES),
        ((0.19, 0.02), (1.0, 0.01), CAVEAT),
        ((0.1, 0.01), (0.91, 0.02), CAVEAT),
        ((0.3, 0.01), (1.0, 0.01), NO),
        ((0.1, 0.01), (1.2, 0.02), NO),
        ((0.1, 0.25), (1.0, 0.01), OPEN),
        ((0.1, 0.01), (1.0, 0.2), OPEN),
        ((NAN, NAN), (1.0, 0.01), NONE),
    ],
)
def test_an_estimate_is_judged_by_median_and_exponent(median, exponent, verdict):
    assert approximate(median, 0.2, exponent, 0.1) == verdict


@pytest.mark.parametrize(
    ("fractions", "last", "verdict"),
    [
        ([YES, YES, YES], NO, YES),
        ([YES, YES, NO], NO, CAVEAT),
        ([NO, NO, NO], YES, CAVEAT),
        ([CAVEAT, NO, NO], NO, CAVEAT),
        ([NO, NO, NO], NO, NO),
        ([OPEN, NO, NO], NO, OPEN),
        ([NONE, NONE, NONE], NONE, NONE),
    ],
)
def test_a_time_without_an_end_is_judged_at_several_fractions(fractions, last, verdict):
    assert at_fractions(fractions, last) == verdict


@pytest.mark.parametrize(
    ("held", "failed", "undecided", "condition", "verdict"),
    [
        (40, 0, 0, False, YES),
        (40, 0, 0, True, CAVEAT),
        (36, 0, 4, False, CAVEAT),
        (35, 0, 5, False, OPEN),
        (39, 1, 0, False, NO),
        (10, 1, 29, False, NO),
        (0, 0, 3, False, OPEN),
        (0, 0, 0, False, NONE),
    ],
)
def test_one_decided_run_contradicts_every(held, failed, undecided, condition, verdict):
    assert qualitative(held, failed, undecided, condition) == verdict


def test_one_decided_run_of_each_case_shows_that_there_are():
    assert existence([3, 1]) == YES
    assert existence([3, 0]) == existence([]) == OPEN


@pytest.mark.parametrize(
    ("p", "degrees", "verdict"),
    [(0.5, 7, YES), (0.04, 7, CAVEAT), (0.001, 7, NO), (0.5, 1, OPEN), (NAN, 7, NONE)],
)
def test_readings_are_judged_together(p, degrees, verdict):
    assert reading(p, degrees, 0.05) == verdict


def test_arithmetic_is_right_or_wrong():
    assert arithmetic(2e-16, 1e-12) == YES
    assert arithmetic(0.5, 1e-12) == NO
