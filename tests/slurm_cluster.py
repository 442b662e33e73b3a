"""The draft through a Slurm cluster gives the data of the draft without, bit for bit.

    make slurm-test

Starts a cluster of one node on the loopback, with its configuration and key in a temporary folder,
and stops it at the end, whatever happened. Installs missing packages with apt-get. It must be root.
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
# Programs, and the Debian packages that hold them.
PROGRAMS = {"munged": "munge", "slurmctld": "slurmctld", "slurmd": "slurmd"}
PROGRAMS |= {"sbatch": "slurm-client"}
# proctrack/linuxproc and task/none need no control groups, which containers often lack. Cores and
# memory are limited, as on clusters. Finished jobs stay visible to squeue, and in a log.
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
last_line = lambda text: (text.strip().splitlines() or ["it said nothing"])[-1]


def unable(reason: str) -> NoReturn:
    """Exit because the machine cannot run a cluster, which is no failure of the project."""
    sys.exit(f"slurm-test: not run: {reason}")


def install() -> None:
    """Install what is missing of Slurm and munge, from Debian."""
    if os.geteuid() != 0:
        unable("make slurm-test starts a Slurm cluster, for which it must be root")
    missing = sorted({package for program, package in PROGRAMS.items() if not find(program)})
    if not missing:
        return
    if not shutil.which("apt-get"):
        unable(f"make slurm-test needs {', '.join(missing)}, and there is no apt-get for them")
    quiet = os.environ | {"DEBIAN_FRONTEND": "noninteractive"}
    for arguments in (["update"], ["install", "-y", "--no-install-recommends", *missing]):
        command = ["apt-get", "-qq", *arguments]
        print(*command, flush=True)
        done = subprocess.run(command, env=quiet, capture_output=True, text=True, check=False)
        if done.returncode:
            unable(f"apt-get {arguments[0]} failed: {last_line(done.stderr)}")


def find(program: str) -> str | None:
    """Find a program; daemons are often not on the path."""
    return shutil.which(program, path=f"{os.environ.get('PATH', '')}:/usr/sbin:/sbin")


@contextmanager
def cluster(folder: Path) -> Iterator[dict[str, str]]:
    """Run a Slurm of one node, whose environment this yields, and end every process of it."""
    for name in ("state", "spool", "bin"):
        (folder / name).mkdir()
    megabytes = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") // 2**20 * 9 // 10
    machine = {"cores": len(os.sched_getaffinity(0)), "megabytes": megabytes}
    # Nobody listens at these two ports of the loopback.
    local = ("127.0.0.1", 0)
    with socket.create_server(local) as first, socket.create_server(local) as second:
        machine["ports"] = [server.getsockname()[1] for server in (first, second)]
    conf, srun, key = folder / "slurm.conf", folder / "bin/srun", folder / "munged.key-file"
    conf.write_text(SLURM_CONF.format(folder=folder, **machine), encoding="ascii")
    key.write_bytes(os.urandom(1024))
    key.chmod(0o400)
    # Within a job the plugin clears the variable that names the configuration, which on a real
    # cluster lies where srun looks by itself.
    srun.write_text(f'#!/bin/sh\nSLURM_CONF={conf} exec {find("srun")} "$@"\n', encoding="ascii")
    srun.chmod(0o755)
    path = f"{folder}/bin:{Path(sys.executable).parent}:{os.environ.get('PATH', '')}"
    environment = os.environ | {"SLURM_CONF": str(conf), "PATH": path}

    def daemon(name: str, *arguments: str) -> None:
        pipes = {"stdin": subprocess.DEVNULL, "stderr": subprocess.STDOUT}
        with open(folder / f"{name}.out", "wb") as said:
            pipes["stdout"] = said
            command = [find(name), *arguments]
            subprocess.Popen(command, env=environment, start_new_session=True, **pipes)

    try:
        files = ("key-file", "socket", "pid-file", "log-file", "seed-file")
        daemon("munged", "--foreground", *[f"--{file}={folder}/munged.{file}" for file in files])
        wait_for((folder / "munged.socket").exists, "munged", folder)
        daemon("slurmctld", "-D")
        daemon("slurmd", "-D", "-N", "localhost")
        state = ("sinfo", "--noheader", "--format=%T")
        wait_for(lambda: answer(environment, *state) == "idle", "slurmd", folder)
        yield environment
    finally:
        answer(environment, "scancel", "--user=root")
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


def answer(environment: dict[str, str], *command: str) -> str:
    """Answer of a command of Slurm; empty while there is no answer."""
    with suppress(OSError, subprocess.TimeoutExpired):
        how = {"env": environment, "stderr": subprocess.DEVNULL, "text": True, "timeout": 10}
        return subprocess.check_output(command, **how).strip()
    return ""


def wait_for(ready, name: str, folder: Path, seconds: float = 30.0) -> None:
    """Wait until a daemon is ready, or exit with its last words."""
    until = time.monotonic() + seconds
    while not ready():
        if time.monotonic() > until:
            paths = sorted(folder.glob(f"{name}.[ol]*"), reverse=True)
            words = last_line("".join(path.read_text(errors="replace") for path in paths))
            unable(f"{name} did not start within {seconds:g} s: {words}")
        time.sleep(0.1)


def draft(folder: Path, environment: dict[str, str], *options: str) -> dict[str, str]:
    """Make the draft replication in a folder; returns the digest of each file of data."""
    began = time.monotonic()
    command = [*SNAKEMAKE, *options, "--config", "preset=draft", "--", "all"]
    how = {"capture_output": True, "text": True, "check": False}
    done = subprocess.run(command, cwd=folder, env=environment, **how)
    assert done.returncode == 0, (done.stdout + done.stderr)[-6000:]
    made = digests(folder).items()
    data = {name: digest for name, digest in made if name.endswith((".nc", ".csv"))}
    seconds = time.monotonic() - began
    print(f"{folder.name}: {len(data)} files of data in {seconds:.0f} s", flush=True)
    return data


def compare(folder: Path) -> str:
    """Run both ways, assert that no job failed and no file differs; returns the closing line."""
    local = copy_project(PROJECT, folder / "local", link=True)
    remote = copy_project(PROJECT, folder / "remote", link=True)
    daemons = folder / "cluster"
    daemons.mkdir()
    # munge wants everybody to reach its socket, but not its key.
    folder.chmod(0o711)
    daemons.chmod(0o755)
    # There is no accounting here, and nobody else in the queue.
    through = ["--slurm-status-command=squeue", "--slurm-init-seconds-before-status-checks=1"]
    with cluster(daemons) as environment:
        expected = draft(local, dict(os.environ), f"--cores={len(os.sched_getaffinity(0))}")
        data = draft(remote, environment, "--profile=workflow/profiles/slurm", *through)
    states = re.findall(r"\bJobState=(\S*)", (daemons / "finished.txt").read_text(encoding="utf-8"))
    left = at_work(daemons)
    assert not left, f"still running: {left}"
    assert states and set(states) == {"COMPLETED"}, f"jobs ended as {sorted(set(states))}"
    differing = sorted(name for name, _ in expected.items() ^ data.items())
    assert expected and not differing, f"other than without Slurm: {differing}"
    counts = f"{len(states)} jobs completed, {len(data)} files identical"
    return f"slurm-test: {counts}; nothing left running"


if __name__ == "__main__":
    # A run that is told to stop stops its cluster too.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    install()
    with tempfile.TemporaryDirectory(prefix="slurm-") as folder:
        try:
            print(compare(Path(folder)))
        finally:
            # A run that was interrupted leaves jobs without Slurm too.
            end_all(Path(folder))
