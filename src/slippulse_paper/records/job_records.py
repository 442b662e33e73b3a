"""Records of jobs: outputs and inputs with their digests, and digests of sources and settings.

Snakemake decides which jobs run, by its own records and the times of files. It does not notice a
result that was edited by hand. For that, the records here have the digest of everything that a job
wrote. The record of a job is ``.records/NAME.json`` in the folder of its first output, NAME. A job
with outputs in two folders has a record in each.
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

FOLDER = ".records"
# The call in a rule that runs a step of this project and so has a record.
STEP_CALL = "run_step("


class ChangedFile(RuntimeError):
    """Refusal of a file that differs from what its job wrote, or that changed during a job."""


class FileState(NamedTuple):
    """Digest of a file, with its size and time, which show quickly that it is unchanged."""

    sha256: str
    size: int
    modified_ns: int


class Record(NamedTuple):
    """Record of a job.

    ``code`` and ``configuration`` are the digests of its sources and of all settings. ``outputs``
    are those in one folder, by name. ``inputs`` has the SHA-256 of each input, by the path relative
    to that folder.
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

    Its size and time are arguments so that the cache is not used after a change.
    """
    return file_digest(path)


def state_of(path: str | Path) -> FileState:
    """Return the state of a file. The content is read only if its size or time has changed."""
    info = os.stat(path)
    digest = _digest_at(os.path.abspath(path), info.st_size, info.st_mtime_ns)
    return FileState(digest, info.st_size, info.st_mtime_ns)


def is_unchanged(path: str | Path, state: FileState) -> bool:
    """Return True if a file has a recorded content. The file is read only if its time differs."""
    info = os.stat(path)
    if (info.st_size, info.st_mtime_ns) == (state.size, state.modified_ns):
        return True
    return info.st_size == state.size and file_digest(path) == state.sha256


def _is_unchanged_or_missing(path: str, state: FileState) -> bool:
    """Return True if a file has a recorded content, or cannot be read."""
    try:
        return is_unchanged(path, state)
    except OSError:
        return True


def record_path(output: str | Path) -> Path:
    """Return the path of the record whose first output is given."""
    path = Path(output)
    return path.parent / FOLDER / f"{path.name}.json"


def write_json(value: object, path: str | Path) -> None:
    """Write plain data as JSON that people can read."""
    write_text(json.dumps(value, indent=1, ensure_ascii=False) + "\n", path)


def write_record(record: Record, folder: str | Path) -> None:
    """Write the record of the outputs of a job in one folder."""
    content = record._asdict()
    content["outputs"] = {name: state._asdict() for name, state in record.outputs.items()}
    first_output, *_ = record.outputs
    write_json(content, record_path(Path(folder, first_output)))


def read_record(path: str | Path) -> Record:
    """Read one record.

    Raises
    ------
    OSError
        if there is no such file
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
    """Outputs of a job in one folder, and the SHA-256 of each input that it read, by path."""

    outputs: list[str]
    inputs: dict[str, str]

    def replaced_inputs(self, states: Mapping[str, FileState]) -> list[str]:
        """Return the inputs whose recorded content is no longer the one that the job read."""
        replaced = []
        for path, sha256 in self.inputs.items():
            if path in states and states[path].sha256 != sha256:
                replaced.append(path)
        return replaced


class RecordedFiles:
    """All records in a folder of results, and the state of the recorded files."""

    def __init__(self, results: str | Path) -> None:
        self.results = Path(results)
        self.records: dict[Path, Record] = {}
        self.unreadable: list[Path] = []
        for path in sorted(self.results.rglob(f"{FOLDER}/*.json")):
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
        """Yield each file whose change Snakemake would not notice, with the reason.

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
                    yield output, f"made from another {replaced_inputs[0]}"

    def older_than_inputs(self) -> set[str]:
        """Return the files that were made from files that have been made again since then.

        This includes files that were made from such files.
        """
        states, jobs = self.states(), self._jobs()
        older: set[str] = set()
        for job in jobs:
            if job.replaced_inputs(states):
                older.update(job.outputs)
        # Repeat until no further file was made from an older one.
        count = -1
        while len(older) > count:
            count = len(older)
            for job in jobs:
                if not older.isdisjoint(job.inputs):
                    older.update(job.outputs)
        return older

    def _jobs(self) -> list["_Job"]:
        """Return outputs and inputs of each record, by their paths from the working directory."""
        jobs = []
        for path, record in self.records.items():
            folder = _recorded_folder(path)
            outputs = [str(folder / name) for name in record.outputs]
            inputs = {
                os.path.normpath(folder / name): digest for name, digest in record.inputs.items()
            }
            jobs.append(_Job(outputs, inputs))
        return jobs


def _changed_files(states: Mapping[str, FileState]) -> Iterator[tuple[str, str]]:
    """Yield each file that has no longer its recorded content, and files unknown to Snakemake."""
    snakemake_files = _files_recorded_by_snakemake()
    # Most of the time goes into digests of the files, which threads compute in parallel.
    with ThreadPoolExecutor() as threads:
        unchanged = threads.map(_is_unchanged_or_missing, states, states.values())
    for name, is_recorded in zip(states, unchanged, strict=True):
        if not is_recorded:
            yield name, "not what its job wrote"
        elif name not in snakemake_files and Path(name).is_file():
            yield name, "Snakemake's own record of it (in .snakemake) is lost"


def _recorded_folder(record: Path) -> Path:
    """Return the folder with the files that a record is about."""
    return record.parent.parent


def _files_recorded_by_snakemake() -> dict[str, Path]:
    """Return Snakemake's record of each file by the path of the file, which its name encodes."""
    folder = Path(".snakemake/metadata")
    records = {}
    for path in folder.rglob("*"):
        # Snakemake splits a long name into folders whose names begin with @.
        encoded = "".join(part.removeprefix("@") for part in path.relative_to(folder).parts)
        with suppress(ValueError):
            records[base64.urlsafe_b64decode(encoded).decode()] = path
    return records


def made_without_step(paths: Iterable[str]) -> set[str]:
    """Return the files that Snakemake made by a rule without a step of this project.

    Such a rule is one of the user, and its jobs have no record here.
    """
    records, found = _files_recorded_by_snakemake(), set()
    for name in {*paths} & {*records}:
        with suppress(OSError, ValueError, TypeError, AttributeError):
            code = json.loads(records[name].read_text(encoding="utf-8")).get("code")
            if code and STEP_CALL not in code:
                found.add(name)
    return found


def job_seconds(results: str | Path) -> dict[str, float]:
    """Return the total time in seconds of the jobs of each step, from their records."""
    seconds: dict[str, float] = {}
    for record in RecordedFiles(results).records.values():
        seconds[record.step] = round(seconds.get(record.step, 0.0) + record.seconds, 2)
    return seconds


def check_inputs(paths: Iterable[str]) -> tuple[dict[str, FileState], dict[str, Record]]:
    """Check that the inputs of a job still have the content that their jobs wrote.

    Returns the state of each existing file, and the record of each recorded file, by path.

    Raises
    ------
    ChangedFile
        if a file has another content
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
            remedy = "delete it and run again, or run `make replicate`, which makes it again"
            raise ChangedFile(f"{path}: not what its job wrote; {remedy}")
    return states, records


def check_unchanged(states: Mapping[str, FileState]) -> None:
    """Raise ChangedFile if a file has changed since its state was taken."""
    for path, state in states.items():
        if not is_unchanged(path, state):
            raise ChangedFile(f"{path}: changed while the job was running; run again")


def _record_of(path: str) -> Record | None:
    """Return the record that has a file among its outputs, or None if there is none."""
    folder = Path(path).parent / FOLDER
    records = _records_in(str(folder), _time_of(folder))
    return records.get(Path(path).name)


def _time_of(folder: Path) -> int:
    """Return the time at which a folder was modified, in ns, or 0 if there is no folder."""
    try:
        return folder.stat().st_mtime_ns
    except OSError:
        return 0


@cache
def _records_in(folder: str, _modified_ns: int) -> dict[str, Record]:
    """Return the record of each output, by its name, from the records in a folder.

    The time of the folder is an argument so that the cache is not used after a change.
    """
    records: dict[str, Record] = {}
    for path in Path(folder).glob("*.json"):
        try:
            record = read_record(path)
        except (OSError, ValueError):
            continue
        records |= dict.fromkeys(record.outputs, record)
    return records
