"""Worker processes that run the jobs of a workflow one after another.

A job of this workflow takes about a second, and a new Python process needs longer than that to load
the libraries. The workers are forked from a process that has loaded them once. The preset draft,
with 50 jobs, takes 75 processor seconds with workers, and 145 with Snakemake's ``script:``.
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
# The fork server listens on a socket in the temporary folder. The system allows socket paths of up
# to 107 bytes, of which the name of the socket takes the rest.
MAX_TEMPORARY_FOLDER_BYTES = 70


class WorkerPool:
    """A pool of worker processes that are reused between jobs. Thread-safe."""

    def __init__(self) -> None:
        self._executor: ProcessPoolExecutor | None = None
        self._executor_lock = Lock()

    def start(self, workers: int) -> None:
        """Start the first worker, which loads the libraries before the first job.

        ``workers`` is the largest number of workers.
        """
        # Any quick function starts the worker. If that fails, the first job reports the reason.
        with suppress(EOFError, OSError):
            self._submit(workers, os.getpid)

    def run(self, job: Job, workers: int) -> None:
        """Run a job in one of at most ``workers`` processes, and wait for its end.

        Raises JobFailed with the reason if the job fails.
        """
        try:
            self._submit(workers, run_job, job).result()
        # An executor whose process has failed cannot be used again. The next job makes a new one.
        except BrokenProcessPool:
            self._executor = None
            raise JobFailed("its process was killed") from None
        except (EOFError, OSError) as error:
            self._executor = None
            raise JobFailed(f"its process could not be started: {error}") from None
        except SystemExit:
            raise JobFailed("stopped") from None

    def _submit(self, workers: int, function, *arguments) -> Future:
        """Let a worker call a function with some arguments, and return its future result.

        The first call starts the processes.
        """
        with self._executor_lock:
            if self._executor is None:
                self._executor = _new_executor(workers)
            return self._executor.submit(function, *arguments)


def run_here(job: Job) -> None:
    """Run a job in this process, which Snakemake has started for the job.

    Raises JobFailed with the reason if the job fails.
    """
    # This import loads the libraries and sets the environment variables that a job needs.
    from . import worker_libraries  # noqa: F401

    run_job(job)


def _new_executor(workers: int) -> ProcessPoolExecutor:
    """Return an executor whose processes are forked from one that has loaded the libraries.

    Where that is not possible, each process loads the libraries itself.
    """
    # A worker would load the main program, Snakemake, which takes long. It does not do this if the
    # main module has no name and no file.
    vars(sys.modules["__main__"]).update(__spec__=None, __file__=None)
    # The socket of the server that forks the workers needs a short path, in the temporary folder.
    has_short_path = len(os.fsencode(tempfile.gettempdir())) <= MAX_TEMPORARY_FOLDER_BYTES
    # On systems other than Linux some libraries fail after a fork.
    can_fork = has_short_path and sys.platform == "linux"
    context = multiprocessing.get_context("forkserver" if can_fork else "spawn")
    context.set_forkserver_preload([LIBRARIES])
    return ProcessPoolExecutor(workers, context, initializer=_prepare_worker)


def _prepare_worker() -> None:
    """Load the libraries, and make the worker end at once if the run ends.

    The run ends if the user stops it, or if the parent process ends.
    """
    # A forked worker has these libraries already; a worker started by "spawn" loads them here.
    from . import worker_libraries  # noqa: F401

    signal.signal(signal.SIGINT, lambda *_: sys.exit("stopped"))
    Thread(target=_kill_after_parent, daemon=True).start()


def _kill_after_parent() -> None:
    """Wait until the parent process has ended, and then kill this process."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os.kill(os.getpid(), signal.SIGKILL)
