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
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NoReturn

from faults import at_work, digests
from pipeline_copy import SNAKEMAKE, copy_project

PROJECT = Path(__file__).resolve().parents[1]
# What is called, and the Debian package that holds it.
PROGRAMS = {
    "munged": "munge",
    "slurmctld": "slurmctld",
    "slurmd": "slurmd",
    "sbatch": "slurm-client",
}
# proctrack/linuxproc and task/none need no control groups, which containers often lack; select by cores and memory,
# as clusters do, so that limits which do not fit are seen; finished jobs stay visible to squeue; a log of them.
SLURM_CONF = """\
ClusterName=loopback
SlurmctldHost=localhost
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser=root
SlurmdUser=root
AuthInfo=socket={folder}/munged.socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
SlurmdParameters=config_overrides
SchedulerParameters=batch_sched_delay=0,sched_min_interval=0
JobCompType=jobcomp/filetxt
JobCompLoc={folder}/finished.txt
MinJobAge=600
ReturnToService=2
NodeName=localhost NodeAddr=127.0.0.1 CPUs={cores} RealMemory={megabytes} State=UNKNOWN
PartitionName=loopback Nodes=ALL Default=YES MaxTime=60 State=UP
"""


def unable(reason: str) -> NoReturn:
    """The cluster cannot be had here, which is no failure of the project."""
    sys.exit(f"slurm-test: not run: {reason}")


def install() -> None:
    """What is missing of Slurm and munge, from Debian."""
    if os.geteuid() != 0:
        unable("make slurm-test starts a Slurm cluster, for which it must be root")
    missing = sorted({package for program, package in PROGRAMS.items() if not find(program)})
    if missing and not shutil.which("apt-get"):
        unable(
            f"make slurm-test needs {', '.join(missing)}, and there is no apt-get to install them"
        )
    quiet = os.environ | {"DEBIAN_FRONTEND": "noninteractive"}
    for command in ("update", "install -y --no-install-recommends") if missing else ():
        words = ["apt-get", "-qq", *command.split(), *(missing if "install" in command else ())]
        print(*words, flush=True)
        done = subprocess.run(words, env=quiet, capture_output=True, text=True, check=False)
        if done.returncode:
            unable(f"apt-get {command} failed: {last_line(done.stderr)}")


def last_line(text: str) -> str:
    return (text.strip().splitlines() or ["it said nothing"])[-1]


def find(program: str) -> str | None:
    """Where a program is; daemons are often not on the path."""
    return shutil.which(program, path=f"{os.environ.get('PATH', '')}:/usr/sbin:/sbin")


@contextmanager
def cluster(folder: Path) -> Iterator[dict[str, str]]:
    """A Slurm of one node; gives the environment that leads to it, and ends every process of it."""
    for name in ("state", "spool", "bin"):
        (folder / name).mkdir()
    megabytes = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") // 2**20 * 9 // 10
    machine = {"cores": len(os.sched_getaffinity(0)), "megabytes": megabytes}
    # Two ports of the loopback that nobody listens at.
    with (
        socket.create_server(("127.0.0.1", 0)) as one,
        socket.create_server(("127.0.0.1", 0)) as other,
    ):
        machine["ports"] = [each.getsockname()[1] for each in (one, other)]
    conf, key, srun = folder / "slurm.conf", folder / "munged.key-file", folder / "bin/srun"
    conf.write_text(SLURM_CONF.format(folder=folder, **machine), encoding="ascii")
    key.write_bytes(os.urandom(1024))
    key.chmod(0o400)
    # Within a job the plugin clears the variable that names the configuration, which on a real cluster lies where
    # srun looks by itself.
    srun.write_text(f'#!/bin/sh\nSLURM_CONF={conf} exec {find("srun")} "$@"\n', encoding="ascii")
    srun.chmod(0o755)
    path = f"{folder}/bin:{Path(sys.executable).parent}:{os.environ.get('PATH', '')}"
    environment = os.environ | {"SLURM_CONF": str(conf), "PATH": path}

    def daemon(name: str, *arguments: str) -> None:
        options = {
            "stdin": subprocess.DEVNULL,
            "stderr": subprocess.STDOUT,
            "start_new_session": True,
        }
        with open(folder / f"{name}.out", "wb") as said:
            subprocess.Popen([find(name), *arguments], env=environment, stdout=said, **options)

    try:
        files = ("key-file", "socket", "pid-file", "log-file", "seed-file")
        daemon("munged", "--foreground", *(f"--{file}={folder}/munged.{file}" for file in files))
        wait_for((folder / "munged.socket").exists, "munged", folder)
        daemon("slurmctld", "-D")
        daemon("slurmd", "-D", "-N", "localhost")
        wait_for(
            lambda: asked(environment, "sinfo", "--noheader", "--format=%T") == "idle",
            "slurmd",
            folder,
        )
        yield environment
    finally:
        asked(environment, "scancel", "--user=root")
        end_all(folder)


def end_all(folder: Path) -> None:
    """End every process that names the folder, gently at first."""
    for sign in (signal.SIGTERM, signal.SIGKILL):
        for number in at_work(folder):
            with suppress(ProcessLookupError):
                os.kill(number, sign)
        until = time.monotonic() + 10
        while at_work(folder) and time.monotonic() < until:
            time.sleep(0.1)


def asked(environment: dict[str, str], *command: str) -> str:
    """What a command of Slurm answers; nothing while there is no answer."""
    with suppress(OSError, subprocess.TimeoutExpired):
        how = {"env": environment, "stderr": subprocess.DEVNULL, "text": True, "timeout": 10}
        return subprocess.check_output(command, **how).strip()
    return ""


def wait_for(ready, name: str, folder: Path, seconds: float = 30.0) -> None:
    """Until a daemon is ready; otherwise its last words."""
    until = time.monotonic() + seconds
    while not ready():
        if time.monotonic() > until:
            said = [
                path.read_text(errors="replace") for path in sorted(folder.glob(f"{name}.[ol]*"))
            ]
            unable(
                f"{name} did not start within {seconds:g} s: {last_line(''.join(reversed(said)))}"
            )
        time.sleep(0.1)


def draft(folder: Path, environment: dict[str, str], *options: str) -> dict[str, str]:
    """The draft replication in a folder; returns the digest of each file of data."""
    began = time.monotonic()
    command = [*SNAKEMAKE, *options, "--config", "preset=draft", "--", "all"]
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, (done.stdout + done.stderr)[-6000:]
    found = {
        name: digest for name, digest in digests(folder).items() if name.endswith((".nc", ".csv"))
    }
    print(
        f"{folder.name}: {len(found)} files of data in {time.monotonic() - began:.0f} s", flush=True
    )
    return found


def compare(folder: Path) -> str:
    """Run both ways, assert that no job failed and no file differs; returns the closing line."""
    local, remote = (
        copy_project(PROJECT, folder / name, link=True) for name in ("local", "remote")
    )
    daemons = folder / "cluster"
    daemons.mkdir()
    # munge wants its socket to be within everybody's reach; the key is not.
    folder.chmod(0o711)
    daemons.chmod(0o755)
    # There is no accounting here, and nobody else in the queue.
    through = ["--slurm-status-command=squeue", "--slurm-init-seconds-before-status-checks=1"]
    with cluster(daemons) as environment:
        expected = draft(local, dict(os.environ), f"--cores={len(os.sched_getaffinity(0))}")
        found = draft(remote, environment, "--profile=workflow/profiles/slurm", *through)
    states = re.findall(r"\bJobState=(\S*)", (daemons / "finished.txt").read_text(encoding="utf-8"))
    assert not (left := at_work(daemons)), f"still running: {left}"
    assert states and set(states) == {"COMPLETED"}, f"jobs ended as {sorted(set(states))}"
    differing = sorted(name for name, _ in expected.items() ^ found.items())
    assert expected and not differing, f"other than without Slurm: {differing}"
    return f"slurm-test: {len(states)} jobs completed, {len(found)} files identical; nothing left running"


def main() -> None:
    # So that a run that is told to stop stops its cluster too.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    install()
    with tempfile.TemporaryDirectory(prefix="slurm-") as folder:
        try:
            print(compare(Path(folder)))
        finally:
            # A run that was interrupted leaves jobs without Slurm, too.
            end_all(Path(folder))


if __name__ == "__main__":
    main()
