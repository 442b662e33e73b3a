"""The chain of jobs that a finished replication waited for, and how many ran at a time.

    python -m tests.benchmark.critical_path [results]

A record is written when its job ends, and has the time that it took. Before it began, a job waited
for the last of its inputs, and then for a core.
"""

import json
import sys
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple


class Job(NamedTuple):
    """A job by its first output: its beginning and end in seconds, and its inputs."""

    name: str
    began: float
    ended: float
    inputs: tuple[str, ...]


def jobs_in(results: Path) -> dict[str, Job]:
    """Jobs of the records below a folder of results, by each of their outputs."""
    jobs = {}
    for path in sorted((results / "records").rglob("*.json")):
        record, ended = json.loads(path.read_text(encoding="utf-8")), path.stat().st_mtime
        outputs = [*record["outputs"]]
        job = Job(outputs[0], ended - record["used"]["seconds"], ended, tuple(record["inputs"]))
        jobs |= dict.fromkeys(outputs, job)
    return jobs


def critical_path(jobs: dict[str, Job]) -> list[Job]:
    """The job that ended last; before it, the job that made the last of its inputs; and so on."""
    path = [max(jobs.values(), key=lambda job: job.ended)]
    while before := [jobs[name] for name in path[-1].inputs if name in jobs]:
        path.append(max(before, key=lambda job: job.ended))
    return path[::-1]


def at_once(jobs: dict[str, Job]) -> dict[int, float]:
    """Seconds during which each number of jobs ran."""
    distinct = {*jobs.values()}
    changes = sorted([(job.began, 1) for job in distinct] + [(job.ended, -1) for job in distinct])
    running, seconds = 0, dict[int, float]()
    for (time, change), (later, _) in pairwise(changes):
        running += change
        seconds[running] = seconds.get(running, 0.0) + later - time
    return dict(sorted(seconds.items()))


def main(results: str = "results") -> None:
    """Print the chain of jobs and the seconds of each number of jobs."""
    jobs = jobs_in(Path(results))
    path = critical_path(jobs)
    start = min(job.began for job in jobs.values())
    print("  ready   waited     took  job")
    for before, job in pairwise([Job("", 0.0, start, ()), *path]):
        ready, waited = before.ended - start, job.began - before.ended
        print(f"{ready:7.1f} {waited:8.1f} {job.ended - job.began:8.1f}  {job.name}")
    counts = at_once(jobs).items()
    print(", ".join(f"{count} at a time: {seconds:.1f} s" for count, seconds in counts))


if __name__ == "__main__":
    main(*sys.argv[1:])
