"""What texts read from the ledger: numbers by kind, counts that leave out what follows, and one sentence of why."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from slippulse.claims.ledger import Claim
from slippulse.claims.reading import Ledger, compared_text, measured_text, predicted_text, why_text

NUMBERS = {"predicted": 1.0, "measured": 1.25, "uncertainty": 0.01, "tolerance": 0.2, "deviation": 0.25}


def claim(id: str = "one", kind: str = "exact", verdict: str = "not reproduced", **fields) -> Claim:
    return Claim(**{**NUMBERS, "note": "", "source": "runs", **fields}, id=id, kind=kind, verdict=verdict)


@pytest.mark.parametrize(
    ("found", "sentence"),
    [
        (claim(verdict="reproduced"), ""),
        (claim(), "It is off by 25 %, where 20 % is allowed."),
        (
            claim(verdict="inconclusive", uncertainty=0.3),
            "Its uncertainty, 30 %, exceeds the tolerance of 20 %.",
        ),
        (claim(predicted=0.0, deviation=0.5, tolerance=0.1), "It is off by 0.500, where 0.100 is allowed."),
        (claim(kind="approximate"), "The median run is off by 25 %, where 20 % is allowed."),
        (
            claim(
                kind="approximate",
                deviation=0.1,
                exponent=1.3,
                exponent_uncertainty=0.02,
                tolerance_exponent=0.1,
            ),
            "The exponent is 1.300(20), where 1 within 0.1 is allowed.",
        ),
        (claim(kind="qualitative", held=4, failed=1, undecided=0, runs=5), "1 of 5 runs contradict it."),
        (
            claim(kind="qualitative", held=4, failed=0, undecided=1, runs=5),
            "In 1 of 5 runs the lattices disagree.",
        ),
        (
            claim(kind="reading", deviation=2e-4, tolerance=0.05),
            "At the best fit p is 2.0×10⁻⁴, below 0.003.",
        ),
        (claim(kind="arithmetic", measured=0.5), "Printed over derived is 0.5000."),
        (claim(verdict="not testable"), "This run leaves no number to judge by."),
        (claim(why="It needs a reason."), "It needs a reason."),
    ],
)
def test_one_sentence_says_why(found, sentence):
    assert why_text(found) == sentence


def read(found: Claim) -> SimpleNamespace:
    return SimpleNamespace(**found.as_dict())


def test_numbers_are_written_as_their_kind_has_them():
    always = read(claim(kind="qualitative", predicted=8.0, held=5, failed=1, undecided=2, tolerance=0.0))
    assert (predicted_text(always), measured_text(always)) == ("all of 8", "5 of 8, 1 against, 2 undecided")
    assert compared_text(always) == "no run may contradict"
    read_off = read(claim(kind="reading", predicted=7.0, measured=1.62, deviation=0.98, tolerance=0.05))
    assert (predicted_text(read_off), measured_text(read_off)) == ("7 degrees of freedom", "χ² = 1.62")
    assert compared_text(read_off) == "p = 0.98, at least 0.05"
    assert measured_text(read(claim())) == "1.250(10)"
    assert compared_text(read(claim(kind="approximate"))) == "median 25 %, tolerance 20 %"


def test_what_follows_is_not_counted_again():
    follows = {"counted": False, "follows_from": ("a",)}
    claims = [claim("a", verdict="reproduced"), claim("b", verdict="reproduced", **follows), claim("c")]
    ledger = Ledger([found.as_dict() for found in claims])
    assert ledger.count() == 2 and ledger.count("reproduced") == 1 and ledger.following() == 1
    assert ledger.summary() == "2 claims: 1 reproduced, 1 not reproduced. 1 more follow from these."
    assert ledger.by_kind() == [("exact", ["1", "0", "0", "0", "1 + 1"])]


def test_findings_and_further_numbers_are_asked_for_by_name():
    found = [
        {"id": "ours", "numbers": {"gap": 0.5}, "text": ""},
        {"id": "nothing", "numbers": {}, "text": ""},
    ]
    further = {"apart, 0: arrested": 3.0, "apart, 0: growing": 2.0, "else": 1.0}
    ledger = Ledger([claim(further=further).as_dict()], found)
    assert ledger.listed("one", "apart") == "arrested: 3, growing: 2"
    assert ledger.found("ours").gap == 0.5 and ledger.found("nothing").gap is None
    with pytest.raises(AttributeError):
        _ = ledger.found("ours").width
    with pytest.raises(ValueError, match="finding: 'no'; allowed: ours, nothing"):
        ledger.found("no")
    with pytest.raises(ValueError, match="claim: 'no'; allowed: one"):
        ledger("no")
