"""Every example overlay runs with the preset draft and does what its comment promises."""

from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import tolerances as tol
from pipeline_copy import copy_project, made

from slippulse import Layer, Prestress, theory
from slippulse_paper.configuration.read import read_config, read_overlay

FRICTION = {"static_friction": 0.6, "kinetic_friction": 0.5}


@pytest.fixture(scope="module")
def make(project, tmp_path_factory):
    """Return a function that makes a target with the overlay of an example and returns its path."""
    folder = copy_project(project, tmp_path_factory.mktemp("examples"), link=True)

    def make(name: str, target: str) -> Path:
        overlay = f"config/examples/{name}.yaml"
        made(folder, "--config", "preset=draft", "--", target, overlay=overlay)
        return folder / target

    return make


# A function for each example checks its measured table and the path of its target.
def another_gamma(table, path):
    """A change of gamma changes the size of the pulse and not its speed."""
    assert set(table["gamma"]) == {0.3}
    undamped = table[table["damping_ratio"] == 0.0]
    assert np.allclose(undamped["pulse_slip"], 2.0 * undamped["left"] / 0.3, rtol=tol.DRAFT_SLIP)
    speed = 1.0 / np.sqrt(1.0 - undamped["left"] ** 2)
    assert np.allclose(undamped["front_speed_right"], speed, rtol=tol.DRAFT_SPEED)


def asymmetric_levels(table, path, levels=(0.3, 0.7)):
    for side, level in zip(("left", "right"), levels, strict=True):
        expected = pytest.approx(theory.front_speed(level, 0.1), rel=tol.DRAFT_SPEED)
        assert table[f"front_speed_{side}"][0] == expected


def two_nucleation_sites(table, path):
    asymmetric_levels(table, path, (0.5, 0.5))


def stress_barrier(table, path):
    """The barrier begins near 18. At the end the undisturbed front on the left is beyond 35."""
    speed = pytest.approx(theory.front_speed(0.5, 0.1), rel=tol.DRAFT_SPEED)
    assert table["front_speed_left"][0] == speed
    fronts = pd.read_csv(path.with_suffix(".csv")).query("role == 'front'")
    assert 12.0 < fronts["position"].max() < 22.0 and fronts["position"].min() < -35.0
    assert "A pulse dies in a wide barrier" in path.read_text(encoding="utf-8")


def other_friction(table, path):
    """The page compares its numbers with no theory, since the theory has another friction."""
    assert table["front_speed_right"][0] == pytest.approx(1.0, rel=tol.DRAFT_SPEED)
    law = "<td>slip weakening, d_c = 0.1, nucleation = 2</td>"
    assert law in path.read_text(encoding="utf-8")
    drawn = pd.read_csv(path.with_suffix(".csv")).set_index("role")["series"]
    assert drawn["friction"] == "slip weakening"
    numbers = pd.read_csv(path.with_name("other_friction_numbers.csv"))
    assert np.isfinite(numbers["value"]).all() and numbers["theory"].isna().all()


def exact_scene(table, path):
    """The exact solution is drawn like a run on a lattice."""
    assert table["scheme"][0] == "continuum"
    stops = theory.Rupture(Prestress(-0.5, 0.5), gamma=0.65, duration=12.0).front_ends[0][0].x
    fronts = pd.read_csv(path.with_suffix(".csv")).query("role == 'front'")
    assert fronts["position"].min() == pytest.approx(stops, abs=table["dx"][0])


def elastic_release(table, path):
    """The run of the space-time figure ends before its front is steady."""
    assert set(table["release"]) == {"elastic"}
    elastic, total = (theory.front_speed(0.25, 0.1, rule) for rule in ("elastic", "total"))
    assert table["front_speed_right"][0] < 0.5 * (elastic + total)


def fixed_beta(table, path):
    """The value null has removed the damping ratio."""
    assert set(table["beta"]) == {0.01} and table["damping_ratio"].nunique() == len(table) > 1
    assert table.sort_values("dx")["front_speed_right"].is_monotonic_decreasing


def halved_spacing(table, path):
    assert set(table["dx"]) == {0.02}
    assert table["beta"][0] == pytest.approx(0.002)


def user_defined_sweep(table, path):
    """Without a target error, the grid study does not mention one."""
    measured = pd.read_csv(path.parents[1] / "measurements/user_defined_sweep.csv")
    assert len(measured) == 12 and np.isfinite(measured["pulse_slip"]).all()
    assert table.columns[-1] == "uncertainty"
    log = path.parents[1] / "logs/study_grid/user_defined_sweep.log"
    assert "accuracy" not in log.read_text(encoding="utf-8")


def prestress_ramp(table, path):
    """Both fronts end on a constant level; the one on the right has crossed the ramp."""
    assert (table["level_ahead_left"][0], table["level_ahead_right"][0]) == (0.6, 0.5)
    asymmetric_levels(table, path, (0.6, 0.5))
    slip = pd.read_csv(path.with_suffix(".csv")).query("series == 'slip' and role == 'profile'")
    on_ramp, before = (slip["value"][np.abs(slip["position"] - x) < 0.5] for x in (11.0, -11.0))
    assert on_ramp.max() < 0.7 * before.min()
    assert "linear between 3 points from x = 0 to 12" in path.read_text(encoding="utf-8")


def stress_file(table, path):
    """The rupture starts where the file has the value 1, and no theory of levels is compared."""
    assert np.isnan(table["width"][0]) and "121 points" in table["steps_and_bumps"][0]
    numbers = pd.read_csv(path.with_name("stress_file_numbers.csv"))
    assert np.isfinite(numbers["value"]).all() and numbers["theory"].isna().all()
    rows = pd.read_csv(path.with_suffix(".csv")).query("role == 'prestress'")
    assert rows["value"].max() == 1.0 and "no Gaussian" in path.read_text(encoding="utf-8")


def rough_prestress(table, path):
    """The pulse of every seed survives, and they all differ."""
    measured = pd.read_csv(path.parents[1] / "measurements/rough_prestress.csv")
    assert measured["seed"].tolist() == [1, 2, 3, 4, 5, 6] and set(measured["profile"]) == {1}
    assert set(measured["pulse_state"]) == {"unsteady"}
    assert measured["pulse_slip"].nunique() == 6 and (measured["pulse_slip"] > 0.5).all()


def rough_ensemble(table, path):
    """A chunk has a fortieth of the runs, ten to twelve of each ensemble."""
    assert len(table) == 1800 and table["seed"].nunique() > 400
    sizes = table.groupby("profile").size()
    assert len(sizes) == 160 and sizes.between(10, 12).all()


def chunked_sweep(table, path):
    levels, widths = table["left"].unique(), table["width"].unique()
    assert [*zip(table["left"], table["width"], strict=True)] == [*product(levels, widths)]
    assert levels.tolist() == [-0.3, -0.6, -1.0, -2.0] and widths.tolist() == [1.0, 2.0, 4.0]
    chunks = sorted(chunk.name for chunk in (path.parent / "chunked_sweep").glob("*.csv"))
    assert chunks == [f"{number}-of-4.csv" for number in (1, 2, 3, 4)]
    assert np.isfinite(table["transition_time"]).all()


def target_error(table, path):
    """All runs keep it, and the log reports that. Narrow and damped pulses take finer lattices."""
    promised = table[table["promised"].notna()]
    assert set(promised["promised"]) == {0.01} and set(promised["point"]) == set(range(12))
    assert promised["kept"].all()
    spacing = table.groupby(["left", "gamma", "damping_ratio"])["dx"].first()
    assert spacing[0.3, 0.65, 0.0] < spacing[0.8, 0.65, 0.0]
    assert spacing[0.3, 0.65, 0.1] < spacing[0.3, 0.1, 0.1]
    log = path.parents[1] / "logs/study_grid/target_error.log"
    assert "target_error: accuracy 0.01: kept in 12 of 12 runs" in log.read_text(encoding="utf-8")


def layer_map(table, path):
    """The chunks are joined in the order of the lists."""
    assert len(table) == 48 and table["fracture_energy"].iloc[:2].tolist() == [0.3, 0.4]
    assert table["gamma"].is_monotonic_decreasing
    assert len([*path.with_suffix("").glob("*-of-8.csv")]) == 8
    brittle = table[table["fracture_energy"] < 0.85]
    assert (brittle["outcome"] == "steady").all()
    assert (table.loc[table["fracture_energy"] > 1.02, "outcome"] == "dying").all()
    assert "growing" not in set(table["outcome"])


def laboratory_block(table, path):
    """The rupture stops before the ends of the block, and is drawn in SI units."""
    drawn = pd.read_csv(path.with_suffix(".csv"))
    roles = dict([*drawn.groupby("role")])
    units = roles["unit"].set_index("series")["unit"]
    assert units["position"] == "mm" and units["stress"] == "MPa"
    assert units["time"] == "\N{MICRO SIGN}s" and units["slip"] == "\N{MICRO SIGN}m"
    assert 95.0 < roles["front"]["position"].max() < 100.0
    assert 16.0 < roles["trailing"]["time"].min() < 17.0
    assert 33.0 < roles["trailing"]["time"].max() < 35.0
    assert 0.33e3 < roles["largest"]["value"].iloc[0] < 0.35e3
    slip = roles["profile"].query("series == 'slip' and abs(position) < 70")["value"]
    assert slip.median() == pytest.approx(1.7, abs=0.05)
    # The measured table has numbers without units.
    numbers = pd.read_csv(path.with_name("laboratory_block_numbers.csv")).set_index("quantity")
    layer = Layer(0.01, 2.1e9, poisson_ratio=0.33, density=1170.0, **FRICTION, normal_stress=5e6)
    stick = layer.convert_to_si(table["first_stick_time"][0], "time")
    assert numbers["value"]["first_stick_time"] * 1e-6 == pytest.approx(stick)


def damage_zone(table, path):
    """The numbers in the comment are the numbers of the exact pulse of this layer."""
    numbers = pd.read_csv(path.with_name("damage_zone_numbers.csv")).set_index("quantity")
    layer = Layer(100.0, 5.2e9, poisson_ratio=0.25, density=2300.0, **FRICTION, normal_stress=4e7)
    results = theory.layer_results(layer, 21.6e6, damping_ratio=0.1).exact
    for name, unit in (("pulse_width", 1.0), ("pulse_slip", 1e-3), ("pulse_peak_velocity", 1.0)):
        measured = numbers["value"][name] * unit
        assert measured == pytest.approx(results[name], rel=tol.DRAFT_SLIP)
    assert numbers["unit"].tolist()[2:5] == ["ms", "km", "m"]
    assert 138.0 < numbers["value"]["transition_time"] < 142.0
    assert 0.97 < numbers["value"]["transition_length"] < 1.05
    text = path.read_text(encoding="utf-8")
    assert "<td>2.604 km/s</td>" in text and "lacks a factor of two" in text


# A cheap target of each example that shows what its comment promises.
TARGETS = {
    another_gamma: "measurements/steady_displacement.csv",
    asymmetric_levels: "measurements/asymmetric_levels.csv",
    stress_barrier: "scenes/stress_barrier.html",
    two_nucleation_sites: "measurements/two_sites.csv",
    other_friction: "scenes/other_friction.html",
    laboratory_block: "scenes/laboratory_block.html",
    damage_zone: "scenes/damage_zone.html",
    exact_scene: "scenes/exact_scene.html",
    elastic_release: "measurements/space_time_displacement.csv",
    fixed_beta: "measurements/continuum_fixed_ratio.csv",
    halved_spacing: "measurements/space_time_displacement.csv",
    user_defined_sweep: "uncertainties/user_defined_sweep.csv",
    chunked_sweep: "measurements/chunked_sweep.csv",
    layer_map: "studies/layer_map.csv",
    prestress_ramp: "scenes/prestress_ramp.html",
    stress_file: "scenes/stress_file.html",
    rough_prestress: "uncertainties/rough_prestress.csv",
    rough_ensemble: "measurements/rough_displacement/3-of-40.csv",
    target_error: "uncertainties/target_error.csv",
}


def test_every_example_is_allowed_tested_and_explained(project, shipped):
    examples = sorted((project / "config/examples").glob("*.yaml"))
    assert [path.stem for path in examples] == sorted(see.__name__ for see in TARGETS)
    for path in examples:
        read_config(shipped, [read_overlay(path)])
        text = path.read_text(encoding="utf-8")
        assert text.startswith("# ") and f"OVERLAY=config/examples/{path.name}" in text


@pytest.mark.slow
@pytest.mark.parametrize("see", TARGETS, ids=lambda see: see.__name__)
def test_an_example_does_what_it_promises(make, see):
    path = make(see.__name__, f"results/{TARGETS[see]}")
    table = path.parents[1] / f"measurements/{path.stem}.csv" if path.suffix == ".html" else path
    see(pd.read_csv(table), path)
