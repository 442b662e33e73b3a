"""No limit of the solver's domain gives a wrong number without a flag."""

import math
from unittest.mock import Mock

import pytest

from slippulse.solver.lattice import UnstableRun
from slippulse_paper.report.report_tables import edges
from slippulse_paper.studies import extremes
from slippulse_paper.studies.extreme_cases import Case
from slippulse_paper.studies.extremes import Outcome

WRONG = "WRONG WITHOUT A FLAG"


@pytest.mark.parametrize(
    ("expected", "outcome", "verdict"),
    [
        pytest.param(2.0, Outcome(2.01), "right", id="within one per cent"),
        pytest.param(2.0, Outcome(2.03), WRONG, id="beyond one per cent"),
        pytest.param(2.0, Outcome(2.03, "energy"), "flagged", id="a flag wins"),
        pytest.param(0.0, Outcome(0.005), "right", id="absolute at 0"),
        pytest.param(0.0, Outcome(0.02), WRONG, id="beyond it at 0"),
        pytest.param(math.nan, Outcome(2.0), WRONG, id="a number where theory has none"),
        pytest.param(2.0, Outcome(math.nan), "no number", id="missing"),
        pytest.param(2.0, Outcome(math.inf), WRONG, id="infinite"),
        pytest.param(2.0, ValueError("dx: -1; allowed: > 0"), "refused", id="refused"),
        pytest.param(2.0, UnstableRun("at t = 1"), "stopped", id="stopped"),
    ],
)
def test_the_verdict_is_computed(monkeypatch, expected, outcome, verdict):
    how = "side_effect" if isinstance(outcome, Exception) else "return_value"
    monkeypatch.setattr(extremes, "measured_outcome", Mock(**{how: outcome}))
    monkeypatch.setattr(Case, "expected", lambda case: expected)
    case = Case("family", "where", "front speed", "right", 0.1, 1.0)
    assert extremes.judged_row(case, 0.3)["verdict"] == verdict


def test_every_case_ends_as_it_should(study):
    table = study("extremes")
    others = table[table["verdict"] != table["should"]]
    assert others.empty, others.to_string()
    assert len(table) == 60 and table["family"].nunique() == 14
    assert len(edges(table).splitlines()) == len(table) + 2
    # Refusals say the bound, flags their reason.
    messages = table.set_index("verdict")["message"]
    assert messages["refused"].str.contains("allowed: ").all()
    flags = set(",".join(messages["flagged"]).split(","))
    assert {"died_out", "unresolved_pulse", "reverse_sliding", "unsteady", "stalled"} <= flags
    table.loc[0, "verdict"] = WRONG
    assert WRONG in edges(table)
