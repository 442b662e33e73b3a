"""A job of the workflow: it runs one step, with a log, a record, and one line on failure."""

import errno
import os
import sys
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from typing import TextIO

from slippulse.data.files import CONFIGURATION

from ..records.job_records import Origin, read_record, write_record
from . import reading

SECONDS_BETWEEN_LINES = 2.0


def run_job(
    origin: Origin, name: str, files: dict, outputs: dict, settings: dict, log: str | Path
) -> None:
    """Run the step of a job; files and outputs are paths, or lists of them, by name."""
    began = time.monotonic()
    os.environ[CONFIGURATION] = origin.configuration
    with logged(log) as progress:
        inputs = {}
        for result, record in origin.inputs.items():
            inputs[result] = read_record(Path("results", record)).outputs[result]
        results = {f"results/{result}": digest for result, digest in inputs.items()}
        with reading.expected({**origin.files, **results}):
            step = import_module(f"slippulse_paper.steps.{origin.step}")
            step.run(files, outputs, {**settings, "progress": progress_of(name, progress)})
        seconds = time.monotonic() - began
        write_record(origin, inputs, {"seconds": round(seconds, 2), "options": origin.options})
    if not sys.stderr.isatty():
        sys.stderr.write(f"{Path(log).read_text(encoding='utf-8')}  {name}: {seconds:.1f} s\n")


def progress_of(name: str, stream: TextIO) -> Callable[[float, int], None]:
    """Make a function of how many runs are done, and of how many, that writes the time left."""
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
    """Log what a job writes, and yield a stream for its progress; a failure is one line."""
    # Snakemake prints the log: the traceback has a file of its own.
    terminal, details = sys.stderr, Path(path).with_suffix(".traceback")
    try:
        details.parent.mkdir(parents=True, exist_ok=True)
        details.unlink(missing_ok=True)
        log = open(path, "w", encoding="utf-8")  # noqa: SIM115
    except OSError as error:
        allowed = "a results folder that can be written"
        raise SystemExit(f"{path}: {error.strerror}; allowed: {allowed}") from None
    sys.stderr = log
    try:
        # A terminal shows a progress bar, which other lines would tear.
        yield log if terminal.isatty() else terminal
    except KeyboardInterrupt:
        raise SystemExit("stopped") from None
    except Exception as error:
        # A full disk has no room for the traceback either; HDF5 describes it in several lines.
        with suppress(OSError):
            details.write_text(traceback.format_exc(), encoding="utf-8")
        reason = f"{type(error).__name__}: {' '.join(str(error).split())}"
        if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EFBIG, errno.EDQUOT):
            remedy = "the unfinished file is removed; make room and run again"
            reason = f"{os.strerror(error.errno)}: {remedy}"
        raise SystemExit(f"{reason} (details: {details})") from None
    finally:
        sys.stderr = terminal
        with suppress(OSError):
            log.close()
