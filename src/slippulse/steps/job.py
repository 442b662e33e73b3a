"""Jobs of the workflow: a process each, with its log, its record, and one line on failure.

Each is forked from one that has loaded what most of them use.
"""

import errno
import gc
import multiprocessing
import os
import resource
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from multiprocessing.connection import wait
from multiprocessing.process import BaseProcess
from pathlib import Path
from threading import Lock, Thread
from typing import Any

from ..data.files import CONFIGURATION
from ..data.records import Origin, write_record
from .reach import digest_of_files, sources

# Seconds between two lines of progress.
BETWEEN = 2.0


class JobFailed(Exception):
    """A job that has said why."""


def end_with(descriptor: int) -> None:
    """End this process and its group when the other end of a pipe is closed, as its holder ends."""

    def wait_for_it() -> None:
        with suppress(OSError):
            os.read(descriptor, 1)
            os.killpg(0, signal.SIGKILL)

    Thread(target=wait_for_it, daemon=True).start()


class Jobs:
    """Runs jobs, each in a process of its own; threads may share it."""

    def __init__(self) -> None:
        # Else each job would load the main program again, of which it needs nothing.
        main = sys.modules["__main__"]
        main.__spec__, main.__file__ = None, None
        # Elsewhere libraries of the system do not all survive a fork.
        self._forks = sys.platform == "linux"
        self._processes: Any = multiprocessing.get_context("forkserver" if self._forks else "spawn")
        self._processes.set_forkserver_preload(["slippulse.steps.libraries"])
        # A process that starts looks after those that have ended: not while another thread does.
        self._turn = Lock()
        # What is loaded by now stays to the end, when Python would look through it for 0.4 s.
        gc.freeze()

    def begin(self) -> None:
        """Load the libraries while Snakemake still plans."""

        def load() -> None:
            # That the server has ended, the first job says.
            with suppress(JobFailed):
                self._wait_for(self._processes.Process())

        if self._forks:
            # Kept for the records: what is edited between this and the loading is then made anew by the next run.
            digest_of_files(sources("steps.libraries"))
            Thread(target=load, daemon=True).start()

    def run(self, *job) -> None:
        """Run a job, given as `run_job` takes it. Raises JobFailed."""
        self._wait_for(self._processes.Process(target=run_job, args=job))

    def _wait_for(self, process: BaseProcess) -> None:
        try:
            with self._turn:
                process.start()
            wait([process.sentinel])
            with self._turn:
                process.join()
        except (EOFError, OSError) as error:
            raise JobFailed("the process that starts the jobs has ended") from error
        if process.exitcode:
            raise JobFailed(f"exit code {process.exitcode}")


def run_job(origin: Origin, name: str, files: dict, outputs: dict, settings: dict, log: str | Path) -> None:
    """Run one step as all that a process does; files and outputs are paths, or lists of them, by name."""
    began = time.monotonic()
    os.environ[CONFIGURATION] = origin.configuration
    with logged(log):
        step = import_module(f"slippulse.steps.{origin.step}")
        step.run(files, outputs, {**settings, "progress": progress_of(name)})
        seconds, used = time.monotonic() - began, resource.getrusage(resource.RUSAGE_SELF)
        memory = used.ru_maxrss / (2**20 if sys.platform == "darwin" else 2**10)
        processor = round(used.ru_utime + used.ru_stime, 2)
        times = {"seconds": round(seconds, 2), "processor_seconds": processor}
        write_record(origin, times | {"memory_MB": round(memory)})
    if not sys.stderr.isatty():
        sys.stderr.write(f"  {name}: {seconds:.1f} s\n")


def progress_of(name: str) -> Callable[[float, int], None]:
    """A function of how many runs are done and of how many there are, which says the time that is left."""
    began = shown = time.monotonic()

    def say(done: float, total: int) -> None:
        nonlocal shown
        now = time.monotonic()
        if 0 < done < total and now - shown > BETWEEN:
            shown = now
            part = f"{done:.0%} of the run" if total == 1 else f"{done} of {total} runs"
            left = (now - began) * (total / done - 1.0)
            print(f"  {name}: {part}, about {left:.0f} s left", file=sys.stderr, flush=True)

    return say


@contextmanager
def logged(path: str | Path) -> Iterator[None]:
    """Send what a job says to its log; a failure is one line on the terminal and a traceback beside the log."""
    terminal = sys.stderr
    # Not in the log itself, which Snakemake prints.
    details = Path(path).with_suffix(".traceback")
    try:
        details.parent.mkdir(parents=True, exist_ok=True)
        details.unlink(missing_ok=True)
        log = open(path, "w", encoding="utf-8")  # noqa: SIM115
    except OSError as error:
        terminal.write(f"{path}: {error.strerror}; allowed: a results folder that can be written\n")
        raise SystemExit(1) from None
    # A terminal shows a progress bar, which other lines would tear.
    sys.stderr = log if terminal.isatty() else _Both(terminal, log)
    try:
        yield
    except KeyboardInterrupt:
        terminal.write("stopped\n")
        raise SystemExit(130) from None
    except Exception as error:
        # A disk that is full has no room for the log either.
        with suppress(OSError):
            details.write_text(traceback.format_exc(), encoding="utf-8")
        terminal.write(f"{_reason(error)} (details: {details})\n")
        raise SystemExit(1) from None
    finally:
        sys.stderr = terminal
        with suppress(OSError):
            log.close()


def _reason(error: Exception) -> str:
    """One line; HDF5 describes a full disk in several, with addresses."""
    if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EFBIG, errno.EDQUOT):
        return f"{os.strerror(error.errno)}: the unfinished file is removed; make room and run again"
    return f"{type(error).__name__}: {' '.join(str(error).split())}"


class _Both:
    """A stream that writes to two."""

    def __init__(self, *streams) -> None:
        self.streams = streams

    def __getattr__(self, name: str) -> Callable:
        return lambda *given: [getattr(stream, name)(*given) for stream in self.streams][-1]
