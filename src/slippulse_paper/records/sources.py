"""Source files that a step of the workflow depends on, with their digests.

A step depends on its own module and on every module of both packages that this module imports,
directly or indirectly. The digest of these files is a parameter of the rule. Snakemake therefore
runs a job again if the content of one of them has changed, but not if only its time has changed.
"""

from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import NamedTuple

import grimp

from .job_records import digest_of, file_digest

PACKAGES = ("slippulse", "slippulse_paper")
SOURCES = Path(__file__).resolve().parents[2]
PROJECT = SOURCES.parent
# Results may depend on the versions of the installed packages, which this file lists.
LOCK = "requirements.lock"


class Sources(NamedTuple):
    """Source files: the SHA-256 of each, by its path below the project, and one digest of all."""

    digest: str
    files: dict[str, str]


@cache
def _imports() -> grimp.ImportGraph:
    """Return the graph of the imports in both packages."""
    graph = grimp.build_graph(*PACKAGES, cache_dir=None, exclude_type_checking_imports=True)
    # Python runs the __init__ of a package before its modules, and so each module depends on it.
    for name in graph.modules - {*PACKAGES}:
        graph.add_import(importer=name, imported=name.rpartition(".")[0])
    return graph


@cache
def _digest(path: str) -> str:
    """Return the SHA-256 of a file, given by its path below the project."""
    return file_digest(PROJECT / path)


@cache
def modules_reached(*modules: str) -> frozenset[str]:
    """Return the full names of modules and of all modules that they import, even indirectly."""
    imports = _imports()
    imported = [imports.find_upstream_modules(module) for module in modules]
    return frozenset(modules).union(*imported)


@cache
def sources_of(modules: tuple[str, ...], texts: tuple[str, ...] = ()) -> Sources:
    """Return the sources of a step: its modules, the texts that it reads, and requirements.lock.

    Parameters
    ----------
    modules : tuple of str
        full names of the modules that the step runs; those that they import are added
    texts : tuple of str
        paths below the project of other files that it reads, such as templates and texts
    """
    module_paths = map(_path_of, modules_reached(*modules))
    paths = sorted({*module_paths, *texts, LOCK})
    files = {path: _digest(path) for path in paths}
    return Sources(digest_of(files), files)


def changed_sources(files: dict[str, str]) -> Iterable[str]:
    """Yield the paths of source files that have changed or are missing.

    ``files`` has the earlier SHA-256 of each file by its path below the project.
    """
    for path, digest in files.items():
        try:
            is_unchanged = file_digest(PROJECT / path) == digest
        except OSError:
            is_unchanged = False
        if not is_unchanged:
            yield path


def _path_of(module: str) -> str:
    """Return the path of a module below the project, from the full name of the module."""
    path = SOURCES.joinpath(*module.split("."))
    path = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    return path.relative_to(PROJECT).as_posix()
