"""What results were made from, and whether they are what they were."""

from __future__ import annotations

import getpass
import json
import shutil
import socket

import pandas as pd
import pytest
import yaml

from slippulse.data.provenance import (
    checksums,
    job_times,
    machine_class,
    manifest,
    provenance,
    source_files,
    tree_digest,
)
from slippulse.data.verify import changed_files, compare, main


def test_an_overlay_is_marked_value_by_value():
    shipped = {"model": {"release": "total", "friction_ratio": 5.0}, "list": [1, 2], "gone": 1}
    config = {"model": {"release": "elastic", "friction_ratio": 5.0}, "list": [1], "new": {"a": 1}}
    assert changes(shipped, config) == [
        {"key": "model.release", "shipped": "total", "here": "elastic"},
        {"key": "list", "shipped": [1, 2], "here": [1]},
        {"key": "gone", "shipped": 1, "here": None},
        {"key": "new", "shipped": None, "here": {"a": 1}},
    ]
    assert changes(shipped, shipped) == []


def test_the_digest_sees_content_and_names_and_no_order(tmp_path):
    for name in ("a", "b"):
        (tmp_path / name).write_text(name)
    paths = [tmp_path / "a", tmp_path / "b"]
    digest = tree_digest(tmp_path, paths)
    assert digest == tree_digest(tmp_path, paths[::-1])
    (tmp_path / "b").write_text("c")
    assert digest != tree_digest(tmp_path, paths)


def test_sources_are_the_library_and_the_workflow(project):
    names = {str(path.relative_to(project)) for path in source_files(project)}
    assert {
        "Snakefile",
        "src/slippulse/model/scene.py",
        "workflow/rules/common.smk",
        "workflow/scripts/simulate.py",
    } <= names
    assert not any("__pycache__" in name or name.startswith("tests") for name in names)


def test_it_holds_everything_and_names_nobody(project, config, tmp_path):
    (tmp_path / "simulate").mkdir()
    (tmp_path / "simulate/a.tsv").write_text("s\tcpu_time\tmax_rss\n1.25\t1\t100\n")
    (tmp_path / "simulate/b.tsv").write_text("s\tcpu_time\tmax_rss\n0.5\t1\t100\n")
    assert job_times(tmp_path) == {"simulate": 1.75}
    facts = provenance(project, config | {"preset": "draft"}, config, tmp_path)
    assert facts["config"]["preset"] == "draft" and [entry["key"] for entry in facts["overlay"]] == ["preset"]
    assert set(facts) == {
        "paper", "overlay", "config", "source_digest", "lock_digest", "git", "versions", "implementation", "machine",
        "times",
    }  # fmt: skip
    text = json.dumps(facts | {"config": None})
    host = socket.gethostname()
    assert len(host) < 4 or host not in text
    assert str(project) not in text and f'"{getpass.getuser()}"' not in text
    assert machine_class()["cores"] >= 1


@pytest.fixture
def results(tmp_path):
    folder = tmp_path / "results"
    (folder / "data").mkdir(parents=True)
    (folder / "data/a.nc").write_bytes(b"data")
    (folder / "claims.json").write_text("[]")
    files = [folder / "data/a.nc", folder / "claims.json"]
    (folder / "checksums.txt").write_text(checksums([str(file) for file in files], folder))
    return folder


def test_untouched_results_verify(results, capsys):
    assert changed_files(results) == []
    assert main([str(results)]) == 0
    assert "2 files are what they were" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("harm", "said"),
    [
        (lambda folder: (folder / "data/a.nc").write_bytes(b"datA"), "a.nc: not what it was"),
        (lambda folder: (folder / "data/a.nc").unlink(), "a.nc: No such file"),
        (lambda folder: (folder / "checksums.txt").unlink(), "checksums.txt: No such file"),
        (lambda folder: (folder / "checksums.txt").write_text("nonsense\n"), "line 1 is not a checksum"),
        (
            lambda folder: (folder / "checksums.txt").write_text("0" * 64 + "  ../x\n"),
            "line 1 is not a checksum",
        ),
        (lambda folder: (folder / "checksums.txt").write_text(""), "0 files"),
    ],
)
def test_harmed_results_do_not(results, harm, said, capsys):
    harm(results)
    assert main([str(results)]) == 1
    printed = capsys.readouterr().out
    assert said in printed and "Traceback" not in printed


def test_the_manifest_lists_every_output(results):
    files = [str(results / "data/a.nc"), str(results / "claims.json")]
    listed = yaml.safe_load(manifest(files, results, {"a": "A caption"}))
    assert [entry["file"] for entry in listed["manifest"]] == ["claims.json", "data/a.nc"]
    assert all(entry["comment"] for entry in listed["manifest"])
    assert len(listed["paper"]["authors"]) == 4


ROW = {
    "point": 0, "boundary": "stress", "left": -1.0, "right": 0.0, "width": 1.0, "gamma": 0.0, "damping_ratio": 0.1,
    "duration": 10.0, "release": "total", "quantity": "speed", "value": 1.0, "uncertainty": 0.01,
}  # fmt: skip


def tree(folder, rows, verdict="reproduced"):
    (folder / "uncertainties").mkdir(parents=True)
    pd.DataFrame(rows).to_csv(folder / "uncertainties/sweep.csv", index=False)
    (folder / "claims.json").write_text(json.dumps([{"id": "speed", "verdict": verdict}]))
    return folder


@pytest.mark.parametrize(
    ("other", "verdict", "code", "said"),
    [
        ({}, "reproduced", 0, "1 of 1 numbers agree"),
        ({"value": 1.015}, "reproduced", 0, "1 of 1 numbers agree"),
        ({"value": 1.03}, "reproduced", 1, "point 0, speed: 1 against 1.03; allowed: a difference of 0.02"),
        ({"left": -2.0}, "reproduced", 1, "sweep.csv: other runs"),
        ({}, "not reproduced", 1, "speed: 'reproduced' against 'not reproduced'"),
    ],
)
def test_two_trees_are_compared_within_their_uncertainties(tmp_path, capsys, other, verdict, code, said):
    here, there = tree(tmp_path / "here", [ROW]), tree(tmp_path / "there", [ROW | other], verdict)
    assert main([str(here), "--against", str(there)]) == code
    assert said in capsys.readouterr().out


def test_a_number_without_uncertainty_is_counted_as_such(tmp_path):
    bare = ROW | {"uncertainty": float("nan")}
    result = compare(tree(tmp_path / "here", [bare]), tree(tmp_path / "there", [bare | {"value": 2.0}]))
    assert (result.compared, result.agree, result.unknown, result.apart) == (1, 0, 1, ())


def test_a_tree_without_numbers_is_refused(tmp_path, capsys):
    here = tree(tmp_path / "here", [ROW])
    shutil.rmtree(here / "uncertainties")
    assert main([str(here), "--against", str(here)]) == 1
    assert "allowed: a finished tree of results" in capsys.readouterr().out
