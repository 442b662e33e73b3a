"""The rule of each kind of claim, on made-up numbers; one verdict over every choice that the paper leaves open."""

import pytest
import yaml

from slippulse.claims import rules
from slippulse.claims.paper import SIMULATIONS
from slippulse.claims.rules import VERDICTS, WORST_FIRST
from slippulse.claims.transition import over_choices
from slippulse.model.quantities import QUANTITIES

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


def judged(deviation: float, uncertainty: float = 0.0) -> dict:
    def at(tolerance: float) -> str:
        return rules.within(deviation, uncertainty, tolerance)

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
    sides = "holds at 0 (13.6 %)", "fails at 0.058 (20.4 %)", "holds at elastic (15.6 %)", "total (23.5 %)"
    assert all(side in claim["why"] for side in sides)
    found = rules.flips(claim["at"], 0.2)
    assert [(flip["below"], flip["above"]) for flip in found] == [
        ("not reproduced", DEPENDS), (DEPENDS, "reproduced")
    ]  # fmt: skip
    assert [flip["tolerance"] for flip in found] == pytest.approx([0.136, 0.235], rel=1e-3)


def test_one_verdict_at_every_choice_is_the_verdict():
    assert over_choices(LENGTHS[1::2])["verdict"] == "reproduced" and "why" not in over_choices(LENGTHS[1::2])
    assert over_choices(LENGTHS[0::2])["verdict"] == "not reproduced"
    unsure = over_choices([(at("total", 0.0), judged(0.19, 0.05)), *LENGTHS[3:]])
    assert unsure["verdict"] == "reproduced with caveat" and "0" in unsure["why"]
    assert rules.flips(judged(0.1)["at"], 0.0) == []


def test_no_claim_compares_a_function_with_itself(project):
    """Each is judged by measured numbers of lattices, by the solved model, or is algebra."""
    claims = yaml.safe_load((project / "manuscript/claims.yaml").read_text(encoding="utf-8"))["claims"]
    for id, entry in claims.items():
        parts = [part.strip() for part in entry["source"].split(";")]
        lattices = [
            part for part in parts if not part.startswith(("studies.", "predictions:", "algebra", "a run"))
        ]
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
