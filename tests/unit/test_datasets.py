"""Sweeps as one Dataset, with every scheme: order of the runs, threads, single runs, and files."""

import dataclasses
import stat
from functools import cache

import numpy as np
import pandas as pd
import pytest
import tolerances as tol
import xarray as xr

import slippulse as sp
from slippulse.data.files import write_whole
from slippulse.data.saving import save_dataset
from slippulse.data.store import load_dataset
from slippulse.data.sweeps import FIELD_VARIABLES, FRONT_VARIABLES
from slippulse.data.tables import load_table, save_table
from slippulse.data.variables import VARIABLES

RECORDS = ("fronts", "fields", "samples")
SCENES = [
    sp.Scene("displacement", sp.Prestress(0.3, 0.5), 2.0, 0.05, gamma=0.65, beta=0.005),
    sp.Scene("displacement", sp.Prestress(0.5, 0.5), 6.0, 0.02, gamma=0.65, beta=0.002),
    sp.Scene("displacement", sp.Prestress(-0.2, 0.5), 4.0, 0.05, gamma=0.65, beta=0.005),
    sp.Scene("stress", sp.Prestress(-0.5, 0.0), 4.0, 0.05),
    sp.Scene("stress", sp.Prestress(0.5, 0.5, peak=0.9), 4.0, 0.05),
]
SAMPLES = [
    sp.Samples(np.linspace(0.0, scene.duration, 7), np.linspace(-1.0, 1.0, 5)) for scene in SCENES
]
STEP = {"gamma": 0.65, "beta": 0.005, "max_step": 0.4}
ONE = sp.Scene("displacement", sp.Prestress(0.4, 0.6), 6.0, 0.05, **STEP)
HELD = sp.Scene("displacement", sp.Prestress(0.5, 0.5), 9.0, 0.1, gamma=0.65, beta=0.01)
EXACT = {
    "displacement": HELD,
    "asymmetric": dataclasses.replace(HELD, prestress=sp.Prestress(-0.5, 0.5), duration=5.0),
    "stress": sp.Scene("stress", sp.Prestress(-0.75, 0.0, 2.0), 9.0, 0.1, beta=0.01),
}


@cache
def sweep(threads: int = 1, record=RECORDS) -> xr.Dataset:
    return sp.run_sweep(SCENES, SAMPLES, record, threads)


def test_only_equal_data_give_equal_bytes_with_any_number_of_threads(tmp_path):
    other = sweep().copy(deep=True)
    other["slip"][3] += 1e-12
    for number, data in enumerate((sweep(1), sweep(2), sweep(5), other)):
        save_dataset(data, tmp_path / f"{number}.nc")
    one, two, three, other = ((tmp_path / f"{number}.nc").read_bytes() for number in range(4))
    assert one == two == three != other


def test_a_run_of_a_sweep_equals_the_same_scene_simulated_alone():
    together = sweep(2)
    for index, (scene, samples) in enumerate(zip(SCENES, SAMPLES, strict=True)):
        alone, again = sp.simulate(scene, samples), sp.point(together, index)
        assert again.equals(alone)
        np.testing.assert_equal(again.attrs, alone.attrs)
        for name, value in alone.attrs.items():
            assert type(again.attrs[name]) is type(value), name
    fields, full = {"x", "prestress"}, sp.simulate(SCENES[1], SAMPLES[1])
    sampled = {"sample_time", "sample_position", "sample_slip", "sample_velocity"}
    kept = (fields | {*FRONT_VARIABLES}, fields | {*FIELD_VARIABLES}, sampled)
    for record, names in zip(RECORDS, kept, strict=True):
        run = sp.point(sweep(record=(record,)), 1)
        assert set(run.variables) == names
        assert all(run[name].variable.equals(full[name].variable) for name in names), record


def test_progress_counts_scenes_and_a_failing_scene_ends_the_sweep():
    seen = []
    sp.run_sweep(SCENES, None, ("fronts",), 2, lambda *done: seen.append(done))
    assert seen == [(done, len(SCENES)) for done in range(1, len(SCENES) + 1)]
    values = {"beta": 0.1, "scheme": "fixed_step", "max_step": 0.01}
    broken = sp.Scene("stress", sp.Prestress(0.2, 0.3), 200.0, 0.1, **values)
    object.__setattr__(broken, "max_step", 3.0)
    with pytest.raises(sp.UnstableRun, match=r"unstable at t = .*max_step"):
        sp.run_sweep([*SCENES, broken], None, ("fronts",), 2)


def test_a_sample_equals_the_final_state_of_a_run_that_ends_at_its_time():
    """A position without a block is at rest."""
    times = np.array([0.0, 0.777, 2.5, 5.9])
    positions = np.array([-900.0, -3.0, -0.52, 0.0, 0.07, 2.0, 900.0])
    run = sp.simulate(ONE, sp.Samples(times, positions))
    for s, time in enumerate(times[1:], start=1):
        end = sp.simulate(dataclasses.replace(ONE, duration=float(time)))
        blocks = end.sel(x=positions, method="nearest")
        near = np.abs(blocks["x"].values - positions) < ONE.dx
        for sampled, name in (("sample_slip", "slip"), ("sample_velocity", "slip_velocity")):
            expected = np.where(near, blocks[name].values, 0.0)
            assert run[sampled].values[s] == pytest.approx(expected, abs=tol.SAMPLE), (time, name)
    assert not run["sample_slip"].values[0].any()
    assert not run["sample_slip"].values[:, [0, -1]].any()
    scene = sp.Scene("stress", sp.Prestress(-2.0, -2.0), 20.0, 0.1, beta=0.01)
    run = sp.simulate(scene, sp.Samples([19.0, 20.0], [0.0]))
    assert run.attrs["stopped_because"] == "everything is stuck"
    assert (run["sample_slip"].values == float(run["slip"].sel(x=0.0))).all()


@pytest.mark.parametrize("scheme", ["localised", "fixed_step"])
def test_samples_do_not_change_the_run_and_are_mirrored_at_mirrored_positions(scheme):
    scene = dataclasses.replace(ONE, scheme=scheme, prestress=sp.Prestress(0.5, 0.5))
    positions = np.array([-1.0251, -0.075, -0.025, 0.025, 0.075, 1.0251])
    for uneven in (dataclasses.replace(ONE, scheme=scheme), scene):
        plain = sp.simulate(uneven)
        sampled = sp.simulate(uneven, sp.Samples(np.linspace(0.0, 6.0, 301), positions))
        assert sampled[list(plain.data_vars)].equals(plain)
    slip = sampled["sample_slip"].values
    assert np.array_equal(slip, slip[:, ::-1])


def test_a_saved_dataset_is_read_unchanged_here_and_by_xarray(tmp_path):
    before = sweep()
    save_dataset(before, tmp_path / "run.nc")
    xr.testing.assert_identical(sp.open_sweep(tmp_path / "run.nc"), before)
    bare = before.drop_indexes([*before.xindexes]).reset_coords()
    loaded = load_dataset(tmp_path / "run.nc")
    xr.testing.assert_identical(loaded.drop_vars("point"), bare.drop_vars("point"))
    with xr.open_dataset(tmp_path / "run.nc") as data:
        assert data["slip"].size == int(data["row_size"].sum())


def test_a_data_file_follows_its_conventions_and_describes_every_variable():
    data = sweep()
    assert data.attrs["Conventions"].startswith("CF-") and data.attrs["featureType"] == "profile"
    assert data["row_size"].attrs["sample_dimension"] == "block"
    assert all(data.attrs[key] for key in ("title", "source", "references"))
    for run in (sp.simulate(SCENES[0], SAMPLES[0]), data):
        for name, variable in run.variables.items():
            assert variable.attrs["units"] and name in VARIABLES, name
            assert variable.attrs["long_name"] not in ("", name.replace("_", " ")), name


def test_the_page_of_columns_describes_variables_as_files_do(project):
    text = (project / "docs/columns.md").read_text(encoding="utf-8")
    rows = text.replace("\\|", "|").splitlines()
    scenes = [dataclasses.replace(HELD, scheme="continuum")] * 2
    exact = sp.run_sweep(scenes, record=("fronts", "fields"))
    assert exact.sizes["point"] == 2 and np.isfinite(exact["first_stick_time"]).all()
    variables = {**sweep().variables, **exact.variables}
    kinds = {name: values.dtype.kind for name, values in variables.items()}
    for name, meaning in VARIABLES.items():
        units = ("1", "count") if kinds.get(name) in (None, *"bif") else ("text",)
        assert any(f"| `{name}` | {unit} | {meaning} |" in rows for unit in units), name


def test_a_table_has_nine_digits_and_no_index(tmp_path):
    table = pd.DataFrame({"name": ["a"], "value": [np.pi], "missing": [np.nan]})
    save_table(table, tmp_path / "t.csv")
    assert (tmp_path / "t.csv").read_text() == "name,value,missing\na,3.14159265,\n"
    assert load_table(tmp_path / "t.csv")["value"].tolist() == [3.14159265]


def test_a_file_is_replaced_only_when_the_new_one_is_complete(tmp_path):
    path = tmp_path / "deep/er/data.txt"
    write_whole(path, lambda part: part.write_text("old"))

    def write(part):
        part.write_text("new")
        assert path.read_text() == "old"
        assert part.parent == path.parent and part.suffix == path.suffix

    write_whole(path, write)
    assert path.read_text() == "new"
    plain = tmp_path / "plain.txt"
    plain.touch()
    assert stat.S_IMODE(path.stat().st_mode) == stat.S_IMODE(plain.stat().st_mode)


def exactly(scene: sp.Scene, samples: sp.Samples | None = None) -> xr.Dataset:
    return sp.simulate(dataclasses.replace(scene, scheme="continuum"), samples)


@pytest.mark.parametrize("name", EXACT)
def test_the_exact_scheme_is_the_exact_rupture(name):
    """Lattices converge to it: see theory_exact/test_against_lattice.py."""
    scene = EXACT[name]
    run, x = exactly(scene), scene.dx * np.arange(-20, 30, 5)
    rupture = sp.theory.Rupture(scene.prestress, scene.gamma, 0.1, duration=scene.duration)
    blocks = run.sel(x=x, method="nearest")
    assert blocks["x"].values == pytest.approx(x)
    for field in ("release_time", "stick_time"):
        assert blocks[field].values == pytest.approx(getattr(rupture, field)(x), nan_ok=True)
    assert blocks["slip"].values == pytest.approx(rupture.slip(x, scene.duration))


def test_exact_and_lattice_datasets_have_the_same_form():
    samples = sp.Samples(times=np.linspace(0.0, 8.0, 5), positions=np.linspace(-4.0, 4.0, 9))
    lattice, exact = sp.simulate(HELD, samples), exactly(HELD, samples)
    assert set(exact.variables) == set(lattice.variables)
    for name in exact.variables:
        assert exact[name].dims == lattice[name].dims and exact[name].attrs == lattice[name].attrs
    missing = set(lattice.attrs) - set(exact.attrs)
    assert all(name.endswith(("energy", "loss", "of_prestress")) for name in missing)
    assert exact.attrs["scheme"] == "continuum" and exact.attrs["run_flags"] == ""
    assert np.abs(exact.sample_slip - lattice.sample_slip).max() < 0.1 * lattice.sample_slip.max()
    scene = dataclasses.replace(HELD, prestress=sp.Prestress(0.5, 0.5, peak=0.9))
    samples = sp.Samples([0.0, 1.0], [0.0, 1.0])
    lattice, exact = sp.simulate(scene, samples), exactly(scene, samples)
    assert exact.equals(lattice) and lattice.attrs["run_flags"] == "nothing_released"
    for name in ("releases", "sticks", "stopped_because", "run_flags", "pulse_blocks"):
        assert exact.attrs[name] == lattice.attrs[name]
    assert np.isnan(exact.attrs["first_stick_time"]) and exact.attrs["end_time"] == scene.duration


def test_no_number_is_given_that_an_exact_solution_does_not_know():
    """On lattices the block at x = 2 first sticks at 4.2.

    It sticks for the last time at 5.7 for dx = 0.04, and at 5.68 for dx = 0.02.
    """
    profile = sp.Prestress(0.5, 0.5, bumps=((8.0, 0.5, 1.0),))
    scene = sp.Scene("displacement", profile, 9.0, 0.04, 0.65, 0.1 * 0.04)
    samples = sp.Samples(np.linspace(0.0, 9.0, 10), np.linspace(-12.0, 20.0, 65))
    run, lattice = exactly(scene, samples), sp.simulate(scene, samples)
    assert run.attrs["run_flags"] == "construction_ended"
    x = np.linspace(-10.0, 18.0, 141)
    stick, last = (one.stick_time.sel(x=x, method="nearest").values for one in (run, lattice))
    known = np.isfinite(stick) & np.isfinite(last)
    assert known.any() and not known[np.abs(x - 2.0) < 0.1].any()
    assert stick[known] == pytest.approx(last[known], abs=0.05)
    numbers, expected = sp.measure(run), sp.measure(lattice)
    unknown = "largest_velocity", "pulse_width", "pulse_slip", "sliding_at_once", "lattice_noise"
    for name in (*unknown, "pulse_half_width", "trailing_edge_5", "trailing_edge_9"):
        assert np.isnan(numbers[name]), name
    assert numbers["regime"] == "undecided"
    # Earlier numbers are known, and so are fronts that are faster than the waves.
    for name in ("first_stick_time", "front_speed_left", "front_speed_right", "pulse_front"):
        assert numbers[name] == pytest.approx(expected[name], rel=0.01), name
    rupture = sp.theory.Rupture(profile, 0.65, 0.1, duration=9.0)
    assert float(rupture.stick_time(2.0)) == pytest.approx(4.2018, abs=1e-4)
    assert np.isnan(rupture.final_slip(2.0))


def test_the_end_of_an_exact_solution_is_flagged():
    """Waves from a second nucleation keep a position sliding that is about to stick."""
    profile = sp.Prestress(0.25, 0.25, bumps=((7.0, 0.75, 0.5),))
    run = exactly(dataclasses.replace(HELD, prestress=profile, duration=16.0))
    assert run.attrs["run_flags"] == "construction_ended" and run.attrs["limit_reason"]
    assert run.attrs["limit_time"] <= run.attrs["duration"]
    assert np.isnan(run.slip.values).any()
