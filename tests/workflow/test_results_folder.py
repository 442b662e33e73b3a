"""A results folder cannot mislead: whatever is done to it, `make verify` names it and the next run repairs it.

Every job is imitated by one that writes what it is made by and from: what is tested is which jobs run.
"""

import json
import os
import shutil
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple

import pytest
import yaml
from faults import digests
from pipeline_copy import copy_project, imitate_steps, planned, snakemake

from slippulse.data.lock import take

pytestmark = [pytest.mark.workflow, pytest.mark.slow]

SWEEP = {
    "boundary": "displacement", "left": [0.5, 0.6], "right": "same", "gamma": [0.65], "duration": {"time": 6.0},
    "spacing": {"scale": 4.0}, "record": ["fronts", "fields"], "chunks": 2,
}  # fmt: skip
SCENE = {
    "title": "One", "boundary": "displacement", "left": 0.5, "right": 0.5, "gamma": 0.65, "dx": 0.1, "duration": 6.0,
}  # fmt: skip
OVERLAY = {"preset": "draft", "simulations": {"mine": SWEEP}, "scenes": {"one": SCENE}}
OVERLAYS = {
    "overlay.yaml": OVERLAY,
    "other.yaml": OVERLAY | {"model": {"release": "elastic"}},
    "paper.yaml": OVERLAY | {"preset": "paper"},
}
FIGURE = "figures/fig07_damage_zone"
# What is made by the other overlays.
PART = ("results/scenes/one.html", "results/measurements/arrest.csv", "results/figures/sweep_mine.png")


def run(folder: Path, *targets: str, overlay: str = "overlay.yaml") -> str:
    """What a run says, which must succeed."""
    result = snakemake(folder, "--quiet", "--", *targets, overlay=overlay, cores=2, timeout=900)
    assert result.returncode == 0, result.stderr
    return result.stderr


def verify(folder: Path, overlay: str = "overlay.yaml") -> dict[str, str]:
    """As `make verify`: the reason by file."""
    result = snakemake(folder, "--quiet", "--", "verify", "everything", overlay=overlay)
    assert "Traceback" not in result.stdout + result.stderr
    found = [line.partition(": ") for line in result.stdout.splitlines() if line.startswith("results/")]
    assert result.returncode == bool(found), result.stderr
    return {name.removeprefix("results/"): reason for name, _, reason in found}


@pytest.fixture(scope="module")
def finished(project, tmp_path_factory) -> Path:
    """A draft with a sweep and a scene of the user's; and in folders beside results/, what other overlays make."""
    folder = copy_project(project, tmp_path_factory.mktemp("results") / "first")
    imitate_steps(folder)
    for name, overlay in OVERLAYS.items():
        (folder / name).write_text(yaml.safe_dump(overlay), encoding="utf-8")
        run(folder, *(["everything"] if overlay is OVERLAY else PART), overlay=name)
        (folder / "results").rename(folder / name.partition(".")[0])
    shutil.copytree(folder / "overlay", folder / "results")
    return folder


@pytest.fixture
def folder(finished, tmp_path) -> Path:
    """The same, moved elsewhere: a test may do there what it likes."""
    shutil.copytree(finished, tmp_path / "copied", symlinks=True)
    return Path(shutil.move(tmp_path / "copied", tmp_path / "moved"))


FUTURE = time.time_ns() + 10**13
# Of a file that is edited besides.
TIMES = {"old": 0, "in the future": FUTURE}
HARMS: dict[str, Callable[[bytes], bytes]] = {
    "edited": lambda whole: whole[:-2] + b"!\n",
    "emptied": lambda whole: b"",
    "grown": lambda whole: whole * 2,
    "cut": lambda whole: whole[: len(whole) // 2],
    "with other line ends": lambda whole: whole.replace(b"\n", b"\r\n"),
    "with zeros": lambda whole: whole + b"\0",
}
LINKS = {"a dead link": "nowhere", "a link to a device": "/dev/null"}


def harm(path: Path, how: str) -> None:
    """Do something to a file."""
    if how == "removed":
        path.unlink()
    elif how in LINKS:
        path.unlink()
        path.symlink_to(LINKS[how])
    else:
        path.write_bytes(HARMS.get(how, HARMS["edited"])(path.read_bytes()))
        if how in TIMES:
            os.utime(path, ns=(TIMES[how], TIMES[how]))


class Row(NamedTuple):
    """What is done in a folder, and what verify says of some results."""

    do: Callable[[Path], object]
    named: dict[str, str]


MISSING, CHANGED = "missing", "not what its job wrote"
NO_RECORD, UNREADABLE = "no record", "its record cannot be read"
RULE, SOURCES, CONFIGURATION = (
    f"made by {what}" for what in ("another rule", "other sources", "another configuration")
)
UNKNOWN = "not known; no rule makes it"
# One of each kind of file, with what is done to it.
FILES = {
    "kernels.txt": "old", "data/barrier.nc": "edited", "data/mine/1-of-2.nc": "removed", "data/mine.nc": "emptied",
    "measurements/arrest.csv": "in the future", "measurements/mine/2-of-2.csv": "old",
    "predictions/arrest.csv": "with other line ends", "uncertainties/one.csv": "removed",
    "uncertainties/coarser/one.csv": "edited", "studies/extremes.csv": "grown", f"{FIGURE}.png": "edited",
    f"{FIGURE}.csv": "removed", "figures/fig02_phase_diagram.pdf": "a dead link", "figures/sweep_mine.csv": "old",
    "scenes/one.html": "in the future", "scenes/barrier.pdf": "a link to a device", "claims.json": "edited",
    "findings.json": "removed", "claims.html": "old", "explorer.html": "removed",
    "manuscript/replication.html": "cut", "manuscript/replication.pdf": "removed",
    "manuscript/verdicts.yaml": "emptied", "provenance.json": "with zeros", "checksums.txt": "edited",
    "codecheck.yml": "removed", "index.html": "removed",
}  # fmt: skip


def exchange(folder: Path, one: str, other: str) -> None:
    """Two files, or two folders, for each other."""
    (folder / one).rename(folder / "away")
    (folder / other).rename(folder / one)
    (folder / "away").rename(folder / other)


def record(name: str) -> str:
    return f"results/records/{name}.json"


def rewrite(name: str, **change) -> Callable[[Path], object]:
    """Another content of a record."""

    def do(folder: Path) -> None:
        path = folder / record(name)
        path.write_text(json.dumps(json.loads(path.read_text()) | change))

    return do


def harmed(name: str, how: str) -> Callable[[Path], object]:
    return lambda folder: harm(folder / name, how)


def edited(name: str) -> Callable[[Path], object]:
    """A source or a text, as `rsync -a` and `cp -p` leave it."""

    def do(folder: Path) -> None:
        path = folder / name
        times = path.stat()
        path.write_bytes(path.read_bytes() + b"\n# edited\n" * (path.suffix != ".html") + b"\n")
        os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))

    return do


def removed(*names: str) -> Callable[[Path], object]:
    def do(folder: Path) -> None:
        for name in names:
            shutil.rmtree(folder / name)

    return do


def timed(*moments: int) -> Callable[[Path], object]:
    """All results of some times, in nanoseconds, in turn."""

    def do(folder: Path) -> None:
        for number, path in enumerate((folder / "results").rglob("*")):
            os.utime(path, ns=(moments[number % len(moments)],) * 2)

    return do


def replaced(name: str, by: str) -> Callable[[Path], object]:
    """A file, or a folder, by a copy of another with new times."""

    def do(folder: Path) -> None:
        if (folder / by).is_dir():
            shutil.rmtree(folder / name)
            shutil.copytree(folder / by, folder / name, copy_function=shutil.copyfile)
        else:
            content = (folder / by).read_bytes()
            (folder / name).unlink(missing_ok=True)
            (folder / name).write_bytes(content)

    return do


def linked(folder: Path) -> None:
    path = folder / "results/scenes/one.png"
    path.rename(folder / "one.png")
    path.symlink_to(folder / "one.png")


def older(name: str) -> str:
    return f"older than {name}, which it is made from"


# What is done at once to one folder, as each is named and repaired by itself.
CONTENT = {
    **{f"{name} {how}": Row(harmed(f"results/{name}", how),
                            {name: MISSING if how == "removed" or how in LINKS else CHANGED})
       for name, how in FILES.items()},
    "two files of data for each other": Row(
        lambda folder: exchange(folder / "results/data", "pulse_damping.nc", "one.nc"),
        {"data/pulse_damping.nc": CHANGED, "data/one.nc": CHANGED},
    ),
    "a picture of another figure": Row(
        replaced("results/figures/fig05_scaling.png", "results/figures/fig04_space_time.png"),
        {"figures/fig05_scaling.png": CHANGED},
    ),
    "a table of another name": Row(
        lambda folder: (folder / "results/measurements/damping_stress.csv").rename(
            folder / "results/measurements/Damping_stress.csv"),
        {"measurements/damping_stress.csv": MISSING, "measurements/Damping_stress.csv": UNKNOWN},
    ),
    "a file that no rule makes": Row(
        lambda folder: (folder / "results/data/unknown.nc").write_text("mine"), {"data/unknown.nc": UNKNOWN}
    ),
    "a record of a job that there is not": Row(
        lambda folder: (folder / record("gone.csv")).write_text("{}"), {"records/gone.csv.json": UNKNOWN}
    ),
}  # fmt: skip
RECORDS = {
    **{f"record {how}": Row(harmed(record(name), how), {name: reason}) for name, how, reason in (
        ("figures/fig01_system_sketch.png", "removed", NO_RECORD),
        ("figures/fig02_phase_diagram.png", "a dead link", NO_RECORD),
        ("figures/fig03_steady_state.png", "emptied", UNREADABLE),
        ("figures/fig04_space_time.png", "edited", UNREADABLE),
        ("figures/fig05_scaling.png", "grown", UNREADABLE),
        ("figures/fig06_burridge_knopoff.png", "cut", UNREADABLE),
    )},
    "of another step": Row(rewrite(f"{FIGURE}.png", step="measure"), {f"{FIGURE}.csv": RULE}),
    "without outputs": Row(rewrite("scenes/one.png", outputs={}), {"scenes/one.pdf": RULE}),
    "without inputs": Row(rewrite("scenes/barrier.png", inputs={}), {"scenes/barrier.html": RULE}),
    "of other outputs": Row(
        rewrite("explorer.html", outputs={"explorer.html": "0"}), {"explorer.html": CHANGED}
    ),
    "of other sources": Row(rewrite("data/arrest.nc", sources=""), {
        "data/arrest.nc": SOURCES, "measurements/arrest.csv": older("data/arrest.nc")}),
    "of another configuration": Row(
        rewrite("studies/extremes.csv", configuration=""), {"studies/extremes.csv": CONFIGURATION}
    ),
    "of other inputs": Row(
        rewrite("measurements/one.csv", inputs={"data/one.nc": "0"}), {"measurements/one.csv": older("data/one.nc")}
    ),
    "two tables and their records for each other": Row(
        lambda folder: [exchange(folder / f"results/{room}", f"measurements/scaling_stress.csv{ending}",
                                 f"measurements/damping_stress.csv{ending}")
                        for room, ending in ((".", ""), ("records", ".json"))],
        {"measurements/scaling_stress.csv": RULE, "measurements/damping_stress.csv": RULE},
    ),
}  # fmt: skip
NOTHING_LOST = {
    "Snakemake's notes removed": Row(removed(".snakemake"), {}),
    "new times without order": Row(timed(0, FUTURE), {}),
    "logs removed": Row(removed("results/logs"), {}),
    "remembered digests garbled": Row(
        lambda folder: (folder / "results/records/.digests").write_text('{"results/kernels.txt": [1]}'), {}
    ),
    "what a kill leaves": Row(
        lambda folder: (folder / "results/data/.one-12345678.nc").write_text("half"), {}
    ),
    "a picture elsewhere, with a link to it": Row(linked, {}),
    "the same content copied": Row(replaced("results/index.html", "overlay/index.html"), {}),
}  # fmt: skip


class Case(NamedTuple):
    """Rows for one folder, and the overlay and targets of what comes after them."""

    rows: dict[str, Row]
    overlay: str = "overlay.yaml"
    targets: Iterable[str] = ("everything",)


def at_once(name: str, do: Callable[[Path], object], named: dict[str, str], *after) -> dict[str, Case]:
    """A case of one row."""
    return {name: Case({name: Row(do, named)}, *after)}


def then(*several: Callable[[Path], object]) -> Callable[[Path], object]:
    return lambda folder: [do(folder) for do in several]


SOLVER = "src/slippulse/solver/taylor.py"
CASES = {
    "content": Case(CONTENT),
    "records": Case(RECORDS),
    "nothing lost": Case(NOTHING_LOST),
    "sources and texts with their old times": Case({
        "a figure": Row(edited(f"src/slippulse/{FIGURE}.py"), {f"{FIGURE}.png": SOURCES}),
        "a study": Row(edited("src/slippulse/studies/extremes.py"), {"studies/extremes.csv": SOURCES}),
        "a template": Row(edited("src/slippulse/report/templates/explorer.html"), {"explorer.html": SOURCES}),
        "a text": Row(edited("manuscript/summary.yaml"), {"index.html": SOURCES}),
        "a rule": Row(edited("workflow/rules/common.smk"), {"provenance.json": SOURCES}),
    }),
    "folders": Case({
        "of figures removed": Row(removed("results/figures"), {f"{FIGURE}.pdf": MISSING}),
        "of measurements removed": Row(removed("results/measurements"), {"measurements/one.csv": MISSING}),
        "of records removed": Row(removed("results/records/scenes"), {"scenes/one.html": NO_RECORD}),
    }),
    **at_once("a source under results in the future", then(timed(FUTURE), edited(SOLVER)),
              {"data/one.nc": SOURCES}),
    **at_once("a source with its old time, notes removed", then(removed(".snakemake"), edited(SOLVER)),
              {"data/one.nc": SOURCES}),
    **at_once("the lock", edited("requirements.lock"), {f"{FIGURE}.png": SOURCES, "data/one.nc": SOURCES}),
    **at_once("another overlay, notes removed", removed(".snakemake"), {"data/one.nc": CONFIGURATION},
              "other.yaml", PART),
    **at_once("another preset, notes removed", removed(".snakemake"), {"data/arrest.nc": CONFIGURATION},
              "paper.yaml", PART),
    **at_once("results of another overlay swapped in", lambda folder: exchange(folder, "results", "other"),
              {"data/one.nc": CONFIGURATION}, "overlay.yaml", PART),
    **at_once("results of another preset copied in", replaced("results", "paper"),
              {"data/arrest.nc": CONFIGURATION}, "overlay.yaml", PART),
    **at_once("a copy of the results put back", replaced("results", "overlay"), {}),
    **at_once("an overlay edited, with an old time",
              then(replaced("overlay.yaml", "other.yaml"), lambda folder: os.utime(folder / "overlay.yaml", (0, 0))),
              {"data/one.nc": CONFIGURATION}, "overlay.yaml", PART),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_what_was_done_to_a_folder_is_named_and_repaired(folder, case):
    rows, overlay, targets = CASES[case]
    # Of the configuration that stands there then.
    for row in rows.values():
        row.do(folder)
    quiet = next(
        name for name, one in OVERLAYS.items() if one == yaml.safe_load((folder / overlay).read_text())
    )
    expected = digests(folder, quiet.partition(".")[0])
    if targets == PART:
        names = digests(folder, "paper")
        expected = {name: digest for name, digest in expected.items() if name in names}
    named = verify(folder, overlay)
    for name, row in rows.items():
        assert row.named.items() <= named.items(), name
    said = run(folder, *targets, overlay=overlay)
    assert ("and made anew where needed" in said) == bool(named)
    assert expected.items() <= digests(folder).items()
    assert not expected.keys() & verify(folder, overlay).keys()
    if not named:
        assert {row.named == {} for row in rows.values()} == {True}
        assert planned(snakemake(folder, "--dry-run", "--", *targets, overlay=overlay)) == {}


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
    held = take(folder / ".snakemake/run.lock")
    harm(folder / "results/kernels.txt", "edited")
    result = snakemake(folder, "--", "everything", overlay="overlay.yaml")
    assert result.returncode == 1 and "Another run is at work in this folder" in result.stderr
    assert "Traceback" not in result.stderr and (folder / "results/kernels.txt").exists()
    held.close()
    # What a killed run has left of Snakemake's own lock is in nobody's way.
    (folder / ".snakemake/locks").mkdir(exist_ok=True)
    (folder / ".snakemake/locks/0.input.lock").write_text(json.dumps(["results/kernels.txt"]))
    assert "The last run was killed" in run(folder, "everything")
