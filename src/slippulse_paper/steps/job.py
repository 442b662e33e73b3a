"""A job of the workflow: it runs one step, with a log, a record, and one line on failure."""

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
    """A job that failed, with the reason in one line."""


class Job(NamedTuple):
    """A job: the step that it runs, its files by name, its settings, and the sources it depends on.

    ``settings`` are what the results depend on; ``variables`` are wildcards and threads, which are
    given to the step, too. ``sources`` are the SHA-256 of the sources when the run was planned.
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
    """Run the step of a job and write its record. Raises JobFailed."""
    began = time.monotonic()
    with logged(job.log) as progress:
        read, records = check_inputs(_paths(job.inputs))
        # Data, figures and pages carry the digest of all settings that they depend on.
        earlier = sorted({record.configuration for record in records.values()})
        os.environ[CONFIGURATION_VARIABLE] = configuration = digest_of(
            [dict(job.settings), *earlier]
        )
        step = import_module(f"slippulse_paper.steps.{job.step}")
        show = progress_of(job.name, progress)
        # A figure of a sweep is drawn by a module of another name: settings go first.
        settings = {**job.variables, **job.settings, "progress": show}
        step.run(job.inputs, job.outputs, settings)
        check_unchanged(read)
        for path in changed_sources(dict(job.sources)):
            raise ChangedFile(f"{path}: changed since this run was planned; run again")
        seconds = round(time.monotonic() - began, 2)
        _write_records(job, configuration, read, seconds)
    if not sys.stderr.isatty():
        sys.stderr.write(f"{Path(job.log).read_text(encoding='utf-8')}  {job.name}: {seconds} s\n")


def _write_records(
    job: Job, configuration: str, read: Mapping[str, FileState], seconds: float
) -> None:
    """Write one record for each folder in which a job has written; the first has its seconds."""
    folders: dict[Path, list[str]] = {}
    for output in map(Path, _paths(job.outputs)):
        folders.setdefault(output.parent, []).append(output.name)
    for folder, names in folders.items():
        outputs = {name: state_of(folder / name) for name in names}
        inputs = {os.path.relpath(path, folder): state.sha256 for path, state in read.items()}
        record = Record(job.step, job.code, configuration, outputs, inputs, seconds)
        write_record(record, folder)
        seconds = 0.0


def _paths(files: Mapping[str, str | list[str]]) -> list[str]:
    """List the paths of files by name, each of which is a path or a list of paths."""
    lists = ([value] if isinstance(value, str) else value for value in files.values())
    return [path for paths in lists for path in paths]


def progress_of(name: str, stream: TextIO) -> Callable[[float, int], None]:
    """Make a function of the number of finished runs and of all runs that writes the time left."""
    began = shown = time.monotonic()

    def show(done: float, total: int) -> None:
        nonlocal shown
        now = time.monotonic()
        if 0 < done < total and now - shown > SECONDS_BETWEEN_LINES:
            shown = now
            part = f"{done:.0%} of the run" if total == 1 else f"{done} of {total} runs"
            left = (now - began) * (total / done - 1.0)
            print(f"  {name}: {part}, about {left:.0f} s left", file=stream, flush=True)

    return show


@contextmanager
def logged(path: str | Path) -> Iterator[TextIO]:
    """Log what a job writes, and yield a stream for its progress. Raises JobFailed in one line."""
    # Snakemake prints the log: the traceback has a file of its own.
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
        # A terminal shows a progress bar, which other lines would tear.
        yield log if terminal.isatty() else terminal
    except KeyboardInterrupt:
        raise JobFailed("stopped") from None
    except ChangedFile as error:
        raise JobFailed(str(error)) from None
    except Exception as error:
        # A full disk has no room for the traceback either; HDF5 describes it in several lines.
        with suppress(OSError):
            details.write_text(traceback.format_exc(), encoding="utf-8")
        reason = f"{type(error).__name__}: {' '.join(str(error).split())}"
        if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EFBIG, errno.EDQUOT):
            remedy = "the unfinished file is removed; make room and run again"
            reason = f"{os.strerror(error.errno)}: {remedy}"
        raise JobFailed(f"{reason} (details: {details})") from None
    finally:
        sys.stderr = terminal
        with suppress(OSError):
            log.close()
