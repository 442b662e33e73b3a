"""What texts read from the ledger: numbers by kind, counts that leave out what follows, and one sentence of why."""

from types import SimpleNamespace

import pytest

from slippulse.claims import reading

CLAIM = {
    "id": "one", "kind": "exact", "verdict": "not reproduced", "predicted": 1.0, "measured": 1.25, "uncertainty": 0.01,
    "tolerance": 0.2, "deviation": 0.25, "note": "", "source": "runs", "further": {}, "why": "", "counted": True,
    "follows_from": [], "flips_at": [], "choices": [],
}  # fmt: skip
ESTIMATE = {"kind": "approximate", "exponent": None, "exact_largest": None, "largest": None}
ALWAYS = {"kind": "qualitative", "held": 4, "failed": 0, "undecided": 0, "runs": 5}
READING = {"kind": "reading", "predicted": 7.0, "measured": 1.62, "deviation": 0.98, "tolerance": 0.05}


def claim(**fields) -> SimpleNamespace:
    return SimpleNamespace(**CLAIM | fields)


# Of a claim with some fields the one sentence that says why.
WHY = [
    ({"verdict": "reproduced"}, ""),
    ({}, "It is off by 25 %, tolerance 20 %; its uncertainty is 1 %."),
    ({"predicted": 0.0, "deviation": 0.5, "tolerance": 0.1},
     "It is off by 0.50, tolerance 0.1; its uncertainty is 0.0100."),
    (ESTIMATE | {"deviation": 0.1, "exponent": 1.3, "exponent_uncertainty": 0.02, "tolerance_exponent": 0.1},
     "It is off by median 10 %, tolerance 20 %; exponent 1.300(20), tolerance 0.1; its uncertainty is 1 %."),
    (ALWAYS | {"failed": 1}, "It holds in 4 of 5 cases, with 1 against."),
    (READING | {"deviation": 2e-4}, "At the best fit p = 2.0×10⁻⁴, at least 0.05 is asked."),
    ({"kind": "arithmetic", "measured": 0.5}, "The printed formula gives 0.5000 of the derived value."),
    ({"verdict": "not testable"}, "This run leaves no number to judge by."),
    ({"why": "It needs a reason."}, "It needs a reason."),
]  # fmt: skip
# What is predicted, measured and compared.
NUMBERS = [
    (ALWAYS | {"predicted": 8.0, "held": 5, "failed": 1, "undecided": 2, "tolerance": 0.0},
     "all of 8", "5 of 8, 1 against, 2 undecided", "no run may contradict"),
    (READING, "7 degrees of freedom", "χ² = 1.62", "p = 0.98, at least 0.05"),
    (ESTIMATE, "1", "1.250(10)", "median 25 %, tolerance 20 %"),
]  # fmt: skip


@pytest.mark.parametrize(("fields", "sentence"), WHY)
def test_one_sentence_says_why(fields, sentence):
    assert reading.why_text(claim(**fields)) == sentence


@pytest.mark.parametrize(("fields", *"abc"), NUMBERS)
def test_numbers_are_written_as_their_kind_has_them(fields, a, b, c):
    found = claim(**fields)
    assert (reading.predicted_text(found), reading.measured_text(found), reading.compared_text(found)) == (
        a,
        b,
        c,
    )


def test_a_verdict_that_hangs_on_the_tolerance_says_so():
    sides = {"below": "inconclusive", "above": "reproduced"}
    flips = [sides | {"tolerance": tolerance} for tolerance in (0.1, 0.15, 0.29)]
    found = reading.evidence_text(claim(**ALWAYS, flips_at=flips))
    assert found == "with a tolerance below 0.150: inconclusive; with a tolerance above 0.290: reproduced"


def test_what_follows_is_not_counted_again():
    reproduced = {"verdict": "reproduced"}
    follows = reproduced | {"id": "b", "counted": False, "follows_from": ["a"]}
    ledger = reading.Ledger([CLAIM | fields for fields in (reproduced | {"id": "a"}, follows, {"id": "c"})])
    assert ledger.count() == 2 and ledger.count("reproduced") == 1 and ledger.following() == 1
    assert ledger.summary() == "2 claims: 1 reproduced, 1 not reproduced. 1 more follow from these."


def test_findings_and_further_numbers_are_asked_for_by_name():
    found = [{"id": "ours", "numbers": {"gap": 0.5}}, {"id": "no", "numbers": {}}]
    further = {"apart, 0: arrested": 3.0, "apart, 0: growing": 2.0, "apart": 4.0, "else": 1.0}
    ledger = reading.Ledger([CLAIM | {"further": further}], found)
    assert ledger.listed("one", "apart") == "3 arrested; 2 growing"
    assert ledger.found("ours").gap == 0.5 and ledger.found("no") is None
    with pytest.raises(ValueError, match="finding: 'none'; allowed: ours, no"):
        ledger.found("none")
    with pytest.raises(ValueError, match="claim: 'no'; allowed: one"):
        ledger("no")
