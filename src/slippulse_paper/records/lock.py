"""A lock that the system releases when its holder ends, even if the holder is killed.

    python lock.py FILE COMMAND...     waits until the lock is free, and runs a command
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
    """Take a lock on a file. The lock is held until the returned file is closed.

    If another process holds the lock, wait for it if ``wait`` is set, and otherwise return None.
    """
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    file = open(path, "a", encoding="utf-8")  # noqa: SIM115
    flags = fcntl.LOCK_EX if wait else fcntl.LOCK_EX | fcntl.LOCK_NB
    try:
        fcntl.flock(file, flags)
    except OSError as error:
        # These errors mean that the lock is held. Others mean that the file system has no locks,
        # and then the run goes on without one.
        if error.errno in (errno.EAGAIN, errno.EACCES):
            file.close()
            return None
    return file


def main(arguments: list[str]) -> int:
    """Run the module as a command, and return its exit code.

    ``arguments`` are the path of the lock, and a command that runs as soon as the lock is free.
    Without a command, the exit code is 1 if another process holds the lock, and otherwise 0.
    """
    path, *command = arguments
    lock = take(path)
    if not command:
        return int(lock is None)
    if lock is None:
        print("Another set-up is running in this folder: waiting for it", flush=True)
        lock = take(path, wait=True)
    return subprocess.run(command, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
