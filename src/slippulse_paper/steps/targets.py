"""Targets of a run, obstacles to it, and the summary that it leaves."""

import os
import re
import sys
import time
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from copy import deepcopy
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TextIO

from slippulse.model.checks import short_repr

from ..configuration.problems import ConfigError, nearest
from ..records.job_records import record_path
from ..records.lock import take
from ..records.tree import Tree
from .origins import RESULTS, Job, below, origins_of

# A faulty result is older than the folder of the sources. Snakemake takes 0 for no time.
SOURCES, OLD = "src", 1.0


def selected(config: Mapping, keys: Iterable[str], additions: Mapping) -> dict:
    """Take the values of some dotted keys of the configuration, nested as there, with additions."""
    values = deepcopy(dict(additions))
    for key in keys:
        target, source = values, config
        *parents, last = key.split(".")
        for parent in parents:
            target, source = target.setdefault(parent, {}), source[parent]
        target[last] = source[last]
    return values


class Plan:
    """All jobs, the files of rules that may be named as targets, and the folder of results."""

    def __init__(self, jobs: Sequence[Job], named: Mapping, options: str = "") -> None:
        self.jobs, self.named = jobs, named
        self.origins = origins_of(jobs, options)
        self.tree = Tree(RESULTS, self.origins)

    def wanted(self, targets: Iterable[str]) -> list[str]:
        """List the results that targets need. Raises ConfigError with the target probably meant."""
        known = [*self.named, *(f"{RESULTS}/{name}" for name in self.origins)]
        files: list[str] = []
        for target in targets:
            if target not in known:
                meant = f"{short_repr(target)}{nearest(target, known)}"
                allowed = "a rule of a single job, or a file that a rule makes"
                raise ConfigError(f"target: {meant}; allowed: {allowed}")
            files += self.named.get(target, (target,))
        return self.tree.behind(map(below, files))

    def check_places(self, *folders: str) -> None:
        """Refuse a file in the place of a folder that a run needs, and the reverse."""
        files = {RESULTS / name for name in self.origins}
        files |= {RESULTS / record_path(origin) for origin in self.origins.values()}
        parents = set(map(Path, folders)).union(*(path.parents[:-1] for path in files))
        for path in sorted(files | parents):
            needed, kind = ("folder", "file") if path in parents else ("file", "folder")
            if os.path.lexists(path) and path.is_dir() == (kind == "folder"):
                remedy = f"remove or rename it: a {needed} of that name is needed"
                raise ConfigError(f"{path} is a {kind}; {remedy}")

    def verify(self, complete: Iterable[str]) -> int:
        """Print what is not as a complete run would make it; returns the exit code."""
        problems, count, foreign = self.tree.problems(complete)
        print("\n".join(problems) or f"{count} files are as made by what is here now")
        others = [name for name in self.wanted(["everything"]) if name not in complete]
        missing = [name for name in others if not (RESULTS / name).exists()]
        aside = {"of another configuration": foreign}
        aside["that TARGET=everything makes besides"] = missing
        for kind, files in aside.items():
            if files:
                print(f"Not looked at: {len(files)} files {kind}, as {files[0]}")
        return int(bool(problems))

    def begin(self, wanted: Iterable[str], makes: bool = True) -> TextIO | None:
        """Lock the folder until the returned file is closed, and have its faulty results found old.

        Where the run ``makes`` none, the folder of another run is left as it is.
        """
        if not (makes or os.access(RESULTS, os.W_OK)):
            return None
        held = take(RESULTS / ".run.lock")
        if held is None and makes:
            raise ConfigError("Another run is at work in this folder: wait for it, or stop it.")
        left = [*Path(".snakemake").glob("locks/*.lock")] if makes else []
        if left:
            # The last run was killed. A file has a hidden name of its own until it is whole.
            for path in [*left, *RESULTS.rglob(".*-????????.*")]:
                path.unlink(missing_ok=True)
            sys.stderr.write("The last run was killed: what it left unfinished is made anew.\n")
        faulty = self.tree.to_renew(wanted)
        write_faulty(faulty, "; made anew where needed.")
        if held:
            self._set_times({*wanted}, {f"{RESULTS}/{name}" for name in faulty})
            if not makes:
                held.close()
        return held

    def _set_times(self, wanted: set[str], faulty: set[str]) -> None:
        """Set times such that Snakemake finds faulty results outdated, and no others."""
        for path in faulty:
            os.utime(path, (OLD, OLD), follow_symlinks=False)
        jobs = [job for job in self.jobs if below(job.outputs[0]) in wanted]
        paths = {SOURCES}.union(*(job.inputs + job.outputs for job in jobs)) - faulty
        times = {path: os.path.getmtime(path) for path in filter(os.path.exists, paths)}
        now = time.time()
        old = sorted(path for path, changed in times.items() if changed > now)
        if old:
            text = f"{len(old)} files have a time in the future, as {old[0]}: set to now."
            print(text, file=sys.stderr)
        for job in jobs:
            newest = max(times.get(path, 0.0) for path in (SOURCES, *job.inputs))
            made = [path for path in job.outputs if path in times]
            old += [path for path in made if os.lstat(path).st_mtime < newest]
        # Some order would be wrong if only these were new.
        for path in {*old, *(path for path in times if old and below(path) != path)}:
            with suppress(OSError):
                os.utime(path, (now, now))


def unlike(lock: str | Path) -> str:
    """First package whose installed version is not in a lock, in one line; or an empty text."""
    pins: defaultdict[str, set[str]] = defaultdict(set)
    text = Path(lock).read_text(encoding="utf-8")
    for name, pinned in re.findall(r"^([\w.-]+)==([^\s;\\]+)", text, re.M):
        pins[name].add(pinned)
    for name, wanted in pins.items():
        # Another system, or another Python, needs other packages: the lock names those of all.
        with suppress(PackageNotFoundError):
            if version(name) not in wanted:
                allowed = f"{' or '.join(sorted(wanted))}, as in requirements.lock"
                remedy = "(rm -r .venv; make setup)"
                return f"{name}: {version(name)} is installed; allowed: {allowed} {remedy}"
    return ""


def write_faulty(reasons: Mapping[str, str], outcome: str) -> None:
    """Write one line on faulty results, with the reason of the first that has its own."""
    if reasons:
        first = min(reasons, key=lambda name: "older than" in reasons[name])
        count = "1 result is" if len(reasons) == 1 else f"{len(reasons)} results are"
        reason = f"such as results/{first}: {reasons[first]}"
        sys.stderr.write(f"{count} out of date, {reason}{outcome}\n")
