"""Stop a small run at random times, again and again. Its results must equal those of a quiet run.

    make faults                   24 stops
    python tests/faults.py 3      3 stops

There are several ways to stop a run. If `make replicate` has started it, it gets a signal, or the
process that starts its workers is killed. If Snakemake was started directly, Snakemake, one job or
all processes are killed. The next run must continue from what is there.
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
from collections.abc import Iterable, Sequence
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
WAYS_TO_STOP = (*SIGNALS, "the server of jobs", *WITHOUT_MAKE)
# Longest time in seconds until all processes have ended. After SIGKILL a worker only notices that
# its parent has ended when it has started completely.
MAX_SECONDS_TO_END, MAX_SECONDS_AFTER_SIGKILL = 2.0, 60.0


def prepare(folder: Path) -> Path:
    """Make a folder for the small run, with links to the sources and its overlay."""
    copy_project(PROJECT, folder, link=True)
    (folder / "overlay.yaml").write_text(yaml.safe_dump(OVERLAY), encoding="utf-8")
    return folder


def start(folder: Path, targets: Sequence[str], by_make: bool = True) -> subprocess.Popen:
    """Start a run in a new process group, as `make replicate` does, or by Snakemake."""
    command = [*SNAKEMAKE, "--cores", "2", "--configfile", "overlay.yaml", "--", *targets]
    if not by_make and any((folder / ".snakemake/locks").glob("*.lock")):
        # Snakemake asks the user to do this after a kill. `make replicate` does it itself.
        unlock = [*SNAKEMAKE, "--configfile", "overlay.yaml", "--unlock"]
        subprocess.run(unlock, cwd=folder, check=True, capture_output=True)
    if by_make:
        command = [sys.executable, "workflow/run.py", "replicate"]
    options = {"CORES": "2", "PRESET": "", "OVERLAY": "overlay.yaml", "TARGET": " ".join(targets)}
    process_options = {"cwd": folder, "env": os.environ | options, "start_new_session": True}
    with open(folder / "output.txt", "w", encoding="utf-8") as output_file:
        return subprocess.Popen(command, stdout=output_file, stderr=output_file, **process_options)


def output_of(folder: Path) -> str:
    """Return what the last run in a folder has printed."""
    return (folder / "output.txt").read_text(encoding="utf-8")


def digests(folder: Path, results: str = "results") -> dict[str, str]:
    """Return the digest of every result, without logs, measured seconds and hidden files.

    Records are hidden files, and so are the unfinished files that a killed run leaves.
    """
    digest = {}
    for path in sorted((folder / results).rglob("*")):
        name = path.relative_to(folder / results)
        is_hidden = any(part.startswith(".") for part in name.parts)
        if path.is_file() and not is_hidden and name.parts[0] not in ("logs", "seconds"):
            digest[str(name)] = hashlib.sha256(path.read_bytes()).hexdigest()
    return digest


def processes_in(folder: Path) -> dict[int, bytes]:
    """Return the arguments of the other processes that run in a folder or name it, by their ids."""
    folder, others = folder.resolve(), {}
    for entry in Path("/proc").glob("[0-9]*"):
        # A process may end while its files are read.
        with suppress(OSError):
            arguments = (entry / "cmdline").read_bytes()
            environment = (entry / "environ").read_bytes()
            is_in_folder = (entry / "cwd").resolve().is_relative_to(folder)
            names_folder = os.fsencode(folder) in arguments + environment
            if arguments and (is_in_folder or names_folder):
                others[int(entry.name)] = arguments
    others.pop(os.getpid(), None)
    return others


def find_victims(run: subprocess.Popen, folder: Path, way: str) -> list[int]:
    """Return the ids of the processes of a run, of which one is killed to stop it in some way."""
    if way not in ("a job", "the server of jobs"):
        return [run.pid]
    others = processes_in(folder)
    others.pop(run.pid, None)
    if way == "a job":
        return [*others]
    forked = sorted(number for number, arguments in others.items() if b"forkserver" in arguments)
    # The first process is the server if there is a second one, which is a worker.
    return forked[:1] if len(forked) > 1 else []


def stop(run: subprocess.Popen, folder: Path, way: str, chance: random.Random) -> bool:
    """Stop a run in some way, and return True if there was a process to kill before it ended.

    All processes of the run must end too, except the jobs of a Snakemake that was killed alone.
    """
    victims: list[int] = []
    while not victims and run.poll() is None:
        victims = find_victims(run, folder, way)
    kill = os.killpg if way in (*SIGNALS, "everything") else os.kill
    # If the run has ended, there is no process to choose from.
    with suppress(ProcessLookupError, IndexError):
        kill(chance.choice(victims), getattr(signal, way, signal.SIGKILL))
    killed_at = time.monotonic()
    run.wait(timeout=300)
    if way not in WITHOUT_MAKE:
        # After the end of its server, Snakemake first waits for the jobs that are running.
        begin = killed_at if way in SIGNALS else time.monotonic()
        seconds = MAX_SECONDS_AFTER_SIGKILL if way == "SIGKILL" else MAX_SECONDS_TO_END
        check_all_ended(folder, begin + seconds, way)
        unwanted = "Traceback|Exception" if way in SIGNALS else "Traceback"
        assert not re.search(unwanted, output_of(folder)), output_of(folder)[-4000:]
    return bool(victims)


def check_all_ended(folder: Path, limit: float, way: str) -> None:
    """Wait until no process runs in a folder, which must be so before a time."""
    while others := processes_in(folder):
        assert time.monotonic() < limit, (way, others)
        time.sleep(0.02)


def fault_run(folder: Path, stops: int, seed: int, targets: Sequence[str] = TARGETS) -> str:
    """Stop runs ``stops`` times, and return a summary of what happened.

    Whenever a run ends by itself, its results are compared with those of a quiet run.
    """
    quiet, harmed = prepare(folder / "quiet"), prepare(folder / "harmed")
    began = time.monotonic()
    assert start(quiet, targets).wait(timeout=1200) == 0, output_of(quiet)
    duration = time.monotonic() - began
    expected = digests(quiet)
    assert len(expected) >= 3 * len(targets)
    # Every file is a target, so that each file that is removed is made again.
    targets = [f"results/{name}" for name in expected]
    chance, stopped = random.Random(seed), Counter()
    comparisons, has_finished = 0, False
    while not has_finished:
        # The way that was used least comes next.
        way = min(WAYS_TO_STOP, key=stopped.__getitem__)
        run = start(harmed, targets, by_make=way not in WITHOUT_MAKE)
        is_last = stopped.total() >= stops
        seconds = 1200.0 if is_last else chance.uniform(0.02, 0.7) * duration
        with suppress(subprocess.TimeoutExpired):
            run.wait(seconds)
        if run.poll() is None:
            stopped[way] += stop(run, harmed, way, chance)
            assert run.returncode or digests(harmed) == expected
            continue
        check_results(run, harmed, expected)
        comparisons += 1
        has_finished = is_last
        if not has_finished:
            remove_some(harmed, expected, chance)
    counts = ", ".join(f"{count} by {way}" for way, count in stopped.items())
    same_files = f"{len(expected)} files the same, byte by byte, {comparisons} times"
    return f"{stops} stops survived ({counts}); {same_files}"


def check_results(run: subprocess.Popen, folder: Path, expected: dict[str, str]) -> None:
    """Assert that a run has ended well, with the expected results."""
    assert run.returncode == 0, output_of(folder)[-4000:]
    differing = dict(digests(folder).items() ^ expected.items())
    assert not differing, f"files that differ from a quiet run: {sorted(differing)}"


def remove_some(folder: Path, names: Iterable[str], chance: random.Random) -> None:
    """Remove all results or a third of them, so that the next runs have work."""
    first, step = chance.randrange(3), chance.choice((1, 3))
    for name in sorted(names)[first::step]:
        (folder / "results" / name).unlink()


if __name__ == "__main__":
    with tempfile.TemporaryDirectory(prefix="faults für ") as folder:
        print(fault_run(Path(folder), int(sys.argv[1]), seed=1))
