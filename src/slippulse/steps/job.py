"""What every job of the workflow does around its step: the log, the record, one line on failure, a quick exit."""

from __future__ import annotations

import contextlib
import errno
import gc
import os
import sys
import time
import traceback
from collections.abc import Iterator, Mapping
from importlib import import_module
from pathlib import Path

# New objects between two searches for cyclic garbage: loading the libraries, a third of a short job, makes fewer.
OBJECTS_BETWEEN_SEARCHES = 1_000_000


def run_job(
    step: str, name: str, files: Mapping, outputs: Mapping, settings: Mapping, log: str | Path
) -> None:
    """Run one step as all that a process does.

    Parameters
    ----------
    step : module of `slippulse.steps` with ``run(files, outputs, settings)``
    name : of the job, for messages
    files, outputs : paths, or lists of paths, by name
    settings : what the step takes from the configuration; ``configuration`` is the digest of all that it comes from
    log : file for what the job says
    """
    gc.set_threshold(OBJECTS_BETWEEN_SEARCHES)
    began = time.monotonic()
    with logged(log):
        from ..data.origin import configured_by
        from ..data.records import write_record

        with configured_by(settings.get("configuration", "")):
            import_module(f"slippulse.steps.{step}").run(files, outputs, settings)
        write_record(step, files, outputs, settings)
    if not sys.stderr.isatty():
        sys.stderr.write(f"  {name}: {time.monotonic() - began:.1f} s\n")
    leave()


def leave(code: int = 0) -> None:
    """Exit without interpreter teardown; saves 0.2 s."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)


@contextlib.contextmanager
def logged(path: str | Path) -> Iterator[None]:
    """Send what a job says to its log; a failure is one line on the terminal and a traceback in the log."""
    terminal = sys.stderr
    try:
        Path(path).parent.mkdir(parents=True, exist_ok=True)
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
        leave(130)
    except Exception as error:
        # A disk that is full has no room for the log either.
        with contextlib.suppress(OSError):
            log.write(traceback.format_exc())
        terminal.write(f"{_reason(error)} (details: {path})\n")
        raise SystemExit(1) from None
    finally:
        sys.stderr = terminal
        with contextlib.suppress(OSError):
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

    def write(self, text: str) -> int:
        for stream in self.streams:
            stream.write(text)
        return len(text)

    def flush(self) -> None:
        for stream in self.streams:
            stream.flush()
