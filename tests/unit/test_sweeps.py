"""Sweeps by their parameters: selections, grids, tables of numbers, files, and progress."""

import dataclasses
import os
import sys

import numpy as np
import pytest
import xarray as xr

import slippulse as sp

LEVELS, GAMMAS = [0.4, 0.5], [0.6, 0.3]
VALUES = {"boundary": "displacement", "damping_ratio": 0.1, "dx": 0.1, "duration": 8.0}
FIELDS = ("fronts", "fields")


@pytest.fixture(scope="module")
def runs() -> xr.Dataset:
    return sp.sweep(gamma=GAMMAS, left=LEVELS, record=FIELDS, **VALUES)


def alone(gamma: float, level: float) -> xr.Dataset:
    return sp.simulate(sp.Scene(prestress=sp.Prestress(level, level), gamma=gamma, **VALUES))


def test_a_sweep_has_one_run_for_each_combination_in_order(runs):
    assert runs["gamma"].values.tolist() == [0.6, 0.6, 0.3, 0.3]
    assert runs["left"].values.tolist() == runs["right"].values.tolist() == 2 * LEVELS
    for number, (gamma, level) in enumerate((g, tau) for g in GAMMAS for tau in LEVELS):
        assert sp.point(runs, number).equals(alone(gamma, level))


def test_runs_are_selected_by_any_parameters_and_keep_their_blocks(runs):
    one = runs.sel(gamma=0.3, left=0.5)
    assert one["point"].values.tolist() == [3] and sp.point(one).equals(alone(0.3, 0.5))
    assert runs.sel(gamma=0.3).sel(left=0.5).identical(one)
    # beta/dx may be a rounding error away from the number that was given.
    assert runs.sel(damping_ratio=0.1 + 1e-15).sizes["point"] == 4
    assert runs.sel(left=slice(0.45, None), boundary="displacement").sizes["point"] == 2
    assert runs.sel(gamma=0.35, method="nearest")["gamma"].values.tolist() == [0.3, 0.3]
    assert runs.sel(gamma=[0.3, 0.6]).sizes["point"] == 4
    assert sp.point(runs.isel(point=2)).equals(sp.point(runs, 2))
    with pytest.raises(KeyError, match=r"gamma = 0\.5: no such run; the runs have .*0\.3, 0\.6"):
        runs.sel(gamma=0.5)


def test_the_nearest_run_is_found_among_runs_without_the_parameter():
    scenes = [sp.Scene("stress", sp.Prestress(-0.3, 0.0, width), 0.5, 0.1) for width in (None, 2.0)]
    sweep = sp.run_sweep(scenes)
    assert sweep.sel(width=1.9, method="nearest")["width"].values.tolist() == [2.0]
    for no_width in (None, float("nan")):
        assert sweep.sel(width=no_width)["point"].values.tolist() == [0]
    assert sweep.sel(width=[None, 2.0]).sizes["point"] == 2
    for options in ({"method": "pad"}, {"method": "nearest", "tolerance": 0.1}):
        with pytest.raises(ValueError, match="allowed: None"):
            sweep.sel(width=1.9, **options)


def test_xarray_and_pandas_operations_work_on_a_sweep(runs):
    sticks = runs["first_stick_time"]
    expected = [float(sticks.sel(gamma=gamma).mean()) for gamma in sorted(GAMMAS)]
    assert sticks.groupby("gamma").mean().values.tolist() == expected
    assert (sticks * runs["gamma"] / runs["gamma"]).values == pytest.approx(sticks.values)
    assert sticks.where(runs["gamma"] > 0.4).isnull().sum() == 2
    table = runs.drop_dims("block").to_dataframe()
    assert table.index.names == ["gamma", "left"] and len(table) == 4
    assert table["first_stick_time"].loc[0.3, 0.5] == float(sticks[3])
    line = runs.sel(left=0.5).drop_dims("block").to_dataframe()
    assert line.index.tolist() == GAMMAS and line.index.name == "gamma"
    numbers = runs.drop_dims("block")
    assert xr.concat([numbers, numbers], "point").sel(left=0.4).sizes["point"] == 4
    assert numbers.sortby("left").sel(left=0.4).equals(numbers.sel(left=0.4))
    assert numbers.rename(gamma="elasticity").sel(elasticity=0.3).sizes["point"] == 2


def test_a_full_product_becomes_a_grid_and_other_sweeps_are_refused(runs):
    grid = sp.as_grid(runs)
    assert grid["first_stick_time"].sizes == {"gamma": 2, "left": 2}
    assert grid["dx"].dims == ()
    assert sp.point(grid.sel(gamma=0.3, left=0.5)).equals(alone(0.3, 0.5))
    # The lists need not be known: beta, right and the ratio follow from other parameters.
    bare = sp.as_grid(runs.assign_attrs(sweep_axes=""))
    assert bare["slip"].equals(grid["slip"]) and bare.sizes == grid.sizes
    measured = sp.measure(grid).set_index(["gamma", "left"])
    assert measured["transition_time"].loc[0.3, 0.5] == float(runs["first_stick_time"][3])
    line = sp.as_grid(runs.sel(gamma=0.3), over="left")
    assert line["first_stick_time"].dims == ("left",)
    with pytest.raises(ValueError, match="number of runs: 3; allowed: 4, one for each comb"):
        sp.as_grid(runs.isel(point=[0, 1, 2]))
    with pytest.raises(ValueError, match=r"over: \['speed'\]; allowed: parameters"):
        sp.as_grid(runs, over=["speed"])


def test_a_grid_keeps_the_runs_without_a_parameter():
    lists = {"left": [-0.3, -0.2], "width": [None, 2.0]}
    sweep = sp.sweep(boundary="stress", right=0.0, duration=0.5, dx=0.1, **lists)
    grid = sp.as_grid(sweep)
    assert grid["releases"].sizes == {"left": 2, "width": 2} and len(sp.measure(grid)) == 4
    # The value NaN is the last one. The first run has no width.
    assert np.isnan(grid["width"][-1])
    assert sp.point(grid.isel(left=0, width=-1)).equals(sp.point(sweep, 0))


def test_measuring_a_sweep_equals_measuring_each_run(runs):
    table = sp.measure(runs)
    assert table.index.name == "point" and len(table) == 4
    for number, row in table.iterrows():
        for name, value in sp.measure(sp.point(runs, number)).items():
            np.testing.assert_equal(row[name], value)
    assert sp.measure(runs.sel(left=0.5))["gamma"].tolist() == GAMMAS
    with pytest.raises(ValueError, match=r"run: .*; allowed: a sweep that was recorded with"):
        sp.measure(sp.sweep(left=0.5, record=("fields",), gamma=0.5, **VALUES))


def test_a_sweep_can_be_read_from_a_file(runs, tmp_path):
    runs.to_netcdf(tmp_path / "sweep.nc", engine="h5netcdf")
    again = sp.open_sweep(tmp_path / "sweep.nc")
    xr.testing.assert_identical(again, runs)
    assert again.sel(gamma=0.3).sizes["point"] == 2
    selected = runs.sel(gamma=0.3)
    selected.to_netcdf(tmp_path / "selected.nc", engine="h5netcdf")
    again = sp.open_sweep(tmp_path / "selected.nc")
    xr.testing.assert_identical(again, selected)
    assert sp.point(again, 1).equals(alone(0.3, 0.5))
    alone(0.3, 0.5).to_netcdf(tmp_path / "run.nc", engine="h5netcdf")
    with pytest.raises(ValueError, match="allowed: the data file of a sweep"):
        sp.open_sweep(tmp_path / "run.nc")


@pytest.mark.parametrize(
    ("refusal", "values"),
    [
        ("parameter: 'gama'; allowed: boundary", {"gama": 0.3}),
        ("left: None; allowed: a level", {"right": 0.3}),
        (
            "prestress: .*; allowed: prestress, or left",
            {"prestress": sp.Prestress(0, 0), "left": 0},
        ),
        ("gamma: \\[\\]; allowed: a value, or a list", {"left": 0.5, "gamma": []}),
        ("gamma: -1.0; allowed", {"left": 0.5, "gamma": [0.3, -1.0]}),
    ],
)
def test_wrong_lists_are_refused(refusal, values):
    with pytest.raises(ValueError, match=refusal):
        sp.sweep(**VALUES | values)
    with pytest.raises(ValueError, match="duration: None; allowed: a value, which every scene"):
        sp.sweep(boundary="stress", left=0.5, dx=0.1)


def test_an_array_can_be_a_list_or_a_single_value():
    runs = sp.sweep(**VALUES | {"gamma": np.array(0.3), "left": np.array([0.4, 0.5])})
    assert runs["left"].values.tolist() == [0.4, 0.5]
    assert (runs["gamma"] == 0.3).all()


def test_profiles_of_pre_stress_can_be_listed():
    profiles = [sp.Prestress(0.5, 0.5), sp.Prestress(0.5, 0.5, width=2.0)]
    runs = sp.sweep(boundary="stress", prestress=profiles, dx=[0.1, 0.2], duration=1.0)
    assert runs["width"].values.tolist() == [1.0, 1.0, 2.0, 2.0]
    assert sp.as_grid(runs)["releases"].sizes == {"dx": 2, "width": 2}


def test_all_cores_are_used_by_default(monkeypatch):
    used = []
    module = sys.modules["slippulse.simulation.simulate"]
    solve = module.solve_sweep
    monkeypatch.setattr(module, "solve_sweep", lambda *a: used.append(a[4]) or solve(*a))
    sp.sweep(boundary="stress", left=0.5, dx=0.1, duration=1.0)
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    assert used == [cores]


def test_without_tqdm_a_sweep_runs_with_one_line_of_advice(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    scene = sp.Scene("stress", sp.Prestress(0.5, 0.5), 1.0, 0.1)
    for run in (
        lambda: sp.simulate(scene, progress=True),
        lambda: sp.run_sweep([scene] * 2, progress=True),
    ):
        assert run()["release_time"].size
        shown = capsys.readouterr().err
        assert shown == "progress: no bar is drawn, since tqdm is not installed\n"


def test_a_damping_ratio_replaces_beta():
    profile = sp.Prestress(0.6, 0.6)
    scene = sp.Scene("stress", profile, 15.0, dx=0.01, damping_ratio=0.1)
    assert scene == sp.Scene("stress", profile, 15.0, dx=0.01, beta=1e-3)
    assert scene.beta == 1e-3 and scene.damping_ratio == 0.1
    assert dataclasses.replace(scene, dx=0.02).damping_ratio == 0.05
    assert sp.Scene.from_attributes(scene.attributes()) == scene
    assert hash(scene) == hash(dataclasses.replace(scene))
    with pytest.raises(dataclasses.FrozenInstanceError):
        scene.beta = 0.0
    refused = r"damping_ratio: 0\.1; allowed: damping_ratio or beta \(here 0\.0\), not both"
    with pytest.raises(ValueError, match=refused):
        sp.Scene("stress", profile, 15.0, 0.01, beta=0.0, damping_ratio=0.1)
    with pytest.raises(ValueError, match=refused):
        sp.Scene("stress", profile, 15.0, 0.01, 0.0, 0.0, damping_ratio=0.1)
    with pytest.raises(ValueError, match=r"damping_ratio: -1; allowed: a finite number and >= 0"):
        sp.Scene("stress", profile, 15.0, 0.01, damping_ratio=-1)
