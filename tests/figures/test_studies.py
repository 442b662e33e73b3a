"""The studies show what they claim, in the data that they draw."""

from __future__ import annotations

import numpy as np
import pytest
import tolerances as tol

from slippulse.figures import study_stability_of_pulses


def test_front_speed_points_lie_on_their_lines(draw):
    drawn = draw("study_front_speed")
    rows = drawn.table[drawn.table["role"] == "simulation"]
    for rule in ("total", "elastic"):
        steady = rows[(rows["release"] == rule) & (rows["tau0"] >= 0.3) & (rows["damping_ratio"] <= 1.0)]
        assert len(steady) >= 8
        assert np.max(np.abs(steady["speed"] / steady["theory"] - 1.0)) < tol.FRONT_SPEED_STUDY
    # The two rules agree without damping, and differ with it.
    plain = drawn.table[(drawn.table["role"] == "simulation") & (drawn.table["damping_ratio"] == 0.0)]
    total, elastic = (plain[plain["release"] == rule]["speed"].to_numpy() for rule in ("total", "elastic"))
    assert total == pytest.approx(elastic, rel=tol.FRONT_SPEED_STUDY)
    ids = {line.get_gid() for axes in drawn.figure.axes for line in axes.lines}
    assert {f"theory {ratio:g}" for ratio in rows["damping_ratio"].unique()} <= ids


def test_pulse_theory_beats_the_paper_where_there_is_damping(draw):
    table = draw("study_pulse_theory").table
    rows = table[(table["role"] == "simulation") & (table["damping_ratio"] > 0.0)]
    peaks = rows[rows["quantity"] == "peak_velocity"]
    ours = np.abs(peaks["y"] / peaks["theory"] - 1.0)
    papers = np.abs(peaks["y"] / peaks["paper"] - 1.0)
    assert (ours < papers).all()
    assert papers.max() > 0.1


def test_refining_at_fixed_ratio_converges_and_at_fixed_beta_does_not(draw):
    table = draw("study_continuum_limit").table
    speed = table[(table["quantity"] == "front_speed_right") & (table["role"] == "simulation")]
    spread = {
        name: np.ptp(rows.sort_values("dx")["value"]) / rows["value"].iloc[0]
        for name, rows in speed.groupby("series")
    }
    assert spread["fixed ratio, total"] < 0.01
    assert spread["fixed beta, total"] > 0.5
    fixed = table[(table["series"] == "fixed ratio, total") & (table["quantity"] == "transition_time")]
    fixed = fixed.sort_values("dx")
    error = np.abs(fixed["value"] / fixed["theory"] - 1.0).to_numpy()
    assert (np.diff(error) > 0.0).all()


def test_exact_theory_collapses_what_the_paper_scatters(draw):
    table = draw("study_exact_transition").table
    rows = table[(table["role"] == "sweep") & table["run_flags"].isna() & table["measured"].notna()]
    for _, group in rows.groupby(["boundary", "quantity"]):
        papers = np.abs(group["measured"] / group["paper"] - 1.0).median()
        exact = np.abs(group["measured"] / group["exact"] - 1.0).median()
        assert exact < 0.25 * papers


def test_shares_converge_and_the_last_release_is_beyond_them(draw):
    table = draw("study_arrest").table
    shares = table[(table["role"] == "share") & (table["share"] <= 0.9) & (table["damping_ratio"] > 0.0)]
    shares = shares.assign(error=np.abs(shares["y"] / shares["exact"] - 1.0))
    by_spacing = shares.groupby("dx")["error"].max().sort_index().to_numpy()
    assert by_spacing[0] == by_spacing.min()
    arrest = table[table["role"] == "arrest"]
    assert (arrest["y"] > shares["y"].max()).all()


def test_pulses_settle_or_grow_or_decay_by_sign(draw):
    table = draw("study_stability_of_pulses").table
    slip = table[table["role"] == "slip"]
    for _, rows in slip.groupby("level"):
        last = rows.sort_values("x").iloc[-1]
        assert last["y"] == pytest.approx(last["steady"], rel=0.05)
        settled = study_stability_of_pulses.relaxation_length(
            rows["x"].to_numpy(), rows["y"].to_numpy(), rows["y"].iloc[-1]
        )
        assert np.isfinite(settled)
    velocity = table[(table["role"] == "velocity") & (table["left"] == table["left"].min())]
    for level, rows in velocity.groupby("level"):
        rows = rows[rows["x"] > rows["place"]].sort_values("x")
        change = rows["y"].iloc[-1] / rows["y"].iloc[0] - 1.0
        assert np.sign(change) == np.sign(level) or level == 0.0
