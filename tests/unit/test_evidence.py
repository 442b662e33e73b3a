"""Claims of each kind from invented tables on three lattices, and how they are written."""

import json

import numpy as np
import pandas as pd
import pytest

from slippulse.claims.evidence import Evidence, agreeing
from slippulse.claims.paper import findings, written
from slippulse.claims.reading import read_entries
from slippulse.claims.rules import VERDICTS
from slippulse.measure.uncertainty import grid_tables

YES, CAVEAT, _, NO, OPEN, NONE = VERDICTS
ENTRIES = {
    "equation": {"kind": "exact", "tolerance": 0.01, "sentences": ["a"]},
    "estimate": {
        "kind": "approximate", "tolerance": 0.2, "tolerance_exponent": 0.1, "sentences": [],
        "follows_from": ["equation"],
    },
}  # fmt: skip
LEVELS = [0.2, 0.4, 0.6, 0.8]


def evidence(measure=lambda level, factor: level, flagged: int | None = None) -> Evidence:
    """One sweep over four levels, measured as a function of both, on spacings 1, 2 and 4, predicted."""
    tables = [
        pd.DataFrame([{"left": level, "run_flags": "", "number": measure(level, factor)} for level in LEVELS])
        for factor in (1.0, 2.0, 4.0)
    ]
    if flagged is not None:
        tables[0].loc[flagged, "run_flags"] = "unresolved"
    coarser = [table.assign(factor=factor) for table, factor in zip(tables[1:], (2.0, 4.0), strict=True)]
    ends = ["other", "arrested", "arrested", "undecided"]
    found = {
        "sweep": tables[0].assign(paper=LEVELS, exact_number=np.array(LEVELS) / 1.1, exact_regime=ends),
        "coarser/sweep": pd.concat(coarser, ignore_index=True),
        "uncertainties/sweep": grid_tables(tuple(tables), (2.0, 4.0), ("left", "run_flags")),
    }
    return Evidence(found, ENTRIES, 0.02)


def exact(found: Evidence):
    return found.exact("equation", found.lattices("sweep")[0], "number", "paper")


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
    assert (
        estimate(lambda level, factor: level * (1.15 if level == 0.8 else 1.0))["exponent_uncertainty"] > 0.03
    )


def test_a_run_is_decided_where_two_lattices_agree_or_theory_tells():
    found = evidence(lambda level, factor: level if factor == 1.0 or level != 0.6 else 0.0)
    assert found.agreed("sweep", "left > 0.3", "number > 0.5") == [False, None, True]
    assert found.agreed("sweep", "left > 0.3", "number > 0.5", ends=["arrested"]) == [False, True, True]
    assert found.agreed("sweep", "left > 0.3", "number > 0.5", ends=["other"]) == [False, False, True]
    # Where a lattice has not run long enough it is not asked.
    assert found.agreed("sweep", "left > 0.3", "number > 0.5", "left < 0.7") == [False, None, None]
    assert found.agreed("sweep", "left > 0.7", "number > 0.5", "left < 0.7", ["arrested"]) == [None]
    assert agreeing([True, None, False], [True, None, True]) == [True, None, None]


def test_a_qualitative_claim_counts_runs():
    claim = evidence().qualitative([True] * 38 + [None] * 2)
    assert claim == claim | {"runs": 40, "held": 38, "failed": 0, "undecided": 2, "verdict": CAVEAT}
    assert evidence().qualitative([np.bool_(True), np.bool_(False)])["verdict"] == NO
    assert evidence().qualitative([])["verdict"] == NONE


def test_a_claim_is_written_with_its_entry_and_the_theory_beside():
    claim = exact(evidence()) | evidence().compared("sweep", "number")
    found = written("equation", claim, ENTRIES["equation"], "III A")
    assert found["exact_median"] == found["exact_largest"] == pytest.approx(0.1)
    expected = {
        "id": "equation",
        "counted": True,
        "follows_from": [],
        "figure_or_section": "III A",
        "why": "",
    }
    assert found == found | expected | {"tolerance": 0.01}
    nothing = evidence().approximate("estimate", [pd.DataFrame({"a": [np.nan], "b": 1.0})], "a", "b")
    found = written("estimate", nothing, ENTRIES["estimate"], "")
    assert found["verdict"] == NONE and found["measured"] is None and not found["counted"]
    json.dumps(found, allow_nan=False)


def test_what_is_missing_is_named(tmp_path):
    texts = {"none": {"numbers": [{"table": "sweep", "where": "left > 1", "take": {"a": "left.max()"}}]}}
    texts = {"some": {"numbers": [{"table": "sweep", "take": {"a": "left.max()"}}]}} | texts
    written = findings(evidence(), 0.1, {id: entry | {"text": "{{ n.a }}"} for id, entry in texts.items()})
    assert [finding["text"] for finding in written] == ["0.800", "not measured"]
    path, other = tmp_path / "claims.yaml", {"tolerance": 0.2}
    path.write_text("claims: {one: {tolerance: 0.1}}\n", encoding="utf-8")
    assert read_entries(path, {"one": other})["claims"]["one"] == other
    with pytest.raises(ValueError, match=r"claims\.on: unknown claim.*'one'.*; allowed: those in"):
        read_entries(path, {"on": other})
