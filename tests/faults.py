"""Stop a reduced draft run at random instants, over and over; what comes out must be what a quiet run gives.

    make faults             24 stops
    python tests/faults.py --kills 3 --seed 7

A run as `make replicate` starts it is stopped by a signal, or its server of jobs is killed; of one that Snakemake alone
starts, Snakemake, a job or everything is. The next run goes on from what is there. Results are compared byte by byte.
"""

import argparse
import hashlib
import os
import random
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
OVERLAY = {
    "preset": "draft",
    "simulations": {
        "steady_displacement": {"left": [0.4, 0.5, 0.6, 0.7], "damping_ratio": [0.0, 0.1], "duration": {"time": 20.0}}
    },
    "scenes": {"one": SCENE | {"dx": 0.04, "duration": 10.0}},
}  # fmt: skip
SIGNALS = ("SIGTERM", "SIGINT", "SIGHUP", "SIGKILL")
WITHOUT_MAKE = ("Snakemake", "a job", "everything")
WAYS = (*SIGNALS, "the server of jobs", *WITHOUT_MAKE)
# Seconds. SIGKILL leaves nobody who could end what was started: that ends itself when it has begun to work.
AT_ONCE, AFTER_SIGKILL = 2.0, 60.0


def prepare(folder: Path) -> Path:
    """A folder in which the reduced run can be made, its sources linked."""
    copy_project(PROJECT, folder, link=True)
    (folder / "overlay.yaml").write_text(yaml.safe_dump(OVERLAY), encoding="utf-8")
    return folder


def start(folder: Path, targets: Sequence[str], by_make: bool = True) -> subprocess.Popen:
    """A run in a process group of its own, as `make replicate` starts it or by Snakemake itself."""
    command = [*SNAKEMAKE, "--cores", "2", "--configfile", "overlay.yaml", "--", *targets]
    options = {"CORES": "2", "PRESET": "", "OVERLAY": "overlay.yaml", "TARGET": " ".join(targets)}
    with open(folder / "said.txt", "w", encoding="utf-8") as said:
        return subprocess.Popen(
            [sys.executable, "workflow/run.py", "replicate"] if by_make else command,
            cwd=folder, env=os.environ | options, stdout=said, stderr=said, start_new_session=True,
        )  # fmt: skip


def digests(folder: Path, results: str = "results") -> dict[str, str]:
    """Every result but logs, times and notes; a hidden name is a file that its writer was killed over."""
    paths = {
        path.relative_to(folder / results): path for path in sorted((folder / results).rglob("*"))
    }
    return {
        str(name): hashlib.sha256(path.read_bytes()).hexdigest()
        for name, path in paths.items()
        if path.is_file()
        and not path.name.startswith(".")
        and name.parts[0] not in ("logs", "benchmarks", "records")
    }


def at_work(folder: Path) -> dict[int, bytes]:
    """Arguments of all other processes that work in a folder, or whose arguments or environment name it."""
    found, folder = {}, folder.resolve()
    for entry in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            arguments, here = (entry / "cmdline").read_bytes(), (entry / "cwd").resolve()
            named = os.fsencode(folder) in arguments + (entry / "environ").read_bytes()
            if (
                arguments
                and int(entry.name) != os.getpid()
                and (named or here.is_relative_to(folder))
            ):
                found[int(entry.name)] = arguments
    return found


def stop(run: subprocess.Popen, folder: Path, way: str, chance: random.Random) -> bool:
    """Stop a run in some way, unless it ends before there is what is killed; returns whether it was stopped.

    All that it has started ends with it, but for jobs of a Snakemake that was killed alone.
    """
    able: list[int] = []
    while not able and run.poll() is None:
        others = {number: name for number, name in at_work(folder).items() if number != run.pid}
        # The first is the server, if there is another, which is a job.
        servers = sorted(number for number, name in others.items() if b"forkserver" in name)
        able = {"a job": [*others], "the server of jobs": servers[: len(servers) > 1]}.get(
            way, [run.pid]
        )
    kill = os.killpg if way in (*SIGNALS, "everything") else os.kill
    with suppress(ProcessLookupError):
        for victim in able and [chance.choice(able)]:
            kill(victim, getattr(signal, way, signal.SIGKILL))
    since = time.monotonic()
    run.wait(timeout=300)
    if way in WITHOUT_MAKE:
        return bool(able)
    # That the server is gone, the run has to see first.
    since = since if way in SIGNALS else time.monotonic()
    while left := at_work(folder):
        assert time.monotonic() - since < (AFTER_SIGKILL if way == "SIGKILL" else AT_ONCE), (
            way,
            left,
        )
        time.sleep(0.02)
    said = (folder / "said.txt").read_text(encoding="utf-8")
    assert "Traceback" not in said and ("Exception" not in said or way not in SIGNALS), said[-4000:]
    return bool(able)


def fault_run(folder: Path, stops: int, seed: int, targets: Sequence[str] = TARGETS) -> str:
    """Stop runs ``stops`` times; compare each time that one gets to its end. Returns what happened."""
    chance, stopped, compared = random.Random(seed), Counter(), 0
    quiet, harmed = prepare(folder / "quiet"), prepare(folder / "harmed")
    began = time.monotonic()
    assert start(quiet, targets).wait(timeout=1200) == 0, (quiet / "said.txt").read_text(
        encoding="utf-8"
    )
    duration = time.monotonic() - began
    expected = digests(quiet)
    assert len(expected) >= 3 * len(targets)
    # Every file by name, so that each that is taken away is missed.
    targets = [f"results/{name}" for name in expected]
    while True:
        left, way = stops - stopped.total(), min(WAYS, key=stopped.__getitem__)
        run = start(harmed, targets, by_make=way not in WITHOUT_MAKE)
        try:
            # What is there already is not made again.
            run.wait(chance.uniform(0.02, 0.7) * duration if left else 1200)
        except subprocess.TimeoutExpired:
            stopped[way] += stop(run, harmed, way, chance)
            assert run.returncode or digests(harmed) == expected
            continue
        assert run.returncode == 0, (harmed / "said.txt").read_text(encoding="utf-8")[-4000:]
        differing = dict(digests(harmed).items() ^ expected.items())
        assert not differing, f"other than in a quiet run: {sorted(differing)}"
        compared += 1
        if not left:
            break
        # Some of the files are taken away, so that the next runs have work.
        for name in sorted(expected)[chance.randrange(3) :: chance.choice((1, 3))]:
            (harmed / "results" / name).unlink()
    counts = ", ".join(f"{count} by {way}" for way, count in stopped.items())
    same = f"{len(expected)} files the same, byte by byte, {compared} times"
    return f"{stops} stops survived ({counts}); {same}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=24)
    parser.add_argument("--seed", type=int, default=1)
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="faults für ") as folder:
        print(fault_run(Path(folder), chosen.kills, chosen.seed))


if __name__ == "__main__":
    main()
