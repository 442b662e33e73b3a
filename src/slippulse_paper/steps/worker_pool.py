"""Worker processes that run the jobs of a workflow one after another.

A job of this workflow lasts about a second, and a new Python process needs more than that to load
the libraries. Workers load them once: a draft of 50 jobs takes 75 processor seconds with them, and
145 with Snakemake's ``script:``. They are forked from a process that has loaded the libraries.
"""

import multiprocessing
import os
import signal
import sys
import tempfile
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from threading import Lock, Thread

from .job import Job, JobFailed, run_job

LIBRARIES = "slippulse_paper.steps.worker_libraries"
# The fork server listens on a socket in this folder; the system takes paths of up to 107 bytes.
LONGEST_TEMPORARY_FOLDER = 70


class WorkerPool:
    """Runs jobs in worker processes that are reused from one job to the next. Thread-safe."""

    def __init__(self) -> None:
        self._executor: ProcessPoolExecutor | None = None
        self._turn = Lock()

    def start(self, workers: int) -> None:
        """Start the first of some workers, which loads the libraries before a job comes."""
        # If that is impossible, the first job says why.
        with suppress(EOFError, OSError):
            self._submit(workers, os.getpid)

    def run(self, job: Job, workers: int) -> None:
        """Run a job in one of some workers. Raises JobFailed with the reason in one line."""
        try:
            self._submit(workers, run_job, job).result()
        except BrokenProcessPool:
            self._executor = None
            raise JobFailed("its process was killed") from None
        except (EOFError, OSError) as error:
            self._executor = None
            raise JobFailed(f"its process could not be started: {error}") from None
        except SystemExit:
            raise JobFailed("stopped") from None

    def _submit(self, workers: int, function, *arguments) -> Future:
        with self._turn:
            if self._executor is None:
                self._executor = _new_executor(workers)
            return self._executor.submit(function, *arguments)


def run_here(job: Job) -> None:
    """Run a job in this process, which Snakemake has started for it. Raises JobFailed."""
    from . import worker_libraries  # noqa: F401

    run_job(job)


def _new_executor(workers: int) -> ProcessPoolExecutor:
    # Each worker would load the main program again, which is Snakemake, and needs nothing of it.
    vars(sys.modules["__main__"]).update(__spec__=None, __file__=None)
    short = len(os.fsencode(tempfile.gettempdir())) <= LONGEST_TEMPORARY_FOLDER
    # Some libraries of other systems do not survive a fork.
    context = multiprocessing.get_context(
        "forkserver" if short and sys.platform == "linux" else "spawn"
    )
    context.set_forkserver_preload([LIBRARIES])
    return ProcessPoolExecutor(workers, context, initializer=_begin)


def _begin() -> None:
    """Let a worker end at once when the user stops the run, or when its parent has ended."""
    from . import worker_libraries  # noqa: F401

    signal.signal(signal.SIGINT, lambda *_: sys.exit("stopped"))
    Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os.kill(os.getpid(), signal.SIGKILL)
