"""Digests of files that this process reads, each taken when it is read.

Modules are compiled from their sources, since a file in ``__pycache__`` may be of others.
"""

import hashlib
import os
import sys
from collections.abc import Iterable, Mapping
from contextlib import suppress
from functools import cache
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader

from .reach import PACKAGE, ROOT

# SHA-256 of each file as it was read, by its real path: sources while the process lives.
_read: dict[str, set[str]] = {}
# Files that the present job may read.
_watched: set[str] = set()


class FileChanged(RuntimeError):
    """A file that is not as it was when the run was planned."""


class _FromSource(SourceFileLoader):
    def get_code(self, fullname: str):
        return self.source_to_code(self.get_data(self.path), self.path)


class _Finder:
    @staticmethod
    def find_spec(name: str, path=None, target=None) -> ModuleSpec | None:
        spec = PathFinder.find_spec(name, path) if name.startswith("slippulse.") else None
        if spec and isinstance(spec.loader, SourceFileLoader):
            spec.loader = _FromSource(name, spec.loader.path)
        return spec


def begin() -> None:
    """Take digests of all that this process reads from now on."""
    if _Finder not in sys.meta_path:
        sys.meta_path.insert(0, _Finder)
        sys.addaudithook(_note)
        for name, module in [*sys.modules.items()]:
            if name.partition(".")[0] == "slippulse":
                _add(os.path.realpath(str(module.__file__)))


def watch(paths: Iterable[str]) -> None:
    """Take digests of what a job may read, and forget what the last job has read."""
    _watched.clear()
    _watched.update(map(_real, paths))
    for path in _watched:
        if not path.endswith(".py"):
            _read.pop(path, None)


def check(planned: Mapping[str, str]) -> None:
    """Raise FileChanged unless all that was read is as planned, by path and SHA-256."""
    for path, digest in planned.items():
        if _digests(path) - {digest}:
            raise FileChanged(f"{path}: changed since this run was planned; run again")


def digest_of_read(path: str) -> str:
    """SHA-256 of a file as this job has read it. Raises FileChanged if it read two versions."""
    digests = _digests(path)
    if len(digests) != 1:
        raise FileChanged(f"{path}: changed while a job read it; run again")
    return min(digests)


def _digests(path: str) -> set[str]:
    """Digests of a file at each time when it was read; as it is now, if another program read it."""
    real = _real(path)
    if real not in _read and not real.endswith(".py"):
        _add(real)
    return _read.get(real, set())


def _real(path: str) -> str:
    return os.path.realpath(path) if path.startswith("results/") else _real_source(path)


@cache
def _real_source(path: str) -> str:
    return os.path.realpath(ROOT / path)


def _note(event: str, arguments: tuple) -> None:
    """Take the digest of a file that Python opens for reading, or that a program may read."""
    if event == "open" and isinstance(arguments[0], str) and "r" in (arguments[1] or ""):
        real = "" if arguments[0].endswith(".pyc") else os.path.realpath(arguments[0])
        if real in _watched or (real.endswith(".py") and real.startswith(str(PACKAGE))):
            _add(real)
    elif event == "subprocess.Popen":
        for real in _watched - _read.keys():
            if not real.endswith(".py"):
                _add(real)


def _add(real: str) -> None:
    # This way to open a file has no mode, and so is not noted.
    with suppress(OSError), os.fdopen(os.open(real, os.O_RDONLY), "rb") as file:
        _read.setdefault(real, set()).add(hashlib.file_digest(file, "sha256").hexdigest())
