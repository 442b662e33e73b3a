"""The studies show what they claim, in the data that they draw."""

from itertools import product

import numpy as np
import pytest
import tolerances as tol

from slippulse.claims.inference import inference, likely
from slippulse.model.prestress import Prestress
from slippulse.theory.rupture import Rupture
from slippulse.theory.slow_front import barrier_depth, barrier_depth_estimate


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
    steady = runs["run_flags"].isna() & (runs["pulse_state"] == "steady")
    wide = runs[steady & (runs["pulse_width"] >= 4.0 * runs["dx"])]
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
            exact, paper = (off(rows, number, f"{source}_{number}").median() for source in ("exact", "paper"))
            assert exact < 0.25 * paper
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


def test_lattices_tend_to_the_exact_depth(draw):
    table = draw("study_barriers").table
    runs = table[table["part"] == "depth"]
    assert len(runs.groupby(["tau0", "barrier"])) >= 12
    orders = []
    for (*_, ratio), line in runs.groupby(["tau0", "barrier", "gamma", "damping_ratio"]):
        line = line.sort_values("dx")
        assert len(line) == 3
        off = np.abs(line["measured"] / line["exact"] - 1.0).to_numpy()
        assert off[0] < 0.03 and off[0] < off[-1]
        if ratio > 0.0:
            assert (np.diff(off) > 0.0).all()
            orders.append(np.polyfit(np.log(line["dx"]), np.log(off), 1)[0])
    # Depths are whole blocks.
    assert 0.85 < np.median(orders) < 1.15


def test_a_barrier_is_passed_if_and_only_if_it_is_shorter(study):
    rows = study("barriers")
    rows = rows[rows["part"] == "passing"]
    assert (rows["length"] < 1.0).sum() == (rows["length"] > 1.0).sum() >= 24
    assert ((rows["measured"] == 1.0) == (rows["length"] < 1.0)).all()


def test_the_fine_map_is_the_exact_depth(draw):
    table = draw("study_barriers").table
    fine = table[table["part"] == "fine"].iloc[::397]
    for _, row in fine.iterrows():
        exact = barrier_depth(row["tau0"], row["barrier"], 1.0, row["damping_ratio"])
        assert row["exact"] == pytest.approx(exact, rel=5e-3)


def test_depth_falls_with_the_barrier_and_the_estimate_is_short_of_it_at_low_levels(draw):
    table = draw("study_barriers").table
    curves = table[table["part"] == "curve"]
    for (tau0, _), line in curves.groupby(["tau0", "damping_ratio"]):
        line = line.sort_values("barrier")
        assert (np.diff(line["exact"]) > 0.0).all()
        estimate = [barrier_depth_estimate(*row) for row in line[["tau0", "barrier", "gamma"]].to_numpy()]
        assert line["paper"].to_numpy() == pytest.approx(estimate, rel=1e-3)
        if tau0 < 0.3:
            assert (line["paper"] < 0.5 * line["exact"]).all()


def test_every_quantity_converges_at_first_order(draw):
    table = draw("study_exact_solution").table
    lines = table[table["role"] == "difference"].groupby(["scene", "quantity"])
    assert len(lines) == 11, "nothing sticks without leaf springs"
    for _, line in lines:
        line = line.sort_values("dx")
        assert 0.9 < np.polyfit(np.log(line["dx"]), np.log(line["difference"]), 1)[0] < 1.1
        assert (np.diff(line["difference"]) > 0.0).all()
        assert line["difference"].iloc[0] < 0.005
        assert line["places"].min() >= 20


def test_marks_lie_on_the_exact_curves_and_the_trailing_edge_follows_the_front(draw):
    table = draw("study_exact_solution").table
    for _, rows in table[table["role"].isin(["exact", "lattice"])].groupby("scene"):
        exact, lattice = rows[rows["role"] == "exact"], rows[rows["role"] == "lattice"]
        assert (exact["release"].notna() & (exact["slip"] >= 0.0)).all(), "no construction ends early"
        known = exact.dropna(subset="stick")
        assert len(known) > 100 and (known["stick"] > known["release"]).all()
        for quantity in ("release", "stick", "slip"):
            line, marks = exact.dropna(subset=quantity), lattice.dropna(subset=quantity)
            marks = marks[marks["position"].between(line["position"].min(), line["position"].max())]
            off = np.abs(marks[quantity] - np.interp(marks["position"], line["position"], line[quantity]))
            assert off.median() < 0.03 * line[quantity].max()


def test_both_halves_of_the_map_agree(draw):
    table = draw("study_exact_solution").table.copy()
    table["position"] = table["position"].abs().round(6)
    axes = {"index": "time", "columns": "position", "values": "slip_velocity"}
    halves = [
        table[table["role"] == f"map_{source}"].pivot(**axes).fillna(0.0) for source in ("exact", "lattice")
    ]
    exact, lattice = halves[0].align(halves[1], fill_value=0.0)
    assert (exact - lattice).abs().to_numpy().mean() < 0.02 * exact.to_numpy().max()


def test_uniform_prestress_leaves_the_papers_estimate_from_above(study):
    rows = study("gaussian_transition")
    uniform = rows[rows["gamma"].isna()].set_index("left")["over_paper"]
    assert uniform[[0.1, 0.4, 0.9]].to_numpy() == pytest.approx([1.219, 1.206, 1.112], abs=1e-3)
    assert (np.diff(uniform) < 0.0).all()
    peaks = rows.dropna(subset="gamma")
    # The peak brings the transition forward.
    assert (peaks["over_paper"].to_numpy() < uniform[peaks["left"]].to_numpy()).all()


def test_a_weaker_barrier_lets_a_one_way_pulse_come_later_and_farther():
    found = np.empty((3, 3, 3))
    for (row, left), (column, right) in product(enumerate((-1.0, -0.3, -0.1)), enumerate((0.1, 0.5, 0.9))):
        rupture = Rupture(Prestress(left, right), 0.65, 0.1, duration=9.0)
        end = rupture.front_ends[0][0]
        assert end.reason == "stops" and not rupture.limit
        found[row, column] = -end.x, rupture.transition_time, rupture.transition_length
    assert np.isfinite(found).all()
    assert (np.diff(found, axis=0) > 0.0).all()
    assert (np.diff(found[:, :, 1:], axis=1) > 0.0).all()


def test_the_lattice_of_the_space_time_figure_lies_on_the_exact_edges(draw):
    rows = draw("fig04_space_time").table
    rows = rows[rows["panel"] == "displacement"]
    assert not (rows["role"] == "limit").any()
    for lattice, exact in (("front", "exact_front"), ("trailing", "exact_trailing")):
        line = rows[rows["role"] == exact].sort_values("position")
        found = rows[rows["role"] == lattice].dropna(subset="time")
        found = found[found["position"].between(line["position"].min(), line["position"].max())]
        off = found["time"] - np.interp(found["position"], line["position"], line["time"])
        assert len(found) > 100 and np.abs(off).max() < 0.12


def test_numbers_are_the_same_from_the_figures_own_table(draw):
    drawn = draw("study_published_figure")
    again, study = inference(drawn.table), inference(drawn.measured["published_figure"])
    assert again == study
    for release in ("total", "elastic"):
        rows = drawn.table[(drawn.table["part"] == "best") & (drawn.table["release"] == release)]
        assert (rows["pull"] ** 2).sum() == pytest.approx(study[release]["chi2"])
        pulls = [study[release]["pulls"][name] for name in rows["reading"]]
        assert rows["pull"].to_list() == pytest.approx(pulls)


def test_regions_are_drawn_around_the_best_fits_and_curves_as_far_as_accepted(draw):
    drawn = draw("study_published_figure")
    axes = drawn.figure.axes
    for panel, name in zip(axes[1:3], ("tau0", "gamma"), strict=True):
        for release in ("total", "elastic"):
            found = inference(drawn.table)[release]
            patches = {patch.get_gid(): patch for patch in panel.collections}
            outer, inner = (patches[f"{release} {level}"].get_paths()[0].vertices for level in (0.95, 0.68))
            low, high = found["regions"][0.95][name]
            # A joint region of two parameters is wider than that of one.
            assert outer[:, 1].min() < low and outer[:, 1].max() > high
            assert np.ptp(inner[:, 0]) < np.ptp(outer[:, 0])
            assert inner[:, 0].min() < found["damping_ratio"] < inner[:, 0].max()
    assert max(line.get_ydata().max() for line in axes[0].lines if line.get_gid()) <= likely(0.95, 7)


def test_lattices_a_tenth_away_from_the_line_where_pulses_end_are_on_its_exact_side(draw):
    table = draw("study_rate_dependence").table
    runs = table[table["role"] == "lattice"]
    side = (runs["regime"] == "pulse") == (runs["over_critical"].abs() < 1.0)
    assert len(runs) >= 40 and side[(runs["over_critical"].abs() - 1.0).abs() > 0.09].all()
    # Width and slip of those with a pulse, against the exact line.
    steady = table[table["role"] == "steady"].sort_values("rate_strengthening")
    pulses = runs[(runs["level"] == 0.5) & (runs["regime"] == "pulse") & (runs["over_critical"].abs() <= 0.5)]
    for quantity, most in (("pulse_width", 0.05), ("pulse_slip", 0.08)):
        exact = np.interp(pulses["rate_strengthening"], steady["rate_strengthening"], steady[quantity])
        assert (pulses[quantity] / exact - 1.0).abs().max() < most
    # Without leaf springs: the late height is that of diffusion. The right front, its leading edge gone, goes on in
    # jerks, which stand above it for 15 % of t = 20 to 100 at dx = 0.05, for 1 % at 0.025 and never at 0.0125.
    arrest = table[(table["role"] == "arrest") & (table["dx"] == 0.025) & (table["time"] > 20.0)]
    limit, at = table[table["role"] == "asymptote"], ["rate_strengthening", "time"]
    late = arrest[arrest["rate_strengthening"] == 0.5].merge(limit, on=at, suffixes=("", "_limit"))
    assert (late["largest_velocity"] / late["largest_velocity_limit"]).between(0.8, 1.1).all()
