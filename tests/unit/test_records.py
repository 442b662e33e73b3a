"""What each job made from what: what was changed by hand, what is out of date, and pages that say so."""

from __future__ import annotations

import json
import os
import time
from pathlib import Path

import pytest

from slippulse.data.files import write_text
from slippulse.data.provenance import job_times
from slippulse.data.records import (
    NOTE,
    changed_since_made,
    digest_of,
    mark_outdated,
    outdated,
    read_records,
    remove_changed,
    write_record,
)

PAGE = "<html><body class='wide'><p>All well.</p></body></html>"


def make(results: Path, name: str, content: str, *sources: str) -> Path:
    """A job that writes one file from others."""
    path = results / name
    write_text(content, path)
    files = {"sources": [str(results / source) for source in sources]}
    write_record("some_step", files, {"made": str(path)}, {"configuration": "abc"}, {})
    return path


@pytest.fixture
def results(tmp_path) -> Path:
    """Data, numbers measured in them, and two pages and a document that show the numbers."""
    folder = tmp_path / "results"
    make(folder, "data/a.nc", "data")
    make(folder, "measurements/a.csv", "x\n1\n", "data/a.nc")
    make(folder, "index.html", PAGE, "measurements/a.csv")
    make(folder, "manuscript/report.pdf", "%PDF", "measurements/a.csv")
    make(folder, "scenes/other.html", PAGE)
    return folder


def later(path: Path) -> None:
    """Let a file be newer than its record, as an edit makes it."""
    moment = time.time_ns() + 10**9
    os.utime(path, ns=(moment, moment))


def test_a_record_says_what_was_made_by_which_configuration_from_what(results):
    (record,) = (record for record in read_records(results) if "measurements/a.csv" in record.outputs)
    assert (record.step, record.configuration) == ("some_step", "abc")
    assert list(record.inputs) == ["data/a.nc"]
    assert changed_since_made(results) == []
    assert outdated(results) == mark_outdated(results) == {}


def test_a_file_edited_by_hand_is_found_and_removed(results):
    path = results / "measurements/a.csv"
    path.write_text("x\n2\n")
    later(path)
    assert changed_since_made(results) == ["measurements/a.csv"]
    assert remove_changed(results) == ["measurements/a.csv"] and not path.exists()
    assert changed_since_made(results) == []


def test_a_file_that_is_only_touched_stays(results):
    later(results / "measurements/a.csv")
    assert remove_changed(results) == [] and (results / "measurements/a.csv").exists()


def test_a_file_changed_long_ago_is_found(results):
    """As a backup that keeps its times brings it back."""
    path = results / "data/a.nc"
    path.write_text("datA")
    os.utime(path, ns=(0, 0))
    assert changed_since_made(results) == ["data/a.nc"]


def test_what_is_made_from_something_outdated_is_outdated_too(results):
    make(results, "data/a.nc", "other data")
    assert outdated(results) == {
        "measurements/a.csv": "data/a.nc",
        "index.html": "measurements/a.csv",
        "manuscript/report.pdf": "measurements/a.csv",
    }


def test_outdated_pages_are_marked_once_and_documents_go(results):
    page, other = results / "index.html", results / "scenes/other.html"
    before = page.stat().st_mtime_ns
    make(results, "data/a.nc", "other data")
    for _ in range(2):
        assert set(mark_outdated(results)) >= {"index.html", "measurements/a.csv"}
        assert page.read_text().count("Out of date") == page.read_text().count(NOTE) == 1
    assert page.read_text().startswith("<html><body class='wide'>" + NOTE)
    # Older than what it is made from, so that the next run renews it; the mark is not an edit by hand.
    assert page.stat().st_mtime_ns == before and changed_since_made(results) == []
    assert other.read_text() == PAGE and not (results / "manuscript/report.pdf").exists()


def test_a_page_that_is_made_anew_is_no_longer_outdated(results):
    make(results, "data/a.nc", "other data")
    make(results, "measurements/a.csv", "x\n3\n", "data/a.nc")
    make(results, "index.html", PAGE, "measurements/a.csv")
    assert "index.html" not in mark_outdated(results)
    assert (results / "index.html").read_text() == PAGE


ODD = ["", "{", "[]", '{"step": 1}', "[" * 100_000]
ODD += [
    json.dumps({"step": "s", "configuration": "", "outputs": {"data/a.nc": "0"}, "inputs": {}} | change)
    for change in ({"outputs": 5}, {"outputs": ["a"]}, {"inputs": None}, {"used": 5})
]


@pytest.mark.parametrize("text", ODD)
def test_a_record_that_cannot_be_read_is_as_none_and_stays(results, text):
    path = results / "records/data/a.nc.json"
    path.write_text(text)
    assert "data/a.nc" not in [name for record in read_records(results) for name in record.outputs]
    assert changed_since_made(results) == [] and mark_outdated(results) == {} and path.read_text() == text


def test_a_folder_in_place_of_a_record_or_of_an_output_stops_nothing(results):
    for name in ("records/data/a.nc.json", "measurements/a.csv"):
        (results / name).unlink()
        (results / name).mkdir()
    assert changed_since_made(results) == ["measurements/a.csv"]
    assert remove_changed(results) == [] and (results / "measurements/a.csv").is_dir()


@pytest.mark.parametrize("place", ["../mine.txt", "data/../../mine.txt", "{outside}/mine.txt"])
def test_a_record_that_names_a_file_elsewhere_is_as_none(results, place):
    mine = results.parent / "mine.txt"
    mine.write_text("mine")
    path = results / "records/data/a.nc.json"
    content = json.loads(path.read_text())
    content["outputs"] |= {place.format(outside=results.parent): "0"}
    path.write_text(json.dumps(content))
    later(mine)
    assert remove_changed(results) == [] and mine.read_text() == "mine"


def test_a_record_of_another_version_is_read(results):
    path = results / "records/data/a.nc.json"
    content = json.loads(path.read_text())
    del content["used"]
    path.write_text(json.dumps(content | {"host": "new"}))
    (record,) = (record for record in read_records(results) if "data/a.nc" in record.outputs)
    assert record.used["seconds"] == 0.0 and job_times(results) == {"some_step": 0.0}


def test_an_expected_file_without_a_record_is_removed_and_no_other(results):
    (results / "records/data/a.nc.json").unlink()
    (results / "data/mine.nc").write_text("mine")
    assert remove_changed(results) == []
    expected = ["data/a.nc", "data/b.nc", "measurements/a.csv"]
    assert changed_since_made(results, expected=expected) == ["data/a.nc"]
    assert remove_changed(results, expected) == ["data/a.nc"]
    assert not (results / "data/a.nc").exists() and (results / "data/mine.nc").exists()


def test_the_digest_does_not_depend_on_the_order_of_keys():
    assert digest_of({"a": 1, "b": [2]}) == digest_of({"b": [2], "a": 1}) != digest_of({"a": 1, "b": [3]})
