"""Jobs as planned and as run: what each makes, from what, by which configuration and sources."""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from slippulse.data.files import write_text

FOLDER = "records"


class Origin(NamedTuple):
    """A job as planned: paths below results/, records of inputs, SHA-256 of other files to read."""

    outputs: tuple[str, ...]
    step: str
    configuration: str
    sources: str
    inputs: Mapping[str, str]
    files: Mapping[str, str] = {}
    options: str = ""


class Record(NamedTuple):
    """A job as run: the same, with the SHA-256 of each output and input, and what it used."""

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


def record_path(origin: Origin) -> str:
    """Path of the record of a job below results/; the first output gives it its name."""
    return f"{FOLDER}/{origin.outputs[0]}.json"


def write_json(value: object, path: str | Path) -> None:
    """Write builtins as JSON that people can read."""
    write_text(json.dumps(value, indent=1, ensure_ascii=False) + "\n", path)


def write_record(
    origin: Origin, inputs: Mapping, used: Mapping, results: str | Path = "results"
) -> None:
    """Write the record of a job that has ended; inputs are the digests of what it has read."""
    outputs = {name: file_digest(Path(results, name)) for name in origin.outputs}
    record = Record(
        origin.step, origin.configuration, origin.sources, outputs, {**inputs}, {**used}
    )
    write_json(record._asdict(), Path(results, record_path(origin)))


def read_record(path: str | Path) -> Record:
    """Read one record. Raises OSError without a file, ValueError if it is not of this form."""
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
        types = Record.__annotations__.items()
        return Record(**{name: kind(content[name]) for name, kind in types})
    except (KeyError, TypeError, RecursionError) as error:
        raise ValueError(str(error)) from error
