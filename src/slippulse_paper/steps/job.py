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
DISK_FULL_ERRORS = (errno.ENOSPC, errno.EFBIG, errno.EDQUOT)


class JobFailed(Exception):
    """Failure of a job, with the reason in one line."""


class Job(NamedTuple):
    """A job: the step that it runs, its files, its settings and the sources that it depends on.

    Results depend on ``settings``. The step also gets ``variables``, which are the wildcards and
    the number of threads of Snakemake. Results do not depend on them. ``sources`` has the SHA-256
    that each source file had when the run was planned, and ``code`` is the digest of all of them.
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
    """Run the step of a job, and write its log and its record.

    Raises JobFailed with the reason in one line if the job fails.
    """
    began = time.monotonic()
    with logged(job.log) as progress_stream:
        # The states of the input files, and the records of the jobs that made them.
        input_states, input_records = check_inputs(_paths(job.inputs))
        # Data, figures and pages contain the digest of all settings that they depend on, which are
        # those of this job and of the jobs that made its inputs.
        input_digests = {record.configuration for record in input_records.values()}
        configuration = digest_of([dict(job.settings), *sorted(input_digests)])
        os.environ[CONFIGURATION_VARIABLE] = configuration
        step = import_module(f"slippulse_paper.steps.{job.step}")
        # Settings replace wildcards of the same name, because the figure of a user-defined sweep is
        # drawn by a module whose name differs from the wildcard.
        report_progress = progress_writer(progress_stream, job.name)
        settings = {**job.variables, **job.settings, "progress": report_progress}
        step.run(job.inputs, job.outputs, settings)
        # The job fails if an input or a source file has changed meanwhile.
        check_unchanged(input_states)
        changed_source = next(iter(changed_sources(dict(job.sources))), None)
        if changed_source is not None:
            raise ChangedFile(f"{changed_source}: changed since this run was planned; run again")
        seconds = round(time.monotonic() - began, 2)
        _write_records(job, configuration, input_states, seconds)
    # In a terminal, a progress bar is shown instead of the logs.
    if not sys.stderr.isatty():
        log = Path(job.log).read_text(encoding="utf-8")
        sys.stderr.write(f"{log}  {job.name}: {seconds} s\n")


def _write_records(
    job: Job, configuration: str, input_states: Mapping[str, FileState], seconds: float
) -> None:
    """Write a record of the job into each folder that contains some of its outputs.

    Only the first record has the computing time, so that a sum over all records counts it once.
    ``configuration`` is the digest of all settings that the outputs depend on.
    """
    names_by_folder: dict[Path, list[str]] = {}
    for output in map(Path, _paths(job.outputs)):
        names_by_folder.setdefault(output.parent, []).append(output.name)
    for folder, names in names_by_folder.items():
        outputs = {name: state_of(folder / name) for name in names}
        inputs = {
            os.path.relpath(path, folder): state.sha256 for path, state in input_states.items()
        }
        record = Record(
            step=job.step,
            code=job.code,
            configuration=configuration,
            outputs=outputs,
            inputs=inputs,
            seconds=seconds,
        )
        write_record(record, folder)
        seconds = 0.0


def _paths(files: Mapping[str, str | list[str]]) -> list[str]:
    """Return the paths of all files. Each name in ``files`` has one path or a list of paths."""
    paths = []
    for path_or_list in files.values():
        paths += [path_or_list] if isinstance(path_or_list, str) else path_or_list
    return paths


def progress_writer(stream: TextIO, name: str) -> Callable[[float, int], None]:
    """Return a function that writes how much of a job is done and how long the rest will take.

    The returned function takes the number of finished runs, which is a fraction during a single
    run, and the number of all runs. It writes a line only if the last one is some seconds old.
    """
    began = last_written = time.monotonic()

    def write(done: float, total: int) -> None:
        """Write a line if the job is under way, and if the last line is old enough."""
        nonlocal last_written
        now = time.monotonic()
        is_underway = 0 < done < total
        if not is_underway or now - last_written <= SECONDS_BETWEEN_LINES:
            return
        last_written = now
        progress = f"{done:.0%} of the run" if total == 1 else f"{done} of {total} runs"
        seconds_left = (now - began) * (total / done - 1.0)
        print(f"  {name}: {progress}, about {seconds_left:.0f} s left", file=stream, flush=True)

    return write


@contextmanager
def logged(path: str | Path) -> Iterator[TextIO]:
    """Redirect the standard error of a job to its log, and yield a stream for its progress.

    A terminal shows a progress bar of the whole run, which lines on the progress of a job would
    interrupt. So these lines go to the log if standard error is a terminal, and otherwise to
    standard error. If the job raises an exception, write the traceback to a separate file, and
    raise JobFailed with the reason in one line.
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
        yield log if terminal.isatty() else terminal
    except KeyboardInterrupt:
        raise JobFailed("stopped") from None
    except ChangedFile as error:
        raise JobFailed(str(error)) from None
    except Exception as error:
        # If the disk is full, the traceback cannot be written either.
        with suppress(OSError):
            details.write_text(traceback.format_exc(), encoding="utf-8")
        raise JobFailed(f"{_reason(error)} (details: {details})") from None
    finally:
        sys.stderr = terminal
        with suppress(OSError):
            log.close()


def _reason(error: Exception) -> str:
    """Return in one line why a step has failed."""
    if isinstance(error, OSError) and error.errno in DISK_FULL_ERRORS:
        remedy = "the unfinished file was removed; free some space and run again"
        return f"{os.strerror(error.errno)}: {remedy}"
    # Messages of HDF5 have several lines.
    return f"{type(error).__name__}: {' '.join(str(error).split())}"
