"""Digests of files that this process reads, each taken when it is read.

Modules are compiled from their sources, since a file in ``__pycache__`` may be of others.
"""

import hashlib
import os
import sys
from collections import defaultdict
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from importlib.machinery import SOURCE_SUFFIXES, FileFinder, SourceFileLoader

from .reach import PACKAGES, ROOT, SOURCES

# SHA-256 of each file at each time when it was read, by its real path.
_read: defaultdict[str, set[str]] = defaultdict(set)
# Texts and results that the present job may read.
_watched: set[str] = set()


class FileChanged(RuntimeError):
    """A file that is not as it was when the run was planned, or as its job wrote it."""


class _FromSource(SourceFileLoader):
    def get_code(self, fullname: str):
        source = self.get_data(self.path)
        _read[os.path.realpath(self.path)].add(hashlib.sha256(source).hexdigest())
        return self.source_to_code(source, self.path)


def _finder(folder: str) -> FileFinder:
    if not os.path.realpath(folder).startswith(str(SOURCES)):
        raise ImportError
    return FileFinder(folder, (_FromSource, SOURCE_SUFFIXES))


def begin() -> None:
    """Take digests of all that this process reads from now on."""
    sys.path_hooks.insert(0, _finder)
    sys.path_importer_cache.clear()
    sys.addaudithook(_note)
    for name, module in [*sys.modules.items()]:
        if name.partition(".")[0] in PACKAGES:
            _add_now(os.path.realpath(str(module.__file__)))


@contextmanager
def expected(planned: Mapping[str, str]) -> Iterator[None]:
    """Let a job read files, by path with SHA-256; raise FileChanged if it read other content."""
    _watched.clear()
    _watched.update(path for path in map(_real, planned) if not path.endswith(".py"))
    for path in _watched:
        _read.pop(path, None)
    yield
    for path, digest in planned.items():
        real = _real(path)
        # Another program may have read it.
        if real in _watched - _read.keys():
            _add_now(real)
        if _read.get(real, set()) - {digest}:
            since = "its job wrote it" if path.startswith("results/") else "this run was planned"
            raise FileChanged(f"{path}: changed since {since}; run again")


def _real(path: str) -> str:
    """Real path of a result, or of a file of the project."""
    return os.path.realpath(path if path.startswith("results/") else ROOT / path)


def _note(event: str, arguments: tuple) -> None:
    """Take the digest of a file that Python opens for reading, or that a program may read."""
    if event == "open" and isinstance(arguments[0], str) and "r" in (arguments[1] or ""):
        real = os.path.realpath(arguments[0])
        if real in _watched:
            _add_now(real)
    elif event == "subprocess.Popen":
        for real in _watched - _read.keys():
            _add_now(real)


def _add_now(real: str) -> None:
    # This way to open a file has no mode, and so is not noted.
    with suppress(OSError), os.fdopen(os.open(real, os.O_RDONLY), "rb") as file:
        _read[real].add(hashlib.file_digest(file, "sha256").hexdigest())
