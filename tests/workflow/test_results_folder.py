"""A results folder cannot mislead: `make verify` names every change, and the next run repairs it.

Each job is imitated by one that writes by what and from what it is made: the tests see which run.
"""

import re
import shutil
import subprocess
from pathlib import Path

import pytest
import yaml
from faults import digests
from pipeline_copy import OVERLAY, made, planned, snakemake
from workflow.conftest import TARGETS

pytestmark = pytest.mark.slow

FIGURE = "figures/fig07_damage_zone"


def run(folder: Path, *targets: str, overlay: str = "overlay.yaml", **environment: str) -> str:
    """Run successfully, and return what the run writes to the terminal."""
    how = {"overlay": overlay, "cores": 2, "environment": environment}
    return made(folder, "--quiet", "--", *targets, **how).stderr


def verify(folder: Path) -> dict[str, str]:
    """Verify as `make verify` does, and return the reason by file."""
    result = snakemake(folder, "--quiet", "--", "verify", "everything", overlay="overlay.yaml")
    assert "Traceback" not in result.stdout + result.stderr
    reasons = dict(re.findall(r"^results/(.+?): (.+)$", result.stdout, re.M))
    assert result.returncode == bool(reasons), result.stderr
    return reasons


@pytest.fixture
def folder(imitated, tmp_path) -> Path:
    """A folder elsewhere with the imitated results, a copy beside them, and another overlay."""
    folder = Path(shutil.copytree(imitated, tmp_path / "copied", symlinks=True))
    shutil.copytree(folder / "results", folder / "overlay")
    other = OVERLAY | {"model": {"release": "elastic"}}
    (folder / "other.yaml").write_text(yaml.safe_dump(other), encoding="utf-8")
    return folder


# A function of the shell that edits a source or a text, as `rsync -a` and `cp -p` leave it.
SHELL = 'edit() { touch -r "$1" was; echo "# edited" >> "$1"; touch -r was "$1"; }; '
# Reasons that verify gives.
MISSING, CHANGED = "missing", "not what its job wrote"
NO_RECORD, SOURCES = "no record", "made by other sources"
CONFIGURATION, UNKNOWN = "made by another configuration", "not known; no rule makes it"
# Files of each kind: some are removed, and some changed, which keeps their size.
REMOVED = f"data/mine/1-of-2.nc uncertainties/one.csv {FIGURE}.csv findings.json explorer.html"
REMOVED += " manuscript/replication.pdf codecheck.yml index.html"
EDITED = f"data/barrier.nc uncertainties/coarser/one.csv {FIGURE}.png claims.json checksums.txt"
EDITED += " predictions/arrest.csv data/mine.nc manuscript/verdicts.yaml studies/extremes.csv"
EDITED += " manuscript/replication.html provenance.json kernels/localised.txt scenes/one.html"
EDITED += " measurements/mine/2-of-2.csv measurements/arrest.csv figures/sweep_mine.csv claims.html"
# Commands, and what verify then says of some results. All commands of a table change one folder,
# where each change is named and repaired by itself.
CONTENT = {f"rm results/{name}": {name: MISSING} for name in REMOVED.split()}
CONTENT |= {f"sed -i 's/.$/!/' results/{name}": {name: CHANGED} for name in EDITED.split()}
MOVES = {
    "cd results/data; mv one.nc a; mv pulse_damping.nc one.nc; mv a pulse_damping.nc": {
        "data/pulse_damping.nc": CHANGED,
        "data/one.nc": CHANGED,
    },
    "cd results/measurements; mv damping_stress.csv Damping_stress.csv": {
        "measurements/damping_stress.csv": MISSING,
        "measurements/Damping_stress.csv": UNKNOWN,
    },
    "ln -sf nowhere results/figures/fig02_phase_diagram.pdf": {
        "figures/fig02_phase_diagram.pdf": MISSING,
    },
    "ln -sf /dev/null results/scenes/barrier.pdf": {"scenes/barrier.pdf": MISSING},
    "echo mine > results/data/unknown.nc": {"data/unknown.nc": UNKNOWN},
    "echo {} > results/records/gone.csv.json": {"records/gone.csv.json": UNKNOWN},
}
OLD_SOURCES = {
    f"edit src/slippulse/{FIGURE}.py": {f"{FIGURE}.png": SOURCES},
    "edit src/slippulse_paper/studies/extremes.py": {"studies/extremes.csv": SOURCES},
    "edit src/slippulse_paper/report/templates/explorer.html": {"explorer.html": SOURCES},
    "edit manuscript/summary.yaml": {"index.html": SOURCES},
    "edit workflow/rules/common.smk": {"provenance.json": SOURCES},
    "edit src/slippulse/solver/taylor.py": {"data/one.nc": SOURCES},
}
FOLDERS = {
    "rm -r results/figures": {f"{FIGURE}.pdf": MISSING},
    "rm -r results/measurements": {"measurements/one.csv": MISSING},
    "rm -r results/records/scenes": {"scenes/one.html": NO_RECORD},
}
LOCK = {"edit requirements.lock": {"data/one.nc": SOURCES, f"{FIGURE}.png": SOURCES}}
CHANGES = {"content": CONTENT | MOVES, "sources": OLD_SOURCES, "folders": FOLDERS, "lock": LOCK}


@pytest.mark.parametrize("changes", CHANGES.values(), ids=CHANGES)
def test_a_change_of_a_folder_is_named_and_repaired(folder, changes):
    named = change_and_verify(folder, changes)
    assert "made anew where needed" in run(folder, *TARGETS)
    assert named and digests(folder, "overlay").items() <= digests(folder).items()
    assert not digests(folder, "overlay").keys() & verify(folder).keys()


# Commands that lose nothing: times without order, what a kill leaves, notes of no form.
PUT_BACK = ("rm -r results; cp -r overlay results",)
HARMLESS = (
    "rm -r .snakemake",
    "rm -r results/logs",
    "cp overlay/index.html results/index.html",
    "find results | sed 'n;d' | xargs touch -d @0",
    "find results | sed '1d;n;d' | xargs touch -d '3 hours'",
    "echo half > results/data/.one-12345678.nc",
    "mv results/scenes/one.png elsewhere; ln -s ../../elsewhere results/scenes/one.png",
)


@pytest.mark.parametrize("commands", [HARMLESS, PUT_BACK], ids=["harmless", "a copy put back"])
def test_nothing_is_made_anew_where_nothing_is_lost(folder, commands):
    assert change_and_verify(folder, {command: {} for command in commands}) == {}
    assert "made anew where needed" not in run(folder, *TARGETS)
    assert digests(folder, "overlay").items() <= digests(folder).items()
    assert planned(snakemake(folder, "--dry-run", "--", *TARGETS, overlay="overlay.yaml")) == {}


def change_and_verify(folder: Path, changes: dict) -> dict[str, str]:
    """Change a folder by commands; verify must name each change. Returns all reasons by file."""
    for command in changes:
        subprocess.run(["sh", "-ec", SHELL + command], cwd=folder, check=True)
    named = verify(folder)
    for command, reasons in changes.items():
        assert reasons.items() <= named.items(), command
    return named


BELOW_MAKE = {"MAKELEVEL": "1", "OVERLAY": "other.yaml"}
RENEWALS = {
    "snakemake --cores 2 --configfile other.yaml -- everything": {},
    "make replicate OVERLAY=other.yaml TARGET=everything": BELOW_MAKE,
}


@pytest.mark.parametrize(("renewal", "environment"), RENEWALS.items(), ids=["snakemake", "make"])
def test_a_run_of_one_target_says_what_it_leaves_behind_and_touches_nothing_else(
    folder, renewal, environment
):
    page = folder / "results/index.html"
    before, times = page.read_bytes(), page.stat()
    said = run(folder, "results/data/one.nc", overlay="other.yaml", **environment)
    assert f"Renew them: {renewal}\n" in said
    assert page.read_bytes() == before and page.stat() == times
    assert (folder / "results/manuscript/replication.pdf").exists()
    assert verify(folder)["data/one.nc"] == CONFIGURATION


OPTIONS = ["--dry-run", "--executor dryrun", "--touch", "--executor touch", "--summary"]
OPTIONS += ["--rulegraph", "--until compile_kernels", "--omit-from simulate"]


@pytest.mark.parametrize("options", OPTIONS)
def test_nothing_is_removed_that_is_not_made_anew(folder, options):
    (folder / "results/records/data/one.nc.json").unlink()
    before, table = digests(folder), "results/measurements/one.csv"
    said = made(folder, *options.split(), "--", table, overlay="overlay.yaml").stderr
    assert "as results/data/one.nc: no record; made anew" in said
    assert digests(folder) == before
    # What was not made anew is so by the next run, which Snakemake announces.
    jobs = planned(snakemake(folder, "--dry-run", "--", table, overlay="overlay.yaml"))
    assert jobs["simulate"] == jobs["measure"] == 1
    run(folder, table)
    assert "data/one.nc" not in verify(folder)


def test_a_draft_is_verified_as_a_draft(folder):
    for name in ("claims.json", "index.html"):
        (folder / "results" / name).unlink()
    result = snakemake(folder, "--", "verify", overlay="overlay.yaml")
    assert "Not looked at: " in result.stdout and "TARGET=everything makes besides" in result.stdout
    assert "missing" not in result.stdout
