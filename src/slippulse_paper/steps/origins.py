"""Jobs of the rules, and by which job, configuration and sources each result is made."""

from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

from ..records.job_records import Origin, digest_of, file_digest, record_path
from .reach import ROOT, declared, sources

RESULTS = Path("results")
LOCK = "requirements.lock"


class Job(NamedTuple):
    """A job: its step, the files that it reads and writes, its part of the configuration."""

    step: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    settings: Mapping


def below(path: str) -> str:
    """Path of a result below results/."""
    return path.removeprefix(f"{RESULTS}/")


def jobs_of(name: str, rule: Any, values: Mapping) -> Iterator[Job]:
    """Yield the jobs of a rule, one for each of the ``values`` of its wildcard, if it has one."""
    wildcard = next((key for key in values if f"{{{key}}}" in rule.output[0]), "none")
    for value in values.get(wildcard, [""]):
        wildcards = SimpleNamespace(**{wildcard: value})
        read: list[str] = []
        for entry in rule.input:
            read += entry(wildcards) if callable(entry) else [entry]
        settings = {}
        for key, param in rule.params.items():
            settings[key] = param(wildcards) if callable(param) else param
        # Snakemake's files are text that remembers its rule.
        files = [str(path).format(**{wildcard: value}) for path in read]
        made = [str(path).format(**{wildcard: value}) for path in rule.output]
        # A rule whose params name no step has the step of its own name.
        yield Job(settings.pop("step", name), tuple(files), tuple(made), settings)


def origins_of(jobs: Iterable[Job], options: str = "") -> dict[str, Origin]:
    """Find the origin of each result; its configuration is also that of all it is made from."""
    makers = {below(output): job for job in jobs for output in job.outputs}
    digest = cache(lambda path: file_digest(ROOT / path))

    @cache
    def origin(name: str) -> Origin:
        job = makers[name]
        texts = sorted(path for path in job.inputs if below(path) == path)
        names = sorted(map(below, {*job.inputs}.difference(texts)))
        inputs = {name: record_path(origin(name)) for name in names}
        earlier = sorted({origin(name).configuration for name in names})
        by = job.step, digest_of([job.settings, *earlier])
        read = [*sources(*modules_of(job.step, job.settings)), *texts, LOCK]
        files = {path: digest(path) for path in read}
        outputs = tuple(map(below, job.outputs))
        return Origin(outputs, *by, digest_of(files), inputs, files, options)

    return {name: origin(name) for name in makers}


def modules_of(step: str, settings: Mapping) -> list[str]:
    """List the modules that a step runs: its own, and those that its settings name."""
    topics = declared("steps.predict", "MODULES")
    modules = [f"steps.{step}"]
    modules += [f"slippulse.prediction.{topics[topic]}" for topic in settings.get("topics", ())]
    for key, room in (("figure", "figures."), ("study", "studies."), ("solver", "")):
        if key in settings:
            modules.append(room + settings[key].partition(":")[0])
    return modules
