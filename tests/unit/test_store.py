"""Files are written whole or not at all, and equal data give equal bytes."""

from __future__ import annotations

import stat

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import slippulse as sp
from slippulse.data.files import write_whole
from slippulse.data.store import load_dataset, load_table, save_dataset, save_table
from slippulse.data.variables import VARIABLES

SCENES = [
    sp.Scene("displacement", sp.Prestress(tau, 0.5), 2.0, 0.1, gamma=0.65, beta=0.01) for tau in (0.3, 0.5)
]
SAMPLES = [sp.Samples([0.0, 1.0], [-0.5, 0.0])] * 2


def sweep() -> xr.Dataset:
    return sp.run_sweep(SCENES, SAMPLES, ("fronts", "fields", "samples"))


def test_equal_data_give_equal_bytes(tmp_path):
    for name in ("one.nc", "two.nc"):
        save_dataset(sweep(), tmp_path / name)
    assert (tmp_path / "one.nc").read_bytes() == (tmp_path / "two.nc").read_bytes()


def test_other_data_give_other_bytes(tmp_path):
    save_dataset(sweep(), tmp_path / "one.nc")
    other = sweep()
    other["slip"][3] += 1e-12
    save_dataset(other, tmp_path / "two.nc")
    assert (tmp_path / "one.nc").read_bytes() != (tmp_path / "two.nc").read_bytes()


def test_a_dataset_comes_back_as_it_was(tmp_path):
    before = sweep()
    save_dataset(before, tmp_path / "run.nc")
    xr.testing.assert_identical(load_dataset(tmp_path / "run.nc"), before)


def test_a_file_opens_without_this_project(tmp_path):
    save_dataset(sweep(), tmp_path / "run.nc")
    with xr.open_dataset(tmp_path / "run.nc") as data:
        assert data["slip"].size == int(data["row_size"].sum())


def test_every_variable_has_units_and_a_name():
    one = sp.simulate(SCENES[0], SAMPLES[0])
    for data in (one, sweep()):
        for name in data.variables:
            assert data[name].attrs["units"], name
            assert data[name].attrs["long_name"], name
            assert data[name].attrs["long_name"] != name.replace("_", " "), name
            assert name in VARIABLES


def test_the_table_of_columns_has_the_units_and_the_meaning_that_files_have(project):
    rows = (project / "docs/columns.md").read_text(encoding="utf-8").replace("\\|", "|").splitlines()
    for name, (units, meaning) in VARIABLES.items():
        assert f"| `{name}` | {units} | {meaning} |" in rows


def test_a_data_file_follows_the_conventions_it_names():
    data = sweep()
    assert data.attrs["Conventions"].startswith("CF-") and data.attrs["featureType"] == "profile"
    assert data["row_size"].attrs["sample_dimension"] == "block"
    assert all(data.attrs[key] for key in ("title", "source", "references"))


def test_a_table_has_nine_digits_and_no_index(tmp_path):
    save_table(pd.DataFrame({"name": ["a"], "value": [np.pi], "missing": [np.nan]}), tmp_path / "t.csv")
    assert (tmp_path / "t.csv").read_text() == "name,value,missing\na,3.14159265,\n"
    assert load_table(tmp_path / "t.csv")["value"].tolist() == [3.14159265]


@pytest.mark.parametrize(
    "existing", [b"the old file", None], ids=["over an old file", "where there was none"]
)
def test_a_writer_that_fails_leaves_the_folder_as_it_was(tmp_path, existing):
    path = tmp_path / "data.nc"
    if existing is not None:
        path.write_bytes(existing)

    def fail(part):
        part.write_bytes(b"half of the n")
        raise RuntimeError("disk full")

    with pytest.raises(RuntimeError, match="disk full"):
        write_whole(path, fail)
    assert [entry.name for entry in tmp_path.iterdir()] == (["data.nc"] if existing is not None else [])
    if existing is not None:
        assert path.read_bytes() == existing


def test_a_writer_sees_the_old_file_until_it_is_done(tmp_path):
    path = tmp_path / "deep/er/data.txt"
    write_whole(path, lambda part: part.write_text("old"))

    def write(part):
        part.write_text("new")
        assert path.read_text() == "old"
        assert part.parent == path.parent and part.suffix == path.suffix

    write_whole(path, write)
    assert path.read_text() == "new"


def test_a_file_is_as_readable_as_any_other(tmp_path):
    plain = tmp_path / "plain.txt"
    plain.write_text("x")
    write_whole(tmp_path / "whole.txt", lambda part: part.write_text("x"))
    assert stat.S_IMODE((tmp_path / "whole.txt").stat().st_mode) == stat.S_IMODE(plain.stat().st_mode)
