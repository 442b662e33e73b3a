"""A lock that the system frees when its holder ends, however that happens.

    python lock.py FILE COMMAND...     waits for the lock, then runs a command
    python lock.py FILE                fails where somebody holds the lock

The set-up of the environment uses it too: it needs nothing but Python.
"""

import errno
import fcntl
import subprocess
import sys
from pathlib import Path
from typing import TextIO


def take(path: str | Path, wait: bool = False) -> TextIO | None:
    """Hold a lock until the returned file is closed; wait for it, or return None if it is held."""
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    file = open(path, "a", encoding="utf-8")  # noqa: SIM115
    try:
        fcntl.flock(file, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except OSError as error:
        # Some file systems have no locks: there is then no protection.
        if error.errno in (errno.EAGAIN, errno.EACCES):
            file.close()
            return None
    return file


def main(arguments: list[str]) -> int:
    """Run the module as a command, and return its exit code."""
    path, *command = arguments
    held = take(path)
    if not command:
        return int(held is None)
    if held is None:
        print("Another set-up is at work in this folder: waiting for it", flush=True)
        held = take(path, wait=True)
    return subprocess.run(command, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
