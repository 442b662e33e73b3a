"""Kill a reduced draft run at random instants, over and over; what comes out must be what a quiet run gives.

    make faults             24 kills
    python tests/faults.py --kills 3 --seed 7

Each run is killed by SIGKILL: Snakemake alone, a job alone, or everything, in turn. The next run goes on from what is
there. Results are compared file by file, byte by byte.
"""

import argparse
import hashlib
import math
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import yaml
from pipeline_copy import copy_project

PROJECT = Path(__file__).resolve().parents[1]
TARGETS = (
    "results/figures/fig07_damage_zone.png",
    "results/figures/fig08_steady_state_displacement.png",
    "results/uncertainties/steady_displacement.csv",
    "results/scenes/one.html",
)
OVERLAY = {
    "preset": "draft",
    "simulations": {
        "steady_displacement": {"left": [0.4, 0.5, 0.6, 0.7], "damping_ratio": [0.0, 0.1], "duration": {"time": 20.0}}
    },
    "scenes": {
        "one": {
            "title": "One", "boundary": "displacement", "left": 0.5, "right": 0.6, "gamma": 0.65, "dx": 0.04,
            "duration": 10.0,
        }
    },
}  # fmt: skip
WHOM = ("Snakemake", "a job", "everything")


@dataclass
class Report:
    """What happened: kills by victim, runs that finished before they were killed, files compared."""

    kills: dict[str, int] = field(default_factory=lambda: dict.fromkeys(WHOM, 0))
    finished_first: int = 0
    comparisons: int = 0
    files: int = 0


def prepare(folder: Path) -> Path:
    """A folder in which the reduced run can be made, its sources linked."""
    copy_project(PROJECT, folder, link=True)
    (folder / "overlay.yaml").write_text(yaml.safe_dump(OVERLAY), encoding="utf-8")
    return folder


def start(folder: Path, targets: Iterable[str] = TARGETS) -> subprocess.Popen:
    """A run in a process group of its own."""
    command = [sys.executable, "-m", "snakemake", "--workflow-profile", "none", "--rerun-incomplete"]
    command += ["--force-use-threads", "--cores", "2", "--configfile", "overlay.yaml", "--", *targets]
    return _begun(folder, command)


def start_by_make(folder: Path, targets: Iterable[str] = TARGETS) -> subprocess.Popen:
    """The same as `make replicate` starts it."""
    options = {"CORES": "2", "PRESET": "", "OVERLAY": "overlay.yaml", "TARGET": " ".join(targets)}
    return _begun(folder, [sys.executable, "workflow/run.py", "replicate"], **options)


def _begun(folder: Path, command: list[str], **more: str) -> subprocess.Popen:
    with open(folder / "said.txt", "w", encoding="utf-8") as said:
        return subprocess.Popen(
            command, cwd=folder, env=os.environ | more, stdout=said, stderr=said, start_new_session=True
        )


def digests(folder: Path, results: str = "results") -> dict[str, str]:
    """Every result but logs, times and notes; a hidden name is a file that its writer was killed over."""
    results = folder / results
    return {
        str(path.relative_to(results)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(results.rglob("*"))
        if path.is_file()
        and not path.name.startswith(".")
        and path.relative_to(results).parts[0] not in ("logs", "benchmarks", "records")
    }


def at_work(folder: Path) -> list[int]:
    """Processes whose working directory is the folder."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            with suppress(OSError):
                if (entry / "cwd").resolve() == folder.resolve() and (entry / "cmdline").read_bytes():
                    found.append(int(entry.name))
    return found


def stop_at(folder: Path, number: int, instant: float, targets: Iterable[str] = TARGETS) -> float:
    """Send a signal to the group of a run at an instant; seconds until nothing of it is left, NaN where it was over."""
    run = start_by_make(folder, targets)
    with suppress(subprocess.TimeoutExpired):
        run.wait(timeout=instant)
        return math.nan
    os.killpg(run.pid, number)
    sent = time.monotonic()
    run.wait(timeout=60)
    while at_work(folder):
        assert time.monotonic() - sent < 60.0, "what a run has started goes on after its end"
        time.sleep(0.02)
    said = (folder / "said.txt").read_text(encoding="utf-8")
    assert "Traceback" not in said and "Exception" not in said, said[-4000:]
    return time.monotonic() - sent


def kill(run: subprocess.Popen, folder: Path, whom: str, chance: random.Random) -> None:
    """SIGKILL to Snakemake, a job or everything; waits for Snakemake's end.

    Jobs of a Snakemake that was killed alone may still write; the next run starts among them.
    """
    jobs = [process for process in at_work(folder) if process != run.pid]
    if whom == "everything":
        os.killpg(run.pid, signal.SIGKILL)
    else:
        victim = chance.choice(jobs) if whom == "a job" and jobs else run.pid
        with suppress(ProcessLookupError):
            os.kill(victim, signal.SIGKILL)
    run.wait(timeout=300)


def fault_run(folder: Path, kills: int, seed: int, say=print, targets: Iterable[str] = TARGETS) -> Report:
    """Kill runs until ``kills`` have been killed; compare each time that one gets to its end.

    Raises
    ------
    AssertionError
        When a run fails, or a result differs from that of a quiet run.
    """
    chance, report = random.Random(seed), Report()
    quiet = prepare(folder / "quiet")
    began = time.monotonic()
    assert start(quiet, targets).wait(timeout=1200) == 0, (quiet / "said.txt").read_text(encoding="utf-8")
    duration = time.monotonic() - began
    expected = digests(quiet)
    report.files = len(expected)
    say(f"A quiet run: {duration:.0f} s, {len(expected)} files")

    harmed = prepare(folder / "harmed")
    # Every file by name, so that each that is taken away is missed.
    targets = [f"results/{name}" for name in expected]
    while sum(report.kills.values()) < kills:
        whom = WHOM[sum(report.kills.values()) % len(WHOM)]
        run = start(harmed, targets)
        instant = chance.uniform(0.05, 0.7) * duration
        try:
            run.wait(timeout=instant)
        except subprocess.TimeoutExpired:
            kill(run, harmed, whom, chance)
            report.kills[whom] += 1
            say(f"killed {whom} after {instant:.1f} s: {len(digests(harmed))} files there")
            continue
        report.finished_first += 1
        _finish(harmed, expected, report)
        # A third of the files is taken away, so that the next runs have work.
        for name in sorted(expected)[chance.randrange(3) :: 3]:
            (harmed / "results" / name).unlink()
    _finish(harmed, expected, report)
    return report


def _finish(folder: Path, expected: dict[str, str], report: Report) -> None:
    ended = start(folder, [f"results/{name}" for name in expected]).wait(timeout=1200)
    assert ended == 0, (folder / "said.txt").read_text(encoding="utf-8")[-4000:]
    differing = dict(digests(folder).items() ^ expected.items())
    assert not differing, f"other than in a quiet run: {sorted(differing)}"
    report.comparisons += 1


def main() -> int:
    """Run it; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=24)
    parser.add_argument("--seed", type=int, default=1)
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="faults für ") as folder:
        report = fault_run(Path(folder), chosen.kills, chosen.seed)
    survived = ", ".join(f"{count} of {whom}" for whom, count in report.kills.items())
    print(
        f"{sum(report.kills.values())} kills survived ({survived};"
        f" {report.finished_first} runs finished first); {report.files} files the same, byte by byte,"
        f" {report.comparisons} times"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
