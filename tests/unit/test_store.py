"""Files are written whole or not at all, and equal data give equal bytes."""

import stat

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import slippulse as sp
from slippulse.data.files import write_whole
from slippulse.data.store import load_dataset, save_dataset
from slippulse.data.tables import load_table, save_table
from slippulse.data.variables import VARIABLES

SCENES = [
    sp.Scene("displacement", sp.Prestress(tau, 0.5), 2.0, 0.1, gamma=0.65, beta=0.01) for tau in (0.3, 0.5)
]
SAMPLES = [sp.Samples([0.0, 1.0], [-0.5, 0.0])] * 2


def sweep() -> xr.Dataset:
    return sp.run_sweep(SCENES, SAMPLES, ("fronts", "fields", "samples"))


def test_equal_data_give_equal_bytes_and_others_do_not(tmp_path):
    other = sweep()
    other["slip"][3] += 1e-12
    for name, data in {"one": sweep(), "two": sweep(), "other": other}.items():
        save_dataset(data, tmp_path / name)
    one, two, other = ((tmp_path / name).read_bytes() for name in ("one", "two", "other"))
    assert one == two != other


def test_a_dataset_comes_back_as_it_was_and_opens_without_this_project(tmp_path):
    before = sweep()
    save_dataset(before, tmp_path / "run.nc")
    xr.testing.assert_identical(load_dataset(tmp_path / "run.nc"), before)
    with xr.open_dataset(tmp_path / "run.nc") as data:
        assert data["slip"].size == int(data["row_size"].sum())


def test_every_variable_has_units_and_a_name():
    one = sp.simulate(SCENES[0], SAMPLES[0])
    for data in (one, sweep()):
        for name in data.variables:
            assert data[name].attrs["units"] and name in VARIABLES, name
            assert data[name].attrs["long_name"] not in ("", name.replace("_", " ")), name


def test_the_table_of_columns_has_the_units_and_the_meaning_that_files_have(project):
    rows = (project / "docs/columns.md").read_text(encoding="utf-8").replace("\\|", "|").splitlines()
    for name, meaning in VARIABLES.items():
        assert any(f"| `{name}` | {units} | {meaning} |" in rows for units in ("1", "count", "text")), name


def test_a_data_file_follows_the_conventions_it_names():
    data = sweep()
    assert data.attrs["Conventions"].startswith("CF-") and data.attrs["featureType"] == "profile"
    assert data["row_size"].attrs["sample_dimension"] == "block"
    assert all(data.attrs[key] for key in ("title", "source", "references"))


def test_a_table_has_nine_digits_and_no_index(tmp_path):
    save_table(pd.DataFrame({"name": ["a"], "value": [np.pi], "missing": [np.nan]}), tmp_path / "t.csv")
    assert (tmp_path / "t.csv").read_text() == "name,value,missing\na,3.14159265,\n"
    assert load_table(tmp_path / "t.csv")["value"].tolist() == [3.14159265]


@pytest.mark.parametrize("existing", [b"the old file", None])
def test_a_writer_that_fails_leaves_the_folder_as_it_was(tmp_path, existing):
    path = tmp_path / "data.nc"
    if existing:
        path.write_bytes(existing)

    def fail(part):
        part.write_bytes(b"half of the n")
        raise RuntimeError("disk full")

    with pytest.raises(RuntimeError, match="disk full"):
        write_whole(path, fail)
    assert [entry.read_bytes() for entry in tmp_path.iterdir()] == ([existing] if existing else [])


def test_a_writer_sees_the_old_file_until_it_is_done_and_leaves_one_as_readable_as_any(tmp_path):
    path = tmp_path / "deep/er/data.txt"
    write_whole(path, lambda part: part.write_text("old"))

    def write(part):
        part.write_text("new")
        assert path.read_text() == "old"
        assert part.parent == path.parent and part.suffix == path.suffix

    write_whole(path, write)
    assert path.read_text() == "new"
    (tmp_path / "plain.txt").touch()
    assert stat.S_IMODE(path.stat().st_mode) == stat.S_IMODE((tmp_path / "plain.txt").stat().st_mode)
