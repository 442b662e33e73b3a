"""One verdict over every choice that the paper leaves open, and where it would change."""

import pytest
import yaml

from slippulse.claims import rules
from slippulse.claims.paper import SIMULATIONS
from slippulse.claims.rules import DEPENDS
from slippulse.claims.transition import over_choices as over_all
from slippulse.measure.quantities import QUANTITIES


def judged(deviation: float, uncertainty: float = 0.0) -> dict:
    def at(tolerance: float) -> str:
        return rules.within(deviation, uncertainty, tolerance)

    return {"verdict": at(0.2), "at": at, "deviation": deviation}


def over_choices(claims: list) -> dict:
    return over_all(claims, lambda claim: claim)


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
