"""Records of jobs: outputs and inputs with their digests, and digests of sources and settings.

Snakemake decides by its own records and by the times of files which jobs run. It does not notice a
result that was edited by hand. The records of this module show that, since they have the digest of
every file that a job wrote. The record of a job is ``.records/NAME.json`` in the folder of its
first output, NAME. A job with outputs in two folders has a record in each.
"""

import base64
import hashlib
import json
import os
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from slippulse.data.files import write_text

RECORD_FOLDER = ".records"
# The rules of this project contain this call. It runs a step, which writes a record.
STEP_CALL = "run_step("


class ChangedFile(RuntimeError):
    """A file differs from what its job wrote, or it has changed while a job used it."""


class FileState(NamedTuple):
    """Digest of a file, and its size and time, which show quickly whether the file has changed."""

    sha256: str
    size: int
    modified_ns: int


class Record(NamedTuple):
    """Record of a job, with those of its outputs that are in one folder.

    ``code`` is the digest of the sources of the job, and ``configuration`` that of all settings.
    ``outputs`` has the state of each output, by the name of the file. ``inputs`` has the SHA-256 of
    each input, by the path relative to the folder of the outputs.
    """

    step: str
    code: str
    configuration: str
    outputs: dict[str, FileState]
    inputs: dict[str, str]
    seconds: float


def digest_of(value: object) -> str:
    """Return a short digest of plain data, which does not depend on the order of keys."""
    text = json.dumps(value, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def file_digest(path: str | Path) -> str:
    """Return the SHA-256 of a file."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


@cache
def _digest_at(path: str, _size: int, _modified_ns: int) -> str:
    """Return the SHA-256 of a file.

    The size and time of the file are arguments, so that a changed file is not found in the cache.
    """
    return file_digest(path)


def state_of(path: str | Path) -> FileState:
    """Return the state of a file.

    The file is read only if its size or time has changed since the last call.
    """
    info = os.stat(path)
    digest = _digest_at(os.path.abspath(path), info.st_size, info.st_mtime_ns)
    return FileState(digest, info.st_size, info.st_mtime_ns)


def is_unchanged(path: str | Path, state: FileState) -> bool:
    """Return True if a file still has its recorded content.

    The file is read only if it has the recorded size but another time.
    """
    info = os.stat(path)
    if (info.st_size, info.st_mtime_ns) == (state.size, state.modified_ns):
        return True
    return info.st_size == state.size and file_digest(path) == state.sha256


def _is_unchanged_or_missing(path: str, state: FileState) -> bool:
    """Return True if a file still has its recorded content, or if it cannot be read.

    Snakemake itself notices a missing file.
    """
    try:
        return is_unchanged(path, state)
    except OSError:
        return True


def record_path(output: str | Path) -> Path:
    """Return the path of the record of a job, given the first output of the job."""
    path = Path(output)
    return path.parent / RECORD_FOLDER / f"{path.name}.json"


def write_json(value: object, path: str | Path) -> None:
    """Write plain data as JSON that people can read."""
    write_text(json.dumps(value, indent=1, ensure_ascii=False) + "\n", path)


def write_record(record: Record, folder: str | Path) -> None:
    """Write the record of a job. ``folder`` is the folder of its outputs."""
    content = record._asdict()
    content["outputs"] = {name: state._asdict() for name, state in record.outputs.items()}
    first_output, *_ = record.outputs
    write_json(content, record_path(Path(folder, first_output)))


def read_record(path: str | Path) -> Record:
    """Read the record in one file.

    Raises
    ------
    OSError
        if the file cannot be read
    ValueError
        if the file does not have the form of a record
    """
    try:
        content: dict[str, Any] = json.loads(Path(path).read_text(encoding="utf-8"))
        states = {name: FileState(**state) for name, state in content["outputs"].items()}
        return Record(**{**content, "outputs": states, "inputs": dict(content["inputs"])})
    except (KeyError, TypeError, AttributeError, RecursionError) as error:
        raise ValueError(str(error)) from error


class _Job(NamedTuple):
    """A recorded job: the paths of its outputs, and the SHA-256 of each input that it read."""

    outputs: list[str]
    inputs: dict[str, str]

    def replaced_inputs(self, states: Mapping[str, FileState]) -> list[str]:
        """Return the inputs that were written again, with other content, after the job read them.

        ``states`` has the recorded state of each file by its path.
        """
        replaced = []
        for path, sha256 in self.inputs.items():
            if path in states and states[path].sha256 != sha256:
                replaced.append(path)
        return replaced


class RecordedFiles:
    """All records in a folder of results, and the states of the files that they record."""

    def __init__(self, results: str | Path) -> None:
        """Read all records in the folder of results, and list those that cannot be read."""
        self.results = Path(results)
        self.records: dict[Path, Record] = {}
        self.unreadable: list[Path] = []
        for path in sorted(self.results.rglob(f"{RECORD_FOLDER}/*.json")):
            try:
                self.records[path] = read_record(path)
            except (OSError, ValueError):
                self.unreadable.append(path)

    def states(self) -> dict[str, FileState]:
        """Return the recorded state of each file, by its path from the working directory."""
        states = {}
        for path, record in self.records.items():
            for name, state in record.outputs.items():
                states[str(_recorded_folder(path) / name)] = state
        return states

    def problems(self) -> Iterator[tuple[str, str]]:
        """Yield each file whose change Snakemake does not notice, and the reason.

        A missing file is not a problem, since Snakemake makes it again if it is needed.
        """
        for path in self.unreadable:
            yield str(_recorded_folder(path) / path.stem), "its record cannot be read"
        states = self.states()
        yield from _changed_files(states)
        for job in self._jobs():
            replaced_inputs = job.replaced_inputs(states)
            if replaced_inputs:
                for output in job.outputs:
                    yield output, f"made from an earlier version of {replaced_inputs[0]}"

    def older_than_inputs(self) -> set[str]:
        """Return the files that were made from an older version of one of their inputs.

        The result includes files that were made from such files.
        """
        states, jobs = self.states(), self._jobs()
        older: set[str] = set()
        for job in jobs:
            if job.replaced_inputs(states):
                older.update(job.outputs)
        # Repeat until no further file is added.
        previous_count = -1
        while len(older) > previous_count:
            previous_count = len(older)
            for job in jobs:
                if not older.isdisjoint(job.inputs):
                    older.update(job.outputs)
        return older

    def _jobs(self) -> list["_Job"]:
        """Return the job of each record, with paths from the working directory."""
        jobs = []
        for path, record in self.records.items():
            folder = _recorded_folder(path)
            outputs = [str(folder / name) for name in record.outputs]
            # The recorded path of an input may lead out of the folder, by "..".
            inputs = {
                os.path.normpath(folder / name): digest for name, digest in record.inputs.items()
            }
            jobs.append(_Job(outputs, inputs))
        return jobs


def _changed_files(states: Mapping[str, FileState]) -> Iterator[tuple[str, str]]:
    """Yield each file with another content than the recorded one, or that Snakemake does not know.

    Each file comes with the reason. ``states`` has the recorded state of each file by its path.
    """
    snakemake_files = _files_recorded_by_snakemake()
    # The digests of the files take most of the time. Threads compute them in parallel.
    with ThreadPoolExecutor() as threads:
        unchanged = threads.map(_is_unchanged_or_missing, states, states.values())
    for name, is_unchanged_file in zip(states, unchanged, strict=True):
        if not is_unchanged_file:
            yield name, "changed since its job wrote it"
        elif name not in snakemake_files and Path(name).is_file():
            yield name, "Snakemake's own record of this file (in .snakemake) is lost"


def _recorded_folder(record: Path) -> Path:
    """Return the folder of the outputs in a record, given the path of the record."""
    return record.parent.parent


def _files_recorded_by_snakemake() -> dict[str, Path]:
    """Return the path of Snakemake's record of each file, by the path of the file.

    The name of a record is the path of the file, encoded in base64.
    """
    folder = Path(".snakemake/metadata")
    records = {}
    for path in folder.rglob("*"):
        # Snakemake splits a long name into folders whose names begin with @.
        encoded = "".join(part.removeprefix("@") for part in path.relative_to(folder).parts)
        with suppress(ValueError):
            records[base64.urlsafe_b64decode(encoded).decode()] = path
    return records


def made_without_step(paths: Iterable[str]) -> set[str]:
    """Return those files that Snakemake made by a rule of the user.

    Such a rule runs no step of this project, so its jobs have no record of this module. The code of
    the rule, which Snakemake's own record of the file contains, does not call a step.
    """
    records = _files_recorded_by_snakemake()
    user_files = set()
    for name in {*paths} & {*records}:
        with suppress(OSError, ValueError, TypeError, AttributeError):
            rule_code = json.loads(records[name].read_text(encoding="utf-8")).get("code")
            if rule_code and STEP_CALL not in rule_code:
                user_files.add(name)
    return user_files


def job_seconds(results: str | Path) -> dict[str, float]:
    """Return the total time in seconds of all jobs of each step, from the records in a folder."""
    seconds: dict[str, float] = {}
    for record in RecordedFiles(results).records.values():
        seconds[record.step] = round(seconds.get(record.step, 0.0) + record.seconds, 2)
    return seconds


def check_inputs(paths: Iterable[str]) -> tuple[dict[str, FileState], dict[str, Record]]:
    """Raise ChangedFile if an input of a job has another content than its own job wrote.

    Returns the state of each input that exists, and the record of each input that has one, by path.
    """
    states, records = {}, {}
    for path in paths:
        if not Path(path).is_file():
            continue
        states[path] = state_of(path)
        record = _record_of(path)
        if record is None:
            continue
        records[path] = record
        if record.outputs[Path(path).name].sha256 != states[path].sha256:
            remedy = (
                "delete the file and run again, or run `make replicate`, which makes the file again"
            )
            raise ChangedFile(f"{path}: changed since its job wrote it; {remedy}")
    return states, records


def check_unchanged(states: Mapping[str, FileState]) -> None:
    """Raise ChangedFile if a file has changed since its state was taken."""
    for path, state in states.items():
        if not is_unchanged(path, state):
            raise ChangedFile(f"{path}: changed while the job was running; run again")


def _record_of(path: str) -> Record | None:
    """Return the record that has a file among its outputs, or None if there is none."""
    folder = Path(path).parent / RECORD_FOLDER
    # The records of a folder are cached, and read again when its modification time has changed.
    records = _records_in(str(folder), _modification_time(folder))
    return records.get(Path(path).name)


def _modification_time(folder: Path) -> int:
    """Return the time at which a folder was modified, in ns, or 0 if there is no folder."""
    try:
        return folder.stat().st_mtime_ns
    except OSError:
        return 0


@cache
def _records_in(folder: str, _modified_ns: int) -> dict[str, Record]:
    """Return the record of each output in a folder of records, by the name of the output.

    The time of the folder is an argument, so that a changed folder is not found in the cache.
    """
    records: dict[str, Record] = {}
    for path in Path(folder).glob("*.json"):
        try:
            record = read_record(path)
        except (OSError, ValueError):
            continue
        records |= dict.fromkeys(record.outputs, record)
    return records
