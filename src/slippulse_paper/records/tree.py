"""A folder of results, compared with what would make them here and now.

A result is as a run would make it if it has the content that its record says, and if its record
says what a run would do. The times of files do not count.
"""

import os
from collections.abc import Iterable, Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path

from .job_records import FOLDER, Origin, Record, file_digest, read_record, record_path

# Folders of results in which no rule makes the files.
BESIDE = ("logs", "benchmarks", "reference")


class Tree:
    """The results in a folder, by path below it, each with its origin."""

    def __init__(self, results: str | Path, origins: Mapping[str, Origin]) -> None:
        self.results, self.origins = Path(results), origins
        self._read, self._outdated = cache(read_record), cache(self._find_outdated)

    def behind(self, names: Iterable[str]) -> list[str]:
        """List some results after all that they are made from, with all files of the same jobs."""
        ordered: dict[str, None] = {}

        def visit(name: str) -> None:
            if name not in ordered and name in self.origins:
                for source in sorted(self.origins[name].inputs):
                    visit(source)
                ordered.update(dict.fromkeys(self.origins[name].outputs))

        for name in names:
            visit(name)
        return [*ordered]

    def faults(self, names: Iterable[str]) -> dict[str, str]:
        """Find which of some results are not as a run would make them, each with the reason."""
        reasons = {}
        for name in names:
            path, reason = self.results / name, self._outdated(name)
            if not path.is_file():
                reason = "missing"
            elif not reason and file_digest(path) != self._record(name).outputs[name]:
                reason = "not what its job wrote"
            if reason:
                reasons[name] = reason
        return reasons

    def outdated(self) -> dict[str, str]:
        """Find the results that would be made anew, whatever their content, the last one first."""
        present = [name for name in reversed([*self.origins]) if (self.results / name).is_file()]
        return {name: self._outdated(name) for name in present if self._outdated(name)}

    def to_renew(self, names: Iterable[str]) -> dict[str, str]:
        """Find files that a run for some results would make anew, with the reason."""
        faults = self.faults(self.behind(names))
        reasons = {}
        # A missing file is made anew only where the other files of its job are missing too.
        for name in faults:
            for output in self.origins[name].outputs:
                reasons[output] = faults.get(output, "made with a file that is not as made")
        # A link to nowhere, or to something else than a file, counts too.
        present = [name for name in reasons if os.path.lexists(self.results / name)]
        return {name: reasons[name] for name in present if not (self.results / name).is_dir()}

    def problems(self, complete: Iterable[str]) -> tuple[list[str], int, list[str]]:
        """Say what is wrong with files that are there or ``complete``, count them, name others'."""
        paths = [path for path in self.results.rglob("[!.]*") if path.is_file()]
        names = [path.relative_to(self.results) for path in paths]
        present = {name.as_posix() for name in names if name.parts[0] not in BESIDE}
        compared = [name for name in self.origins if name in present.union(complete)]
        records = {record_path(origin) for origin in self.origins.values()}
        unknown = sorted(present - self.origins.keys() - records)
        # Files that are as records of their own say, by the options of their run.
        others: dict[str, str] = {}
        for name in unknown:
            # A file that is no record says nothing.
            with suppress(OSError, ValueError, KeyError, TypeError):
                record = read_record(self.results / name)
                digests = {output: file_digest(self.results / output) for output in record.outputs}
                if (
                    name in [f"{FOLDER}/{output}.json" for output in digests]
                    and digests == record.outputs
                ):
                    options = record.used["options"] or "the shipped configuration"
                    others |= dict.fromkeys([*digests, name], f"made with {options}: harmless")
        reasons = self.faults(compared)
        reasons |= {name: "not known; no rule makes it" for name in unknown if name not in others}
        lines = [f"{self.results / name}: {reason}" for name, reason in reasons.items()]
        foreign = [f"{self.results / name}: {others[name]}" for name in unknown if name in others]
        return lines, len(compared), foreign

    def _record(self, name: str) -> Record:
        return self._read(self.results / record_path(self.origins[name]))

    def _find_outdated(self, name: str) -> str:
        """Reason why the record of a result is not that of its origin; empty where it is."""
        origin = self.origins[name]
        try:
            record = self._record(name)
        except FileNotFoundError:
            return "no record"
        except (OSError, ValueError):
            return "its record cannot be read"
        made_by = record.step, record.inputs.keys(), name in record.outputs
        if made_by != (origin.step, origin.inputs.keys(), True):
            return "made by another rule"
        if record.configuration != origin.configuration:
            return "made by another configuration"
        if record.sources != origin.sources:
            return "made by other sources"
        for source, digest in record.inputs.items():
            if self._outdated(source) or self._record(source).outputs[source] != digest:
                return f"older than {source}, which it is made from"
        return ""
