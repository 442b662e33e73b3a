"""Claims: the rule of each kind on invented numbers, claims from invented tables, their texts."""

import itertools
import json
from dataclasses import replace
from functools import partial
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from scipy.special import chdtri

from slippulse.measurement.uncertainty import grid_tables
from slippulse.model.measured_columns import RECORD_FOR
from slippulse_paper.claims import rules
from slippulse_paper.claims.choices import LAST_RELEASE_FRACTION, Combination, over_choices
from slippulse_paper.claims.claim_texts import read_entries, read_text
from slippulse_paper.claims.evidence import Evidence, agreed_answers, evaluated, fit_exponent
from slippulse_paper.claims.findings import NO_NUMBER, findings, length_changes_by_damping
from slippulse_paper.claims.kinds import Approximate, Equation, Qualitative, Reading
from slippulse_paper.claims.ledger import Ledger, with_texts
from slippulse_paper.claims.paper_claims import (
    SIMULATIONS,
    all_claims,
    fields_of_claim,
    judge_claim,
)
from slippulse_paper.claims.pulse_claims import (
    PERTURBED,
    UNPERTURBED,
    growth_signs,
    perturbed_pulses_settle,
    thin_layer,
)
from slippulse_paper.claims.rules import VERDICTS, WORST_FIRST, Uncertain
from slippulse_paper.claims.transition_claims import (
    SHOWN_FRACTION,
    divergence,
    exact_runs,
    front_arrest_position,
    judge_rise_with_prestress,
    lattice_runs,
    takes_longer,
    transition_diverges,
    transition_time_underestimated,
)
from slippulse_paper.text.prose import fill

YES, CAVEAT, DEPENDS, UNMET, NO, OPEN, NONE, HOLDS, WITH_CAVEAT, BEYOND = VERDICTS
NAN = float("nan")
KNOWN = [1e-4, 1e-4]
OVER_CHOICES = rules.verdict_over_choices

answers = lambda held, failed, undecided: [True] * held + [False] * failed + [None] * undecided
every = lambda *counts, **fields: Qualitative(decided=answers(*counts), **fields).verdict()
fit = lambda p, degrees: {"chi_square": chdtri(degrees, p), "degrees_of_freedom": degrees}
reading = lambda p, degrees, tolerance: Reading(tolerance=tolerance, **fit(p, degrees)).verdict()


def equation(
    deviations: list[float], uncertainties: list[float], tolerance: float
) -> tuple[str, float | None]:
    """The verdict on an equation that predicts 1, and the value that decides."""
    measured = 1.0 + np.array(deviations)
    numbers = {"predicted": np.ones_like(measured), "uncertainty": np.array(uncertainties)}
    fields = Equation(tolerance=tolerance, measured=measured, **numbers).fields()
    return fields["verdict"], fields.get("measured")


# A rule, its arguments (a tolerance where it takes one), and the verdict.
CASES = {
    "number: well within": (rules.verdict_on_number, (0.001, 0.0001, 0.01), YES),
    "number: just within": (rules.verdict_on_number, (0.0095, 0.001, 0.01), CAVEAT),
    "number: just outside": (rules.verdict_on_number, (0.0105, 0.001, 0.01), CAVEAT),
    "number: well outside": (rules.verdict_on_number, (0.02, 0.001, 0.01), NO),
    "number: badly known, but too far off": (rules.verdict_on_number, (0.05, 0.02, 0.01), NO),
    "number: badly known, within": (rules.verdict_on_number, (0.001, 0.02, 0.01), OPEN),
    "number: badly known, outside": (rules.verdict_on_number, (0.025, 0.02, 0.01), OPEN),
    "number: no deviation": (rules.verdict_on_number, (NAN, 0.001, 0.01), NONE),
    "number: no uncertainty": (rules.verdict_on_number, (0.001, NAN, 0.01), NONE),
    "equation: the farthest off decides": (equation, ([0.02, 0.03], KNOWN, 0.01), (NO, 1.03)),
    "equation: a failure is not hidden": (equation, ([0.001, 0.02], [0.5, 1e-4], 0.01), (NO, 1.02)),
    "equation: badly known": (equation, ([0.001, 0.002], [0.02, 1e-4], 0.01), (OPEN, 1.001)),
    "equation: one without a number": (equation, ([NAN, 0.002], KNOWN, 0.01), (YES, 1.002)),
    "equation: no number": (equation, ([NAN], [1e-4], 0.01), (NONE, None)),
    "choices: all hold": (OVER_CHOICES, ([YES, YES, YES],), YES),
    "choices: a caveat": (OVER_CHOICES, ([YES, CAVEAT, NONE],), CAVEAT),
    "choices: one open": (OVER_CHOICES, ([OPEN, YES],), OPEN),
    "choices: one fails": (OVER_CHOICES, ([YES, YES, NO],), DEPENDS),
    "choices: one of each": (OVER_CHOICES, ([CAVEAT, NO, OPEN],), DEPENDS),
    "choices: none holds": (OVER_CHOICES, ([NO, NO, OPEN],), NO),
    "choices: no numbers": (OVER_CHOICES, ([NONE, NONE],), NONE),
    "worst: open": (rules.worst, ([YES, OPEN, CAVEAT],), OPEN),
    "worst: failed": (rules.worst, ([YES, NO, OPEN],), NO),
    "worst: none": (rules.worst, ([],), NONE),
    "every: all hold": (every, (40, 0, 0), YES),
    "every: under a condition": (partial(every, has_caveat=True), (40, 0, 0), CAVEAT),
    "every: few undecided": (every, (36, 0, 4), CAVEAT),
    "every: many undecided": (every, (35, 0, 5), OPEN),
    "every: all undecided": (every, (0, 0, 3), OPEN),
    "every: one against": (every, (39, 1, 0), NO),
    "every: one against, many open": (every, (10, 1, 29), NO),
    "every: no runs": (every, (0, 0, 0), NONE),
    "premise: all hold": (partial(every, failing=UNMET), (2, 0, 0), YES),
    "premise: one against": (partial(every, failing=UNMET), (1, 1, 0), UNMET),
    "reading: likely": (reading, (0.5, 7, 0.05), YES),
    "reading: unlikely": (reading, (0.04, 7, 0.05), NO),
    "reading: too few readings": (reading, (0.5, 1, 0.05), OPEN),
    "reading: no fit": (reading, (NAN, 7, 0.05), NONE),
}
ESTIMATED = {"kind": "approximate", "tolerance": 0.2, "earlier_tolerance": 0.01, "sentences": []}
ENTRIES = {"equation": {"kind": "exact", "tolerance": 0.01, "sentences": ["a"]}}
ENTRIES["estimate"] = ESTIMATED | {"follows_from": ["equation"]}
LEVELS = [0.2, 0.4, 0.6, 0.8]


@pytest.mark.parametrize(("rule", "arguments", "verdict"), CASES.values(), ids=CASES)
def test_the_verdict_of_each_rule(rule, arguments, verdict):
    assert rule(*arguments) == verdict


def estimated(
    release: str, ratio: float, deviation: float, uncertainty: float = 0.0, **others
) -> Combination:
    """An estimate at one release rule and damping ratio, by the exact solution."""
    choice = {"release": release, "damping_ratio": ratio, "solution": "exact"} | others
    numbers = {"deviations": np.array([0.0]), "median": Uncertain(deviation, uncertainty)}
    claim = Approximate(tolerance=0.2, template_values={"reason": ""}, **numbers)
    return Combination(choice, claim)


# The length of the transition under leaf springs, as the exact theory has it.
KNOWN_LENGTHS = [("total", 0.1, 0.235), ("total", 0.0, 0.136)]
KNOWN_LENGTHS += [("total", 0.058, 0.204), ("elastic", 0.1, 0.156)]
LENGTHS = [estimated(*known) for known in KNOWN_LENGTHS]


@pytest.fixture(scope="module")
def over_all(project):
    """A claim judged over choices, as JSON has it, with the sentences on all such claims."""
    common = read_text(project / "manuscript/claims.yaml")["over_choices"]
    entry = ESTIMATED | {"why": "{{ runs }} runs.", "doubt": "{{ unsure.reason }}"}

    def write(combinations: list[Combination]) -> dict:
        return fields_of_claim("length", over_choices(combinations), entry, "", common)

    return write


def test_a_claim_that_fails_at_some_choices_depends_on_the_one_that_moves_it_most(over_all):
    claim = over_all(LENGTHS)
    assert (claim["verdict"], claim["choice"]) == (DEPENDS, "damping_ratio")
    assert (claim["holds_at"], claim["combinations"]) == (2, 4)
    start = "1 runs. The claim holds at 2 of 4 combinations of open choices, with deviations up to"
    rest = "The claim fails at the other combinations, with deviations of 20 % or more."
    assert claim["why"].startswith(f"{start} 16 %. {rest}")
    sides = ("holds for 0 (off by 13.6 %)", "fails for 0.058 (off by 20.4 %)")
    sides += ("holds for *elastic* (off by 15.6 %)", "fails for *total* (off by 23.5 %)")
    assert all(side in claim["why"] for side in sides)
    flips = [("not reproduced", DEPENDS), (DEPENDS, "reproduced")]
    assert [(flip["below"], flip["above"]) for flip in claim["flips_at"]] == flips
    tolerances = [flip["tolerance"] for flip in claim["flips_at"]]
    assert tolerances == pytest.approx([0.136, 0.235], rel=1e-3)


def test_the_last_release_of_a_lattice_decides_nothing_and_is_reported(over_all):
    last = [estimated(*known, fraction=LAST_RELEASE_FRACTION) for known in KNOWN_LENGTHS]
    claim = over_all(last)
    assert claim["verdict"] == DEPENDS and claim["choice"] == "" and "depends" not in claim["why"]
    reported = "The deviation at the last release is 14 % to 24 %"
    assert reported in claim["why"] and "last release" not in over_all(LENGTHS)["why"]


def test_one_verdict_at_every_choice_is_the_verdict(over_all):
    assert sorted(WORST_FIRST) == sorted(VERDICTS)
    held = over_all(LENGTHS[1::2])
    assert held["verdict"] == "reproduced" and held["why"] == "1 runs."
    assert over_choices(LENGTHS[0::2]).verdict() == "not reproduced"
    unsure = estimated("total", 0.0, 0.19, 0.05)
    reasons = {
        "": "the claim is within the tolerance, but the deviation plus its uncertainty is not",
        "so": "so",
    }
    for reason, words in reasons.items():
        doubted = replace(unsure, claim=replace(unsure.claim, template_values={"reason": reason}))
        claim = over_all([doubted, *LENGTHS[3:]])
        assert claim["verdict"] == "reproduced with caveat" and "doubt" not in claim
        choices = r"the release rule *total* and the damping ratio $\beta/\Delta x$ = 0"
        assert claim["why"] == f"With {choices}, {words}."


def test_each_claim_of_the_texts_has_a_judge_and_each_judge_a_text():
    with pytest.raises(ValueError, match=r"claims: .*estimate, .*thin_layer.*; allowed: the same"):
        all_claims(evidence(), {}, [])


@pytest.mark.parametrize(
    ("rule", "reason"),
    [
        ({"sweep": ["sweep"]}, "unexpected keyword argument 'sweep'"),
        ({"sweeps": ["sweeps"], "holds": "left > 0"}, "'sweeps'"),
        ({"sweeps": ["sweep"], "holds": "lef > 0"}, "name 'lef' is not defined"),
        ({"sweeps": ["sweep"], "holds": "left >"}, "invalid syntax"),
    ],
)
def test_a_rule_that_fails_is_named(rule, reason):
    entries = {"always": {"kind": "qualitative", "tolerance": 0.0, "rule": rule}}
    tables = evidence()
    tables.entries = entries
    with pytest.raises(ValueError, match=f"claims: rule of always: .*{reason}.*; allowed: the"):
        judge_claim(tables, "always")


def test_a_claim_without_a_number_names_the_flagged_runs(monkeypatch):
    monkeypatch.setattr("slippulse_paper.claims.paper_claims.JUDGES_BY_CLAIM", {})
    source = {"kind": "qualitative", "source": "sweep: number; predictions: exact_regime"}
    entry = source | {"tolerance": 0.0, "sentences": []}
    rule = {"sweeps": ["sweep"], "holds": "left > 0", "where": "left > 1"}
    tables = evidence(flagged=2)
    tables.entries = {"always": entry | {"rule": rule}}
    monkeypatch.setattr(tables, "assign", lambda *_: None)
    nothing = "This run has no number that could be judged."
    [claim] = all_claims(tables, {}, [])
    assert claim["verdict"] == NONE
    assert claim["why"] == f"{nothing} 1 of 4 runs of sweep are flagged (unresolved)" + (
        " and therefore not used."
    )
    assert evidence().sentence_on_flags(entry["source"]) == ""


def test_no_claim_compares_a_function_with_itself(project):
    """Each is judged by measured numbers of lattices, or by the solved model."""
    claims = read_text(project / "manuscript/claims.yaml")["claims"]
    # Studies that simulate by themselves.
    simulating = ("studies.rate_dependence", "studies.layer", "studies.rough_prestress")
    for id, entry in claims.items():
        parts = [part.strip() for part in entry["source"].split(";")]
        lattices = [part for part in parts if not part.startswith(("studies.", "predictions:"))]
        judges = {
            "lattice": lattices or any(part.startswith(simulating) for part in parts),
            "solved model": any(part.startswith("studies.") for part in parts),
        }
        assert judges[entry["judged_by"]], id
        for part in lattices:
            sweeps, _, quantities = part.partition(":")
            assert {*sweeps.split(", ")} <= {*SIMULATIONS}, id
            assert quantities and {*quantities.strip().split(", ")} <= {*RECORD_FOR, "regime"}, id


def evidence(measure=lambda level, factor: level, flagged: int | None = None) -> Evidence:
    """One sweep over four levels, measured as a function of level and spacing, and predicted."""
    tables = []
    for factor in (1.0, 2.0, 4.0):
        numbers = [measure(level, factor) for level in LEVELS]
        tables.append(pd.DataFrame({"left": LEVELS, "run_flags": "", "number": numbers}))
    if flagged is not None:
        tables[0].loc[flagged, "run_flags"] = "unresolved"
    coarser = [tables[1].assign(factor=2.0), tables[2].assign(factor=4.0)]
    ends = ["other", "arrested", "arrested", "undecided"]
    exact = np.array(LEVELS) / 1.1
    named = {
        "sweep": tables[0].assign(paper=LEVELS, exact_number=exact, exact_regime=ends),
        "coarser/sweep": pd.concat(coarser, ignore_index=True),
        "uncertainties/sweep": grid_tables(tuple(tables), (2.0, 4.0), ("left", "run_flags")),
    }
    return Evidence(named, ENTRIES, 0.02, {})


def test_an_equation_is_judged_at_spacing_zero_and_fails_by_one_run_that_is_not_flagged():
    def exact(*measured, **flagged):
        sweep = evidence(*measured, **flagged)
        return sweep.equation("equation", sweep.finest("sweep"), "number", "paper").fields()

    claim = exact(lambda level, factor: level * (1.0 + 0.002 * factor))
    assert claim == claim | {"verdict": YES, "runs": 4, "left_out": 0}
    assert claim["deviation"] < 1e-9
    assert claim["uncertainty"] == pytest.approx(0.002 * claim["predicted"])
    one_off = lambda level, factor: level * (1.05 if level == 0.6 else 1.0) + 1e-4 * factor * level
    claim = exact(one_off)
    assert claim["verdict"] == NO and claim["predicted"] == 0.6
    assert claim["deviation"] == pytest.approx(0.05, rel=0.01)
    assert exact(one_off, flagged=2)["verdict"] == YES


def test_an_estimate_is_judged_by_its_median_not_by_the_worst_run():
    def estimate(measure):
        sweep = evidence(measure)
        return sweep.approximate("estimate", sweep.lattices("sweep"), "number", "paper").fields()

    good = estimate(lambda level, factor: level * (1.05 + 1e-3 * factor))
    assert good["verdict"] == YES and good["measured"] == pytest.approx(1.051)
    assert (good["largest"], good["uncertainty"]) == pytest.approx((0.051, 1e-3), rel=1e-3)
    assert estimate(lambda level, _: 1.3 * level)["verdict"] == NO


def test_a_scaling_is_judged_by_its_exponent():
    def power(measure):
        lattices = evidence(measure).lattices("sweep")
        columns = {"measured": "number", "predicted": "paper", "varied_columns": ["left"]}
        known = fit_exponent(lattices, **columns)
        measured, uncertainty = map(np.atleast_1d, known)
        numbers = {"predicted": np.ones(1), "measured": measured, "uncertainty": uncertainty}
        return Equation(tolerance=0.1, **numbers, counts={"runs": len(LEVELS)}).fields()

    assert power(lambda level, factor: level * (1.05 + 1e-3 * factor))["verdict"] == YES
    claim = power(lambda level, factor: level**1.2 * 1.1)
    assert claim["verdict"] == NO and claim["measured"] == pytest.approx(1.2)
    # Its uncertainty is at least what one level moves it.
    assert power(lambda level, factor: level * (1.15 if level == 0.8 else 1))["uncertainty"] > 0.03


def test_a_run_is_decided_where_two_lattices_agree_or_theory_tells():
    sweep = evidence(lambda level, factor: level if factor == 1.0 or level != 0.6 else 0.0)
    runs = "sweep", "left > 0.3", "number > 0.5"
    assert sweep.holds_in_runs(*runs) == [False, None, True]
    assert sweep.holds_in_runs(*runs, ends=["arrested"]) == [False, True, True]
    assert sweep.holds_in_runs(*runs, ends=["other"]) == [False, False, True]
    # Where a lattice has not run long enough it is not asked.
    assert sweep.holds_in_runs(*runs, "left < 0.7") == [False, None, None]
    late = "left > 0.7", "number > 0.5", "left < 0.7", ["arrested"]
    assert sweep.holds_in_runs("sweep", *late) == [None]
    assert agreed_answers([True, None, False], [True, None, True]) == [True, None, None]


def test_an_arrest_is_not_testable_if_every_level_would_make_blocks_slide_back():
    choice = {"release": "total", "damping_ratio": 0.1, "nucleation": "tent", "fraction": 0.95}
    times = {"transition_time": 3.0, "paper_transition_time": 2.0}
    lengths = {"transition_length": 3.0, "paper_transition_length": 2.0}
    runs = pd.DataFrame({"left": [-1.0, -2.0], "boundary": "stress", "width": 1.0})
    runs = runs.assign(**choice, **times, **lengths)

    class StrongBarriers:
        tables = dict.fromkeys(("open_choices", "scaling_stress", "damping_stress"), runs)

        def lattices(self, sweep, where):
            return [self.tables[sweep].query(where)]

    claim = transition_time_underestimated(StrongBarriers(), "underestimate")
    assert claim.verdict() == NONE
    assert np.isnan([*claim.json_fields()["further"].values()]).all()


def test_claims_show_exact_runs_with_the_choices_and_the_gaussian_of_figure_5():
    choices = itertools.product(
        ("elastic", "total"), (0.0, 0.1), ("tent", "Gaussian"), (0.5, SHOWN_FRACTION)
    )
    names = ["release", "damping_ratio", "nucleation", "fraction"]
    table = pd.DataFrame(choices, columns=names).assign(boundary="stress", left=-0.5)
    figure_5 = pd.DataFrame({"release": ["total"], "damping_ratio": [0.1]})
    tables = {"open_choices": table, "scaling_stress": figure_5}
    runs = exact_runs(SimpleNamespace(tables=tables), "stress")
    assert len(runs) == len(table)
    assert [runs[0].choice[name] for name in names] == ["total", 0.1, "Gaussian", SHOWN_FRACTION]


def test_a_run_whose_front_has_not_moved_is_undecided():
    runs = pd.DataFrame({"time": [0.0, 2.0, 1.0], "covered": [-0.0, 1.0, 2.0]})
    assert takes_longer([runs]).decided == [None, True, False]
    assert takes_longer([runs, runs.iloc[[0, 1, 1]]]).decided == [None, True, None]
    assert takes_longer([runs], limit=0.5).decided == [None, False, False]


def test_lattice_runs_of_several_release_rules_and_damping_ratios_are_not_mixed():
    lists = {"left": [0.2, 0.4], "release": ["total", "elastic"], "damping_ratio": [0.1, 0.2]}
    finest = pd.MultiIndex.from_product(lists.values(), names=lists).to_frame(index=False)
    runs = lattice_runs([finest, finest.assign(factor=2.0)])
    choices = [(choice["release"], choice["damping_ratio"]) for choice, _ in runs]
    assert choices == [("total", 0.1), ("total", 0.2), ("elastic", 0.1), ("elastic", 0.2)]
    for choice, tables in runs:
        for table in tables:
            assert [*table["left"]] == [0.2, 0.4]
            assert (table["release"] == choice["release"]).all()
            assert (table["damping_ratio"] == choice["damping_ratio"]).all()
    assert lattice_runs([finest.iloc[:0]]) == []


@pytest.mark.parametrize("judge", [front_arrest_position, transition_diverges])
def test_a_claim_is_not_testable_if_all_its_runs_are_flagged(judge):
    columns = ["left", "width", "gamma", "release", "damping_ratio", "factor"]
    columns += ["last_release_distance", "balance_distance", "transition_time", "transition_length"]

    no_runs = pd.DataFrame(columns=columns, dtype=float)
    flagged = SimpleNamespace(
        entries={"claim": {"tolerance_exponent": 0.1}},
        tables={"open_choices": pd.DataFrame({"damping_ratio": [0.1]})},
        tolerance=lambda id: 0.1,
        lattices=lambda *sweeps, where="": [no_runs] * 3,
    )
    flagged.approximate = partial(Evidence.approximate, flagged)
    claim = judge(flagged, "claim")
    assert claim.verdict() == NONE
    assert claim.sentence_values().get("holding", []) == []


def test_a_choice_at_whose_values_a_claim_holds_does_not_decide():
    over = over_choices([estimated("total", 0.1, 0.05), estimated("total", 0.0, 0.06)])
    assert len(over.decisive) == 1 and over.sentence_values()["changes"] == []


def test_runs_that_end_before_the_transition_do_not_show_whether_it_diverges():
    runs = pd.DataFrame({"gamma": [0.1, 0.2, 0.4, 0.8], "transition_time": [9.0, 6.0, 4.0, 3.0]})
    runs["transition_length"] = runs["transition_time"]
    assert divergence(runs).diverges is True
    assert divergence(runs.assign(transition_time=[NAN, NAN, 4.0, 3.0])).diverges is None
    assert divergence(runs.assign(transition_time=NAN)).diverges is None


def test_a_front_that_still_runs_does_not_show_where_it_stops():
    """In the last of four equal runs, the front has not stopped half-way."""
    runs = pd.DataFrame({"width": [1.0, 2.0, 4.0, 4.0], "factor": 2.0, "left": -0.5})
    runs = runs.assign(damping_ratio=0.1, release="total", gamma=0.0, end_time=10.0)
    runs["balance_distance"] = 3.0 * runs["width"]
    runs["last_release_distance"] = runs["balance_distance"] * [1.0, 1.0, 1.0, 0.5]
    runs["last_release_time"] = [2.0, 4.0, 8.0, 9.9]
    entries = {"claim": {"tolerance": 0.1, "tolerance_exponent": 0.1}}
    given = Evidence({"open_choices": pd.DataFrame({"damping_ratio": [0.1]})}, entries, 0.02, {})

    def lattices(*sweeps, where):
        return [runs[evaluated(runs, where)]] * 3

    given.lattices = lattices
    further = front_arrest_position(given, "claim").shown.further
    assert further["smallest measured / predicted distance"] == 1.0


def test_a_qualitative_claim_without_runs_is_not_measured():
    entry = {"kind": "qualitative", "tolerance": 0.0, "sentences": ["a"]}
    entry = fields_of_claim("all", Qualitative(decided=[]), entry, "")
    assert with_texts(entry).measured_text() == "not measured"


def test_a_pulse_is_undecided_without_a_steady_one_and_if_it_has_not_formed():
    same = {"gamma": 0.65, "damping_ratio": 0.1, "exact_pulse_slip": 1.0, "paper_pulse_slip": 1.0}
    same |= {"release": "total", "friction": "coulomb", "scheme": "localised"}
    steady = pd.DataFrame({"left": [0.3, 0.6], "pulse_slip": 1.0}).assign(**same)
    # The slip of this pulse still changes, and the next is a pulse of the continuum.
    young = pd.DataFrame({"left": [0.7], "pulse_slip": 0.9}).assign(**same, slip_variation=0.1)
    exact = young.assign(left=0.8, slip_variation=0.0, scheme="continuum")
    steady = pd.concat([steady.assign(slip_variation=1e-6), young, exact])
    perturbed = pd.DataFrame(
        {
            "beyond": [0.3, 0.6, 0.9, 0.6, 0.6, 0.7, 0.8],
            "pulse_slip": [1.0, 1.1, 1.0, NAN, NAN, 1.0, 1.0],
            # The run of the fourth rupture ends when it is still a crack. The fifth pulse has died.
            "transition_time": [4.0, 4.0, 4.0, NAN, 4.0, 4.0, 4.0],
        }
    )
    tables = {PERTURBED: [perturbed.assign(**same)] * 3, UNPERTURBED: [steady] * 3}
    evidence = SimpleNamespace(
        tolerance=lambda id: 0.01, lattices=lambda *simulations: tables[simulations]
    )
    judged = perturbed_pulses_settle(evidence, "perturbed_pulses_settle")
    assert judged.decided == [True, False, None, None, False, None, None]
    assert judged.further["largest deviation of the slip"] == pytest.approx(0.1)


def test_a_layer_is_neither_thin_nor_thick_in_a_run_without_a_pulse():
    runs = pd.DataFrame({"pulse_width": [10.0, 9.0, NAN], "front_speed_right": 1.1})
    runs = runs.assign(gamma=0.65, damping_ratio=0.1)
    evidence = SimpleNamespace(tolerance=lambda id: 0.1, finest=lambda simulation: runs)
    judged = thin_layer(evidence, "thin_layer")
    assert list(judged.decided) == [True, False, None]


def test_a_fitted_exponent_has_no_sentence_without_runs(project):
    claims = read_entries(project / "manuscript" / "claims.yaml", {})["claims"]
    values = {"measured": None, "uncertainty": None, "deviation": None, "runs": 0}
    assert fill(claims["transition_scaling_stress"]["why"], values).strip() == ""


def test_a_pulse_grows_if_it_changes_more_than_one_of_the_same_width_at_level_zero():
    """In the first pair of runs the second pulse grows more than the first, in the other less."""
    runs = pd.DataFrame({"width": [1.0, 1.0, 2.0, 2.0], "beyond": [0.0, 0.1, 0.0, 0.1]})
    runs["largest_velocity_change"] = [0.01, 0.05, 0.1, 0.05]
    runs["pulse_half_width"] = [1.0, 1.5, 3.0, 2.0]
    same = {"left": -0.5, "right": 0.0, "dx": 0.1, "damping_ratio": 0.1, "release": "total"}
    signs = growth_signs(runs.assign(**same, friction="coulomb", regime="pulse, one-way, steady"))
    assert [*signs["velocity_growth"]] == [0.0, 1.0, 0.0, 0.0]
    assert [*signs["width_growth"]] == [0.0, 1.0, 0.0, -1.0]


def test_growth_is_unknown_without_a_pulse_that_stays_at_level_zero():
    """The second pulse has died, which needs no comparison."""
    runs = pd.DataFrame({"beyond": [0.2, -0.2], "regime": ["pulse, one-way, growing", "arrested"]})
    runs = runs.assign(largest_velocity_change=0.1, pulse_half_width=1.0, width=1.0, left=-0.5)
    runs = runs.assign(right=0.0, dx=0.1, damping_ratio=0.1, release="total", friction="coulomb")
    signs = growth_signs(runs)
    assert [*signs["velocity_growth"].isna()] == [True, False]
    assert [*signs["width_growth"].isna()] == [True, False]


def test_a_sweep_may_have_several_release_rules():
    """A length rises with the level by either rule, and damping changes it by a factor of two."""
    lists = {"left": [0.2, 0.4], "release": ["total", "elastic"], "damping_ratio": [0.0, 0.1]}
    runs = pd.MultiIndex.from_product(lists.values(), names=lists).to_frame(index=False)
    runs = runs.assign(gamma=0.1, width=1.0, dx=0.1)
    runs["transition_length"] = np.where(runs["release"] == "total", 5.0, 3.0) * (
        1.0 + runs["left"]
    )
    runs["transition_length"] *= np.where(runs["damping_ratio"] > 0.0, 2.0, 1.0)

    class Sweeps:
        def finest(self, name):
            return runs

    numbers = length_changes_by_damping(Sweeps())
    assert (numbers["stress_change"], numbers["stress_scenes"]) == (2.0, 4.0)
    # Without undamped runs there is nothing to compare with.
    Sweeps.finest = lambda self, name: runs[runs["damping_ratio"] > 0.0]
    assert length_changes_by_damping(Sweeps()) == {}
    assert judge_rise_with_prestress(runs, "transition_length").decided == [True] * 4


def test_the_extra_verdict_decides_at_every_tolerance():
    """So a claim that fails by its second condition has no tolerance at which it is reproduced."""
    numbers = {"deviations": np.array([0.1]), "median": Uncertain(0.1, 0.001)}
    claim = Approximate(tolerance=0.2, extra_verdict=lambda tolerance: NO, **numbers)
    assert claim.verdict() == NO and claim.flips() == []
    assert replace(claim, failing=BEYOND).verdict() == BEYOND
    lenient = lambda allowed: YES if allowed > 0.3 else OPEN
    claim = Approximate(tolerance=0.2, extra_verdict=lenient, **numbers)
    assert claim.verdict() == OPEN
    assert [flip["above"] for flip in claim.flips()] == [OPEN, YES]


def test_a_claim_is_written_with_its_entry_and_the_theory_beside():
    sweep = evidence()
    claim = sweep.equation("equation", sweep.finest("sweep"), "number", "paper")
    entry = fields_of_claim("equation", claim, ENTRIES["equation"], "III A")
    expected = {"id": "equation", "counted": True, "follows_from": [], "tolerance": 0.01}
    assert entry == entry | expected | {"figure_or_section": "III A", "why": ""}
    failing = replace(claim, extra_verdict=lambda _: NO, counts={"held": 1, "failed": 1})
    entry = fields_of_claim("equation", failing, ENTRIES["equation"], "III A")
    assert (entry["verdict"], entry["held"], entry["failed"]) == (NO, 1, 1)
    beside = sweep.deviation_from_exact("sweep", "number")
    assert beside == pytest.approx((0.1, 0.1))
    table = pd.DataFrame({"a": [np.nan], "b": 1.0})
    nothing = replace(sweep.approximate("estimate", [table], "a", "b"), from_exact=beside)
    entry = fields_of_claim("estimate", nothing, ENTRIES["estimate"], "")
    assert entry["verdict"] == NONE and entry["measured"] is None and not entry["counted"]
    assert (entry["exact_median"], entry["exact_largest"]) == beside
    estimate = sweep.approximate("estimate", sweep.lattices("sweep"), "1.05 * paper", "paper")
    entry = fields_of_claim("estimate", estimate, ENTRIES["estimate"], "")
    assert (entry["verdict"], entry["at_earlier"]) == (YES, NO)
    json.dumps(entry, allow_nan=False)


def test_what_is_missing_is_named(tmp_path):
    row = {"table": "sweep", "take": {"a": "left.max()"}}
    kept = {"numbers": [row], "text": "{{ n.a }}"}
    empty = kept | {"numbers": [row | {"where": "left > 1"}]}
    written = findings(evidence(), 0.1, {"kept": kept, "empty": empty})
    assert [finding["text"] for finding in written] == ["0.800", NO_NUMBER]
    path, changed = tmp_path / "claims.yaml", {"tolerance": 0.2}
    path.write_text("claims: {one: {tolerance: 0.1}}\n", encoding="utf-8")
    assert read_entries(path, {"one": changed})["claims"]["one"] == changed
    with pytest.raises(ValueError, match=r"claims\.on: unknown claim.*'one'.*; allowed: those in"):
        read_entries(path, {"on": changed})


# A claim that is off, as claims.json has it, and the fields in which other kinds differ.
CLAIM = {"id": "one", "kind": "exact", "verdict": NO, "note": "", "source": "runs", "asked": ""}
CLAIM |= {"predicted": 1.0, "measured": 1.25, "uncertainty": 0.01, "deviation": 0.25}
CLAIM |= {"tolerance": 0.2, "further": {}, "why": "", "counted": True, "follows_from": []}
CLAIM |= {"flips_at": [], "choices": [], "at_earlier": "", "beyond": False}
ESTIMATE = {"kind": "approximate", "exact_largest": None, "largest": None}
ESTIMATE |= {"deviation_uncertainty": 0.03}
ALWAYS = {"kind": "qualitative", "predicted": 8.0, "held": 5, "undecided": 2, "tolerance": 0.0}
AGAINST, HELD = ALWAYS | {"failed": 1}, ("all of 8", "5 of 8, 1 against, 2 undecided")
READING = {"kind": "reading", "predicted": 7.0, "measured": 1.62, "tolerance": 0.05}
LIKELY, UNLIKELY = READING | {"deviation": 0.98}, READING | {"deviation": 2e-4}
ZERO = {"predicted": 0.0, "deviation": 0.5, "tolerance": 0.1}
ASKED = {"asked": "some run"}
claim = lambda fields: with_texts(CLAIM | fields)
# Fields of a claim, and the sentence that says why.
WHY = {
    "reproduced": ({"verdict": YES}, ""),
    "equation": ({}, "The deviation is 25 %, tolerance 20 %; the uncertainty is 1 %."),
    "zero predicted": (ZERO, "The deviation is 0.50, tolerance 0.1; the uncertainty is 0.0100."),
    "estimate": (ESTIMATE, "The median deviation is 25 %, tolerance 20 %; the uncertainty is 3 %."),
    "scaling": (
        {"kind": "scaling"},
        "The deviation is 0.25, tolerance 0.2; the uncertainty is 0.0100.",
    ),
    "always": (AGAINST, "The claim holds in 5 of 8 cases (1 against, 2 undecided)."),
    "reading": (UNLIKELY, "The best fit has p = 2.0×10⁻⁴, required at least 0.05."),
    "not testable": ({"verdict": NONE}, "This run has no number that could be judged."),
    "its own reason": ({"why": "It needs a reason."}, "It needs a reason."),
}
# Fields of a claim, and texts: predicted, measured and compared.
NUMBERS = {
    "always": (AGAINST, (*HELD, "no run may contradict")),
    "some": (AGAINST | ASKED, (*HELD, "some run")),
    "also": (ESTIMATE | ASKED, ("1", "1.250(10)", "median 25 %, tolerance 20 %; some run")),
    "reading": (LIKELY, ("7 degrees of freedom", "χ² = 1.62", "p = 0.98, required at least 0.05")),
}


@pytest.mark.parametrize(("fields", "sentence"), WHY.values(), ids=WHY)
def test_one_sentence_says_why(fields, sentence):
    assert claim(fields).why_text() == sentence


@pytest.mark.parametrize(("fields", "texts"), NUMBERS.values(), ids=NUMBERS)
def test_numbers_are_written_in_the_form_of_their_kind(fields, texts):
    judged = claim(fields)
    assert texts == (judged.predicted_text(), judged.measured_text(), judged.compared_text())


def test_a_verdict_that_hangs_on_the_tolerance_says_so():
    sides = {"below": "inconclusive", "above": "reproduced"}
    flips = [sides | {"tolerance": tolerance} for tolerance in (0.1, 0.15, 0.29)]
    text = "with a tolerance below 0.150: inconclusive; with a tolerance above 0.290: reproduced"
    assert claim({"flips_at": flips}).evidence_text() == text


def test_what_follows_is_not_counted_again_and_findings_are_asked_for_by_name():
    others = [{"id": "a", "verdict": "reproduced"}, {"id": "c"}]
    others.append(others[0] | {"id": "b", "counted": False, "follows_from": ["a"]})
    ledger = Ledger([CLAIM | fields for fields in others])
    assert ledger.count() == 2 and ledger.count("reproduced") == 1
    counted = "2 counted claims: 1 reproduced, 1 not reproduced"
    assert ledger.summary() == f"{counted}."
    remark = CLAIM | {"id": "d", "counted": False}
    ledger_with_remark = Ledger([*(CLAIM | fields for fields in others), remark])
    more = "1 further claim, which is not counted, is not reproduced"
    assert ledger_with_remark.summary() == f"{counted}; {more}."
    changed = [{"key": "c", "shipped": OPEN, "here": NO}]
    assert ledger.differences({"a": YES, "b": YES, "c": OPEN}) == changed
    numbers = [{"id": "ours", "numbers": {"gap": 0.5}}, {"id": "no", "numbers": {}}]
    further = {"apart, 0: arrested": 3.0, "apart, 0: growing": 2.0, "apart": 4.0, "else": 1.0}
    ledger = Ledger([CLAIM | {"further": further}], numbers)
    assert ledger.listed("one", "apart") == "3 *arrested*; 2 *growing*"
    assert ledger.listed("one", "apart,\n0") == "3 *arrested*; 2 *growing*"
    assert ledger.listed("one", "else") == "none"
    assert ledger.found("ours").gap == 0.5 and ledger.found("no") is None
    with pytest.raises(ValueError, match="finding: 'none'; allowed: ours, no"):
        ledger.found("none")
    with pytest.raises(ValueError, match="claim: 'no'; allowed: one"):
        ledger("no")


@pytest.mark.parametrize(
    ("counts", "paper", "beyond"),
    [((3, 0, 0), YES, HOLDS), ((19, 0, 1), CAVEAT, WITH_CAVEAT), ((2, 1, 0), NO, BEYOND)],
)
def test_a_claim_beyond_the_paper_holds_but_is_not_reproduced(counts, paper, beyond):
    claim, entry = (
        Qualitative(decided=answers(*counts)),
        ENTRIES["estimate"] | {"kind": "qualitative"},
    )
    assert fields_of_claim("estimate", claim, entry, "")["verdict"] == paper
    other = fields_of_claim("estimate", claim, entry | {"beyond": True}, "")
    assert other["verdict"] == beyond and not other["counted"]
    assert Ledger([other]).summary().startswith("0 counted claims")


@pytest.mark.parametrize("id", ["symmetric_displacement_pulses", "one_way_pulse_displacement"])
def test_a_regime_is_judged_in_its_own_prestress_and_by_long_runs(project, id):
    """One of four runs is in the pre-stress of the claim, and two are too short."""
    rule = read_entries(project / "manuscript" / "claims.yaml", {})["claims"][id]["rule"]
    runs = pd.DataFrame({"left": [0.3, 0.3, -0.3, -0.3], "right": [0.3, -0.3, 0.3, -0.3]})
    runs = runs.assign(paper_transition_time=4.0, gamma=0.6, duration=[5.0, 9.0, 5.0, 9.0])
    assert evaluated(runs, rule["where"]).sum() == 1
    assert [*evaluated(runs, rule["decidable"])] == [False, True, False, True]
