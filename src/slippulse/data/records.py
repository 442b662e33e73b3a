"""What each job made from what: digests of its files and of its part of the configuration, one record a job.

Records tell which results were changed by hand, are missing, or are older than what they were made from.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path

from .files import write_whole

FOLDER = "records"


def digest_of(value: object) -> str:
    """Short digest of builtins, whatever the order of their keys."""
    text = json.dumps(value, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def file_digest(path: str | Path) -> str:
    """SHA-256 of a file."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _paths(files: Mapping) -> list[str]:
    return [str(path) for value in files.values() for path in ([value] if isinstance(value, str) else value)]


def results_of(path: str | Path) -> Path:
    """The folder ``results`` that a file is in."""
    return next(parent for parent in Path(path).parents if parent.name == "results")


def write_record(step: str, files: Mapping, outputs: Mapping, settings: Mapping, used: Mapping) -> None:
    """Note what a job has made.

    Parameters
    ----------
    step : its module
    files, outputs : paths, or lists of paths, by name
    settings : with ``configuration``, the digest of the configuration behind the outputs
    used : seconds, processor_seconds, memory_MB
    """
    made = _paths(outputs)
    base = results_of(made[0])

    def digests(paths: list[str]) -> dict[str, str]:
        inside = [Path(path) for path in paths if "results" in Path(path).parts]
        return {str(path.relative_to(base)): file_digest(path) for path in sorted(inside)}

    record = {
        "step": step,
        "configuration": settings.get("configuration", ""),
        "outputs": digests(made),
        "inputs": digests(_paths(files)),
        "used": dict(used),
    }
    name = Path(made[0]).relative_to(base)
    text = json.dumps(record, indent=1, ensure_ascii=False) + "\n"
    write_whole(
        base / FOLDER / name.with_name(name.name + ".json"),
        lambda part: part.write_text(text, encoding="utf-8"),
    )


@dataclass(frozen=True)
class Record:
    """One job: where its record is, what it made from what (paths below results/, digests), and what it used."""

    path: Path
    step: str
    configuration: str
    outputs: Mapping[str, str]
    inputs: Mapping[str, str]
    used: Mapping[str, float]


def read_records(results: str | Path) -> list[Record]:
    """Every record of a tree of results that can be read, without those whose outputs are all gone."""
    results = Path(results)
    found = []
    for path in sorted((results / FOLDER).rglob("*.json")):
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
            # Another version may have written more, or less.
            record = Record(
                path,
                str(content["step"]),
                str(content["configuration"]),
                dict(content["outputs"]),
                dict(content["inputs"]),
                {"seconds": 0.0, "processor_seconds": 0.0, "memory_MB": 0} | content.get("used", {}),
            )
            if _inside(*record.outputs) and any((results / name).exists() for name in record.outputs):
                found.append(record)
        except (OSError, ValueError, KeyError, TypeError, RecursionError):
            continue
    return found


def _inside(*names: str) -> bool:
    """Whether paths stay below the folder that they are relative to."""
    return not any(Path(name).is_absolute() or ".." in Path(name).parts for name in names)


def changed_since_made(results: str | Path, expected: Collection[str] = ()) -> list[str]:
    """Outputs, below results/, that are no longer what their job wrote, whatever their times.

    Parameters
    ----------
    results : folder
    expected : outputs that a job is known to write: without a record they are nobody's
    """
    results = Path(results)
    records = read_records(results)
    noted = {name for record in records for name in record.outputs}
    changed = [name for name in expected if name not in noted and (results / name).exists()]
    for record in records:
        for name, digest in record.outputs.items():
            path = results / name
            if path.exists() and not (path.is_file() and file_digest(path) == digest):
                changed.append(name)
    return changed


def remove_changed(results: str | Path, expected: Collection[str] = ()) -> list[str]:
    """Remove what `changed_since_made` finds, so that it is made anew where it is needed; returns the names."""
    found = changed_since_made(results, expected=expected)
    changed = [name for name in dict.fromkeys(found) if (Path(results) / name).is_file()]
    for name in changed:
        (Path(results) / name).unlink()
    return changed


def outdated(results: str | Path) -> dict[str, str]:
    """Outputs that were made from something else than what is there now, each with the first such input.

    What is made from an outdated file is outdated too.
    """
    records = read_records(results)
    now = {name: digest for record in records for name, digest in record.outputs.items()}
    stale: dict[str, str] = {}
    pending = True
    while pending:
        pending = False
        for record in records:
            if all(name in stale for name in record.outputs):
                continue
            for name, digest in record.inputs.items():
                if name in stale or (name in now and now[name] != digest):
                    stale |= dict.fromkeys(record.outputs, name)
                    pending = True
                    break
    return stale


# What an outdated page says at its top.
NOTE = (
    '<p role="alert" style="background:#ffd54f;color:#000;padding:.75rem;margin:0">Out of date: parts of these results'
    " were made anew since this page was written. <code>make replicate TARGET=everything</code> renews it.</p>"
)


def mark_outdated(results: str | Path) -> dict[str, str]:
    """Mark pages that are older than what they were made from, and remove documents that cannot be marked.

    Returns
    -------
    outdated outputs, each with the first input that is newer (`outdated`)
    """
    results = Path(results)
    stale = outdated(results)
    for record in read_records(results):
        for name in record.outputs:
            path = results / name
            if name not in stale or not path.is_file():
                continue
            if path.suffix == ".html":
                _mark(path, record)
            elif path.parent.name == "manuscript" and path.suffix == ".pdf":
                path.unlink()
    return stale


def _mark(page: Path, record: Record) -> None:
    text = page.read_text(encoding="utf-8")
    if NOTE in text:
        return
    # It stays older than its inputs, so that it is renewed when it is asked for.
    times = page.stat()
    marked = re.sub(r"(<body[^>]*>)", lambda match: match[1] + NOTE, text, count=1)
    write_whole(page, lambda part: part.write_text(marked, encoding="utf-8"))
    os.utime(page, ns=(times.st_atime_ns, times.st_mtime_ns))
    content = json.loads(record.path.read_text(encoding="utf-8"))
    content["outputs"][str(page.relative_to(results_of(page)))] = file_digest(page)
    text = json.dumps(content, indent=1, ensure_ascii=False) + "\n"
    write_whole(record.path, lambda part: part.write_text(text, encoding="utf-8"))
