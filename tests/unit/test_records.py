"""Records of jobs, and the results that are not as a run would make them."""

import getpass
import json
import os
import socket
from functools import partial
from importlib.metadata import version
from pathlib import Path
from types import SimpleNamespace

import pytest
import yaml
from slippulse_paper.records.tree import Tree
from slippulse_paper.steps.origins import Job, jobs_of, origins_of
from slippulse_paper.steps.targets import Plan, unlike

from slippulse.data.files import write_text
from slippulse_paper.configuration.problems import ConfigError
from slippulse_paper.records.job_records import (
    Origin,
    digest_of,
    file_digest,
    read_record,
    write_record,
)
from slippulse_paper.records.provenance import (
    changes,
    job_times,
    machine_class,
    manifest,
    provenance,
    source_files,
)

DATA, TABLE = "data/a.nc", "measurements/a.csv"
PAGE, OTHER = "index.html", "scenes/other.html"
SUMMARY = "manuscript/summary.yaml"
JOBS = [
    Job("simulate", (), (f"results/{DATA}",), {"level": 0.5}),
    Job("measure", (f"results/{DATA}",), (f"results/{TABLE}",), {}),
    Job("write_index", (f"results/{TABLE}", SUMMARY), (f"results/{PAGE}",), {"title": "All"}),
    Job("animate_scene", (), (f"results/{OTHER}",), {}),
]


def run(folder: Path, jobs=JOBS, options: str = "") -> Path:
    """Write the results and records of some jobs."""
    for job in jobs:
        origin = origins_of(jobs)[job.outputs[0].removeprefix("results/")]
        for output in job.outputs:
            write_text(f"{job.step} {origin.configuration}", folder / output)
        inputs = {name: file_digest(folder / "results" / name) for name in origin.inputs}
        write_record(origin, inputs, {"seconds": 1.5, "options": options}, folder / "results")
    return folder / "results"


@pytest.fixture
def results(tmp_path) -> Path:
    return run(tmp_path)


def faults(results: Path, jobs=JOBS) -> dict[str, str]:
    names = origins_of(jobs)
    return Tree(results, names).faults(names)


def problems(results: Path) -> tuple[list[str], int, list[str]]:
    names = origins_of(JOBS)
    return Tree(results, names).problems(names)


def test_a_record_says_what_was_made_by_what_from_what(results):
    record = read_record(results / f"records/{TABLE}.json")
    assert record.step == "measure" and [*record.inputs] == [DATA] and [*record.outputs] == [TABLE]
    assert faults(results) == {} and problems(results) == ([], len(JOBS), [])
    write_record(Origin((PAGE,), "measure", "", "", {}), {}, {"seconds": 0.25}, results)
    assert job_times(results) == {"simulate": 1.5, "measure": 1.75, "animate_scene": 1.5}


def put_folder(path: Path) -> None:
    path.unlink()
    path.mkdir()


def rewrite(path: Path, **change) -> None:
    path.write_text(json.dumps(json.loads(path.read_text()) | change))


CHANGED = {DATA: "not what its job wrote"}
# The table was made from the data, and the page from the table.
OLDER = {
    TABLE: f"older than {DATA}, which it is made from",
    PAGE: f"older than {TABLE}, which it is made from",
}
MISSING, UNREADABLE = {DATA: "missing"}, {OTHER: "its record cannot be read"}
RULE, SOURCES = {OTHER: "made by another rule"}, {OTHER: "made by other sources"}
CONFIGURATION = {OTHER: "made by another configuration"}
RECORD, OTHER_RECORD = f"records/{DATA}.json", f"records/{OTHER}.json"
ODD_RECORDS = {"empty": "", "cut": "{", "a list": "[]", "a number": "5"}
ODD_RECORDS |= {"without fields": '{"step": 1}', "nested too deep": "[" * 100_000}
# A file, a change of it, and the results that are named, by reason.
HARMED = {
    "edited, of the old size": (DATA, lambda path: path.write_text("datA"), CHANGED),
    "emptied": (DATA, lambda path: path.write_text(""), CHANGED),
    "removed": (DATA, Path.unlink, MISSING),
    "a folder": (DATA, put_folder, MISSING),
    "other outputs": (OTHER_RECORD, partial(rewrite, outputs={}), RULE),
    "other step": (OTHER_RECORD, partial(rewrite, step="measure"), RULE),
    "other sources": (OTHER_RECORD, partial(rewrite, sources=""), SOURCES),
    "other configuration": (OTHER_RECORD, partial(rewrite, configuration=""), CONFIGURATION),
    "other inputs": (f"records/{TABLE}.json", partial(rewrite, inputs={DATA: "0"}), OLDER),
    "other data": (RECORD, partial(rewrite, outputs={DATA: "0"}), CHANGED | OLDER),
    "no record": (RECORD, Path.unlink, {DATA: "no record"} | OLDER),
    "record a folder": (OTHER_RECORD, put_folder, UNREADABLE),
}
for name, text in ODD_RECORDS.items():
    HARMED[f"record {name}"] = OTHER_RECORD, partial(Path.write_text, data=text), UNREADABLE


@pytest.mark.parametrize("time", [None, 0])
@pytest.mark.parametrize(("name", "harm", "expected"), HARMED.values(), ids=HARMED)
def test_a_result_that_is_not_as_made_is_named(results, name, harm, expected, time):
    """Exactly the expected results are faulty, whatever the times of the files: as before, or 0."""
    before = {path: path.stat().st_mtime_ns for path in results.rglob("*")}
    harm(results / name)
    for path in results.rglob("*"):
        os.utime(path, ns=(before[path] if time is None else time,) * 2)
    assert faults(results) == expected
    assert problems(results)[0] == [f"{results / name}: {why}" for name, why in expected.items()]
    names = origins_of(JOBS)
    present = {name: reason for name, reason in expected.items() if reason != "missing"}
    assert Tree(results, names).to_renew(names) == present


def test_only_what_is_wanted_and_what_that_is_made_from_or_with_is_renewed(results):
    for name in (DATA, OTHER):
        (results / name).write_text("changed")
    # The table was made from what the record of the data says.
    assert Tree(results, origins_of(JOBS)).to_renew([TABLE]) == {DATA: "not what its job wrote"}
    jobs = [Job("draw_figure", (), ("results/a.png", "results/a.pdf"), {})]
    run(results.parent, jobs)
    (results / "a.pdf").unlink()
    tree = Tree(results, origins_of(jobs))
    assert tree.behind(["a.png"]) == ["a.png", "a.pdf"]
    assert tree.to_renew(["a.png"]) == {"a.png": "made with a file that is not as made"}


AFTER_DATA = dict.fromkeys((DATA, TABLE, PAGE), "configuration")
OTHER_JOBS = {
    "level": (0, {"settings": {"level": 0.6}}, AFTER_DATA),
    "title": (2, {"settings": {"title": "Other"}}, {PAGE: "configuration"}),
    "text": (2, {"inputs": (f"results/{TABLE}",)}, {PAGE: "sources"}),
    "table": (2, {"inputs": (f"results/{DATA}", SUMMARY)}, {PAGE: "rule"}),
}


@pytest.mark.parametrize(("index", "change", "reasons"), OTHER_JOBS.values(), ids=OTHER_JOBS)
def test_another_configuration_is_told(results, index, change, reasons):
    jobs = [*JOBS]
    jobs[index] = jobs[index]._replace(**change)
    assert {name: why.split()[-1] for name, why in faults(results, jobs).items()} == reasons


def test_a_file_that_no_rule_makes_is_not_known(results):
    (results / "data/mine.nc").write_text("mine")
    (results / "logs").mkdir()
    (results / "logs/a.log").write_text("")
    write_text("{}", results / "records/gone.csv.json")
    names = ("data/mine.nc", "records/gone.csv.json")
    unknown = [f"{results / name}: not known; no rule makes it" for name in names]
    assert problems(results)[0] == unknown


def test_what_another_overlay_has_made_is_harmless_as_long_as_it_is_as_made(results, capsys):
    mine = [Job("draw_scene", (), ("results/scenes/mine.png", "results/scenes/mine.pdf"), {})]
    for options in ("--configfile mine.yaml", ""):
        run(results.parent, mine, options)
        lines, count, foreign = problems(results)
        reason = f"made with {options or 'the shipped configuration'}: harmless"
        names = ("records/scenes/mine.png.json", "scenes/mine.pdf", "scenes/mine.png")
        assert (lines, count) == ([], len(JOBS))
        assert foreign == [f"{results / name}: {reason}" for name in names]
    (results / "scenes/mine.pdf").write_text("edited")
    assert len(problems(results)[0]) == 3 and problems(results)[2] == []


def test_an_environment_that_is_not_that_of_the_lock_is_named(tmp_path, monkeypatch):
    lock = tmp_path / "lock"
    lock.write_text(f"numpy=={version('numpy')} \\\n    --hash=sha256:0\nno-such-package==1.0\n")
    assert unlike(lock) == ""
    for other in ("xarray==0.1 ; python_version < '3.12' \\\n", "xarray==0.2 \\\n"):
        lock.write_text(lock.read_text() + other)
    installed = f"xarray: {version('xarray')} is installed; allowed: 0.1 or 0.2"
    assert unlike(lock).startswith(f"{installed}, as in requirements.lock")


@pytest.fixture
def plan(results, monkeypatch) -> Plan:
    """The plan of the jobs, in the folder of the project."""
    monkeypatch.chdir(results.parent)
    named = {"all": [f"results/{PAGE}"], "everything": [f"results/{PAGE}", f"results/{OTHER}"]}
    return Plan(JOBS, named)


def test_what_is_asked_for_is_known_or_guessed_and_compared(plan, results, capsys):
    assert plan.wanted(["all"]) == [DATA, TABLE, PAGE]
    assert plan.wanted([f"results/{OTHER}"]) == [OTHER]
    refusal = r"target: 'al' \(did you mean 'all'\?\); allowed: a rule"
    with pytest.raises(ConfigError, match=refusal):
        plan.wanted(["al"])
    (results / OTHER).unlink()
    assert plan.verify(plan.wanted(["all"])) == 0
    said = capsys.readouterr().out
    assert "3 files are as made" in said and "Not looked at: 1 files" in said
    assert plan.verify(plan.wanted(["everything"])) == 1
    assert capsys.readouterr().out == f"results/{OTHER}: missing\n"


def test_a_run_begins_with_what_is_as_made_and_alone(plan, results, capsys):
    (results / TABLE).write_text("changed")
    os.utime(results / DATA, (2e9, 2e9))
    (results.parent / "src").mkdir()
    held = plan.begin(plan.wanted(["all"]))
    # Older than the sources, so that Snakemake finds it outdated.
    assert (results / TABLE).read_text() == "changed" and (results / TABLE).stat().st_mtime == 1.0
    times = [path.stat().st_mtime for path in (results.parent / "src", results / DATA)]
    assert max(times) <= (results / PAGE).stat().st_mtime < 2e9
    said, reason = capsys.readouterr().err, "not what its job wrote; made anew where needed"
    assert f"1 result is out of date, such as results/{TABLE}: {reason}" in said
    assert f"1 files have a time in the future, as results/{DATA}" in said
    with pytest.raises(ConfigError, match="Another run is at work"):
        plan.begin([])
    # Whoever only looks then changes nothing.
    (results / PAGE).write_text("changed")
    before = (results / PAGE).stat()
    assert plan.begin(plan.wanted(["all"]), makes=False) is None
    assert (results / PAGE).stat().st_mtime == before.st_mtime
    held.close()


def test_the_jobs_of_a_rule_are_those_of_its_wildcard():
    params = {"level": lambda wildcards: wildcards.name * 2, "step": "study"}
    inputs = ["texts", lambda wildcards: [f"results/{wildcards.name}"]]
    rule = SimpleNamespace(input=inputs, output=["results/{name}.csv"], params=params)
    assert [*jobs_of("run", rule, {"name": "ab"})] == [
        ("study", ("texts", "results/a"), ("results/a.csv",), {"level": "aa"}),
        ("study", ("texts", "results/b"), ("results/b.csv",), {"level": "bb"}),
    ]


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
