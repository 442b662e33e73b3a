"""Changes in the results folder: `make verify` names each, and the next run repairs it.

Imitated jobs write their step, settings and inputs instead of results.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from faults import digests
from pipeline_copy import OVERLAY, planned, snakemake
from workflow.conftest import TARGETS

pytestmark = pytest.mark.slow

FIGURE = "figures/fig07_damage_zone"


def by_make(folder: Path, command: str, *targets: str, overlay: str = "overlay.yaml"):
    """Run `make replicate` or `make verify`, and return the completed process."""
    given = {"CORES": "2", "OVERLAY": overlay, "TARGET": " ".join(targets or TARGETS), "PRESET": ""}
    how = {"cwd": folder, "env": os.environ | given, "text": True, "timeout": 600}
    line = [sys.executable, "workflow/run.py", command]
    result = subprocess.run(line, capture_output=True, check=False, **how)
    assert "Traceback" not in result.stdout + result.stderr
    return result


def run(folder: Path, *targets: str, overlay: str = "overlay.yaml") -> str:
    """Run successfully, and return what the run writes to the terminal."""
    result = by_make(folder, "replicate", *targets, overlay=overlay)
    assert result.returncode == 0, result.stderr
    return result.stderr


def verify(folder: Path) -> dict[str, str]:
    """Run `make verify`, and return the reason that it prints for each file."""
    result = by_make(folder, "verify")
    lines = [line.partition(": ") for line in result.stdout.splitlines()]
    reasons = {name.removeprefix("results/"): reason for name, _, reason in lines if reason}
    assert result.returncode == bool(reasons), result.stderr
    return reasons


@pytest.fixture
def folder(small) -> Path:
    """A folder with imitated results, a copy of them, and a second overlay."""
    shutil.copytree(small / "results", small / "overlay")
    other = OVERLAY | {"model": {"release": "elastic"}}
    (small / "other.yaml").write_text(yaml.safe_dump(other), encoding="utf-8")
    return small


# A shell function that edits a file and restores its time, as `rsync -a` and `cp -p` would do.
SHELL = 'edit() { touch -r "$1" was; echo "# edited" >> "$1"; touch -r was "$1"; }; '
# Reasons that `make verify` prints. "missing" and "params changed" are reasons of Snakemake.
CHANGED, MISSING, SOURCES = "changed since its job wrote it", "missing", "params changed"
RECORD, UNKNOWN = "its record cannot be read", "no job has recorded it"
# Files of each kind that are removed, or edited without a change of their size.
REMOVED = f"{FIGURE}.csv findings.json explorer.html manuscript/replication.pdf codecheck.yml"
EDITED = f"data/barrier.nc uncertainties/coarser/one.csv {FIGURE}.png claims.json checksums.txt"
EDITED += " predictions/arrest.csv data/mine.nc manuscript/verdicts.yaml studies/extremes.csv"
EDITED += " manuscript/replication.html provenance.json kernels/localised.txt"
EDITED += " measurements/mine/2-of-2.csv measurements/arrest.csv figures/sweep_mine.csv claims.html"
# Commands, and the reasons that `make verify` then prints for some results. All commands of a table
# change the same folder, in which each change is named and repaired separately.
CONTENT = {f"rm results/{name}": {name: MISSING} for name in REMOVED.split()}
CONTENT |= {f"sed -i 's/.$/!/' results/{name}": {name: CHANGED} for name in EDITED.split()}
MOVES = {
    "cd results/data; mv one.nc a; mv pulse_damping.nc one.nc; mv a pulse_damping.nc": {
        "data/pulse_damping.nc": CHANGED,
        "data/one.nc": CHANGED,
    },
    "echo mine > results/data/unknown.nc": {"data/unknown.nc": UNKNOWN},
    "echo '[' > results/scenes/.records/one.png.json": {"scenes/one.png": RECORD},
}
OLD_SOURCES = {
    f"edit src/slippulse_paper/{FIGURE}.py": {f"{FIGURE}.png": SOURCES},
    "edit src/slippulse_paper/studies/extremes.py": {"studies/extremes.csv": SOURCES},
    "edit src/slippulse_paper/report/templates/explorer.html": {"explorer.html": SOURCES},
    "edit workflow/rules/common.smk": {"provenance.json": SOURCES},
    "edit src/slippulse/solver/taylor.py": {"data/one.nc": SOURCES},
}
LOCK = {"edit requirements.lock": {"data/one.nc": SOURCES, f"{FIGURE}.png": SOURCES}}
CHANGES = {"content": CONTENT | MOVES, "sources": OLD_SOURCES, "lock": LOCK}


@pytest.mark.parametrize("changes", CHANGES.values(), ids=CHANGES)
def test_a_change_of_a_folder_is_named_and_repaired(folder, changes):
    assert change_and_verify(folder, changes)
    run(folder)
    (folder / "results/data/unknown.nc").unlink(missing_ok=True)
    assert digests(folder, "overlay") == digests(folder) and verify(folder) == {}


# Commands that change no result: they affect logs, times, unfinished files and files of a user.
HARMLESS = (
    "rm -r results/logs",
    "cp overlay/index.html results/index.html",
    "echo half > results/data/.one.slippulse-unfinished-12345678.nc",
    "echo notes > results/figures/.notes-20261127.md",
)


def test_nothing_is_made_again_where_nothing_is_lost_and_a_users_file_stays(folder):
    assert change_and_verify(folder, {command: {} for command in HARMLESS}) == {}
    # The last run was killed.
    (folder / ".snakemake/locks").mkdir(exist_ok=True)
    (folder / ".snakemake/locks/0.input.lock").touch()
    output = run(folder)
    assert "The last run was killed" in output and "made again: " not in output
    assert digests(folder, "overlay") == digests(folder)
    assert (folder / "results/figures/.notes-20261127.md").exists()
    assert not (folder / "results/data/.one.slippulse-unfinished-12345678.nc").exists()
    assert planned(snakemake(folder, "--dry-run", "--", *TARGETS, overlay="overlay.yaml")) == {}


def change_and_verify(folder: Path, changes: dict) -> dict[str, str]:
    """Change a folder by commands, and return the reasons of `make verify` for each file.

    It must name each change.
    """
    for command in changes:
        subprocess.run(["sh", "-ec", SHELL + command], cwd=folder, check=True)
    named = verify(folder)
    for command, reasons in changes.items():
        for name, reason in reasons.items():
            assert reason in named.get(name, "not named"), command
    return named


def test_a_run_of_one_target_touches_nothing_else(folder):
    page = folder / "results/index.html"
    before, times = page.read_bytes(), page.stat()
    run(folder, "results/data/one.nc", overlay="other.yaml")
    assert page.read_bytes() == before and page.stat() == times
    assert (folder / "results/manuscript/replication.pdf").exists()
    # The data were made with another configuration than the verified one.
    assert SOURCES in verify(folder)["data/one.nc"]
