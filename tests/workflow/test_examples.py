"""Every example overlay runs, at draft, and does what its comment promises."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import tolerances as tol
from pipeline_copy import copy_project, snakemake

from slippulse import Prestress, theory
from slippulse.configuration.read import read_overlay

pytestmark = pytest.mark.workflow

# A small target of each example: cheap, and enough to see what it promises.
TARGETS = {
    "another_gamma": "results/measurements/steady_displacement.csv",
    "asymmetric_levels": "results/measurements/asymmetric_levels.csv",
    "stress_barrier": "results/scenes/stress_barrier.html",
    "two_nucleation_sites": "results/measurements/two_sites.csv",
    "exact_scene": "results/scenes/exact_scene.html",
    "elastic_release": "results/measurements/space_time_displacement.csv",
    "fixed_beta": "results/measurements/continuum_fixed_ratio.csv",
    "halved_spacing": "results/measurements/space_time_displacement.csv",
    "own_sweep": "results/measurements/own_sweep.csv",
    "chunked_sweep": "results/measurements/chunked_sweep.csv",
    "target_error": "results/uncertainties/target_error.csv",
}


@pytest.fixture(scope="module")
def run(project, tmp_path_factory):
    """A function that makes an example's target and returns its measured table."""
    folder = copy_project(project, tmp_path_factory.mktemp("examples"), link=True)

    def make(name: str) -> tuple[pd.DataFrame, Path]:
        overlay = f"config/examples/{name}.yaml"
        result = snakemake(folder, "--config", "preset=draft", "--", TARGETS[name], overlay=overlay)
        assert result.returncode == 0, result.stderr
        path = folder / TARGETS[name]
        table = path if path.suffix == ".csv" else folder / f"results/measurements/{path.stem}.csv"
        return pd.read_csv(table), path

    return make


def test_every_example_is_tested_and_explained(project):
    examples = sorted((project / "config/examples").glob("*.yaml"))
    assert [path.stem for path in examples] == sorted(TARGETS)
    for path in examples:
        read_overlay(path)
        text = path.read_text(encoding="utf-8")
        assert text.startswith("# ") and f"OVERLAY=config/examples/{path.name}" in text


@pytest.mark.slow
def test_another_gamma_changes_the_size_and_not_the_speed(run):
    table, _ = run("another_gamma")
    assert set(table["gamma"]) == {0.3}
    undamped = table[table["damping_ratio"] == 0.0]
    assert np.allclose(undamped["pulse_slip"], 2.0 * undamped["left"] / 0.3, rtol=tol.DRAFT_SLIP)
    assert np.allclose(
        undamped["front_speed_right"], 1.0 / np.sqrt(1.0 - undamped["left"] ** 2), rtol=tol.DRAFT_SPEED
    )


@pytest.mark.slow
def test_asymmetric_levels_have_each_sides_speed(run):
    table, _ = run("asymmetric_levels")
    for side, level in (("left", 0.3), ("right", 0.7)):
        expected = pytest.approx(theory.front_speed(level, 0.1), rel=tol.DRAFT_SPEED)
        assert table[f"front_speed_{side}"][0] == expected


@pytest.mark.slow
def test_a_wide_barrier_stops_a_pulse(run):
    table, page = run("stress_barrier")
    assert table["front_speed_left"][0] == pytest.approx(theory.front_speed(0.5, 0.1), rel=tol.DRAFT_SPEED)
    fronts = pd.read_csv(page.with_suffix(".csv"))
    fronts = fronts[fronts["role"] == "front"]
    # The barrier stands at 18, the undisturbed front on the left is beyond 35 by the end.
    assert 12.0 < fronts["position"].max() < 22.0 and fronts["position"].min() < -35.0
    assert "A pulse dies in a wide barrier" in page.read_text(encoding="utf-8")


@pytest.mark.slow
def test_two_sites_send_two_pulses(run):
    table, _ = run("two_nucleation_sites")
    speed = theory.front_speed(0.5, 0.1)
    assert table["front_speed_left"][0] == pytest.approx(speed, rel=tol.DRAFT_SPEED)
    assert table["front_speed_right"][0] == pytest.approx(speed, rel=tol.DRAFT_SPEED)


@pytest.mark.slow
def test_the_exact_solution_is_drawn_like_a_run(run):
    table, page = run("exact_scene")
    assert table["scheme"][0] == "continuum"
    assert table["front_speed_right"][0] == pytest.approx(theory.front_speed(0.5, 0.0), rel=tol.EXACT_RUN)
    fronts = pd.read_csv(page.with_suffix(".csv"))
    exact = theory.Rupture(Prestress(-0.5, 0.5), gamma=0.65, duration=12.0)
    stops = exact.front_ends[0][0].x
    assert fronts[fronts["role"] == "front"]["position"].min() == pytest.approx(stops, abs=table["dx"][0])


@pytest.mark.slow
def test_the_elastic_rule_is_slower(run):
    table, _ = run("elastic_release")
    assert set(table["release"]) == {"elastic"}
    elastic, total = (theory.front_speed(0.25, 0.1, rule) for rule in ("elastic", "total"))
    # The run of the space-time figure ends before its front is steady.
    assert table["front_speed_right"][0] < 0.5 * (elastic + total)


@pytest.mark.slow
def test_null_removes_a_key_and_beta_stays(run):
    table, _ = run("fixed_beta")
    assert set(table["beta"]) == {0.01} and table["damping_ratio"].nunique() == len(table) > 1
    by_spacing = table.sort_values("dx")["front_speed_right"]
    assert by_spacing.is_monotonic_decreasing


@pytest.mark.slow
def test_halved_spacing_is_half_of_the_presets(run):
    table, _ = run("halved_spacing")
    assert set(table["dx"]) == {0.02}
    assert table["beta"][0] == pytest.approx(0.002)


@pytest.mark.slow
def test_a_sweep_of_ones_own_is_the_product_of_its_lists(run):
    table, _ = run("own_sweep")
    assert len(table) == 12
    assert np.isfinite(table["pulse_slip"]).all()


@pytest.mark.slow
def test_a_sweep_in_chunks_is_in_the_order_of_its_lists(run):
    table, path = run("chunked_sweep")
    levels, widths = table["left"].unique(), table["width"].unique()
    assert list(zip(table["left"], table["width"], strict=True)) == [(a, b) for a in levels for b in widths]
    assert levels.tolist() == [-0.3, -0.6, -1.0, -2.0] and widths.tolist() == [1.0, 2.0, 4.0]
    chunks = sorted(chunk.name for chunk in (path.parent / "chunked_sweep").glob("*.csv"))
    assert chunks == [f"{number}-of-4.csv" for number in (1, 2, 3, 4)]
    assert np.isfinite(table["transition_time"]).all()


@pytest.mark.slow
def test_a_target_error_is_kept_and_said(run):
    table, path = run("target_error")
    promised = table[table["promised"].notna()]
    assert set(promised["promised"]) == {0.01} and set(promised["point"]) == set(range(12))
    assert {"front_speed_right", "transition_time", "pulse_width", "pulse_slip"} <= set(promised["quantity"])
    assert (promised["uncertainty"] <= 0.01 * promised["value"].abs()).all()
    assert set(promised["kept"]) == {True} and table.loc[table["promised"].isna(), "kept"].isna().all()
    # Narrow pulses and damped ones take a finer lattice.
    spacing = table.groupby(["left", "gamma", "damping_ratio"])["dx"].first()
    assert spacing[0.3, 0.65, 0.0] < spacing[0.8, 0.65, 0.0]
    assert spacing[0.3, 0.65, 0.1] < spacing[0.3, 0.1, 0.1]
    log = path.parents[1] / "logs/study_grid/target_error.log"
    assert "target_error: accuracy 0.01 kept by 12 of 12 runs" in log.read_text(encoding="utf-8")


@pytest.mark.slow
def test_without_a_target_error_a_grid_study_says_nothing_of_it(run):
    _, path = run("own_sweep")
    folder = path.parents[2]
    target = "results/uncertainties/own_sweep.csv"
    overlay = "config/examples/own_sweep.yaml"
    result = snakemake(folder, "--config", "preset=draft", "--", target, overlay=overlay)
    assert result.returncode == 0, result.stderr
    last = ["quantity", "value", "extrapolated", "observed_order", "uncertainty"]
    assert list(pd.read_csv(folder / target).columns[-5:]) == last
    assert "accuracy" not in (folder / "results/logs/study_grid/own_sweep.log").read_text(encoding="utf-8")
