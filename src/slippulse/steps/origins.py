"""What every result is made by, from the jobs that make them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import PurePath
from typing import NamedTuple

from ..data.records import Origin, digest_of
from .reach import digest_of_files, modules_of, sources

# Every step loads libraries that are in it.
LOCK = "requirements.lock"
RESULTS = PurePath("results")


class Job(NamedTuple):
    """One job of the workflow: its step, the files that it reads and writes, what it takes from the configuration."""

    step: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    settings: Mapping


def origins_of(jobs: Iterable[Job]) -> dict[str, Origin]:
    """What each result is made by.

    Parameters
    ----------
    jobs : all of a configuration; what one reads below results/ another writes

    Returns
    -------
    by path below results/; the configuration is that of the job and of all that it is made from
    """
    makers = {below(output): job for job in jobs for output in job.outputs}
    found: dict[str, Origin] = {}

    def origin(name: str) -> Origin:
        if name not in found:
            job = makers[name]
            inside = frozenset(below(path) for path in job.inputs if is_result(path))
            behind = sorted({origin(source).configuration for source in inside})
            outside = tuple(sorted(path for path in job.inputs if not is_result(path)))
            made = [below(output) for output in job.outputs]
            configuration = digest_of([job.settings, *behind])
            digest = source_digest(tuple(modules_of(job.step, job.settings)), outside)
            found.update(dict.fromkeys(made, Origin(made[0], job.step, configuration, digest, inside)))
        return found[name]

    for name in makers:
        origin(name)
    return found


def is_result(path: str) -> bool:
    """Whether a file is below results/."""
    return PurePath(path).is_relative_to(RESULTS)


def below(path: str) -> str:
    """A path of a result, below results/."""
    return PurePath(path).relative_to(RESULTS).as_posix()


@cache
def source_digest(modules: tuple[str, ...], texts: tuple[str, ...]) -> str:
    """Digest of all that some modules reach, of texts of the project that they read, and of the lock."""
    return digest_of_files([*sources(*modules), *texts, LOCK])
