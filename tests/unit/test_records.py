"""What each job made from what, by which configuration and sources, and what is not as made by what is here now."""

import getpass
import json
import os
import shutil
import socket
from pathlib import Path

import pytest
import yaml

from slippulse.configuration.problems import ConfigError
from slippulse.data import records
from slippulse.data.alterations import changes
from slippulse.data.files import write_text
from slippulse.data.provenance import job_times, machine_class, manifest, provenance, source_files
from slippulse.data.records import (
    Digests,
    Origin,
    Tree,
    digest_of,
    read_record,
    read_records,
    write_record,
)
from slippulse.steps.reach import Job, jobs_of, origins_of
from slippulse.steps.targets import Plan

DATA, TABLE, PAGE, OTHER = "data/a.nc", "measurements/a.csv", "index.html", "scenes/other.html"
JOBS = [
    Job("simulate", (), (f"results/{DATA}",), {"level": 0.5}),
    Job("measure", (f"results/{DATA}",), (f"results/{TABLE}",), {}),
    Job("write_index", (f"results/{TABLE}", "manuscript/summary.yaml"), (f"results/{PAGE}",), {"title": "All"}),
    Job("animate_scene", (), (f"results/{OTHER}",), {}),
]  # fmt: skip


def run(folder: Path, jobs=JOBS) -> None:
    origins = origins_of(jobs)
    for job in jobs:
        origin = origins[job.outputs[0].removeprefix("results/")]
        for output in job.outputs:
            write_text(f"{job.step} {origin.configuration}", folder / output)
        write_record(origin, {"seconds": 1.5}, folder / "results")


@pytest.fixture
def results(tmp_path) -> Path:
    run(tmp_path)
    return tmp_path / "results"


def found(results: Path, kind: str = "faults", jobs=JOBS):
    origins = origins_of(jobs)
    return getattr(Tree(results, origins), kind)(origins)


def test_a_record_says_what_was_made_by_what_from_what(results):
    record = read_record(results / f"records/{TABLE}.json")
    assert record.step == "measure" and [*record.inputs] == [DATA] and [*record.outputs] == [TABLE]
    assert found(results) == {} and len(read_records(results)) == len(JOBS)
    assert found(results, "problems") == ([], len(JOBS))
    write_record(Origin((PAGE,), "measure", "", "", frozenset()), {"seconds": 0.25}, results)
    assert job_times(results) == {"simulate": 1.5, "measure": 1.75, "animate_scene": 1.5}


def record_of(results: Path, name: str, **change) -> None:
    path = results / f"records/{name}.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | change))


RECORD = f"records/{OTHER}.json"
AFTER = {
    one: f"older than {other}, which it is made from"
    for one, other in ((TABLE, DATA), (PAGE, TABLE))
}
HARM = {
    "edited": (lambda folder: (folder / DATA).write_text("datA"), {DATA: "not what its job wrote"}),
    "emptied": (lambda folder: (folder / DATA).write_text(""), {DATA: "not what its job wrote"}),
    "removed": (lambda folder: (folder / DATA).unlink(), {DATA: "missing"}),
    "a folder": (lambda folder: ((folder / DATA).unlink(), (folder / DATA).mkdir()), {DATA: "missing"}),
    "a folder for a record": (
        lambda folder: ((folder / RECORD).unlink(), (folder / RECORD).mkdir()), {OTHER: "its record cannot be read"},
    ),
    "other outputs": (lambda folder: record_of(folder, OTHER, outputs={}), {OTHER: "made by another rule"}),
    "another step": (lambda folder: record_of(folder, OTHER, step="measure"), {OTHER: "made by another rule"}),
    "other sources": (lambda folder: record_of(folder, OTHER, sources=""), {OTHER: "made by other sources"}),
    "no record": (lambda folder: (folder / f"records/{DATA}.json").unlink(), {DATA: "no record"} | AFTER),
    "other data": (
        lambda folder: record_of(folder, DATA, outputs={DATA: "0"}), {DATA: "not what its job wrote"} | AFTER,
    ),
    **{
        f"record {text[:9]}": (
            lambda folder, text=text: (folder / RECORD).write_text(text), {OTHER: "its record cannot be read"},
        )
        for text in ("", "{", "[]", "5", '{"step": 1}', "[" * 100_000)
    },
}  # fmt: skip


@pytest.mark.parametrize("case", HARM)
def test_what_is_not_as_made_is_named_and_in_the_way_whatever_its_time(results, case):
    harm, expected = HARM[case]
    harm(results)
    for path in results.rglob("*"):
        os.utime(path, ns=(0, 0))
    assert found(results) == expected
    assert found(results, "problems")[0] == [
        f"{results / name}: {why}" for name, why in expected.items()
    ]
    in_the_way = {name: reason for name, reason in expected.items() if reason != "missing"}
    assert found(results, "to_remove") == in_the_way


def test_only_what_is_wanted_and_what_that_is_made_from_or_with_is_in_the_way(results):
    for name in (DATA, OTHER):
        (results / name).write_text("changed")
    # The table was made from what the record of the data says.
    assert Tree(results, origins_of(JOBS)).to_remove([TABLE]) == {DATA: "not what its job wrote"}
    jobs = [Job("draw_figure", (), ("results/a.png", "results/a.pdf"), {})]
    run(results.parent, jobs)
    (results / "a.pdf").unlink()
    tree = Tree(results, origins_of(jobs))
    assert tree.behind(["a.png"]) == ["a.png", "a.pdf"]
    assert tree.to_remove(["a.png"]) == {"a.png": "made with a file that is not as made"}


ANOTHER = {
    "level": (0, {"settings": {"level": 0.6}}, dict.fromkeys((DATA, TABLE, PAGE), "configuration")),
    "title": (2, {"settings": {"title": "Other"}}, {PAGE: "configuration"}),
    "text": (2, {"inputs": (f"results/{TABLE}",)}, {PAGE: "sources"}),
    "table": (2, {"inputs": (f"results/{DATA}", "manuscript/summary.yaml")}, {PAGE: "rule"}),
}


@pytest.mark.parametrize("name", ANOTHER)
def test_another_configuration_is_told(results, name):
    (index, change, reasons), jobs = ANOTHER[name], [*JOBS]
    jobs[index] = jobs[index]._replace(**change)
    assert {name: why.split()[-1] for name, why in found(results, jobs=jobs).items()} == reasons


def test_a_file_that_no_rule_makes_is_not_known(results):
    (results / "data/mine.nc").write_text("mine")
    (results / "logs").mkdir()
    (results / "logs/a.log").write_text("")
    write_text("{}", results / "records/gone.csv.json")
    unknown = [
        f"{results / name}: not known; no rule makes it"
        for name in ("data/mine.nc", "records/gone.csv.json")
    ]
    assert found(results, "problems")[0] == unknown


def test_a_digest_is_remembered_as_long_as_the_system_says_that_the_file_is_the_same(
    tmp_path, monkeypatch
):
    path, cache = tmp_path / "a", tmp_path / "cache"
    path.write_text("one")
    # One that was just written is read again.
    for settled in (records.SETTLED, -1.0):
        assert not cache.exists()
        monkeypatch.setattr(records, "SETTLED", settled)
        digests = Digests(cache)
        first = digests.of(path)
        digests.save()
    cache.write_text(cache.read_text().replace(first, "remembered"))
    assert Digests(cache).of(path) == "remembered"
    # Another content of the same length, with the same time.
    times = path.stat()
    path.write_text("two")
    os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))
    second = Digests(cache).of(path)
    assert second not in ("remembered", first)
    shutil.copy2(path, tmp_path / "b")
    (tmp_path / "b").replace(path)
    assert Digests(cache).of(path) == second
    cache.write_text("[" * 100)
    assert Digests(cache).of(path) == second


@pytest.fixture
def plan(results, monkeypatch) -> Plan:
    """In the folder of the project."""
    monkeypatch.chdir(results.parent)
    return Plan(
        JOBS, {"all": [f"results/{PAGE}"], "everything": [f"results/{PAGE}", f"results/{OTHER}"]}
    )


def test_a_target_is_known_or_guessed(plan):
    assert plan.wanted(["all"]) == [DATA, TABLE, PAGE] and plan.wanted([f"results/{OTHER}"]) == [
        OTHER
    ]
    with pytest.raises(
        ConfigError, match=r"target: 'al' \(did you mean 'all'\?\); allowed: a rule"
    ):
        plan.wanted(["al"])


def test_a_run_begins_with_what_is_as_made_and_alone(plan, results, capsys):
    (results / TABLE).write_text("changed")
    os.utime(results / DATA, (2e9, 2e9))
    held = plan.begin(plan.wanted(["all"]), results.parent / "locks")
    assert not (results / TABLE).exists() and (results / PAGE).exists()
    assert (results / DATA).stat().st_mtime <= (results / PAGE).stat().st_mtime < 2e9
    said, reason = capsys.readouterr().err, "not what its job wrote; removed"
    assert f"1 results are not as made by what is here now, as results/{TABLE}: {reason}" in said
    assert f"1 files have a time in the future, as results/{DATA}" in said
    with pytest.raises(ConfigError, match="Another run is at work"):
        plan.begin([], results.parent / "locks")
    held.close()


def test_verification_compares_what_is_asked_for(plan, results, capsys):
    (results / OTHER).unlink()
    assert plan.verify(plan.wanted(["all"])) == 0
    assert (
        "3 files are as made" in (said := capsys.readouterr().out)
        and "Not looked at: 1 files" in said
    )
    assert plan.verify(plan.wanted(["everything"])) == 1
    assert capsys.readouterr().out == f"results/{OTHER}: missing\n"


def test_the_jobs_of_a_rule_are_those_of_its_wildcard():
    of = {"level": lambda wildcards: wildcards.name * 2, "step": "study"}
    inputs = ["texts", lambda wildcards: [f"results/{wildcards.name}"]]
    for name, job in zip(
        "ab", jobs_of("run", inputs, ["results/{name}.csv"], of, {"name": "ab"}), strict=True
    ):
        assert job == (
            "study",
            ("texts", f"results/{name}"),
            (f"results/{name}.csv",),
            {"level": name * 2},
        )


def test_an_overlay_is_marked_value_by_value_and_digests_do_not_depend_on_the_order_of_keys():
    assert (
        digest_of({"a": 1, "b": [2]})
        == digest_of({"b": [2], "a": 1})
        != digest_of({"a": 1, "b": [3]})
    )
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


def test_it_holds_everything_and_names_nobody(project, config, results):
    facts = provenance(project, "", config | {"preset": "draft"}, config, results)
    assert facts["config"]["preset"] == "draft" and [
        entry["key"] for entry in facts["overlay"]
    ] == ["preset"]
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
