"""Processes that run the jobs of the workflow, forked from one that has loaded the libraries."""

import gc
import multiprocessing
import os
import signal
import sys
from contextlib import suppress
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from threading import Lock, Thread
from typing import Any

from .job import run_job


class JobFailed(Exception):
    """A job that failed, with the reason in one line."""


class Jobs:
    """Runs jobs in processes that are kept from one job to the next; threads may share it."""

    def __init__(self) -> None:
        # Each process would load the main program again, of which it needs nothing.
        vars(sys.modules["__main__"]).update(__spec__=None, __file__=None)
        # On other systems some system libraries do not survive a fork.
        kind = "forkserver" if sys.platform == "linux" else "spawn"
        self._context: Any = multiprocessing.get_context(kind)
        self._context.set_forkserver_preload(["slippulse_paper.steps.libraries"])
        self._idle: list[tuple[BaseProcess, Connection]] = []
        # A process that starts looks after those that have ended: only one thread may do so.
        self._turn = Lock()
        # Modules stay loaded to the end, when Python would look through them for 0.4 s.
        gc.freeze()

    def begin(self) -> None:
        """Load the libraries while Snakemake still plans."""

        def load() -> None:
            # The first job says that it cannot be started.
            with suppress(JobFailed), self._turn:
                self._idle.append(self._start())

        Thread(target=load, daemon=True).start()

    def run(self, *job) -> None:
        """Run a job, given by the arguments of `run_job`. Raises JobFailed."""
        with self._turn:
            process, jobs = self._idle.pop() if self._idle else self._start()
        try:
            jobs.send(job)
            reason = jobs.recv()
        except (EOFError, OSError):
            with self._turn:
                process.join()
            reason = f"{job[1]}: its process ended with code {process.exitcode}"
        if reason:
            raise JobFailed(reason)
        self._idle.append((process, jobs))

    def _start(self) -> tuple[BaseProcess, Connection]:
        """Start a process, and return it with the end of the pipe that sends it jobs."""
        jobs, received = self._context.Pipe()
        process = self._context.Process(target=_run_jobs, args=(received,), daemon=True)
        try:
            process.start()
        except (EOFError, OSError) as error:
            raise JobFailed("the process that starts the jobs has ended") from error
        received.close()
        return process, jobs


def _run_jobs(jobs: Connection) -> None:
    """Run the jobs that come through a pipe, until one fails or the pipe is closed."""
    from . import libraries  # noqa: F401

    with suppress(EOFError, OSError, KeyboardInterrupt):
        while True:
            job = jobs.recv()
            try:
                run_job(*job)
                jobs.send(None)
            except SystemExit as reason:
                jobs.send(str(reason))
                return


def end_with(descriptor: int) -> None:
    """End this process and its group when the other end of a pipe is closed, as its holder ends."""

    def wait_for_end() -> None:
        with suppress(OSError):
            os.read(descriptor, 1)
            os.killpg(0, signal.SIGKILL)

    Thread(target=wait_for_end, daemon=True).start()
