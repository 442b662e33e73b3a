"""A lock that the system releases when its holder ends, even if the holder is killed.

    python lock.py FILE COMMAND...     waits for the lock and then runs a command
    python lock.py FILE                fails if another process holds the lock

The set-up of the environment runs this file before any package is installed, and so it imports only
the standard library.
"""

import errno
import fcntl
import subprocess
import sys
from pathlib import Path
from typing import TextIO


def take(path: str | Path, wait: bool = False) -> TextIO | None:
    """Take a lock, which is held until the returned file is closed.

    If another process holds the lock, wait for it, or return None without ``wait``.
    """
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    file = open(path, "a", encoding="utf-8")  # noqa: SIM115
    try:
        fcntl.flock(file, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except OSError as error:
        # Other errors mean that the file system has no locks. The run then goes on without one.
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
        print("Another set-up is running in this folder: waiting for it", flush=True)
        held = take(path, wait=True)
    return subprocess.run(command, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
