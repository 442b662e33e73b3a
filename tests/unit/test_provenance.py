"""What results were made from, and their manifest."""

import getpass
import json
import socket

import yaml

from slippulse.data.alterations import changes
from slippulse.data.provenance import job_times, machine_class, manifest, provenance, source_files
from slippulse.data.records import Origin, write_record


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


def test_sources_are_the_library_and_the_workflow(project):
    names = {str(path.relative_to(project)) for path in source_files(project)}
    assert {"Snakefile", "src/slippulse/model/scene.py", "workflow/rules/common.smk"} <= names
    assert not any("__pycache__" in name or name.startswith("tests") for name in names)


def test_it_holds_everything_and_names_nobody(project, config, tmp_path):
    results = tmp_path / "results"
    results.mkdir()
    for name, seconds in (("a.csv", 1.25), ("b.csv", 0.5)):
        (results / name).write_text(name)
        origin = Origin((name,), "simulate", "", "", frozenset())
        write_record(origin, {"seconds": seconds}, results)
    assert job_times(results) == {"simulate": 1.75}
    facts = provenance(project, "", config | {"preset": "draft"}, config, results)
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


def test_the_manifest_lists_every_output(tmp_path):
    files = [str(tmp_path / "data/a.nc"), str(tmp_path / "claims.json")]
    listed = yaml.safe_load(manifest(files, tmp_path, {"a": "A caption"}))
    assert [entry["file"] for entry in listed["manifest"]] == ["claims.json", "data/a.nc"]
    assert all(entry["comment"] for entry in listed["manifest"])
    assert len(listed["paper"]["authors"]) == 4
