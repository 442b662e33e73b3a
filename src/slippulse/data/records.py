"""What each job made from what, by which configuration and which sources: one record a job.

A result is what its record says, made by what is here now; or it is made anew. No time of a file is looked at.
"""

import hashlib
import json
import os
import time
from collections.abc import Iterable, Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import NamedTuple

from .files import write_json, write_text

FOLDER = "records"
# Folders of results in which no rule makes what stands there.
BESIDE = ("logs", "benchmarks", "reference")
MISSING, CHANGED, PARTED = (
    "missing",
    "not what its job wrote",
    "made with a file that is not as made",
)
# In seconds: a file that was just written may change once more within a tick of the clock.
SETTLED = 2.0


class Origin(NamedTuple):
    """A job: what it makes from which results, below results/; digests of its configuration and sources."""

    outputs: tuple[str, ...]
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


def write_record(origin: Origin, used: Mapping, results: str | Path = "results") -> None:
    """Note what a job has made, and what it used."""
    names = (origin.outputs, sorted(origin.inputs))
    made, taken = ({name: file_digest(Path(results, name)) for name in group} for group in names)
    record = Record(origin.step, origin.configuration, origin.sources, made, taken, dict(used))
    write_json(record._asdict(), Path(results, record_path(origin)))


def record_path(origin: Origin) -> str:
    """Where the record of a job is, below results/: named after its first output."""
    return f"{FOLDER}/{origin.outputs[0]}.json"


def read_record(path: str | Path) -> Record:
    """Read one record. Raises OSError or ValueError: without one, or if it is not what a job writes."""
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
        return Record(
            **{name: kind(content[name]) for name, kind in Record.__annotations__.items()}
        )
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
        self._digests = Digests(self.results / FOLDER / ".digests")
        self._read, self._compared = cache(read_record), cache(self._compare)

    def behind(self, names: Iterable[str]) -> list[str]:
        """Some results, all that they are made from, and what else the same jobs make; the first ones last."""
        found: dict[str, None] = {}

        def visit(name: str) -> None:
            if name not in found and name in self.origins:
                for source in sorted(self.origins[name].inputs):
                    visit(source)
                found.update(dict.fromkeys(self.origins[name].outputs))

        for name in names:
            visit(name)
        return [*found]

    def faults(self, names: Iterable[str]) -> dict[str, str]:
        """Results that are not what their record says, made by what is here now, each with the reason."""
        found = {}
        for name in names:
            path, (reason, written) = self.results / name, self._compared(name)
            if not path.is_file():
                found[name] = MISSING
            elif reason or self._digests.of(path) != written:
                found[name] = reason or CHANGED
        self._digests.save()
        return found

    def outdated(self) -> dict[str, str]:
        """Results that are there and would be made anew, whatever their content, with the reason; the last first."""
        there = [name for name in [*self.origins][::-1] if (self.results / name).is_file()]
        return {name: reason for name in there for reason in self._compared(name)[:1] if reason}

    def to_remove(self, names: Iterable[str]) -> dict[str, str]:
        """What is in the way of making anew what is faulty of some results and of what they are made from."""
        found = self.faults(self.behind(names))
        # What a job has made goes together: a missing file is made anew only where the others are not there either.
        parts = {
            part: found.get(part, PARTED) for name in found for part in self.origins[name].outputs
        }
        # A link to nowhere, or to something else than a file, is in the way too.
        there = [name for name in parts if os.path.lexists(self.results / name)]
        return {name: parts[name] for name in there if not (self.results / name).is_dir()}

    def problems(self, complete: Iterable[str]) -> tuple[list[str], int]:
        """One line for each file that is not as a run makes it, of those there or ``complete``; and their number."""
        paths = (
            path.relative_to(self.results) for path in self.results.rglob("*") if path.is_file()
        )
        there = {
            path.as_posix() for path in paths if path.parts[0] not in BESIDE and path.name[0] != "."
        }
        wanted = there.union(complete)
        compared = [name for name in self.origins if name in wanted]
        unknown = sorted(there - self.origins.keys() - {*map(record_path, self.origins.values())})
        reasons = self.faults(compared) | dict.fromkeys(unknown, "not known; no rule makes it")
        return [f"{self.results / name}: {reason}" for name, reason in reasons.items()], len(
            compared
        )

    def _compare(self, name: str) -> tuple[str, str]:
        """Why a result is outdated, and its digest as its job wrote it; one of them is empty."""
        origin = self.origins[name]
        try:
            record = self._read(self.results / record_path(origin))
        except FileNotFoundError:
            return "no record", ""
        except (OSError, ValueError):
            return "its record cannot be read", ""
        if (
            record.step != origin.step
            or name not in record.outputs
            or record.inputs.keys() != origin.inputs
        ):
            return "made by another rule", ""
        if record.configuration != origin.configuration:
            return "made by another configuration", ""
        if record.sources != origin.sources:
            return "made by other sources", ""
        for source, digest in record.inputs.items():
            if self._compared(source) != ("", digest):
                return f"older than {source}, which it is made from", ""
        return "", record.outputs[name]


class Digests:
    """SHA-256 of files, remembered with size, inode and both times; no program sets that of the inode."""

    def __init__(self, path: Path) -> None:
        self._path, self._known = path, {}
        with suppress(OSError, ValueError):
            self._known = dict(json.loads(path.read_text(encoding="utf-8")))
        self._saved = self._known.copy()

    def of(self, path: Path) -> str:
        """Digest of a file."""
        status = path.stat()
        state = [status.st_size, status.st_ino, status.st_mtime_ns, status.st_ctime_ns]
        match self._known.get(path.as_posix()):
            case [*known, str(digest)] if known == state:
                return digest
        now, digest = time.time(), file_digest(path)
        if now - max(status.st_mtime, status.st_ctime) > SETTLED:
            self._known[path.as_posix()] = [*state, digest]
        return digest

    def save(self) -> None:
        """Remember them, where that is possible."""
        if self._known != self._saved:
            with suppress(OSError):
                write_text(json.dumps(self._known), self._path)
