"""Claims: the rule of each kind on made-up numbers, claims from invented tables, what texts say of them."""

import json
from functools import partial
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
import yaml

from slippulse.claims import reading, rules
from slippulse.claims.evidence import Evidence, agreeing
from slippulse.claims.paper import SIMULATIONS, findings, written
from slippulse.claims.reading import read_entries
from slippulse.claims.rules import VERDICTS, WORST_FIRST
from slippulse.claims.transition import over_choices
from slippulse.measure.uncertainty import grid_tables
from slippulse.model.quantities import QUANTITIES

YES, CAVEAT, DEPENDS, NO, OPEN, NONE = VERDICTS
NAN = float("nan")
# By rule and verdict the arguments that lead to it, with a tolerance where the rule takes one.
CASES = {
    # A formula has no uncertainty; what is known too badly to tell is open, unless even so it is too far off.
    rules.within: {
        YES: [(0.001, 0.0001, 0.01), (2e-16, 0.0, 1e-12)], CAVEAT: [(0.0095, 0.001, 0.01), (0.0105, 0.001, 0.01)],
        NO: [(0.02, 0.001, 0.01), (0.05, 0.02, 0.01), (0.5, 0.0, 1e-12)],
        OPEN: [(0.001, 0.02, 0.01), (0.025, 0.02, 0.01)], NONE: [(NAN, 0.001, 0.01), (0.001, NAN, 0.01)],
    },
    # An equation leaves no run out, and says which decides; a run that is known badly does not hide one that fails.
    rules.exact: {
        (NO, 2): [([0.001, 0.02, 0.03], [1e-4] * 3, 0.01)], (NO, 1): [([0.001, 0.02], [0.5, 1e-4], 0.01)],
        (OPEN, 0): [([0.001, 0.002], [0.02, 1e-4], 0.01)], (YES, 1): [([NAN, 0.002], [1e-4, 1e-4], 0.01)],
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
        YES: [([YES, YES, YES],)], CAVEAT: [([YES, CAVEAT, NONE],)], OPEN: [([OPEN, YES],)],
        DEPENDS: [([YES, YES, NO],), ([CAVEAT, NO, OPEN],)], NO: [([NO, NO, OPEN],)], NONE: [([NONE, NONE],)],
    },
    # Runs that hold, fail and are undecided, and whether under a condition: one decided run contradicts every.
    rules.qualitative: {
        YES: [(40, 0, 0, False)], CAVEAT: [(40, 0, 0, True), (36, 0, 4, False)], NONE: [(0, 0, 0, False)],
        OPEN: [(35, 0, 5, False), (0, 0, 3, False)], NO: [(39, 1, 0, False), (10, 1, 29, False)],
    },
    rules.reading: {
        YES: [(0.5, 7, 0.05)], CAVEAT: [(0.04, 7, 0.05)], NO: [(0.001, 7, 0.05)], OPEN: [(0.5, 1, 0.05)],
        NONE: [(NAN, 7, 0.05)],
    },
    rules.worst: {OPEN: [([YES, OPEN, CAVEAT],)], NO: [([YES, NO, OPEN],)], NONE: [([],)]},
}  # fmt: skip


@pytest.mark.parametrize(
    ("rule", "arguments", "verdict"),
    [
        (rule, case, verdict)
        for rule in CASES
        for verdict, cases in CASES[rule].items()
        for case in cases
    ],
)
def test_the_verdict_of_each_rule(rule, arguments, verdict):
    assert rule(*arguments) == verdict


def judged(deviation: float, uncertainty: float = 0.0) -> dict:
    at = partial(rules.within, deviation, uncertainty)
    return {"verdict": at(0.2), "at": at, "deviation": deviation}


def at(release: str, ratio: float) -> dict:
    return {"release": release, "damping_ratio": ratio, "solution": "exact"}


# Measured of every run.
OF_RUNS = ("regime", "min_velocity", "friction_ratio_needed", "min_stuck_stress")
# Studies that simulate lattices themselves.
LATTICE_STUDIES = ("studies.rate_dependence",)
# The length of the transition under leaf springs, as the exact theory has it.
LENGTHS = [
    (at("total", 0.1), judged(0.235)), (at("total", 0.0), judged(0.136)), (at("total", 0.058), judged(0.204)),
    (at("elastic", 0.1), judged(0.156)),
]  # fmt: skip


def test_a_claim_that_fails_at_some_choices_depends_on_the_one_that_moves_it_most():
    claim = over_choices(LENGTHS)
    assert (claim["verdict"], claim["choice"]) == (DEPENDS, "damping_ratio")
    assert (claim["holds_at"], claim["combinations"]) == (2, 4)
    assert claim["why"].startswith("It holds at 2 of 4 combinations.")
    sides = (
        "holds at 0 (13.6 %)",
        "fails at 0.058 (20.4 %)",
        "holds at elastic (15.6 %)",
        "total (23.5 %)",
    )
    assert all(side in claim["why"] for side in sides)
    found = rules.flips(claim["at"], 0.2)
    assert [(flip["below"], flip["above"]) for flip in found] == [
        ("not reproduced", DEPENDS), (DEPENDS, "reproduced")
    ]  # fmt: skip
    assert [flip["tolerance"] for flip in found] == pytest.approx([0.136, 0.235], rel=1e-3)


def test_one_verdict_at_every_choice_is_the_verdict():
    assert sorted(WORST_FIRST) == sorted(VERDICTS)
    assert over_choices(LENGTHS[1::2])["verdict"] == "reproduced" and "why" not in over_choices(
        LENGTHS[1::2]
    )
    assert over_choices(LENGTHS[0::2])["verdict"] == "not reproduced"
    unsure = over_choices([(at("total", 0.0), judged(0.19, 0.05)), *LENGTHS[3:]])
    assert unsure["verdict"] == "reproduced with caveat" and "0" in unsure["why"]
    assert rules.flips(judged(0.1)["at"], 0.0) == []


def test_no_claim_compares_a_function_with_itself(project):
    """Each is judged by measured numbers of lattices, by the solved model, or is algebra."""
    claims = yaml.safe_load((project / "manuscript/claims.yaml").read_text(encoding="utf-8"))[
        "claims"
    ]
    others = ("studies.", "predictions:", "algebra", "a run")
    for id, entry in claims.items():
        parts = [part.strip() for part in entry["source"].split(";")]
        lattices = [part for part in parts if not part.startswith(others)]
        match entry["judged_by"]:
            case "lattice":
                assert lattices or any(part.startswith(LATTICE_STUDIES) for part in parts), id
            case "solved model":
                assert any(part.startswith("studies.") for part in parts), id
            case other:
                assert other == entry["source"] == "algebra" and entry["kind"] == "arithmetic", id
        for part in lattices:
            sweeps, _, quantities = part.partition(":")
            assert {*sweeps.split(", ")} <= {*SIMULATIONS, "every simulation here"}, id
            assert quantities and {*quantities.strip().split(", ")} <= {*QUANTITIES, *OF_RUNS}, id


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
    numbers = ([measure(level, factor) for level in LEVELS] for factor in (1.0, 2.0, 4.0))
    tables = [
        pd.DataFrame({"left": LEVELS, "run_flags": "", "number": number}) for number in numbers
    ]
    if flagged is not None:
        tables[0].loc[flagged, "run_flags"] = "unresolved"
    coarser = [
        table.assign(factor=factor) for table, factor in zip(tables[1:], (2.0, 4.0), strict=True)
    ]
    ends = ["other", "arrested", "arrested", "undecided"]
    found = {
        "sweep": tables[0].assign(
            paper=LEVELS, exact_number=np.array(LEVELS) / 1.1, exact_regime=ends
        ),
        "coarser/sweep": pd.concat(coarser, ignore_index=True),
        "uncertainties/sweep": grid_tables(tuple(tables), (2.0, 4.0), ("left", "run_flags")),
    }
    return Evidence(found, ENTRIES, 0.02)


def exact(found: Evidence):
    return found.exact("equation", found.lattices("sweep")[0], "number", "paper")


def test_an_equation_is_judged_at_spacing_zero_and_one_run_that_is_off_fails_it_unless_it_is_flagged():
    claim = exact(evidence(lambda level, factor: level * (1.0 + 0.002 * factor)))
    assert claim == claim | {"verdict": YES, "runs": 4, "left_out": 0}
    assert claim["deviation"] < 1e-9 and claim["uncertainty"] / claim["predicted"] == pytest.approx(
        0.002
    )
    off = lambda level, factor: level * (1.0 + 1e-4 * factor + 0.05 * (level == 0.6))
    claim = exact(evidence(off))
    assert claim["verdict"] == NO and claim["predicted"] == 0.6
    assert claim["deviation"] == pytest.approx(0.05, rel=0.01)
    assert exact(evidence(off, flagged=2))["verdict"] == YES


def estimate(measure):
    found = evidence(measure)
    return found.approximate("estimate", found.lattices("sweep"), "number", "paper", "left")


def test_an_estimate_is_judged_by_its_median_and_its_exponent_not_by_the_worst_run():
    claim = estimate(lambda level, factor: level * (1.05 + 1e-3 * factor))
    assert claim["verdict"] == YES and claim["measured"] == pytest.approx(1.051)
    assert claim["exponent"] == pytest.approx(1.0, abs=1e-3)
    assert (claim["largest"], claim["uncertainty"]) == pytest.approx((0.051, 1e-3), rel=1e-3)
    assert estimate(lambda level, factor: 1.3 * level)["verdict"] == NO
    claim = estimate(lambda level, factor: level**1.2 * 1.1)
    assert claim["verdict"] == NO and claim["exponent"] == pytest.approx(1.2)
    # Its uncertainty is at least what one level moves it.
    claim = estimate(lambda level, factor: level * (1.15 if level == 0.8 else 1.0))
    assert claim["exponent_uncertainty"] > 0.03


def test_a_run_is_decided_where_two_lattices_agree_or_theory_tells():
    found = evidence(lambda level, factor: level if factor == 1.0 or level != 0.6 else 0.0)
    assert found.agreed("sweep", "left > 0.3", "number > 0.5") == [False, None, True]
    assert found.agreed("sweep", "left > 0.3", "number > 0.5", ends=["arrested"]) == [
        False,
        True,
        True,
    ]
    assert found.agreed("sweep", "left > 0.3", "number > 0.5", ends=["other"]) == [
        False,
        False,
        True,
    ]
    # Where a lattice has not run long enough it is not asked.
    assert found.agreed("sweep", "left > 0.3", "number > 0.5", "left < 0.7") == [False, None, None]
    assert found.agreed("sweep", "left > 0.7", "number > 0.5", "left < 0.7", ["arrested"]) == [None]
    assert agreeing([True, None, False], [True, None, True]) == [True, None, None]
    # A qualitative claim counts them.
    claim = evidence().qualitative([True] * 38 + [None] * 2)
    assert claim == claim | {"runs": 40, "held": 38, "failed": 0, "undecided": 2, "verdict": CAVEAT}
    assert evidence().qualitative([np.bool_(True), np.bool_(False)])["verdict"] == NO
    assert evidence().qualitative([])["verdict"] == NONE


def test_a_claim_is_written_with_its_entry_and_the_theory_beside():
    claim = exact(evidence()) | evidence().compared("sweep", "number")
    found = written("equation", claim, ENTRIES["equation"], "III A")
    assert found["exact_median"] == found["exact_largest"] == pytest.approx(0.1)
    expected = {"id": "equation", "counted": True, "follows_from": [], "tolerance": 0.01}
    assert found == found | expected | {"figure_or_section": "III A", "why": ""}
    nothing = evidence().approximate(
        "estimate", [pd.DataFrame({"a": [np.nan], "b": 1.0})], "a", "b"
    )
    found = written("estimate", nothing, ENTRIES["estimate"], "")
    assert found["verdict"] == NONE and found["measured"] is None and not found["counted"]
    json.dumps(found, allow_nan=False)


def test_what_is_missing_is_named(tmp_path):
    texts = {
        "none": {"numbers": [{"table": "sweep", "where": "left > 1", "take": {"a": "left.max()"}}]}
    }
    texts = {"some": {"numbers": [{"table": "sweep", "take": {"a": "left.max()"}}]}} | texts
    written = findings(
        evidence(), 0.1, {id: entry | {"text": "{{ n.a }}"} for id, entry in texts.items()}
    )
    assert [finding["text"] for finding in written] == ["0.800", "not measured"]
    path, other = tmp_path / "claims.yaml", {"tolerance": 0.2}
    path.write_text("claims: {one: {tolerance: 0.1}}\n", encoding="utf-8")
    assert read_entries(path, {"one": other})["claims"]["one"] == other
    with pytest.raises(ValueError, match=r"claims\.on: unknown claim.*'one'.*; allowed: those in"):
        read_entries(path, {"on": other})


CLAIM = {
    "id": "one", "kind": "exact", "verdict": "not reproduced", "predicted": 1.0, "measured": 1.25, "uncertainty": 0.01,
    "tolerance": 0.2, "deviation": 0.25, "note": "", "source": "runs", "further": {}, "why": "", "counted": True,
    "follows_from": [], "flips_at": [], "choices": [],
}  # fmt: skip
ESTIMATE = {"kind": "approximate", "exponent": None, "exact_largest": None, "largest": None}
ALWAYS = {"kind": "qualitative", "held": 4, "failed": 0, "undecided": 0, "runs": 5}
READING = {
    "kind": "reading",
    "predicted": 7.0,
    "measured": 1.62,
    "deviation": 0.98,
    "tolerance": 0.05,
}


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
    texts = reading.predicted_text, reading.measured_text, reading.compared_text
    assert [text(found) for text in texts] == [a, b, c]


def test_a_verdict_that_hangs_on_the_tolerance_says_so():
    sides = {"below": "inconclusive", "above": "reproduced"}
    flips = [sides | {"tolerance": tolerance} for tolerance in (0.1, 0.15, 0.29)]
    found = reading.evidence_text(claim(**ALWAYS, flips_at=flips))
    assert (
        found
        == "with a tolerance below 0.150: inconclusive; with a tolerance above 0.290: reproduced"
    )


def test_what_follows_is_not_counted_again_and_findings_and_further_numbers_are_asked_for_by_name():
    reproduced = {"verdict": "reproduced"}
    follows = reproduced | {"id": "b", "counted": False, "follows_from": ["a"]}
    ledger = reading.Ledger(
        [CLAIM | fields for fields in (reproduced | {"id": "a"}, follows, {"id": "c"})]
    )
    assert ledger.count() == 2 and ledger.count("reproduced") == 1 and ledger.following() == 1
    assert ledger.summary() == "2 claims: 1 reproduced, 1 not reproduced. 1 more follow from these."
    found = [{"id": "ours", "numbers": {"gap": 0.5}}, {"id": "no", "numbers": {}}]
    further = {"apart, 0: arrested": 3.0, "apart, 0: growing": 2.0, "apart": 4.0, "else": 1.0}
    ledger = reading.Ledger([CLAIM | {"further": further}], found)
    assert ledger.listed("one", "apart") == "3 arrested; 2 growing"
    assert ledger.found("ours").gap == 0.5 and ledger.found("no") is None
    with pytest.raises(ValueError, match="finding: 'none'; allowed: ours, no"):
        ledger.found("none")
    with pytest.raises(ValueError, match="claim: 'no'; allowed: one"):
        ledger("no")
