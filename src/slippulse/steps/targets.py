"""What a step takes of the configuration; what a run is asked for, what is in its way, and what it leaves behind."""

import os
import sys
import time
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from copy import deepcopy
from pathlib import Path
from typing import TextIO

from ..configuration.problems import ConfigError, nearest
from ..data.lock import take
from ..data.records import Tree, record_path
from ..model.checks import short_repr
from .reach import RESULTS, Job, below, is_result, origins_of


def selected(config: Mapping, keys: Iterable[str], own: Mapping) -> dict:
    """The values of some dotted keys of the configuration, nested as there, beside what is a result's own."""
    found = deepcopy(dict(own))
    for key in keys:
        inside, value = found, config
        *parents, last = key.split(".")
        for parent in parents:
            inside, value = inside.setdefault(parent, {}), value[parent]
        inside[last] = value[last]
    return found


class Plan:
    """All jobs that there are, against the folder of results as it is."""

    def __init__(self, jobs: Sequence[Job], named: Mapping[str, Iterable[str]]) -> None:
        """Also the files of every rule that may be asked for by its name."""
        self.jobs, self.named, self.origins = jobs, named, origins_of(jobs)
        self.tree = Tree(RESULTS, self.origins)

    def wanted(self, targets: Iterable[str]) -> list[str]:
        """Results that rules and files are, with all they are made from; ConfigError has the target probably meant."""
        known = [*self.named, *(f"{RESULTS}/{name}" for name in self.origins)]
        files: list[str] = []
        for target in targets:
            if target not in known:
                allowed = "a rule of a single job, or a file that a rule makes"
                raise ConfigError(
                    f"target: {short_repr(target)}{nearest(target, known)}; allowed: {allowed}"
                )
            files += self.named.get(target, (target,))
        return self.tree.behind(map(below, files))

    def check_places(self, *others: str) -> None:
        """Refuse something else where a result, its record or one of the other folders goes; raises ConfigError."""
        files = {RESULTS / name for name in self.origins}
        files |= {RESULTS / record_path(origin) for origin in self.origins.values()}
        folders = {Path(other) for other in others}.union(*(path.parents[:-1] for path in files))
        taken = [
            (path, "file", "folder")
            for path in folders
            if os.path.lexists(path) and not path.is_dir()
        ]
        taken += [(path, "folder", "file") for path in files if path.is_dir()]
        for path, found, needed in sorted(taken):
            raise ConfigError(
                f"{path} is a {found}; remove or rename it: a {needed} of that name is needed"
            )

    def verify(self, complete: Iterable[str]) -> int:
        """Say what is not as a complete run would make it; returns the exit code."""
        problems, count = self.tree.problems(complete)
        print("\n".join(problems) or f"{count} files are as made by what is here now")
        others = [name for name in self.wanted(["everything"]) if name not in complete]
        if left := [name for name in others if not (RESULTS / name).exists()]:
            print(
                f"Not looked at: {len(left)} files that TARGET=everything makes besides, as {left[0]}"
            )
        return int(bool(problems))

    def begin(self, wanted: Iterable[str], locks: Path) -> TextIO:
        """Lock the folder, and remove what is not as its record says of some results and of what they are made from."""
        held = take(locks / "run.lock")
        if held is None:
            raise ConfigError("Another run is at work in this folder: wait for it, or stop it.")
        # Other locks, below a folder, are left by a run that was killed.
        if stale := [*locks.glob("locks/*.lock")]:
            # Files that a killed job was writing have a hidden name of their own until they are whole.
            for path in [*stale, *Path(RESULTS).rglob(".*-????????.*")]:
                path.unlink(missing_ok=True)
            sys.stderr.write("The last run was killed: what it left unfinished is made anew.\n")
        faulty = self.tree.to_remove(wanted)
        say_faulty(faulty, "; removed, and made anew where needed.")
        for name in faulty:
            (RESULTS / name).unlink()
        self._settle_times({*wanted})
        return held

    def _settle_times(self, wanted: set[str]) -> None:
        """Let no result be older than what it is made from, for which it would be made anew, nor later than now."""
        now, jobs = time.time(), [job for job in self.jobs if below(job.outputs[0]) in wanted]
        paths = {
            path for job in jobs for path in (*job.inputs, *job.outputs) if os.path.isfile(path)
        }
        times = {path: os.path.getmtime(path) for path in paths}
        late = sorted(path for path in paths if times[path] > now)
        if late:
            sys.stderr.write(
                f"{len(late)} files have a time in the future, as {late[0]}: set to now.\n"
            )
        made = [(source, path) for job in jobs for source in job.inputs for path in job.outputs]
        if late or any(times.get(source, 0.0) > times.get(path, now) for source, path in made):
            for path in {*late, *filter(is_result, paths)}:
                with suppress(OSError):
                    os.utime(path, (now, now))


def say_faulty(reasons: Mapping[str, str], fate: str) -> None:
    """One line on results that are not as made by what is here now, with the first reason that is not another's."""
    if reasons:
        first = min(reasons, key=lambda name: "older than" in reasons[name])
        text = f"{len(reasons)} results are not as made by what is here now, as results/{first}: {reasons[first]}"
        sys.stderr.write(f"{text}{fate}\n")
