"""Compare a draft that runs on a Slurm cluster with one that runs without Slurm.

    make slurm-test

The data must be equal, bit for bit. The program starts a cluster of one node on the loopback
interface, with its configuration and key in a temporary folder, and always stops it at the end. The
make target installs Slurm, for which it must be root.
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
from contextlib import suppress
from pathlib import Path

from faults import digests, processes_in
from pipeline_copy import SNAKEMAKE, copy_project

PROJECT = Path(__file__).resolve().parents[1]
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


def start_cluster(folder: Path) -> dict[str, str]:
    """Start a Slurm cluster of one node, and return the environment of its users."""
    for name in ("state", "spool", "bin"):
        (folder / name).mkdir()
    bytes_of_memory = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    # A tenth of the memory stays for the daemons.
    megabytes = bytes_of_memory // 2**20 * 9 // 10
    conf, srun, key = folder / "slurm.conf", folder / "bin/srun", folder / "munged.key-file"
    text = SLURM_CONF.format(
        folder=folder,
        ports=free_ports(),
        cores=len(os.sched_getaffinity(0)),
        megabytes=megabytes,
    )
    conf.write_text(text, encoding="ascii")
    key.write_bytes(os.urandom(1024))
    key.chmod(0o400)
    # Within a job the plugin clears the variable that names the configuration. On a real cluster
    # the configuration is where srun looks by itself.
    srun.write_text(f'#!/bin/sh\nSLURM_CONF={conf} exec {shutil.which("srun")} "$@"\n', "ascii")
    srun.chmod(0o755)
    path = f"{folder}/bin:{Path(sys.executable).parent}:{os.environ['PATH']}"
    environment = os.environ | {"SLURM_CONF": str(conf), "PATH": path}
    files = ("key-file", "socket", "pid-file", "log-file", "seed-file")
    munged = ["munged", *[f"--{file}={folder}/munged.{file}" for file in files]]
    for daemon in (munged, ["slurmctld"], ["slurmd", "-N", "localhost"]):
        subprocess.run(daemon, env=environment, check=True)
    return environment


def free_ports() -> list[int]:
    """Return two ports of the loopback interface at which nobody listens."""
    address = ("127.0.0.1", 0)
    with socket.create_server(address) as first, socket.create_server(address) as second:
        return [server.getsockname()[1] for server in (first, second)]


def end_all(folder: Path) -> None:
    """End every process that names the folder, gently at first."""
    for sign in (signal.SIGTERM, signal.SIGKILL):
        for number in processes_in(folder):
            with suppress(ProcessLookupError):
                os.kill(number, sign)
        until = time.monotonic() + 10
        while processes_in(folder) and time.monotonic() < until:
            time.sleep(0.1)


def draft(folder: Path, environment: dict[str, str], *options: str) -> dict[str, str]:
    """Make the draft replication in a folder, and return the digest of each file of data."""
    command = [*SNAKEMAKE, *options, "--config", "preset=draft", "--", "all"]
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, (done.stdout + done.stderr)[-6000:]
    data = {}
    for name, digest in digests(folder).items():
        if name.endswith((".nc", ".csv")):
            data[name] = digest
    print(f"{folder.name}: {len(data)} files of data", flush=True)
    return data


def compare(folder: Path) -> str:
    """Run with and without Slurm, assert that nothing fails or differs, and return a summary."""
    local = copy_project(PROJECT, folder / "local", link=True)
    remote = copy_project(PROJECT, folder / "remote", link=True)
    daemons = folder / "cluster"
    daemons.mkdir()
    # munge requires that everybody can reach its socket, but not its key.
    folder.chmod(0o711)
    daemons.chmod(0o755)
    # The cluster has no accounting, and nobody else uses it.
    slurm_options = ["--slurm-status-command=squeue", "--slurm-init-seconds-before-status-checks=1"]
    environment = start_cluster(daemons)
    expected = draft(local, dict(os.environ), f"--cores={len(os.sched_getaffinity(0))}")
    # The daemons have found each other while the first draft was running.
    node = subprocess.check_output(["sinfo", "--noheader", "--format=%T"], env=environment)
    assert node == b"idle\n", node
    data = draft(remote, environment, "--profile=workflow/profiles/slurm", *slurm_options)
    end_all(daemons)
    states = re.findall(r"\bJobState=(\S*)", (daemons / "finished.txt").read_text(encoding="utf-8"))
    still_running = processes_in(daemons)
    assert not still_running, f"still running: {still_running}"
    assert states and set(states) == {"COMPLETED"}, f"jobs ended as {sorted(set(states))}"
    differing = sorted(dict(expected.items() ^ data.items()))
    assert expected and not differing, f"files that differ: {differing}"
    counts = f"{len(states)} jobs completed, {len(data)} files identical"
    return f"slurm-test: {counts}; nothing left running"


if __name__ == "__main__":
    # A signal to end also stops the cluster.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    with tempfile.TemporaryDirectory(prefix="slurm-") as folder:
        try:
            print(compare(Path(folder)))
        finally:
            # An interrupted run leaves the daemons and jobs.
            end_all(Path(folder))
