"""Claims of each kind from invented tables on three lattices, and how they are written."""

from __future__ import annotations

import json

import numpy as np
import pandas as pd
import pytest

from slippulse.claims.entries import read_entries
from slippulse.claims.evidence import Evidence, NoRuns, agreeing
from slippulse.claims.paper import written
from slippulse.claims.rules import VERDICTS
from slippulse.measure.uncertainty import grid_tables

YES, CAVEAT, _, NO, OPEN, NONE = VERDICTS
ENTRIES = {
    "equation": {"kind": "exact", "tolerance": 0.01, "sentences": ["a"]},
    "estimate": {
        "kind": "approximate",
        "tolerance": 0.2,
        "tolerance_exponent": 0.1,
        "follows_from": ["equation"],
    },
    "every": {"kind": "qualitative", "tolerance": 0.0},
}
LEVELS = [0.2, 0.4, 0.6, 0.8]


def evidence(measure=lambda level, factor: level, flagged: int | None = None) -> Evidence:
    """One sweep over four levels, measured as a function of both, on spacings 1, 2 and 4, predicted."""
    tables = [
        pd.DataFrame([{"left": level, "run_flags": "", "number": measure(level, factor)} for level in LEVELS])
        for factor in (1.0, 2.0, 4.0)
    ]
    if flagged is not None:
        tables[0].loc[flagged, "run_flags"] = "unresolved"
    study = grid_tables(tuple(tables), (2.0, 4.0), ("left", "run_flags"))
    coarser = [table.assign(factor=factor) for table, factor in zip(tables[1:], (2.0, 4.0), strict=True)]
    finest = tables[0].assign(paper=LEVELS, exact_number=[level / 1.1 for level in LEVELS])
    return Evidence(
        {
            "sweep": finest,
            "coarser/sweep": pd.concat(coarser, ignore_index=True),
            "uncertainties/sweep": study,
        },
        ENTRIES,
        0.02,
    )


def exact(found: Evidence):
    table = found.runs("sweep")
    return found.exact("equation", table["extrapolated_number"], table["uncertainty_number"], table["paper"])


def test_an_equation_is_judged_at_spacing_zero_and_one_run_that_is_off_fails_it_unless_it_is_flagged():
    claim = exact(evidence(lambda level, factor: level * (1.0 + 0.002 * factor)))
    assert claim["verdict"] == YES and (claim["runs"], claim["left_out"]) == (4, 0)
    assert claim["deviation"] < 1e-9
    assert claim["uncertainty"] / claim["predicted"] == pytest.approx(0.002)

    def measure(level, factor):
        return level * (1.0 + 1e-4 * factor + 0.05 * (level == 0.6))

    claim = exact(evidence(measure))
    assert claim["verdict"] == NO and claim["predicted"] == 0.6
    assert claim["deviation"] == pytest.approx(0.05, rel=0.01)
    assert exact(evidence(measure, flagged=2))["verdict"] == YES


def estimate(measure):
    found = evidence(measure)
    return found.approximate("estimate", found.lattices("sweep"), "number", "paper", "left")


def test_an_estimate_is_judged_by_its_median_and_its_exponent_not_by_the_worst_run():
    claim = estimate(lambda level, factor: level * (1.05 + 1e-3 * factor))
    assert claim["verdict"] == YES and claim["measured"] == pytest.approx(1.051)
    assert claim["exponent"] == pytest.approx(1.0, abs=1e-3)
    assert claim["largest"] == pytest.approx(0.051)
    assert claim["uncertainty"] == pytest.approx(1e-3, rel=1e-3)
    assert estimate(lambda level, factor: 1.3 * level)["verdict"] == NO
    claim = estimate(lambda level, factor: level**1.2 * 1.1)
    assert claim["verdict"] == NO and claim["exponent"] == pytest.approx(1.2)
    # Its uncertainty is at least what one level moves it.
    claim = estimate(lambda level, factor: level * (1.15 if level == 0.8 else 1.0))
    assert claim["exponent_uncertainty"] > 0.03


def test_a_run_is_decided_where_two_lattices_agree_or_theory_tells():
    def decided(told="", exactly=None):
        found = evidence(lambda level, factor: level if factor == 1.0 or level != 0.6 else 0.0)
        return found.agreed("sweep", "left > 0.3", "number > 0.5", told, exactly)

    assert decided() == [False, None, True]
    theory = decided(exactly=lambda t: (t["left"] > 0.5).where(t["left"] < 0.7, None))
    assert theory == [False, True, True]
    # Where a lattice has not run long enough it is not asked.
    assert decided("left < 0.7") == [False, None, None]
    assert agreeing([True, None, False], [True, None, True]) == [True, None, None]


def test_a_qualitative_claim_counts_runs():
    claim = evidence().qualitative("every", [True] * 38 + [None] * 2)
    counts = {"runs": 40, "held": 38, "failed": 0, "undecided": 2, "verdict": CAVEAT}
    assert claim == claim | counts
    assert evidence().qualitative("every", [np.bool_(True), np.bool_(False)])["verdict"] == NO
    assert evidence().qualitative("every", [])["verdict"] == NONE


def test_a_claim_is_written_with_its_entry_and_the_theory_beside():
    claim = exact(evidence()) | evidence().compared("sweep", "number")
    found = written(claim, ENTRIES["equation"], "III A")
    assert found["exact_median"] == found["exact_largest"] == pytest.approx(0.1)
    expected = {
        "counted": True,
        "follows_from": [],
        "figure_or_section": "III A",
        "tolerance": 0.01,
        "why": "",
    }
    assert found == found | expected
    nothing = evidence().approximate("estimate", [pd.DataFrame({"a": [np.nan], "b": 1.0})], "a", "b")
    found = written(nothing, ENTRIES["estimate"] | {"sentences": []}, "")
    assert found["verdict"] == NONE and found["measured"] is None and not found["counted"]
    json.dumps(found, allow_nan=False)


def test_what_is_missing_is_named(tmp_path):
    with pytest.raises(NoRuns, match="sweep"):
        evidence().runs("sweep", where="left > 1")
    path, other = tmp_path / "claims.yaml", {"tolerance": 0.2}
    path.write_text("claims: {one: {tolerance: 0.1}}\n", encoding="utf-8")
    assert read_entries(path, {"one": other})["claims"]["one"] == other
    with pytest.raises(ValueError, match=r"claims\.on: unknown claim.*'one'.*; allowed: those in"):
        read_entries(path, {"on": other})
