"""A results folder cannot mislead: what is missing, edited, outdated or moved is seen, renewed or said."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest
import xarray as xr
import yaml
from PIL import Image
from pipeline_copy import copy_project, planned, snakemake
from pypdf import PdfReader

from slippulse.data.records import read_records

pytestmark = [pytest.mark.workflow, pytest.mark.slow]

SWEEP = {
    "boundary": "displacement", "left": [0.5, 0.6], "right": "same", "gamma": [0.65], "duration": {"time": 6.0},
    "spacing": {"scale": 4.0}, "record": ["fronts", "fields"],
}  # fmt: skip
SCENE = {
    "title": "One", "boundary": "displacement", "left": 0.5, "right": 0.5, "gamma": 0.65, "dx": 0.1, "duration": 6.0,
}  # fmt: skip
OVERLAY = {
    "preset": "draft",
    "simulations": {
        "mine": SWEEP, "steady_displacement": {"left": [0.5], "damping_ratio": [0.0], "duration": {"time": 15.0}},
    },
    "scenes": {"one": SCENE},
}  # fmt: skip
NUMBERS = "results/measurements/mine.csv"
FIGURE = "results/figures/fig08_steady_state_displacement.png"
PAGE = "results/scenes/one.html"
TARGETS = (FIGURE, NUMBERS, PAGE)


def run(folder: Path, *arguments: str, overlay: str = "overlay.yaml") -> subprocess.CompletedProcess:
    result = snakemake(folder, *arguments, overlay=overlay, cores=2)
    assert result.returncode == 0, result.stderr
    return result


def verify(folder: Path, *arguments: str) -> subprocess.CompletedProcess:
    """As `make verify`."""
    return subprocess.run(
        [sys.executable, "-m", "slippulse.data.verify", "results", *arguments],
        cwd=folder, capture_output=True, text=True, check=False,
    )  # fmt: skip


@pytest.fixture(scope="module")
def finished(tmp_path_factory) -> Path:
    """A folder in which a figure, a sweep of one's own and a scene of one's own have been made."""
    project = Path(__file__).resolve().parents[2]
    folder = copy_project(project, tmp_path_factory.mktemp("results") / "first", link=True)
    (folder / "overlay.yaml").write_text(yaml.safe_dump(OVERLAY), encoding="utf-8")
    run(folder, "--", *TARGETS)
    return folder


@pytest.fixture
def folder(finished, tmp_path) -> Path:
    """The same, moved elsewhere: a test may do there what it likes."""
    shutil.copytree(finished, tmp_path / "copied", symlinks=True)
    return Path(shutil.move(tmp_path / "copied", tmp_path / "moved"))


def test_a_finished_folder_moved_elsewhere_has_nothing_to_do(folder):
    assert planned(snakemake(folder, "--dry-run", "--", *TARGETS, overlay="overlay.yaml")) == {}
    for path in (folder / "results").rglob("*"):
        if path.suffix in (".json", ".csv", ".html", ".txt", ".log"):
            assert str(folder.parent.parent) not in path.read_text(encoding="utf-8"), path


def test_every_file_says_by_which_configuration_it_was_made(finished):
    results = finished / "results"
    made_by = {name: record.configuration for record in read_records(results) for name in record.outputs}
    figure = results / "figures/fig08_steady_state_displacement"
    with Image.open(figure.with_suffix(".png")) as image:
        in_png = image.text["Comment"]
    in_pdf = PdfReader(figure.with_suffix(".pdf")).metadata["/Keywords"]
    digest = made_by["figures/fig08_steady_state_displacement.png"]
    assert len(digest) == 16 and in_png == in_pdf == f"configuration {digest}"
    for name in ("mine", "steady_displacement", "one"):
        with xr.open_dataset(results / f"data/{name}.nc") as data:
            assert data.attrs["configuration"] == made_by[f"data/{name}.nc"]
    # What is made from the same simulation by the same values has the same digest; another has another.
    assert len({made_by[f"data/{name}.nc"] for name in ("mine", "steady_displacement", "one")}) == 3
    assert all(made_by[name] for name in made_by if name != "kernels.txt")


def test_every_file_has_a_record_of_what_it_was_made_from(finished):
    results = finished / "results"
    records = read_records(results)
    noted = {name: digest for record in records for name, digest in record.outputs.items()}
    there = {
        path.relative_to(results).as_posix()
        for path in results.rglob("*")
        if path.is_file() and path.relative_to(results).parts[0] not in ("logs", "benchmarks", "records")
    }
    assert set(noted) == there
    for name in there:
        assert hashlib.sha256((results / name).read_bytes()).hexdigest() == noted[name], name
    (measured,) = (record for record in records if "measurements/mine.csv" in record.outputs)
    assert measured.step == "measure" and measured.inputs == {"data/mine.nc": noted["data/mine.nc"]}


def test_an_edited_measurement_is_made_anew_with_a_word_before_anything_is_built_on_it(folder):
    path = folder / NUMBERS
    before = path.read_bytes()
    path.write_bytes(before.replace(b"displacement", b"displacemenT", 1))
    moment = time.time_ns() + 10**9
    os.utime(path, ns=(moment, moment))
    dry = run(folder, "--dry-run", "--", "results/uncertainties/mine.csv")
    assert (
        f"{NUMBERS} was changed since it was made, or has no record: it would be removed" in dry.stderr
        and path.exists()
    )
    result = run(folder, "--", "results/uncertainties/mine.csv")
    assert f"{NUMBERS} was changed since it was made, or has no record: it is removed" in result.stderr
    assert path.read_bytes() == before
    (study,) = (
        record for record in read_records(folder / "results") if "uncertainties/mine.csv" in record.outputs
    )
    assert study.inputs["measurements/mine.csv"] == hashlib.sha256(before).hexdigest()


def test_a_page_that_a_killed_run_has_left_behind_is_marked_by_the_next(folder):
    """Its data were made anew, and the run ended before the page and before it could say so."""
    data, record = folder / "results/data/one.nc", folder / "results/records/data/one.nc.json"
    times = data.stat().st_mtime_ns
    data.write_bytes(data.read_bytes() + b"other")
    os.utime(data, ns=(times, times))
    content = json.loads(record.read_text(encoding="utf-8"))
    content["outputs"]["data/one.nc"] = hashlib.sha256(data.read_bytes()).hexdigest()
    record.write_text(json.dumps(content), encoding="utf-8")
    run(folder, "--", NUMBERS)
    assert "Out of date" in (folder / PAGE).read_text(encoding="utf-8")


def test_another_configuration_of_one_target_marks_the_page_it_leaves_behind(folder):
    """A page that was written from other data is marked; the run says so, and verify names it."""
    before = (folder / PAGE).read_text(encoding="utf-8")
    assert "Out of date" not in before
    changed = OVERLAY | {"scenes": {"one": SCENE | {"left": 0.6, "right": 0.6}}}
    (folder / "changed.yaml").write_text(yaml.safe_dump(changed), encoding="utf-8")
    result = run(folder, "--", "results/data/one.nc", overlay="changed.yaml")
    assert "older than what they are made from" in result.stderr
    assert "Out of date" in (folder / PAGE).read_text(encoding="utf-8")
    said = verify(folder, "--against", "results")
    assert said.returncode == 1 and "measurements/one.csv: older than data/one.nc" in said.stdout
    # Asked for again it is made anew.
    run(folder, "--", PAGE, overlay="changed.yaml")
    renewed = (folder / PAGE).read_text(encoding="utf-8")
    assert "Out of date" not in renewed and renewed != before
