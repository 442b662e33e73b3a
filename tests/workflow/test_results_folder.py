"""A results folder cannot mislead: what is not as made by what is here now is named, and made anew to the same bytes.

Every job is imitated by one that writes what it is made by and from: what is tested is which jobs run.
"""

from __future__ import annotations

import json
import os
import shutil
import time
from pathlib import Path

import pytest
import yaml
from faults import digests
from pipeline_copy import copy_project, imitate_steps, planned, snakemake

pytestmark = [pytest.mark.workflow, pytest.mark.slow]

SWEEP = {
    "boundary": "displacement", "left": [0.5, 0.6], "right": "same", "gamma": [0.65], "duration": {"time": 6.0},
    "spacing": {"scale": 4.0}, "record": ["fronts", "fields"], "chunks": 2,
}  # fmt: skip
SCENE = {
    "title": "One", "boundary": "displacement", "left": 0.5, "right": 0.5, "gamma": 0.65, "dx": 0.1, "duration": 6.0,
}  # fmt: skip
OVERLAY = {"preset": "draft", "simulations": {"mine": SWEEP}, "scenes": {"one": SCENE}}
OTHER = OVERLAY | {"model": {"release": "elastic"}}
FIGURE = "figures/fig07_damage_zone"


def run(folder: Path, *targets: str, overlay: str = "overlay.yaml") -> str:
    """What a run says, which must succeed."""
    result = snakemake(folder, "--quiet", "--", *targets, overlay=overlay, cores=2, timeout=900)
    assert result.returncode == 0, result.stderr
    return result.stderr


def verify(folder: Path, *targets: str, overlay: str = "overlay.yaml") -> tuple[int, dict[str, str]]:
    """As `make verify`: the exit code, and the reason by file."""
    result = snakemake(folder, "--quiet", "--", "verify", *targets, overlay=overlay)
    assert "Traceback" not in result.stdout + result.stderr
    found = [line.partition(": ") for line in result.stdout.splitlines()]
    return result.returncode, {
        name.removeprefix("results/"): reason for name, _, reason in found if name.startswith("results/")
    }


@pytest.fixture(scope="module")
def finished(project, tmp_path_factory) -> Path:
    """A draft, with a sweep and a scene of the user's."""
    folder = copy_project(project, tmp_path_factory.mktemp("results") / "first")
    imitate_steps(folder)
    for name, overlay in (("overlay", OVERLAY), ("other", OTHER)):
        (folder / f"{name}.yaml").write_text(yaml.safe_dump(overlay), encoding="utf-8")
    run(folder, "everything")
    return folder


@pytest.fixture
def folder(finished, tmp_path) -> Path:
    """The same, moved elsewhere: a test may do there what it likes."""
    shutil.copytree(finished, tmp_path / "copied", symlinks=True)
    return Path(shutil.move(tmp_path / "copied", tmp_path / "moved"))


def test_a_finished_folder_is_verified_wherever_it_is(folder):
    assert verify(folder, "everything") == (0, {})
    assert planned(snakemake(folder, "--dry-run", "--", "everything", overlay="overlay.yaml")) == {}
    for path in (folder / "results").rglob("*"):
        if path.suffix in (".json", ".log"):
            assert str(folder.parent.parent) not in path.read_text(encoding="utf-8"), path


def edit(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-2] + b"!\n")


def old(path: Path) -> None:
    edit(path)
    os.utime(path, ns=(0, 0))


def in_future(path: Path) -> None:
    edit(path)
    moment = time.time_ns() + 10**13
    os.utime(path, ns=(moment, moment))


def become_folder(path: Path) -> None:
    path.unlink()
    path.mkdir()


HARMS = {
    "edited": edit, "old": old, "in the future": in_future, "emptied": lambda path: path.write_bytes(b""),
    "removed": lambda path: path.unlink(), "grown": lambda path: path.write_bytes(path.read_bytes() * 2),
    "a dead link": lambda path: (path.unlink(), path.symlink_to("nowhere")),
    "a link": lambda path: (path.unlink(), path.symlink_to("/dev/null")),
}  # fmt: skip
# One of each kind of file, with what is done to it.
FILES = {
    "kernels.txt": "old", "data/barrier.nc": "edited", "data/mine/1-of-2.nc": "removed", "data/mine.nc": "emptied",
    "measurements/arrest.csv": "in the future", "measurements/mine/2-of-2.csv": "old",
    "uncertainties/one.csv": "removed", "uncertainties/coarser/one.csv": "edited", "studies/extremes.csv": "grown",
    f"{FIGURE}.png": "edited", f"{FIGURE}.csv": "removed", "figures/fig02_phase_diagram.pdf": "a dead link",
    "figures/sweep_mine.csv": "old", "scenes/one.html": "in the future", "scenes/barrier.pdf": "a link",
    "claims.json": "edited", "findings.json": "removed", "claims.html": "old", "explorer.html": "removed",
    "manuscript/replication.html": "edited", "manuscript/replication.pdf": "removed",
    "manuscript/verdicts.yaml": "emptied", "provenance.json": "removed", "checksums.txt": "edited",
    "codecheck.yml": "removed", "index.html": "removed",
}  # fmt: skip
RECORD = "records/{}.json".format
RECORDS = {
    RECORD("data/arrest.nc"): "removed", RECORD("figures/fig01_system_sketch.png"): "emptied",
    RECORD("measurements/barrier.csv"): "edited", RECORD("data/steady_stress.nc"): "grown",
    RECORD("studies/published_figure.csv"): "removed", RECORD("scenes/barrier.png"): "a dead link",
}  # fmt: skip


def test_files_and_records_are_named_and_repaired_whatever_was_done_to_them(folder):
    results, before = folder / "results", digests(folder)
    for name, harm in (FILES | RECORDS).items():
        HARMS[harm](results / name)
    # Two files of a kind exchanged, with and without their records.
    for one, other in (("data/pulse_damping.nc", "data/one.nc"), ("scenes/one.gif", "scenes/one.png")):
        if (results / one).exists():
            (results / one).rename(results / "away")
            (results / other).rename(results / one)
            (results / "away").rename(results / other)
    for place in ("measurements/{}.csv", RECORD("measurements/{}.csv")):
        one, other = (results / place.format(name) for name in ("scaling_stress", "steady_displacement"))
        one.rename(results / "away")
        other.rename(one)
        (results / "away").rename(other)
    (results / "data/unknown.nc").write_text("mine")
    code, named = verify(folder, "everything")
    assert code == 1
    for name, harm in FILES.items():
        assert named[name], (name, harm)
    for name in RECORDS:
        output = name.removeprefix("records/").removesuffix(".json")
        assert named[output] in ("no record", "its record cannot be read"), output
    for name in ("data/pulse_damping.nc", "data/one.nc"):
        assert named[name] == "not what its job wrote", name
    assert {"measurements/scaling_stress.csv", "measurements/steady_displacement.csv", "data/unknown.nc"} <= {
        *named
    }
    said = run(folder, "everything")
    assert said.count("results are not as made by what is here now") == 1 and "and made anew" in said
    (results / "data/unknown.nc").unlink()
    assert digests(folder) == before and verify(folder, "everything") == (0, {})


def forget(folder: Path) -> None:
    shutil.rmtree(folder / ".snakemake")


def edit_source(folder: Path) -> None:
    """As `rsync -a` and `cp -p` leave it."""
    path = folder / "src/slippulse/solver/taylor.py"
    times = path.stat()
    path.write_text(path.read_text() + "\n# edited\n")
    os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))


def edit_in_future(folder: Path) -> None:
    moment = time.time_ns() + 10**13
    for path in (folder / "results").rglob("*"):
        os.utime(path, ns=(moment, moment))
    edit_source(folder)


def edit_lock(folder: Path) -> None:
    with open(folder / "requirements.lock", "a", encoding="utf-8") as file:
        file.write("# another version\n")


def edit_text(folder: Path) -> None:
    with open(folder / "manuscript/summary.yaml", "a", encoding="utf-8") as file:
        file.write("# edited\n")


def edit_configuration(folder: Path) -> None:
    path = folder / "overlay.yaml"
    path.write_text(yaml.safe_dump(OTHER), encoding="utf-8")
    os.utime(path, ns=(0, 0))


# What is done to the folder, and some files with the reason that verify has for each.
CHANGES = {
    "a source with its old time": (edit_source, {"data/one.nc": "made by other sources"}),
    "a source under results in the future": (edit_in_future, {"data/one.nc": "made by other sources"}),
    "the lock": (edit_lock, {f"{FIGURE}.png": "made by other sources", "data/one.nc": "made by other sources"}),
    "a text": (edit_text, {"index.html": "made by other sources"}),
    "a configuration with an old time": (edit_configuration, {"data/one.nc": "made by another configuration"}),
    "a configuration, Snakemake's notes removed": (
        lambda folder: (forget(folder), edit_configuration(folder)), {"data/one.nc": "made by another configuration"},
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CHANGES)
def test_what_is_made_by_something_else_is_named_and_made_anew(folder, case):
    change, expected = CHANGES[case]
    change(folder)
    code, named = verify(folder, "everything")
    assert code == 1 and {name: named.get(name) for name in expected} == expected
    run(folder, "everything")
    assert verify(folder, "everything") == (0, {})


def test_only_notes_lost_is_nothing_lost(folder):
    forget(folder)
    moment = time.time_ns() + 10**13
    for number, path in enumerate((folder / "results").rglob("*")):
        os.utime(path, ns=(moment, moment) if number % 2 else (0, 0))
    assert "are not as made" not in run(folder, "everything")
    assert planned(snakemake(folder, "--dry-run", "--", "everything", overlay="overlay.yaml")) == {}
    assert verify(folder, "everything") == (0, {})


def test_two_trees_may_be_swapped(folder):
    """As to keep two for AGAINST=; a copy that is put back is the same."""
    shutil.copytree(folder / "results", folder / "r1")
    run(folder, "everything", overlay="other.yaml")
    assert verify(folder, "everything", overlay="other.yaml") == (0, {})
    (folder / "results").rename(folder / "r2")
    (folder / "r1").rename(folder / "results")
    code, named = verify(folder, "everything", overlay="other.yaml")
    assert code == 1 and named["data/one.nc"] == "made by another configuration"
    assert "are not as made" not in run(folder, "everything")
    assert verify(folder, "everything") == (0, {})
    shutil.rmtree(folder / "results")
    shutil.copytree(folder / "r2", folder / "results")
    run(folder, "everything")
    assert verify(folder, "everything") == (0, {})


def test_a_run_of_one_target_says_what_it_leaves_behind_and_touches_nothing_else(folder):
    page = folder / "results/index.html"
    before, times = page.read_bytes(), page.stat()
    said = run(folder, "results/data/one.nc", overlay="other.yaml")
    assert "Renew them: snakemake --cores 2 --configfile other.yaml -- everything" in said
    assert page.read_bytes() == before and page.stat() == times
    assert (folder / "results/manuscript/replication.pdf").exists()


def test_short_names_are_targets(folder):
    for name in ("fig07", "fig07_damage_zone"):
        (folder / f"results/{FIGURE}.png").unlink()
        run(folder, name)
        assert (folder / f"results/{FIGURE}.png").exists(), name
    result = snakemake(folder, "--", "fig077", overlay="overlay.yaml")
    assert (
        result.returncode != 0 and "target: 'fig077' (did you mean 'fig07'?)" in result.stdout + result.stderr
    )


def test_a_draft_is_verified_as_a_draft(folder):
    for name in ("claims.json", "index.html"):
        (folder / "results" / name).unlink()
    result = snakemake(folder, "--", "verify", overlay="overlay.yaml")
    assert "Not looked at: " in result.stdout and "TARGET=everything makes besides" in result.stdout
    assert "missing" not in result.stdout


def test_a_run_is_not_begun_beside_another(folder):
    from slippulse.data.lock import take

    held = take(folder / ".snakemake/run.lock")
    edit(folder / "results/kernels.txt")
    result = snakemake(folder, "--", "everything", overlay="overlay.yaml")
    assert result.returncode == 1 and "Another run is at work in this folder" in result.stderr
    assert "Traceback" not in result.stderr and (folder / "results/kernels.txt").exists()
    held.close()
    # What a killed run has left of Snakemake's own lock is in nobody's way.
    (folder / ".snakemake/locks").mkdir(exist_ok=True)
    (folder / ".snakemake/locks/0.input.lock").write_text(json.dumps(["results/kernels.txt"]))
    assert "The last run was killed" in run(folder, "everything")
