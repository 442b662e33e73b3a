"""Grid studies, the numbers that a promised accuracy covers, and the test whether it is kept."""

import math

import numpy as np
import pandas as pd
import pytest

import slippulse as sp
from slippulse.measurement.promise import (
    REQUIRED_FAST_SIDES,
    covered_numbers,
    judge_promises,
    summarise_promises,
)
from slippulse.measurement.table import PARAMETERS
from slippulse.measurement.uncertainty import grid_study, grid_tables
from slippulse.prediction.comparison import measured_table
from slippulse_paper.figures.shared.main_numbers import scene_numbers
from slippulse_paper.report.scene_page import scene_page

FRACTION = 0.95
COMMON = {"run_flags": "", "damping_ratio": 0.1, "width": 1.0, "peak": 1.0, "dx": 0.1}
COMMON |= {"steps_and_bumps": '{"steps": [], "bumps": []}', "end_time": 20.0}
COMMON |= {"front_intercept_left": 0.0, "front_intercept_right": 0.0, "front_speed_left": 1.2}
BARRIER = {"steps_and_bumps": '{"steps": [], "bumps": [[10.0, -0.6, 1.0]]}'}
FAR_BARRIER = {"steps_and_bumps": '{"steps": [], "bumps": [[30.0, -0.6, 1.0]]}'}
# A table with so many points that the row has only their digest. Left of x = 0 no front ran.
ONLY_RIGHT_FRONT = {"lowest_prestress_left": math.nan, "lowest_prestress_right": 0.4}
ONLY_RIGHT_FRONT |= {"steps_and_bumps": '{"steps": [], "bumps": [], "points": "99 points, 1a2b"}'}
PULSE = COMMON | {"boundary": "displacement", "left": 0.5, "right": 0.5, "beyond": 0.5}
PULSE |= {"front_speed_left": 1.2, "front_speed_right": 1.2, "transition_time": 3.0}
PULSE |= {"pulse_state": "steady", "pulse_width": 2.0, "pulse_acceleration": 1.0}
CRACK = COMMON | {"boundary": "stress", "left": -1.0, "right": 0.0, "beyond": 0.0}
CRACK |= {"front_speed_right": 1.0, "transition_time": 5.0, "largest_velocity": 1.0}
CRACK |= {"transition_state": "resolved"}

# Numbers that are not promised under some boundary, by the beginning of their names, with reasons.
NOT_COVERED = {
    "front_intercept": "a small difference of large numbers",
    "front_speed_error": "an error itself",
    "late_front_speed": "computed from two samples of a front only",
    "pulse": "a position with the lag of the path; under a stress boundary no pulse has a width",
    "trailing_edge": "a position at a stated time",
    ("slip_time", "slip_length"): "its slope vanishes where slip hardly reaches the stated value",
    ("slip_variation", "lattice_noise", "strain_left", "centre"): "near 0",
    ("profile_change", "energy_change"): "near 0",
    "sliding_at_once": "a count of blocks",
    "largest_velocity": "near 0 if a change; under a displacement boundary a pulse may still form",
    "first_stick": "under a stress boundary blocks that stick first may be anywhere",
    "last_release": "the arrest never comes in the continuum",
    "transition_longest_wait": "a wait between two blocks, which shrinks with the spacing",
    "balance_distance": "computed from the pre-stress, no simulation",
    "beyond": "a parameter",
}

# A run, changes of its numbers, some numbers that are then covered, and some that are not.
COVERS = [
    (PULSE, {}, ["front_speed_right", "pulse_width", "transition_time"], ["pulse_acceleration"]),
    (PULSE, {"run_flags": "unresolved_pulse"}, [], ["front_speed_right"]),
    (PULSE, {"pulse_state": "unsteady"}, [], ["pulse_width"]),
    (PULSE, {"pulse_width": math.nan}, [], ["pulse_width"]),
    (PULSE, {"left": -0.1}, ["front_speed_right"], ["front_speed_left"]),
    (PULSE, BARRIER, ["front_speed_left"], ["front_speed_right", "transition_time", "pulse_width"]),
    (PULSE, FAR_BARRIER, ["front_speed_right", "transition_time", "pulse_width"], []),
    (PULSE, {"front_speed_left": math.nan}, ["front_speed_right"], ["transition_time"]),
    (PULSE, ONLY_RIGHT_FRONT, ["front_speed_right", "pulse_width"], ["front_speed_left"]),
    (CRACK, {}, ["transition_time", "largest_velocity"], ["front_speed_right"]),
    (CRACK, {"transition_state": "stalled"}, [], ["transition_time"]),
    (CRACK, {"damping_ratio": 0.0}, ["largest_velocity"], ["transition_time"]),
    (CRACK, {"right": 0.3, "beyond": 0.3}, [], ["largest_velocity"]),
]


@pytest.mark.parametrize(("run", "changed", "covered", "not_covered"), COVERS)
def test_the_expected_numbers_are_covered(run, changed, covered, not_covered):
    names = covered_numbers(run | changed, FRACTION)
    assert names.issuperset(covered) and names.isdisjoint(not_covered)
    assert "transition_time" not in covered_numbers(CRACK, 0.99)


@pytest.fixture(scope="module")
def tables(shipped):
    """Measured tables of one run under each boundary, at three spacings."""
    assert shipped["measure"]["fraction"] == FRACTION
    out = []
    for dx in (0.05, 0.1, 0.2):
        pulse = sp.Scene("displacement", sp.Prestress(0.5, 0.5), 30.0, dx, 0.3, 0.1 * dx)
        crack = sp.Scene("stress", sp.Prestress(-1.0, 0.0), 9.0, dx, beta=0.1 * dx)
        times, x = np.linspace(0.0, 1.0, 10), np.linspace(-20.0, 20.0, 81)
        samples = [sp.Samples(scene.duration * times, x) for scene in (pulse, crack)]
        sweep = sp.run_sweep([pulse, crack], samples, ("fronts", "fields", "samples"))
        out.append(measured_table(sweep, shipped["measure"]))
    return out


@pytest.fixture(scope="module")
def study(tables) -> pd.DataFrame:
    return grid_tables(tuple(tables), (2.0, 4.0), PARAMETERS)


def test_every_measured_number_is_covered_or_has_a_reason_not_to_be(study):
    reasons = tuple(np.hstack([*NOT_COVERED]))
    for boundary, promised in REQUIRED_FAST_SIDES.items():
        rows = study[study["boundary"] == boundary]
        measured = set(rows.loc[rows["value"].notna(), "quantity"])
        assert set(promised) <= measured
        assert [name for name in measured - set(promised) if not name.startswith(reasons)] == []


def test_a_study_judges_each_number_and_counts_the_runs_that_kept_it(tables, study):
    generous, strict = (
        judge_promises(study, tables[0], promise, FRACTION) for promise in (10.0, 1e-9)
    )
    assert set(generous["kept"]) == {"true", ""} and set(strict["kept"]) == {"false", ""}
    pd.testing.assert_series_equal(generous["kept"] == "true", strict["kept"] == "false")
    assert (generous["promised"].notna() == (generous["kept"] != "")).all()
    pd.testing.assert_frame_equal(generous[study.columns], study)
    assert summarise_promises(generous, 10.0) == "accuracy 10: kept in 2 of 2 runs"
    assert summarise_promises(strict, 1e-9).startswith(
        "accuracy 1e-09: kept in 0 of 2 runs; missed by run 0 ("
    )
    relative = (study["uncertainty"] / study["value"].abs())[generous["kept"] != ""]
    middle = float(relative.median())
    between = judge_promises(study, tables[0], middle, FRACTION)["kept"][relative.index]
    assert list(between == "true") == list(relative <= middle)
    # A user-defined spacing promises nothing.
    unknown = judge_promises(study, tables[0], math.nan, FRACTION)
    assert set(unknown["kept"]) == {""} and unknown["promised"].isna().all()
    assert (
        summarise_promises(unknown, math.nan)
        == "the block spacing is user-defined, so no accuracy is promised"
    )
    coarse = tables[2].assign(front_speed_right=math.nan)
    # An unknown uncertainty has not kept its promise.
    study = grid_tables((*tables[:2], coarse), (2.0, 4.0), PARAMETERS)
    study = judge_promises(study, tables[0], 10.0, FRACTION)
    row = study[(study["quantity"] == "front_speed_right") & (study["point"] == 0)]
    assert list(row["kept"]) == ["false"]
    assert "missed by run 0 (error of front_speed_right: inf)" in summarise_promises(study, 10.0)


def test_the_numbers_and_the_page_of_a_scene_carry_the_verdict(tables, study, tmp_path):
    parts = (study, judge_promises(study, tables[0], 10.0, FRACTION))
    first = tables[0].iloc[0]
    plain, promised = (scene_numbers(first, part[part["point"] == 0]) for part in parts)
    assert set(promised.columns) - set(plain.columns) == {"promised", "kept"}
    assert set(promised["kept"]) == {"true"} and set(promised["promised"]) == {10.0}
    pd.testing.assert_frame_equal(promised[plain.columns], plain)
    promised.loc[1, "kept"] = "false"
    promised.loc[2, ["promised", "kept"]] = [math.nan, ""]
    picture = tmp_path / "one.png"
    picture.write_bytes(b"")
    before, after = (scene_page("one", "One", picture, part, {}, "") for part in (plain, promised))
    for text in ("promised accuracy", "10, kept", "10, missed", "not covered"):
        assert text in after and text not in before


@pytest.mark.parametrize("order", [1.0, 2.0, 3.5])
@pytest.mark.parametrize("factors", [(2.0, 4.0), (1.5, 2.0)])
def test_a_power_of_the_spacing_is_recovered(order, factors):
    result = grid_study(tuple(3.0 + 0.2 * factor**order for factor in (1.0, *factors)), factors)
    assert (result.observed_order, result.uncertainty) == pytest.approx((order, 0.2), rel=1e-9)
    assert result.extrapolated == pytest.approx(3.0, rel=1e-12)


def test_without_an_order_the_spread_gives_the_uncertainty():
    result = grid_study((1.0, 1.1, 0.95), (2.0, 4.0))
    assert np.isnan(result.observed_order) and result.extrapolated == 1.0
    assert result.uncertainty == pytest.approx(0.15)
    # Nearer spacings show less of the error: the lowest order, 1/2, scales what they show.
    assert grid_study((1.0, 1.1, 0.95), (1.2, 1.44)).uncertainty == pytest.approx(0.15 / 0.2)
    assert np.isnan(grid_study((1.0, np.nan, 1.0), (2.0, 4.0)).uncertainty)
