"""Jobs of the workflow, each with its log, its record, and one line on failure.

Processes that run them are forked from one that has loaded what most of them use; each runs one job after another.
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
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from threading import Lock, Thread
from typing import Any

from ..data.files import CONFIGURATION
from ..data.records import Origin, write_record

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
    """Runs jobs in processes that are kept from one to the next; threads may share it."""

    def __init__(self) -> None:
        # Else each process would load the main program again, of which it needs nothing.
        vars(sys.modules["__main__"]).update(__spec__=None, __file__=None)
        # Elsewhere libraries of the system do not all survive a fork.
        kind = "forkserver" if sys.platform == "linux" else "spawn"
        self._context: Any = multiprocessing.get_context(kind)
        self._context.set_forkserver_preload(["slippulse.steps.libraries"])
        self._idle: list[tuple[BaseProcess, Connection]] = []
        # A process that starts looks after those that have ended: not while another thread does.
        self._turn = Lock()
        # What is loaded by now stays to the end, when Python would look through it for 0.4 s.
        gc.freeze()

    def begin(self) -> None:
        """Load the libraries while Snakemake still plans."""

        def load() -> None:
            # That it cannot be started, the first job says.
            with suppress(JobFailed), self._turn:
                self._idle.append(self._start())

        Thread(target=load, daemon=True).start()

    def run(self, *job) -> None:
        """Run a job, given as `run_job` takes it. Raises JobFailed."""
        with self._turn:
            process, jobs = self._idle.pop() if self._idle else self._start()
        try:
            jobs.send(job)
            jobs.recv()
        except (EOFError, OSError):
            with self._turn:
                process.join()
            raise JobFailed(f"exit code {process.exitcode}") from None
        self._idle.append((process, jobs))

    def _start(self) -> tuple[BaseProcess, Connection]:
        jobs, theirs = self._context.Pipe()
        process = self._context.Process(target=run_jobs, args=(theirs,), daemon=True)
        try:
            process.start()
        except (EOFError, OSError) as error:
            raise JobFailed("the process that starts the jobs has ended") from error
        theirs.close()
        return process, jobs


def run_jobs(jobs: Connection) -> None:
    """Run those that come through a pipe, until one fails or the other end is closed."""
    with suppress(EOFError, OSError, KeyboardInterrupt):
        while True:
            run_job(*jobs.recv())
            jobs.send(None)


def run_job(
    origin: Origin, name: str, files: dict, outputs: dict, settings: dict, log: str | Path
) -> None:
    """Run one step; files and outputs are paths, or lists of them, by name."""
    began, processor = time.monotonic(), time.process_time()
    # Else the record would have the most memory of all jobs before.
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
    os.environ[CONFIGURATION] = origin.configuration
    with logged(log):
        step = import_module(f"slippulse.steps.{origin.step}")
        step.run(files, outputs, {**settings, "progress": progress_of(name)})
        used = {
            "seconds": time.monotonic() - began,
            "processor_seconds": time.process_time() - processor,
        }
        bits = 20 if sys.platform == "darwin" else 10
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss >> bits
        write_record(
            origin, {key: round(value, 2) for key, value in used.items()} | {"memory_MB": memory}
        )
    if not sys.stderr.isatty():
        sys.stderr.write(f"  {name}: {used['seconds']:.1f} s\n")


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
        return (
            f"{os.strerror(error.errno)}: the unfinished file is removed; make room and run again"
        )
    return f"{type(error).__name__}: {' '.join(str(error).split())}"


class _Both:
    """A stream that writes to two."""

    def __init__(self, *streams) -> None:
        self.streams = streams

    def __getattr__(self, name: str) -> Callable:
        return lambda *given: [getattr(stream, name)(*given) for stream in self.streams][-1]
