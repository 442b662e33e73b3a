"""The draft through a Slurm cluster, against the draft without; the data must be the same, bit for bit.

    make slurm-test

Starts a cluster of one node on the loopback, with a configuration and a key of its own in a temporary folder, and stops
it at the end, whatever happened. Packages that are missing are installed with apt-get; for both it must be root.
"""

import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from faults import digests
from pipeline_copy import copy_project

PROJECT = Path(__file__).resolve().parents[1]
# What is called, and the Debian package that holds it.
PROGRAMS = {"munged": "munge", "slurmctld": "slurmctld", "slurmd": "slurmd", "sbatch": "slurm-client"}
COMPARED = (".nc", ".csv")
# How a line begins that says why there was no run: a machine without Slurm is no failure of the project.
NOT_RUN = "slurm-test: not run"

# proctrack/linuxproc and task/none need no control groups, which containers often lack; select by cores and memory,
# as clusters do, so that limits which do not fit are seen; finished jobs stay visible to squeue; a log of them.
SLURM_CONF = """\
ClusterName=loopback
SlurmctldHost=localhost
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.sock
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
SlurmdParameters=config_overrides
SchedulerParameters=batch_sched_delay=0,sched_min_interval=0
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
JobCompType=jobcomp/filetxt
JobCompLoc={folder}/finished.txt
MinJobAge=600
ReturnToService=2
NodeName=localhost NodeAddr=127.0.0.1 CPUs={cores} RealMemory={megabytes} State=UNKNOWN
PartitionName=loopback Nodes=ALL Default=YES MaxTime=60 State=UP
"""


class Unable(Exception):
    """The cluster cannot be had here; the message says why, in one line."""


def install() -> None:
    """What is missing of Slurm and munge, from Debian."""
    missing = sorted({package for program, package in PROGRAMS.items() if not find(program)})
    if os.geteuid() != 0:
        raise Unable("make slurm-test starts a Slurm cluster, for which it must be root")
    if not missing:
        return
    if not shutil.which("apt-get"):
        raise Unable(f"make slurm-test needs {', '.join(missing)}, and there is no apt-get to install them")
    print(f"Installing {', '.join(missing)}", flush=True)
    quiet = os.environ | {"DEBIAN_FRONTEND": "noninteractive"}
    for command in (["update", "-qq"], ["install", "-y", "-qq", "--no-install-recommends", *missing]):
        done = subprocess.run(
            ["apt-get", *command], env=quiet, capture_output=True, text=True, stdin=subprocess.DEVNULL, check=False
        )  # fmt: skip
        if done.returncode:
            words = done.stderr.strip().splitlines() or ["no reason given"]
            raise Unable(f"apt-get {command[0]} failed: {words[-1]}")


def find(program: str) -> str | None:
    """Where a program is; daemons are often not on the path."""
    return shutil.which(program, path=f"{os.environ.get('PATH', '')}:/usr/sbin:/sbin")


def free_ports(count: int) -> list[int]:
    """Ports of the loopback that nobody listens at."""
    with ExitStack() as open_ones:
        sockets = [open_ones.enter_context(socket.socket()) for _ in range(count)]
        for each in sockets:
            each.bind(("127.0.0.1", 0))
        return [each.getsockname()[1] for each in sockets]


def processes_of(folder: Path) -> list[int]:
    """Processes whose arguments or environment name the folder: daemons, and what a job left behind."""
    name, found = os.fsencode(folder), []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit() and int(entry.name) != os.getpid():
            with suppress(OSError):
                if name in (entry / "cmdline").read_bytes() or name in (entry / "environ").read_bytes():
                    found.append(int(entry.name))
    return found


@contextmanager
def cluster(folder: Path) -> Iterator[dict[str, str]]:
    """A Slurm of one node; gives the environment that leads to it, and ends every process of it."""
    for name in ("state", "spool", "bin"):
        (folder / name).mkdir()
    machine = {
        "cores": len(os.sched_getaffinity(0)),
        "megabytes": os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") // 2**20 * 9 // 10,
    }
    conf = folder / "slurm.conf"
    conf.write_text(SLURM_CONF.format(folder=folder, ports=free_ports(2), **machine), encoding="ascii")
    key = folder / "munge.key"
    key.write_bytes(os.urandom(1024))
    key.chmod(0o400)
    # Within a job the plugin clears the variable that names the configuration, which on a real cluster lies where
    # srun looks by itself.
    srun = folder / "bin/srun"
    srun.write_text(f'#!/bin/sh\nSLURM_CONF={conf} exec {find("srun")} "$@"\n', encoding="ascii")
    srun.chmod(0o755)
    path = f"{folder}/bin:{Path(sys.executable).parent}:{os.environ.get('PATH', '')}"
    environment = os.environ | {"SLURM_CONF": str(conf), "PATH": path}
    daemons = []

    def daemon(name: str, *arguments: str) -> None:
        with open(folder / f"{name}.out", "wb") as said:
            process = subprocess.Popen(
                [find(name), *arguments], env=environment, stdin=subprocess.DEVNULL, stdout=said, stderr=said,
                start_new_session=True,
            )  # fmt: skip
            daemons.append(process)

    try:
        munge = [f"--{option}={folder}/munge.{ending}" for option, ending in (
            ("key-file", "key"), ("socket", "sock"), ("pid-file", "pid"), ("log-file", "log"), ("seed-file", "seed"),
        )]  # fmt: skip
        daemon("munged", "--foreground", *munge)
        wait_for(lambda: (folder / "munge.sock").exists(), "munged", folder)
        daemon("slurmctld", "-D")
        daemon("slurmd", "-D", "-N", "localhost")
        wait_for(lambda: asked(environment, "sinfo", "--noheader", "--format=%T") == "idle", "slurmd", folder)
        yield environment
    finally:
        asked(environment, "scancel", "--user=root")
        for process in reversed(daemons):
            process.terminate()
        for process in daemons:
            with suppress(subprocess.TimeoutExpired):
                process.wait(timeout=10)
        end_all(folder)
        for process in daemons:
            process.wait()


def end_all(folder: Path) -> None:
    """End every process that names the folder, gently at first."""
    for sign in (signal.SIGTERM, signal.SIGKILL):
        for pid in processes_of(folder):
            with suppress(ProcessLookupError):
                os.kill(pid, sign)
        until = time.monotonic() + 5
        while processes_of(folder) and time.monotonic() < until:
            time.sleep(0.1)


def asked(environment: dict[str, str], *command: str) -> str:
    """What a command of Slurm answers; nothing while there is no answer."""
    with suppress(OSError, subprocess.TimeoutExpired):
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True, timeout=10, check=False
        )
        return done.stdout.strip()
    return ""


def wait_for(ready, name: str, folder: Path, seconds: float = 30.0) -> None:
    """Until a daemon is ready; otherwise its last words."""
    until = time.monotonic() + seconds
    while not ready():
        if time.monotonic() > until:
            paths = [path for path in (folder / f"{name}.out", folder / f"{name}.log") if path.exists()]
            said = "".join(path.read_text(encoding="utf-8", errors="replace") for path in paths)
            words = said.splitlines() or ["it said nothing"]
            raise Unable(f"{name} did not start within {seconds:g} s: {words[-1]}")
        time.sleep(0.1)


def draft(folder: Path, environment: dict[str, str], *arguments: str) -> float:
    """The draft replication in a folder; returns seconds."""
    began = time.monotonic()
    command = [
        sys.executable,
        "-m",
        "snakemake",
        "--workflow-profile",
        "none",
        "--force-use-threads",
        *arguments,
    ]
    with open(folder / "said.txt", "wb") as said:
        done = subprocess.run(
            [*command, "--config", "preset=draft", "--", "all"], cwd=folder, env=environment, check=False,
            stdin=subprocess.DEVNULL, stdout=said, stderr=said,
        )  # fmt: skip
    assert done.returncode == 0, (folder / "said.txt").read_text(encoding="utf-8")[-6000:]
    return time.monotonic() - began


def data_of(folder: Path) -> dict[str, str]:
    """Checksums of the data in a folder's results."""
    return {name: digest for name, digest in digests(folder).items() if name.endswith(COMPARED)}


def finished(folder: Path) -> list[str]:
    """State in which each job of the cluster ended."""
    text = (folder / "finished.txt").read_text(encoding="utf-8")
    return re.findall(r"\bJobState=(\S*)", text)


def compare(folder: Path) -> str:
    """Run both ways and compare; returns the closing line.

    Raises
    ------
    AssertionError
        When a run fails, a job did not complete, or a file differs.
    """
    local = copy_project(PROJECT, folder / "local", link=True)
    remote = copy_project(PROJECT, folder / "remote", link=True)
    daemons = folder / "cluster"
    daemons.mkdir()
    # munge wants its socket to be within everybody's reach; the key is not.
    folder.chmod(0o711)
    daemons.chmod(0o755)
    cores = len(os.sched_getaffinity(0))
    with cluster(daemons) as environment:
        seconds = draft(local, dict(os.environ), "--cores", str(cores))
        expected = data_of(local)
        print(f"Without Slurm: {len(expected)} data files in {seconds:.0f} s", flush=True)
        # There is no accounting here, and nobody else in the queue.
        seconds = draft(
            remote,
            environment,
            "--profile=workflow/profiles/slurm",
            "--slurm-status-command=squeue",
            "--slurm-init-seconds-before-status-checks=1",
        )
    states, found = finished(daemons), data_of(remote)
    print(f"Through Slurm: {len(states)} jobs, {len(found)} data files in {seconds:.0f} s", flush=True)
    left = processes_of(daemons)
    assert not left, f"still running: {left}"
    assert states and set(states) == {"COMPLETED"}, f"jobs ended as {sorted(set(states))}"
    assert expected and sorted(expected) == sorted(found), sorted({*expected} ^ {*found})
    differing = [name for name in expected if expected[name] != found[name]]
    assert not differing, f"other than without Slurm: {differing}"
    kinds = ", ".join(f"{sum(name.endswith(kind) for name in found)} {kind[1:]}" for kind in COMPARED)
    return (
        f"slurm-test: {len(states)} jobs through Slurm, all completed; {len(found)} files compared ({kinds}),"
        f" {len(found) - len(differing)} identical; nothing left running"
    )


def main() -> int:
    """Run it; returns the exit code."""
    # So that a run that is told to stop stops its cluster too.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    try:
        install()
        with tempfile.TemporaryDirectory(prefix="slurm-") as folder:
            try:
                print(compare(Path(folder)))
            finally:
                # A run that was interrupted leaves jobs without Slurm, too.
                end_all(Path(folder))
    except Unable as reason:
        print(f"{NOT_RUN}: {reason}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
