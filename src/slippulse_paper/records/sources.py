"""Source files that a step of the workflow depends on, with their digests.

A step depends on its own module and on every module that this one imports, directly or not, within
both packages. Their digest is a parameter of the rule, so that Snakemake runs a job again when, and
only when, one of these files has another content, whatever the time of the file.
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
# Packages of other versions may give other results.
LOCK = "requirements.lock"


class Sources(NamedTuple):
    """Files with their SHA-256, by path below the project, and one digest of all."""

    digest: str
    files: dict[str, str]


@cache
def _imports() -> grimp.ImportGraph:
    """Graph of the imports within both packages; a module imports the packages that it is in."""
    graph = grimp.build_graph(*PACKAGES, cache_dir=None, exclude_type_checking_imports=True)
    for name in graph.modules - {*PACKAGES}:
        graph.add_import(importer=name, imported=name.rpartition(".")[0])
    return graph


@cache
def _digest(path: str) -> str:
    return file_digest(PROJECT / path)


@cache
def modules_reached(*modules: str) -> frozenset[str]:
    """Return the full names of modules and of all that they import, with their packages."""
    return frozenset(modules).union(*map(_imports().find_upstream_modules, modules))


@cache
def sources_of(modules: tuple[str, ...], texts: tuple[str, ...] = ()) -> Sources:
    """Find the sources of a step.

    Parameters
    ----------
    modules : tuple of str
        full names of the modules that the step runs
    texts : tuple of str
        further files that it reads, as paths below the project: templates and texts
    """
    paths = {_path(module) for module in modules_reached(*modules)} | {*texts, LOCK}
    files = {path: _digest(path) for path in sorted(paths)}
    return Sources(digest_of(files), files)


def changed_sources(files: dict[str, str]) -> Iterable[str]:
    """Yield the paths of sources whose content is no longer the one given by their SHA-256."""
    for path, digest in files.items():
        try:
            unchanged = file_digest(PROJECT / path) == digest
        except OSError:
            unchanged = False
        if not unchanged:
            yield path


def _path(module: str) -> str:
    """Return the path of a module below the project."""
    path = SOURCES.joinpath(*module.split("."))
    path = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    return path.relative_to(PROJECT).as_posix()
