"""What a finished run waited for: the chain of jobs that ends with the last one, and how many ran at a time.

    python -m tests.benchmark.critical_path [results]

A record is written when its job ends and says how long that took. Before it began a job waited for the last of its
inputs, and then for a core.
"""

import json
import sys
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple


class Job(NamedTuple):
    """A job by its first output: when it began and ended (s), and what it is made from."""

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
    """The job that ended last, before it that of its inputs that was there last, and so on; the first one first."""
    found = [max(jobs.values(), key=lambda job: job.ended)]
    while before := [jobs[name] for name in found[-1].inputs if name in jobs]:
        found.append(max(before, key=lambda job: job.ended))
    return found[::-1]


def at_once(jobs: dict[str, Job]) -> dict[int, float]:
    """For how many seconds how many jobs ran."""
    changes = sorted(
        change for job in {*jobs.values()} for change in ((job.began, 1), (job.ended, -1))
    )
    running, seconds = 0, dict[int, float]()
    for (time, change), (later, _) in pairwise(changes):
        running += change
        seconds[running] = seconds.get(running, 0.0) + later - time
    return dict(sorted(seconds.items()))


def main(results: str = "results") -> None:
    """Print both."""
    jobs = jobs_in(Path(results))
    path = critical_path(jobs)
    start = min(job.began for job in jobs.values())
    print("  ready   waited     took  job")
    for before, job in pairwise([Job("", 0.0, start, ()), *path]):
        print(
            f"{before.ended - start:7.1f} {job.began - before.ended:8.1f} {job.ended - job.began:8.1f}  {job.name}"
        )
    print(
        ", ".join(f"{count} at a time: {seconds:.1f} s" for count, seconds in at_once(jobs).items())
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
