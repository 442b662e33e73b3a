"""Jobs of the workflow.

A job runs one step and writes a log and a record of what it read and wrote. If it fails, it reports
the reason in one line.
"""

import errno
import os
import sys
import time
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple, TextIO

from slippulse.data.files import CONFIGURATION_VARIABLE

from ..records.job_records import (
    ChangedFile,
    FileState,
    Record,
    check_inputs,
    check_unchanged,
    digest_of,
    state_of,
    write_record,
)
from ..records.sources import changed_sources

SECONDS_BETWEEN_LINES = 2.0


class JobFailed(Exception):
    """Failure of a job, with the reason in one line."""


class Job(NamedTuple):
    """A job: the step that it runs, its files, its settings and the sources that it depends on.

    Results depend on ``settings``. They do not depend on ``variables``, the wildcards and threads
    of Snakemake, which the step gets too. ``code`` is the digest of ``sources``, which has the
    SHA-256 of each source file when the run was planned.
    """

    step: str
    name: str
    inputs: Mapping[str, str | list[str]]
    outputs: Mapping[str, str | list[str]]
    settings: Mapping[str, Any]
    variables: Mapping[str, Any]
    log: str
    code: str
    sources: Mapping[str, str]


def run_job(job: Job) -> None:
    """Run the step of a job and write its record. Raises JobFailed if that is impossible."""
    began = time.monotonic()
    with logged(job.log) as progress:
        states, records = check_inputs(_paths(job.inputs))
        # Data, figures and pages contain the digest of all settings that they depend on, which are
        # those of this job and of the jobs that made its inputs.
        input_digests = sorted({record.configuration for record in records.values()})
        configuration = digest_of([dict(job.settings), *input_digests])
        os.environ[CONFIGURATION_VARIABLE] = configuration
        step = import_module(f"slippulse_paper.steps.{job.step}")
        # Settings replace wildcards of the same name: the figure of a user-defined sweep is drawn
        # by a module with another name than the wildcard.
        progress_function = write_progress_to(progress, job.name)
        settings = {**job.variables, **job.settings, "progress": progress_function}
        step.run(job.inputs, job.outputs, settings)
        check_unchanged(states)
        for path in changed_sources(dict(job.sources)):
            raise ChangedFile(f"{path}: changed since this run was planned; run again")
        seconds = round(time.monotonic() - began, 2)
        _write_records(job, configuration, states, seconds)
    if not sys.stderr.isatty():
        sys.stderr.write(f"{Path(job.log).read_text(encoding='utf-8')}  {job.name}: {seconds} s\n")


def _write_records(
    job: Job, configuration: str, input_states: Mapping[str, FileState], seconds: float
) -> None:
    """Write a record of the job into each folder that has some of its outputs.

    Only the first record has the computing time, so that a sum over all records counts it once.
    """
    folders: dict[Path, list[str]] = {}
    for output in map(Path, _paths(job.outputs)):
        folders.setdefault(output.parent, []).append(output.name)
    for folder, names in folders.items():
        outputs = {name: state_of(folder / name) for name in names}
        inputs = {
            os.path.relpath(path, folder): state.sha256 for path, state in input_states.items()
        }
        record = Record(job.step, job.code, configuration, outputs, inputs, seconds)
        write_record(record, folder)
        seconds = 0.0


def _paths(files: Mapping[str, str | list[str]]) -> list[str]:
    """List all paths of named files, each of which is a path or a list of paths."""
    lists = ([value] if isinstance(value, str) else value for value in files.values())
    return [path for paths in lists for path in paths]


def write_progress_to(stream: TextIO, name: str) -> Callable[[float, int], None]:
    """Return a function that writes how much of a job is done and how long the rest will take.

    Its arguments are the number of finished runs and the number of all runs.
    """
    began = last_written = time.monotonic()

    def show(done: float, total: int) -> None:
        nonlocal last_written
        now = time.monotonic()
        if 0 < done < total and now - last_written > SECONDS_BETWEEN_LINES:
            last_written = now
            part = f"{done:.0%} of the run" if total == 1 else f"{done} of {total} runs"
            left = (now - began) * (total / done - 1.0)
            print(f"  {name}: {part}, about {left:.0f} s left", file=stream, flush=True)

    return show


@contextmanager
def logged(path: str | Path) -> Iterator[TextIO]:
    """Write the standard error of a job to its log, and yield a stream for its progress.

    Raises JobFailed with the reason in one line if the job raises an exception.
    """
    # Snakemake prints the log of a failed job, and so the traceback has a separate file.
    terminal, details = sys.stderr, Path(path).with_suffix(".traceback")
    try:
        details.parent.mkdir(parents=True, exist_ok=True)
        details.unlink(missing_ok=True)
        log = open(path, "w", encoding="utf-8")  # noqa: SIM115
    except OSError as error:
        allowed = "a results folder that can be written"
        raise JobFailed(f"{path}: {error.strerror}; allowed: {allowed}") from None
    sys.stderr = log
    try:
        # A terminal shows a progress bar, which other lines would interrupt.
        yield log if terminal.isatty() else terminal
    except KeyboardInterrupt:
        raise JobFailed("stopped") from None
    except ChangedFile as error:
        raise JobFailed(str(error)) from None
    except Exception as error:
        # If the disk is full, the traceback cannot be written either.
        with suppress(OSError):
            details.write_text(traceback.format_exc(), encoding="utf-8")
        # Messages of HDF5 have several lines.
        reason = f"{type(error).__name__}: {' '.join(str(error).split())}"
        if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EFBIG, errno.EDQUOT):
            remedy = "the unfinished file is removed; make room and run again"
            reason = f"{os.strerror(error.errno)}: {remedy}"
        raise JobFailed(f"{reason} (details: {details})") from None
    finally:
        sys.stderr = terminal
        with suppress(OSError):
            log.close()
