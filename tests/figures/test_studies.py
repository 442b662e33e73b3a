"""The studies show what they claim, in the data that they draw."""

import numpy as np
import pandas as pd
import pytest
import tolerances as tol
from matplotlib.lines import Line2D
from selection import small_sweep

import slippulse as sp
from slippulse.measurement.inference import chi_square_rise, infer_parameters
from slippulse_paper.studies import arrest_path

deviation = lambda rows, value, exact: np.abs(rows[value] / rows[exact] - 1.0)
rises = lambda values: bool((np.diff(values) > 0.0).all())
order = lambda line, error: np.polyfit(np.log(line["dx"]), np.log(error), 1)[0]


def select(table, **values):
    """Return the rows that have these values in these columns."""
    for column, value in values.items():
        table = table[table[column] == value]
    return table


def between(marks, line, value: str, along: str = "position"):
    """Return the distances of markers from a line, where the line is defined."""
    line, marks = line.dropna(subset=value).sort_values(along), marks.dropna(subset=value)
    marks = marks[marks[along].between(line[along].min(), line[along].max())]
    return np.abs(marks[value] - np.interp(marks[along], line[along], line[value]))


def test_front_speeds_lie_on_their_lines_and_leaf_springs_slow_fronts_down(draw):
    drawn = draw("study_front_speed")
    uniform = select(drawn.table, role="simulation", panel="prestress")
    for _, rows in uniform.query("left >= 0.3 and damping_ratio <= 1").groupby("release"):
        assert len(rows) >= 8 and deviation(rows, "speed", "theory").max() < tol.FRONT_SPEED_STUDY
    ids = {line.get_gid() for line in drawn.figure.findobj(Line2D)}
    ratios = [f"{ratio:g}" for ratio in np.sort(uniform["damping_ratio"].unique())]
    assert {f"theory {ratio}" for ratio in ratios} <= ids
    # Ratios whose runs are all flagged have an entry, too.
    (legend,) = drawn.figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ratios
    # Leaf springs, under both rules.
    steady = select(drawn.measured["front_speed_springs"], pulse_state="steady")
    wide = steady[(steady["pulse_width"] >= 4.0 * steady["dx"]) & steady["run_flags"].isna()]
    assert len(wide) >= 20 and (wide["dx"] == 1.0).sum() >= 10 and wide["release"].nunique() == 2
    assert deviation(wide, "front_speed_right", "lattice_front_speed_right").max() < 3e-4
    lines = select(drawn.table, panel="springs", role="theory").sort_values("springs")
    lines = lines.dropna(subset="speed")
    assert all(rises(-line["speed"]) for _, line in lines.groupby(["left", "damping_ratio"]))


def test_refining_at_fixed_ratio_converges_and_at_fixed_beta_does_not(draw):
    table = draw("study_front_speed").table
    rows = select(table, panel="refined").sort_values("dx").round({"dx": 9})
    runs, theory = (select(rows, role=role) for role in ("simulation", "theory"))
    speeds = runs.groupby(["held", "release", "fixed"])["speed"]
    spread = {key: np.ptp(group) / group.max() for key, group in speeds}
    assert spread["b", "total", 0.1] < 0.01 and spread["beta", "total", 0.01] > 0.35
    limits = select(table, panel="limit").set_index("fixed")["speed"]
    for beta, line in select(theory, held="beta", release="elastic").groupby("fixed"):
        gap = limits[beta] - line["speed"]
        assert (gap > 0.0).all() and rises(gap)
    both = runs.merge(theory, on=["held", "release", "fixed", "dx"], suffixes=("", "_of_theory"))
    both = select(both, fixed=0.1)
    assert len(both) == 6 and deviation(both, "speed", "speed_of_theory").max() < 3e-4


def test_pulse_theory_beats_the_paper_where_there_is_damping_and_is_the_limit(draw):
    table = draw("study_pulse_theory").table
    peaks = select(table, role="simulation", quantity="peak_velocity").query("damping_ratio > 0")
    assert (deviation(peaks, "value", "theory") < deviation(peaks, "value", "paper")).all()
    assert deviation(peaks, "value", "paper").max() > 0.1
    for _, line in select(table, role="refined").sort_values("dx").groupby("quantity"):
        error = deviation(line, "value", "theory")
        assert rises(error) and error.iloc[0] < 0.3 * error.iloc[-1]


def test_exact_theory_collapses_what_the_paper_scatters_and_is_the_limit(draw):
    table = draw("study_exact_transition").table
    sound = select(table[table["run_flags"].isna()], role="sweep")
    refined = select(table, role="refinement")
    for number in ("transition_time", "transition_length"):
        for _, rows in sound.dropna(subset=number).groupby("boundary"):
            exact = deviation(rows, number, f"exact_{number}").median()
            assert exact < 0.25 * deviation(rows, number, f"paper_{number}").median()
        largest = deviation(refined, number, f"exact_{number}").groupby(refined["dx"]).max()
        assert rises(largest) and largest.iloc[-1] < 0.03
    # The peak brings the transition forward.
    gaussian = select(table, role="gaussian")
    peaks = gaussian.dropna(subset="gamma")
    uniform = gaussian[gaussian["gamma"].isna()].set_index("left")["over_paper"]
    assert (np.diff(uniform) < 0.0).all()
    assert (peaks["over_paper"].to_numpy() < uniform[peaks["left"]].to_numpy()).all()


def test_the_time_of_a_fraction_converges_and_the_last_release_is_beyond_it(draw):
    table = draw("study_arrest").table
    runs = select(table, role="run").query("damping_ratio > 0")
    by_spacing = deviation(runs, "fraction_time", "exact_fraction_time").groupby(runs["dx"]).max()
    assert by_spacing.iloc[0] == by_spacing.min()
    assert (runs["last_release"] > runs["fraction_time"]).all()
    paths = select(table, role="exact_path").groupby("damping_ratio")
    assert all(rises(path["time"]) for _, path in paths)


def test_pulses_change_by_the_sign_of_the_level_and_are_steady_only_beyond_their_memory(draw):
    table = draw("study_stability_of_pulses").table
    velocity = select(table, role="velocity").sort_values("time")
    for level, rows in velocity[velocity["time"] > velocity["step"]].groupby("level"):
        first, *_, last = rows["largest_velocity"]
        assert np.sign(last / first - 1.0) == np.sign(level) or level == 0.0
    exact = select(table, role="exact")
    assert exact["level"].nunique() >= 4 and exact["slip"].notna().all()
    for level, rows in exact.groupby("level"):
        difference, fraction = deviation(rows, "slip", "steady"), rows["x"] / rows["memory"]
        assert difference[fraction >= 1.0].max() < 1e-8 and (fraction >= 1.0).sum() >= 10
        assert difference[(fraction > 0.5) & (fraction < 0.9)].min() > 1e-4
        assert deviation(rows[rows["x"] < -5.0], "slip", "steady_before").max() < 1e-8
        lattice = select(table, role="lattice", level=level).sort_values("x")
        distance = lattice["slip"] / np.interp(lattice["x"], rows["x"], rows["slip"]) - 1.0
        assert distance.abs().max() < 0.1 and abs(distance.iloc[-1]) < 0.05


def test_lattices_tend_to_the_exact_depth_which_the_estimate_falls_short_of_at_low_levels(draw):
    table = draw("study_barriers").table
    runs = select(table, part="depth").sort_values("dx")
    assert len(runs.groupby(["tau0", "barrier"])) >= 12
    orders = []
    for (*_, ratio), line in runs.groupby(["tau0", "barrier", "gamma", "damping_ratio"]):
        error = deviation(line, "measured", "exact")
        assert len(line) == 3 and error.iloc[0] < min(0.03, error.iloc[-1])
        if ratio > 0.0:
            assert rises(error)
            orders.append(order(line, error))
    # Depths are whole blocks.
    assert 0.85 < np.median(orders) < 1.15
    for _, row in select(table, part="fine").iloc[::397].iterrows():
        exact = sp.theory.barrier_depth(row["tau0"], row["barrier"], 1.0, row["damping_ratio"])
        assert row["exact"] == pytest.approx(exact, rel=5e-3)
    curves = select(table, part="curve").sort_values("barrier")
    for (tau0, _), line in curves.groupby(["tau0", "damping_ratio"]):
        assert rises(line["exact"])
        parameters = line[["tau0", "barrier", "gamma"]].to_numpy()
        estimate = [sp.theory.barrier_depth_estimate(*row) for row in parameters]
        assert line["paper"].to_numpy() == pytest.approx(estimate, rel=1e-3)
        assert tau0 >= 0.3 or (line["paper"] < 0.5 * line["exact"]).all()


def test_a_barrier_is_passed_if_and_only_if_it_is_shorter(study):
    rows = select(study("barriers"), part="passing")
    assert (rows["length"] < 1.0).sum() == (rows["length"] > 1.0).sum() >= 24
    assert ((rows["measured"] == 1.0) == (rows["length"] < 1.0)).all()


def test_every_quantity_converges_at_first_order_to_the_exact_curves(draw):
    table = draw("study_exact_solution").table
    lines = select(table, role="difference").sort_values("dx").groupby(["scene", "quantity"])
    assert len(lines) == 11, "nothing sticks without leaf springs"
    for _, line in lines:
        assert 0.9 < order(line, line["difference"]) < 1.1
        assert rises(line["difference"]) and line["difference"].iloc[0] < 0.005
        assert line["places"].min() >= 20
    # Marks lie on the curves, and the trailing edge follows the front.
    for scene, exact in select(table, role="exact").groupby("scene"):
        assert (exact["release"].notna() & (exact["slip"] >= 0.0)).all()
        known = exact.dropna(subset="stick")
        assert len(known) > 100 and (known["stick"] > known["release"]).all()
        for quantity in ("release", "stick", "slip"):
            distance = between(select(table, role="lattice", scene=scene), exact, quantity)
            assert distance.median() < 0.03 * exact[quantity].max()
    # Both halves of the map agree.
    table = table.assign(position=table["position"].abs().round(6))
    axes = {"index": "time", "columns": "position", "values": "slip_velocity"}
    exact = select(table, role="map_exact").pivot(**axes).fillna(0.0)
    lattice = select(table, role="map_lattice").pivot(**axes).fillna(0.0)
    exact, lattice = exact.align(lattice, fill_value=0.0)
    assert (exact - lattice).abs().to_numpy().mean() < 0.02 * exact.to_numpy().max()


def test_the_lattice_of_the_space_time_figure_lies_on_the_exact_edges(draw):
    rows = select(draw("fig04_space_time").table, panel="displacement")
    for lattice, exact in (("front", "exact_front"), ("trailing", "exact_trailing")):
        distance = between(select(rows, role=lattice), select(rows, role=exact), "time")
        assert len(distance) > 100 and distance.max() < 0.12


def test_numbers_are_those_of_the_figures_own_table_and_regions_are_around_the_best_fits(draw):
    drawn = draw("study_published_figure")
    fits, axes = infer_parameters(drawn.measured["published_figure"]), drawn.figure.axes
    for release in ("total", "elastic"):
        fit, rows = fits[release], select(drawn.table, part="best", release=release)
        pulls = [fit["pulls"][name] for name in rows["reading"]]
        assert rows["pull"].to_list() == pytest.approx(pulls)
        for panel, name in zip(axes[1:3], ("tau0", "gamma"), strict=True):
            patches = {patch.get_gid(): patch for patch in panel.collections}
            outer = patches[f"{release} 0.95"].get_paths()[0].vertices
            inner = patches[f"{release} 0.68"].get_paths()[0].vertices
            # A joint region of two parameters is wider than that of one.
            low, high = fit["regions"][0.95]
            assert outer[:, 0].min() < low and outer[:, 0].max() > high
            assert outer[:, 1].min() < fit[name] < outer[:, 1].max()
            assert np.ptp(inner[:, 0]) < np.ptp(outer[:, 0])
            assert inner[:, 0].min() < fit["damping_ratio"] < inner[:, 0].max()
    # Curves are drawn as far as they are accepted.
    highest = max(line.get_ydata().max() for line in axes[0].lines if line.get_gid())
    assert highest <= chi_square_rise(0.95, 7)


def test_lattices_a_tenth_away_from_the_line_where_pulses_cease_to_stick_are_on_its_side(draw):
    table = draw("study_rate_dependence").table
    runs = select(table, role="lattice")
    runs = runs.assign(over_critical=runs["over_critical"].abs())
    # Every rupture is a pulse by the one definition; which one sticks is what the line says.
    assert set(runs["regime"]) == {"sticking pulse", "creeping pulse"}
    side = (runs["regime"] == "sticking pulse") == (runs["over_critical"] < 1.0)
    assert len(runs) >= 40 and side[(runs["over_critical"] - 1.0).abs() > 0.09].all()
    # Width and slip of those with a pulse, against the exact line.
    steady = select(table, role="steady").sort_values("rate_strengthening")
    pulses = select(runs, level=0.5, regime="sticking pulse").query("over_critical <= 0.5")
    for quantity, most in (("pulse_width", 0.05), ("pulse_slip", 0.08)):
        alphas = pulses["rate_strengthening"], steady["rate_strengthening"]
        exact = np.interp(*alphas, steady[quantity])
        assert (pulses[quantity] / exact - 1.0).abs().max() < most
    # Without leaf springs the late height is that of diffusion. The right front, without a leading
    # edge by then, advances in jerks, which exceed that height for 15 % of t = 20 to 100 at
    # dx = 0.05, for 1 % at 0.025 and never at 0.0125.
    late = select(table, role="arrest", dx=0.025, rate_strengthening=0.5).query("time > 20")
    limit = select(table, role="asymptote")
    assert not late["gamma"].any() and not limit["gamma"].any()
    late = late.merge(limit, on=["rate_strengthening", "time"], suffixes=("", "_limit"))
    assert (late["largest_velocity"] / late["largest_velocity_limit"]).between(0.8, 1.1).all()


def test_the_bottom_slides_the_top_is_held_and_nothing_moves_ahead_of_the_fastest_wave(draw):
    field = select(draw("study_layer").table, part="field")
    assert field["velocity"].abs().max() > 1.0
    assert select(field, y=1.0)["velocity"].abs().max() == 0.0
    assert field.query("x > time + 2.1")["velocity"].abs().max() < 0.01


def test_weak_or_slowly_weakening_friction_ends_pulses_that_stick(draw):
    table = draw("study_friction_laws").table
    plane = select(table, role="plane")
    assert (select(plane, law="rate_weakening")["regime"] == "sticking pulse").all()
    # A little strengthening leaves the pulse, and much of it does not.
    grown = select(plane, law="bounded_rate")
    assert (grown[grown["strength"] < 0.55]["regime"] == "sticking pulse").all()
    assert "sticking pulse" not in {*grown[grown["strength"] > 0.85]["regime"]}
    # Exponential weakening costs d_c, more than tau_0^2/(2 gamma) is never paid for.
    costly = select(plane, law="exponential_weakening").query("strength > 0.7")
    assert {*costly["regime"]} == {"no rupture"}
    assert "no rupture" not in {*select(plane, law="slip_weakening")["regime"]}
    # Resolved slip weakening selects the exact front speed.
    runs = select(table, role="selection").dropna(subset=["exact_speed"])
    error = deviation(runs, "speed", "exact_speed")
    assert error[runs["d_c"] >= 3.9 * runs["dx"]].max() < 0.01
    assert error[runs["dx"] == runs["dx"].min()].max() < 1e-3
    exact, keys = select(table, role="theory"), ["law", "level", "strength"]
    cases = select(table, role="case").merge(exact, on=keys, suffixes=("", "_exact"))
    finest = select(cases, dx=0.02, regime="sticking pulse")
    assert len(finest) == 4 and deviation(finest, "pulse_slip", "pulse_slip_exact").max() < 0.006


@pytest.mark.parametrize(
    ("figure", "sweep", "changes"),
    [
        ("study_pulse_theory", "pulse_damping", {"gamma": 0.3}),
        ("study_pulse_theory", "pulse_damping", {"release": "elastic"}),
        ("study_pulse_theory", "continuum_fixed_ratio", {"left": 0.2, "right": 0.2}),
        ("study_arrest", "arrest", {"left": -0.5}),
        ("study_arrest", "arrest", {"release": "elastic"}),
    ],
)
def test_runs_with_other_parameters_than_the_exact_curve_are_not_drawn(
    draw, figure, sweep, changes
):
    drawn = draw(figure)
    runs = drawn.measured[sweep]
    more_runs = pd.concat([runs, runs.assign(**changes)], ignore_index=True)
    options = {"measure": {"fraction": drawn.table.get("fraction", pd.Series([0.0])).max()}}
    tables = [
        drawn.module.table(drawn.data, drawn.measured | {sweep: rows}, options)
        for rows in (runs, more_runs)
    ]
    pd.testing.assert_frame_equal(*tables)


def test_the_exact_path_of_the_left_front_is_that_of_the_first_run_that_stops(shipped):
    sweep = small_sweep(shipped, "arrest") | {"release": ["total", "elastic"]}
    only_first, several = (
        arrest_path.table({}, {}, {"sweeps": {"arrest": sweep | {"left": levels}}})
        for levels in ([-0.75], [0.5, -0.75, -0.5])
    )
    pd.testing.assert_frame_equal(several, only_first)
