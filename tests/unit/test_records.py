"""Records of jobs, and the results that are not what their jobs wrote."""

import base64
import getpass
import json
import os
import socket
from functools import partial
from importlib.metadata import version
from pathlib import Path

import pytest
import yaml

from slippulse.data.files import write_text
from slippulse_paper.records.job_records import (
    FileState,
    Record,
    RecordedFiles,
    digest_of,
    file_digest,
    job_seconds,
    made_without_step,
    read_record,
    state_of,
    write_record,
)
from slippulse_paper.records.packages import package_problem
from slippulse_paper.records.provenance import (
    changes,
    machine_class,
    manifest,
    provenance,
    source_files,
)

DATA, TABLE = "results/data/a.nc", "results/measurements/a.csv"
PAGE, PICTURE = "results/index.html", "results/index.png"
# Outputs of each job by its step, and its inputs.
JOBS = {
    "simulate": ([DATA], []),
    "measure": ([TABLE], [DATA]),
    "write_index": ([PAGE, PICTURE], [TABLE]),
}


@pytest.fixture
def results(tmp_path, monkeypatch) -> Path:
    """The results and records of some jobs, in the working directory."""
    monkeypatch.chdir(tmp_path)
    for step, (outputs, inputs) in JOBS.items():
        for output in outputs:
            write_text(f"{step} {inputs}", output)
            name = base64.urlsafe_b64encode(output.encode()).decode()
            write_text("{}", f".snakemake/metadata/{name}")
        folder = Path(outputs[0]).parent
        states = {Path(output).name: state_of(output) for output in outputs}
        read = {os.path.relpath(path, folder): file_digest(path) for path in inputs}
        write_record(Record(step, "code", "settings", states, read, 1.5), folder)
    return Path("results")


def problems(results: Path) -> dict[str, str]:
    return dict(RecordedFiles(results).problems())


def test_a_record_says_what_was_made_by_what_from_what(results):
    record = read_record("results/measurements/.records/a.csv.json")
    assert record.step == "measure" and record.inputs == {"../data/a.nc": file_digest(DATA)}
    assert record.outputs == {"a.csv": state_of(TABLE)} and record.code == "code"
    assert problems(results) == {}
    assert job_seconds(results) == dict.fromkeys(JOBS, 1.5)
    write_record(record._replace(outputs={"b.csv": FileState("", 0, 0)}, seconds=0.25), results)
    assert job_seconds(results)["measure"] == 1.75


def put_folder(path: Path) -> None:
    path.unlink()
    path.mkdir()


def rewrite(path: Path, **change) -> None:
    path.write_text(json.dumps(json.loads(path.read_text()) | change))


CHANGED = {DATA: "changed since its job wrote it"}
OLDER = {TABLE: f"made from an earlier version of {DATA}"}
UNREADABLE = {PAGE: "its record cannot be read"}
RECORD, PAGE_RECORD = "results/data/.records/a.nc.json", "results/.records/index.html.json"
TABLE_RECORD = "results/measurements/.records/a.csv.json"
KNOWN = f".snakemake/metadata/{base64.urlsafe_b64encode(DATA.encode()).decode()}"
OTHER_STATE = {"a.nc": {"sha256": "0", "size": 1, "modified_ns": 1}}
ODD_RECORDS = {"empty": "", "cut": "{", "a list": "[]", "a number": "5"}
ODD_RECORDS |= {"without fields": '{"step": 1}', "nested too deep": "[" * 100_000}
# A file, a change of it, and the results that are named, by reason.
HARMED = {
    "edited, of the old size": (DATA, lambda path: path.write_text("simulatE []"), CHANGED),
    "emptied": (DATA, lambda path: path.write_text(""), CHANGED),
    # Snakemake makes it again where it is needed.
    "removed": (DATA, Path.unlink, {}),
    "a folder": (DATA, put_folder, CHANGED),
    "other inputs": (TABLE_RECORD, partial(rewrite, inputs={"../data/a.nc": "0"}), OLDER),
    "other data": (RECORD, partial(rewrite, outputs=OTHER_STATE), CHANGED | OLDER),
    "no record": (RECORD, Path.unlink, {}),
    "unknown to Snakemake": (
        KNOWN,
        Path.unlink,
        {DATA: "Snakemake's own record of this file (in .snakemake) is lost"},
    ),
}
for name, text in ODD_RECORDS.items():
    HARMED[f"record {name}"] = PAGE_RECORD, partial(Path.write_text, data=text), UNREADABLE


@pytest.mark.parametrize("time", [None, 0])
@pytest.mark.parametrize(("name", "harm", "expected"), HARMED.values(), ids=HARMED)
def test_a_result_that_is_not_as_made_is_named(results, name, harm, expected, time):
    """Exactly the expected results are named, whatever the times of files whose content changed."""
    paths = [path for path in results.rglob("*") if path.is_file()]
    before = {path: path.stat().st_mtime_ns for path in paths}
    harm(Path(name))
    for path in paths:
        if path.exists() and time is not None:
            os.utime(path, ns=(time, time))
        elif path.exists() and path != Path(name):
            os.utime(path, ns=(before[path],) * 2)
    assert problems(results) == expected


def test_results_of_older_inputs_are_found_through_all_jobs(results):
    recorded = RecordedFiles(results)
    assert recorded.older_than_inputs() == set()
    rewrite(Path(RECORD), outputs=OTHER_STATE)
    # The page was made from the table, and the table from other data.
    assert RecordedFiles(results).older_than_inputs() == {TABLE, PAGE, PICTURE}


def test_a_file_by_a_rule_of_the_user_needs_no_record(results):
    codes = {DATA: '        run_step("simulate", ...)', TABLE: "wc -l {input}", PAGE: None}
    for name, code in codes.items():
        path = Path(".snakemake/metadata", base64.urlsafe_b64encode(name.encode()).decode())
        path.write_text(json.dumps({"code": code}))
    assert made_without_step([*codes, PICTURE, "results/unknown.txt"]) == {TABLE}


def test_a_file_that_was_copied_elsewhere_with_its_record_is_as_made(results):
    os.utime(DATA)
    Path("results").rename("moved")
    assert {reason for reason in problems(Path("moved")).values()} <= {
        "Snakemake's own record of this file (in .snakemake) is lost"
    }


def test_an_environment_that_is_not_that_of_the_lock_is_named(tmp_path):
    lock = tmp_path / "lock"
    lock.write_text(f"numpy=={version('numpy')} \\\n    --hash=sha256:0\nno-such-package==1.0\n")
    assert package_problem(lock) == ""
    for other in ("xarray==0.1 ; python_version < '3.12' \\\n", "xarray==0.2 \\\n"):
        lock.write_text(lock.read_text() + other)
    installed = f"xarray: {version('xarray')} is installed; allowed: 0.1 or 0.2"
    assert package_problem(lock).startswith(f"{installed}, as in requirements.lock")


def test_a_digest_does_not_depend_on_the_order_of_keys():
    digest = digest_of({"a": 1, "b": [2]})
    assert digest == digest_of({"b": [2], "a": 1}) != digest_of({"a": 1, "b": [3]})


def test_an_overlay_is_marked_value_by_value():
    shipped = {"model": {"release": "total", "friction_ratio": 5.0}, "list": [1, 2], "gone": 1}
    config = {"model": {"release": "elastic", "friction_ratio": 5.0}, "list": [1], "new": {"a": 1}}
    expected = [("model.release", "total", "elastic"), ("list", [1, 2], [1])]
    expected += [("gone", 1, None), ("new", None, {"a": 1})]
    assert [(*change.values(),) for change in changes(shipped, config)] == expected
    assert changes(shipped, shipped) == []


def test_provenance_holds_everything_and_names_nobody(project, config, results, tmp_path):
    facts = provenance(project, config | {"preset": "draft"}, config, results)
    assert facts["config"]["preset"] == "draft"
    assert [entry["key"] for entry in facts["overlay"]] == ["preset"]
    names = "paper overlay config source_digest lock_digest git versions machine times"
    assert set(facts) == {*names.split()}
    text = json.dumps(facts | {"config": None})
    host = socket.gethostname()
    assert len(host) < 4 or host not in text
    assert str(project) not in text and f'"{getpass.getuser()}"' not in text
    assert machine_class()["cores"] >= 1
    files = [str(tmp_path / "data/a.nc"), str(tmp_path / "claims.json")]
    listed = yaml.safe_load(manifest(files, tmp_path, {"a": "A caption"}))
    assert [entry["file"] for entry in listed["manifest"]] == ["claims.json", "data/a.nc"]
    assert all(entry["comment"] for entry in listed["manifest"])
    assert len(listed["paper"]["authors"]) == 4
    names = {str(path.relative_to(project)) for path in source_files(project)}
    assert {"Snakefile", "src/slippulse/model/scene.py", "workflow/rules/common.smk"} <= names
    assert not any("__pycache__" in name or name.startswith("tests") for name in names)
