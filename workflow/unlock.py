"""Remove the lock that a killed run left in a folder, unless a run is alive there.

    python workflow/unlock.py .

Snakemake locks a folder while it runs; SIGKILL or a power cut leave the lock behind, and the next run would stop at it.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path


def snakemakes_in(folder: Path) -> list[int] | None:
    """Process ids of Snakemakes whose working directory is the folder; None where that cannot be told."""
    processes = Path("/proc")
    if not (processes / "self/cwd").exists():
        return None
    found = []
    for entry in processes.iterdir():
        if not entry.name.isdigit() or int(entry.name) == os.getpid():
            continue
        try:
            arguments = (entry / "cmdline").read_bytes().split(b"\0")
            here = (entry / "cwd").resolve() == folder
        except OSError:
            continue
        # The program itself, or `python -m snakemake`; not the scripts that it runs from .snakemake/scripts.
        names = [os.path.basename(argument) for argument in arguments[:3]]
        if here and b"snakemake" in names:
            found.append(int(entry.name))
    return found


def main(folders: list[str]) -> int:
    """Unlock a folder; returns the exit code."""
    if len(folders) != 1 or not Path(folders[0]).is_dir():
        print("usage: python workflow/unlock.py FOLDER", file=sys.stderr)
        return 2
    path = Path(folders[0]).resolve()
    locks = [lock for lock in (path / ".snakemake/locks").glob("*") if lock.is_file()]
    if not locks:
        return 0
    running = snakemakes_in(path)
    if running is None:
        print(
            "This folder is locked by another run. If there is none, run: snakemake --unlock", file=sys.stderr
        )
        return 1
    if running:
        print(
            f"Another run (process {running[0]}) is at work in this folder: wait for it, or stop it.",
            file=sys.stderr,
        )
        return 1
    for lock in locks:
        lock.unlink(missing_ok=True)
    # Files that a killed job was writing have a hidden name of their own until they are whole.
    for part in (path / "results").rglob(".*-????????.*"):
        part.unlink(missing_ok=True)
    print(
        "The last run was killed: its lock is removed, what it left unfinished is made anew.", file=sys.stderr
    )
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
