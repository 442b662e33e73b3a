"""What each job made from what, by which configuration and which sources: one record a job.

A result is what its record says, made by what is here now; or it is made anew. No time of a file is looked at.
"""

import hashlib
import json
import os
import time
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from .files import write_json, write_text

FOLDER = "records"
# Folders of results in which no rule makes what stands there.
BESIDE = ("logs", "benchmarks", "reference")
MISSING, CHANGED, PARTED = "missing", "not what its job wrote", "made with a file that is not as made"
# In seconds: a file that was just written may change once more within a tick of the clock.
SETTLED = 2.0


class Origin(NamedTuple):
    """What a result is made by. Paths are below results/.

    Attributes
    ----------
    record : first output of its job, after which the record is named
    step : module of `slippulse.steps`
    configuration : digest of the configuration behind it
    sources : digest of the sources that make it, and of the texts that they read
    inputs : results that it is made from
    """

    record: str
    step: str
    configuration: str
    sources: str
    inputs: frozenset[str]


class Record(NamedTuple):
    """One job: what made it, digests of its outputs and inputs by path below results/, and what it used."""

    step: str
    configuration: str
    sources: str
    outputs: dict
    inputs: dict
    used: dict


def digest_of(value: object) -> str:
    """Short digest of builtins, whatever the order of their keys."""
    text = json.dumps(value, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def file_digest(path: str | Path) -> str:
    """SHA-256 of a file."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def write_record(origin: Origin, outputs: Mapping, used: Mapping) -> None:
    """Note what a job has made: paths, or lists of paths, by name; and what it used."""
    made = [
        Path(path) for value in outputs.values() for path in ([value] if isinstance(value, str) else value)
    ]
    results = next(parent for parent in made[0].parents if parent.name == "results")
    record = Record(
        origin.step,
        origin.configuration,
        origin.sources,
        {path.relative_to(results).as_posix(): file_digest(path) for path in made},
        {name: file_digest(results / name) for name in sorted(origin.inputs)},
        dict(used),
    )
    write_json(record._asdict(), results / record_path(origin.record))


def record_path(name: str) -> str:
    """Where the record is, below results/, of the job whose first output has this name."""
    return f"{FOLDER}/{name}.json"


def read_record(path: str | Path) -> Record:
    """Read one record. Raises OSError or ValueError: without one, or if it is not what a job writes."""
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
        return Record(**{name: kind(content[name]) for name, kind in Record.__annotations__.items()})
    except (KeyError, TypeError, RecursionError) as error:
        raise ValueError(str(error)) from error


def read_records(results: str | Path) -> list[Record]:
    """Every record of a tree of results that can be read."""
    found = []
    for path in sorted((Path(results) / FOLDER).rglob("*.json")):
        with suppress(OSError, ValueError):
            found.append(read_record(path))
    return found


class Tree:
    """A folder of results as it is, against what its results, by path below it, would be made by here and now."""

    def __init__(self, results: str | Path, origins: Mapping[str, Origin]) -> None:
        self.results, self.origins = Path(results), origins
        self._made: dict[str, list[str]] = {}
        for name, origin in origins.items():
            self._made.setdefault(origin.record, []).append(name)
        self._digests = Digests(self.results / FOLDER / ".digests")
        self._records: dict[str, Record | str] = {}
        self._outdated: dict[str, str] = {}

    def behind(self, names: Iterable[str]) -> list[str]:
        """Some results, all that they are made from, and what else the same jobs make; the first ones last."""
        found: dict[str, None] = {}

        def visit(name: str) -> None:
            if name not in found and name in self.origins:
                for source in sorted(self.origins[name].inputs):
                    visit(source)
                found.update(dict.fromkeys(self._made[self.origins[name].record]))

        for name in names:
            visit(name)
        return [*found]

    def faults(self, names: Iterable[str]) -> dict[str, str]:
        """Results that are not what their record says, made by what is here now, each with the reason."""
        found = {name: self._fault(name) for name in names}
        self._digests.save()
        return {name: reason for name, reason in found.items() if reason}

    def outdated(self, name: str) -> str:
        """Why a result would be made anew, whatever its content; empty where it would not."""
        if name not in self._outdated:
            self._outdated[name] = self._compare(name)
        return self._outdated[name]

    def to_remove(self, names: Iterable[str]) -> dict[str, str]:
        """What is in the way of making anew what is faulty of some results and of what they are made from.

        What a job has made goes together: a missing file is made anew only where the others are not there either.
        """
        found = self.faults(self.behind(names))
        jobs = {self.origins[name].record for name in found}
        # A link to nowhere, or to something else than a file, is in the way too.
        return {
            name: found.get(name, PARTED)
            for job in jobs
            for name in self._made[job]
            if os.path.lexists(self.results / name) and not (self.results / name).is_dir()
        }

    def problems(self, complete: Iterable[str]) -> tuple[list[str], int]:
        """One line for each file that is not as a complete run would make it, and how many files were compared.

        ``complete`` is what such a run makes with all that this is made from; others are compared where they are there.
        """
        paths = (path.relative_to(self.results) for path in self.results.rglob("*") if path.is_file())
        there = {path.as_posix() for path in paths if path.parts[0] not in BESIDE and path.name[0] != "."}
        wanted = there.union(complete)
        compared = [name for name in self.origins if name in wanted]
        unknown = sorted(there - self.origins.keys() - {record_path(job) for job in self._made})
        reasons = self.faults(compared) | dict.fromkeys(unknown, "not known; no rule makes it")
        return [f"{self.results / name}: {reason}" for name, reason in reasons.items()], len(compared)

    def _fault(self, name: str) -> str:
        path = self.results / name
        if not path.is_file():
            return MISSING
        if reason := self.outdated(name):
            return reason
        return "" if self._digests.of(path) == self._written(name) else CHANGED

    def _written(self, name: str) -> str:
        """Digest of a result that is not outdated, as its job wrote it."""
        record = self._record(self.origins[name].record)
        assert isinstance(record, Record)
        return record.outputs[name]

    def _record(self, job: str) -> Record | str:
        """The record of a job, or why there is none."""
        if job not in self._records:
            try:
                self._records[job] = read_record(self.results / record_path(job))
            except FileNotFoundError:
                self._records[job] = "no record"
            except (OSError, ValueError):
                self._records[job] = "its record cannot be read"
        return self._records[job]

    def _compare(self, name: str) -> str:
        origin = self.origins[name]
        record = self._record(origin.record)
        if isinstance(record, str):
            return record
        if record.step != origin.step or name not in record.outputs or record.inputs.keys() != origin.inputs:
            return "made by another rule"
        if record.configuration != origin.configuration:
            return "made by another configuration"
        if record.sources != origin.sources:
            return "made by other sources"
        for source, digest in record.inputs.items():
            if self.outdated(source) or self._written(source) != digest:
                return f"older than {source}, which it is made from"
        return ""


class Digests:
    """SHA-256 of files, remembered in a file with what tells that one is still the same: size, inode and its two times.

    The time of the inode changes with every change of content, and no program sets it.
    """

    def __init__(self, path: Path) -> None:
        self._path, self._new = path, False
        self._known: dict[str, list] = {}
        with suppress(OSError, ValueError):
            self._known = dict(json.loads(path.read_text(encoding="utf-8")))

    def of(self, path: Path) -> str:
        """Digest of a file."""
        status = path.stat()
        state = [status.st_size, status.st_ino, status.st_mtime_ns, status.st_ctime_ns]
        match self._known.get(path.as_posix()):
            case [*known, str(digest)] if known == state:
                return digest
        settled = time.time() - max(status.st_mtime, status.st_ctime) > SETTLED
        digest = file_digest(path)
        if settled:
            self._known[path.as_posix()], self._new = [*state, digest], True
        return digest

    def save(self) -> None:
        """Remember them, where that is possible."""
        if self._new:
            with suppress(OSError):
                write_text(json.dumps(self._known), self._path)
            self._new = False
