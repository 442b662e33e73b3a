"""The studies show what they claim, in the data that they draw."""

from __future__ import annotations

import numpy as np
import pytest
import tolerances as tol


def off(rows, value, exact):
    """Relative distances of one column from another."""
    return np.abs(rows[value] / rows[exact] - 1.0)


def test_front_speeds_lie_on_their_lines(draw):
    drawn = draw("study_front_speed")
    runs = drawn.table[drawn.table["role"] == "simulation"]
    uniform = runs[runs["panel"] == "prestress"]
    for _, rows in uniform.groupby("release"):
        steady = rows[(rows["left"] >= 0.3) & (rows["damping_ratio"] <= 1.0)]
        assert len(steady) >= 8 and off(steady, "speed", "theory").max() < tol.FRONT_SPEED_STUDY
    # The two rules agree without damping, and differ with it.
    plain = uniform[uniform["damping_ratio"] == 0.0].groupby("release")["speed"]
    total, elastic = (plain.get_group(rule).to_numpy() for rule in ("total", "elastic"))
    assert total == pytest.approx(elastic, rel=tol.FRONT_SPEED_STUDY)
    ids = {line.get_gid() for axes in drawn.figure.axes for line in axes.lines}
    assert {f"theory {ratio:g}" for ratio in uniform["damping_ratio"].unique()} <= ids


def test_leaf_springs_slow_fronts_under_both_rules_down_to_one_block_a_layer(draw):
    drawn = draw("study_front_speed")
    runs = drawn.measured["front_speed_springs"]
    wide = runs[
        runs["run_flags"].isna()
        & (runs["pulse_state"] == "steady")
        & (runs["pulse_width"] >= 4.0 * runs["dx"])
    ]
    assert len(wide) >= 20 and (wide["dx"] == 1.0).sum() >= 10 and wide["release"].nunique() == 2
    assert off(wide, "front_speed_right", "lattice_front_speed_right").max() < 3e-4
    lines = drawn.table[(drawn.table["panel"] == "springs") & (drawn.table["role"] == "theory")]
    for _, line in lines.groupby(["left", "damping_ratio"]):
        assert (np.diff(line.dropna(subset="speed").sort_values("springs")["speed"]) < 0.0).all()


def test_refining_at_fixed_ratio_converges_and_at_fixed_beta_does_not(draw):
    drawn = draw("study_front_speed")
    rows = drawn.table[drawn.table["panel"] == "refined"]
    speeds = rows[rows["role"] == "simulation"].groupby(["held", "release", "fixed"])["speed"]
    spread = {key: np.ptp(group) / group.max() for key, group in speeds}
    assert spread["b", "total", 0.1] < 0.01 and spread["beta", "total", 0.01] > 0.35
    limits = drawn.table[drawn.table["panel"] == "limit"].set_index("fixed")["speed"]
    for beta, line in rows[(rows["held"] == "beta") & (rows["release"] == "elastic")].groupby("fixed"):
        gap = limits[beta] - line[line["role"] == "theory"].sort_values("dx")["speed"]
        assert (gap > 0.0).all() and (np.diff(gap) > 0.0).all(), "from below, ever nearer"
    line = ["held", "release", "fixed", "dx"]
    runs, theory = (rows[rows["role"] == role].round({"dx": 9}) for role in ("simulation", "theory"))
    both = runs.merge(theory, on=line, suffixes=("", "_of_theory"))
    both = both[both["fixed"] == 0.1]
    assert len(both) == 6 and off(both, "speed", "speed_of_theory").max() < 3e-4


def test_pulse_theory_beats_the_paper_where_there_is_damping_and_is_the_limit(draw):
    table = draw("study_pulse_theory").table
    runs = table[table["role"] == "simulation"]
    peaks = runs[(runs["damping_ratio"] > 0.0) & (runs["quantity"] == "peak_velocity")]
    assert (off(peaks, "value", "theory") < off(peaks, "value", "paper")).all()
    assert off(peaks, "value", "paper").max() > 0.1
    for _, line in table[table["role"] == "refined"].groupby("quantity"):
        error = off(line.sort_values("dx"), "value", "theory")
        assert (np.diff(error) > 0.0).all() and error.iloc[0] < 0.3 * error.iloc[-1]


def test_exact_theory_collapses_what_the_paper_scatters_and_is_the_limit(draw):
    table = draw("study_exact_transition").table
    sound = table[(table["role"] == "sweep") & table["run_flags"].isna()]
    refined = table[table["role"] == "refinement"]
    for number in ("transition_time", "transition_length"):
        for _, rows in sound.dropna(subset=number).groupby("boundary"):
            assert (
                off(rows, number, f"exact_{number}").median()
                < 0.25 * off(rows, number, f"paper_{number}").median()
            )
        largest = off(refined, number, f"exact_{number}").groupby(refined["dx"]).max()
        assert (np.diff(largest) > 0.0).all() and largest.iloc[-1] < 0.03


def test_the_time_of_a_fraction_converges_and_the_last_release_is_beyond_it(draw):
    table = draw("study_arrest").table
    runs = table[(table["role"] == "run") & (table["damping_ratio"] > 0.0)]
    by_spacing = off(runs, "fraction_time", "exact_fraction_time").groupby(runs["dx"]).max()
    assert by_spacing.iloc[0] == by_spacing.min()
    assert (runs["last_release"] > runs["fraction_time"]).all()
    for _, path in table[table["role"] == "exact_path"].groupby("damping_ratio"):
        assert (np.diff(path["time"]) > 0.0).all()


def test_pulses_settle_or_grow_or_decay_by_sign(draw):
    table = draw("study_stability_of_pulses").table
    velocity = table[table["role"] == "velocity"]
    for level, rows in velocity.groupby("level"):
        rows = rows[rows["time"] > rows["step"]].sort_values("time")
        change = rows["largest_velocity"].iloc[-1] / rows["largest_velocity"].iloc[0] - 1.0
        assert np.sign(change) == np.sign(level) or level == 0.0


def test_the_exact_pulse_is_steady_beyond_its_memory_and_not_before_and_the_lattice_follows(draw):
    table = draw("study_stability_of_pulses").table
    exact = table[table["role"] == "exact"]
    assert exact["level"].nunique() >= 4 and exact["slip"].notna().all(), "no construction ends early"
    for level, rows in exact.groupby("level"):
        rest, fraction = off(rows, "slip", "steady"), rows["x"] / rows["memory"]
        assert rest[fraction >= 1.0].max() < 1e-8 and (fraction >= 1.0).sum() >= 10
        assert rest[(fraction > 0.5) & (fraction < 0.9)].min() > 1e-4
        assert off(rows[rows["x"] < -5.0], "slip", "steady_before").max() < 1e-8
        lattice = table[(table["role"] == "lattice") & (table["level"] == level)].sort_values("x")
        distance = lattice["slip"] / np.interp(lattice["x"], rows["x"], rows["slip"]) - 1.0
        assert distance.abs().max() < 0.1 and abs(distance.iloc[-1]) < 0.05
