"""Claims of each kind from invented tables on three lattices."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from slippulse.claims.evidence import Evidence, compared, line
from slippulse.claims.rules import VERDICTS
from slippulse.measure.uncertainty import grid_tables

YES, CAVEAT, NO, OPEN, NONE = VERDICTS
SETTINGS = {
    "equation": {"kind": "exact", "tolerance": 0.01},
    "estimate": {
        "kind": "approximate",
        "tolerance": 0.2,
        "tolerance_exponent": 0.1,
        "follows_from": ["equation"],
    },
    "every": {"kind": "qualitative", "tolerance": 0.0},
    "formula": {"kind": "arithmetic", "tolerance": 1e-12},
}
LEVELS = [0.2, 0.4, 0.6, 0.8]


def evidence(measure, flagged: int | None = None) -> Evidence:
    """One sweep over four levels, measured as a function of level and spacing, on spacings 1, 2 and 4."""
    tables = []
    for factor in (1.0, 2.0, 4.0):
        rows = [
            {"left": level, "run_flags": "", "number": measure(level, factor), "paper": level}
            for level in LEVELS
        ]
        tables.append(pd.DataFrame(rows))
    if flagged is not None:
        tables[0].loc[flagged, "run_flags"] = "unresolved"
    study = grid_tables(tuple(tables), (2.0, 4.0), ("left", "run_flags", "paper"))
    coarser = [table.assign(factor=factor) for table, factor in zip(tables[1:], (2.0, 4.0), strict=True)]
    return Evidence({"sweep": tables[0]}, {"sweep": coarser}, {"sweep": study}, SETTINGS)


def exact(found: Evidence):
    points = found.points("sweep", "number")
    return found.exact("equation", "sweep: number", points, points["paper"])


def test_an_equation_is_judged_at_spacing_zero():
    claim = exact(evidence(lambda level, factor: level * (1.0 + 0.002 * factor)))
    assert claim.verdict == YES and claim.runs == 4 and claim.counted
    assert claim.deviation < 1e-9 and claim.uncertainty / claim.predicted == pytest.approx(0.002)


def test_one_run_that_is_off_fails_an_equation_unless_it_is_flagged():
    def measure(level, factor):
        return level * (1.0 + 1e-4 * factor + 0.05 * (level == 0.6))

    claim = exact(evidence(measure))
    assert claim.verdict == NO and claim.predicted == 0.6 and claim.deviation == pytest.approx(0.05, rel=0.01)
    assert exact(evidence(measure, flagged=2)).verdict == YES


def estimate(measure):
    found = evidence(measure)
    return found.approximate("estimate", "sweep", found.lattices("sweep"), "number", "paper", ("left",))


def test_the_worst_run_does_not_decide_an_estimate():
    claim = estimate(lambda level, factor: level * (1.05 + 1e-3 * factor))
    assert claim.verdict == YES and not claim.counted and claim.follows_from == ("equation",)
    assert claim.measured == pytest.approx(1.051) and claim.exponent == pytest.approx(1.0, abs=1e-3)
    assert claim.largest == pytest.approx(0.051) and claim.uncertainty == pytest.approx(1e-3, rel=1e-3)


def test_a_median_and_an_exponent_can_fail():
    assert estimate(lambda level, factor: 1.3 * level).verdict == NO
    claim = estimate(lambda level, factor: level**1.2 * 1.1)
    assert claim.verdict == NO and claim.exponent == pytest.approx(1.2)


def test_the_uncertainty_of_an_exponent_is_at_least_what_one_level_moves_it():
    claim = estimate(lambda level, factor: level * (1.15 if level == 0.8 else 1.0))
    assert claim.exponent_uncertainty > 0.03


def decided(measure, exactly=lambda row: None, long_enough=None):
    found = evidence(measure)
    return found.agreed("sweep", lambda t: t["left"] > 0.3, lambda t: t["number"] > 0.5, exactly, long_enough)


def test_a_run_is_decided_where_two_lattices_agree_or_theory_tells():
    def measure(level, factor):
        return level if factor == 1.0 or level != 0.6 else 0.0

    assert decided(measure) == [False, None, True]
    assert decided(measure, lambda row: row.left > 0.5) == [False, True, True]
    # Where a lattice has not run long enough it is not asked.
    assert decided(measure, lambda row: None, lambda t: t["left"] < 0.7) == [False, None, None]


def test_a_qualitative_claim_counts_runs():
    found = evidence(lambda level, factor: level)
    claim = found.qualitative("every", "sweep", [True] * 38 + [None] * 2)
    assert (claim.held, claim.failed, claim.undecided, claim.verdict) == (38, 0, 2, CAVEAT)
    assert found.qualitative("every", "sweep", [np.bool_(True), np.bool_(False)]).verdict == NO
    assert found.qualitative("every", "sweep", []).verdict == NONE


def test_arithmetic_and_theory_beside():
    found = evidence(lambda level, factor: level)
    assert found.arithmetic("formula", "here", 1.0 + 1e-15).verdict == YES
    claim = compared(found.arithmetic("formula", "here", 0.5), [1.0, 1.1, np.nan], [1.0, 1.0, 1.0])
    assert claim.verdict == NO and claim.exact_median == pytest.approx(0.05)


def test_the_line_needs_three_points():
    assert np.isnan(line(pd.DataFrame({"a": [1.0, 2.0], "b": [1.0, 2.0]}), "a", "b"))
