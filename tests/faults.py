"""Stop a reduced run at random instants, over and over; its results must be those of a quiet run.

    make faults                   24 stops
    python tests/faults.py 3      3 stops

A run that `make replicate` starts is stopped by a signal, or its server of jobs is killed. Of a run
that Snakemake starts, Snakemake, a job or everything is killed. The next run goes on.
"""

import hashlib
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import yaml
from pipeline_copy import SCENE, SNAKEMAKE, copy_project

PROJECT = Path(__file__).resolve().parents[1]
TARGETS = (
    "results/figures/fig07_damage_zone.png",
    "results/figures/fig08_steady_state_displacement.png",
    "results/uncertainties/steady_displacement.csv",
    "results/scenes/one.html",
)
SWEEP = {"left": [0.4, 0.5, 0.6, 0.7], "damping_ratio": [0.0, 0.1], "duration": {"time": 20.0}}
OVERLAY = {
    "preset": "draft",
    "simulations": {"steady_displacement": SWEEP},
    "scenes": {"one": SCENE | {"dx": 0.04, "duration": 10.0}},
}
SIGNALS = ("SIGTERM", "SIGINT", "SIGHUP", "SIGKILL")
WITHOUT_MAKE = ("Snakemake", "a job", "everything")
WAYS = (*SIGNALS, "the server of jobs", *WITHOUT_MAKE)
# Seconds until all processes have ended; after SIGKILL each ends by itself when it begins to work.
AT_ONCE, AFTER_SIGKILL = 2.0, 60.0


def prepare(folder: Path) -> Path:
    """Link the sources of the reduced run into a folder, and write its overlay."""
    copy_project(PROJECT, folder, link=True)
    (folder / "overlay.yaml").write_text(yaml.safe_dump(OVERLAY), encoding="utf-8")
    return folder


def start(folder: Path, targets: Sequence[str], by_make: bool = True) -> subprocess.Popen:
    """Start a run in a process group of its own, as `make replicate` does, or by Snakemake."""
    command = [*SNAKEMAKE, "--cores", "2", "--configfile", "overlay.yaml", "--", *targets]
    if by_make:
        command = [sys.executable, "workflow/run.py", "replicate"]
    options = {"CORES": "2", "PRESET": "", "OVERLAY": "overlay.yaml", "TARGET": " ".join(targets)}
    how = {"cwd": folder, "env": os.environ | options, "start_new_session": True}
    with open(folder / "said.txt", "w", encoding="utf-8") as said:
        return subprocess.Popen(command, stdout=said, stderr=said, **how)


def said(folder: Path) -> str:
    return (folder / "said.txt").read_text(encoding="utf-8")


def digests(folder: Path, results: str = "results") -> dict[str, str]:
    """Digest every result except logs and records; hidden files may be left by a kill."""
    digest = {}
    for path in sorted((folder / results).rglob("*")):
        name = path.relative_to(folder / results)
        beside = name.parts[0] == "logs" or any(part.startswith(".") for part in name.parts)
        if path.is_file() and not beside:
            digest[str(name)] = hashlib.sha256(path.read_bytes()).hexdigest()
    return digest


def at_work(folder: Path) -> dict[int, bytes]:
    """Arguments of the other processes that work in a folder or name it, by process number."""
    folder, others = folder.resolve(), {}
    for entry in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            arguments, place = (entry / "cmdline").read_bytes(), (entry / "cwd").resolve()
            named = os.fsencode(folder) in arguments + (entry / "environ").read_bytes()
            if arguments and (named or place.is_relative_to(folder)):
                others[int(entry.name)] = arguments
    others.pop(os.getpid(), None)
    return others


def find_victims(run: subprocess.Popen, folder: Path, way: str) -> list[int]:
    """List the processes of a run that a way of stopping it may kill."""
    others = {number: name for number, name in at_work(folder).items() if number != run.pid}
    if way == "a job":
        return [*others]
    if way == "the server of jobs":
        servers = sorted(number for number, name in others.items() if b"forkserver" in name)
        # The first is the server, if there is another, which is a job.
        return servers[:1] if len(servers) > 1 else []
    return [run.pid]


def stop(run: subprocess.Popen, folder: Path, way: str, chance: random.Random) -> bool:
    """Stop a run in some way, and tell whether there was something to kill before it ended.

    All that the run has started must end too, but for jobs of a Snakemake that was killed alone.
    """
    victims: list[int] = []
    while not victims and run.poll() is None:
        victims = find_victims(run, folder, way)
    kill = os.killpg if way in (*SIGNALS, "everything") else os.kill
    # There is nothing to choose from where the run has ended.
    with suppress(ProcessLookupError, IndexError):
        kill(chance.choice(victims), getattr(signal, way, signal.SIGKILL))
    since = time.monotonic()
    run.wait(timeout=300)
    if way in WITHOUT_MAKE:
        return bool(victims)
    if way not in SIGNALS:
        since = time.monotonic()
    limit = since + (AFTER_SIGKILL if way == "SIGKILL" else AT_ONCE)
    while others := at_work(folder):
        assert time.monotonic() < limit, (way, others)
        time.sleep(0.02)
    unwanted = "Traceback|Exception" if way in SIGNALS else "Traceback"
    assert not re.search(unwanted, said(folder)), said(folder)[-4000:]
    return bool(victims)


def fault_run(folder: Path, stops: int, seed: int, targets: Sequence[str] = TARGETS) -> str:
    """Stop runs ``stops`` times; compare whenever one ends by itself. Returns what happened."""
    chance, harmed = random.Random(seed), prepare(folder / "harmed")
    stopped, compared = Counter(), 0
    quiet, began = prepare(folder / "quiet"), time.monotonic()
    assert start(quiet, targets).wait(timeout=1200) == 0, said(quiet)
    duration, expected = time.monotonic() - began, digests(quiet)
    assert len(expected) >= 3 * len(targets)
    # Every file is named, so that each file that is taken away is missed.
    targets = [f"results/{name}" for name in expected]
    while True:
        way = min(WAYS, key=stopped.__getitem__)
        run = start(harmed, targets, by_make=way not in WITHOUT_MAKE)
        last = stopped.total() >= stops
        with suppress(subprocess.TimeoutExpired):
            run.wait(1200 if last else chance.uniform(0.02, 0.7) * duration)
        if run.poll() is None:
            stopped[way] += stop(run, harmed, way, chance)
            assert run.returncode or digests(harmed) == expected
            continue
        assert run.returncode == 0, said(harmed)[-4000:]
        differing = dict(digests(harmed).items() ^ expected.items())
        assert not differing, f"other than in a quiet run: {sorted(differing)}"
        compared += 1
        if last:
            break
        # Some of the files are taken away, so that the next runs have work.
        for name in sorted(expected)[chance.randrange(3) :: chance.choice((1, 3))]:
            (harmed / "results" / name).unlink()
    counts = ", ".join(f"{count} by {way}" for way, count in stopped.items())
    same_files = f"{len(expected)} files the same, byte by byte, {compared} times"
    return f"{stops} stops survived ({counts}); {same_files}"


if __name__ == "__main__":
    with tempfile.TemporaryDirectory(prefix="faults für ") as folder:
        print(fault_run(Path(folder), int(sys.argv[1]), seed=1))
