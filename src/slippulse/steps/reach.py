"""Which source files a step depends on, from its imports; what every result is made by, from the jobs."""

import ast
import hashlib
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path, PurePath
from types import SimpleNamespace
from typing import NamedTuple

from ..data.records import Origin, digest_of

PACKAGE = Path(__file__).resolve().parents[1]
ROOT = PACKAGE.parents[1]
RESULTS = Path("results")
# Every step loads libraries that are in it.
LOCK = "requirements.lock"
# Import statements as ruff formats them. To parse every module would take a second of each start of Snakemake.
IMPORT = re.compile(r"^ *from (\.+)([\w.]*) import (?:\(([^)]*)\)|(.*))", re.M)


class Job(NamedTuple):
    """A job: its step, the files that it reads and writes, what it takes from the configuration."""

    step: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    settings: Mapping


def jobs_of(
    name: str,
    inputs: Iterable,
    outputs: Sequence[str],
    params: Mapping,
    values: Mapping[str, Iterable[str]],
) -> Iterator[Job]:
    """The jobs of a rule, one for each value of its wildcard; its inputs and params may be functions of wildcards."""
    wildcard = next((key for key in values if f"{{{key}}}" in outputs[0]), "none")
    for value in values.get(wildcard, [""]):
        wildcards = SimpleNamespace(**{wildcard: value})

        def files(entries: Iterable, wildcards: SimpleNamespace = wildcards) -> tuple[str, ...]:
            several = (entry(wildcards) if callable(entry) else [entry] for entry in entries)
            return tuple(path.format(**vars(wildcards)) for paths in several for path in paths)

        settings = {
            key: entry(wildcards) if callable(entry) else entry for key, entry in params.items()
        }
        # A rule without another step has that of its own name.
        yield Job(settings.pop("step", name), files(inputs), files(outputs), settings)


def origins_of(jobs: Iterable[Job]) -> dict[str, Origin]:
    """What each result is made by, by path below results/; the configuration is that of all that it is made from."""
    makers = {below(output): job for job in jobs for output in job.outputs}
    found: dict[str, Origin] = {}

    def origin(name: str) -> Origin:
        if name not in found:
            job = makers[name]
            inside = frozenset(below(path) for path in job.inputs if is_result(path))
            behind = sorted({origin(source).configuration for source in inside})
            outside = tuple(sorted(path for path in job.inputs if not is_result(path)))
            made, configuration = tuple(map(below, job.outputs)), digest_of([job.settings, *behind])
            digest = _source_digest(tuple(modules_of(job.step, job.settings)), outside)
            found.update(dict.fromkeys(made, Origin(made, job.step, configuration, digest, inside)))
        return found[name]

    for name in makers:
        origin(name)
    return found


def is_result(path: str) -> bool:
    """Whether a file is below results/."""
    return PurePath(path).is_relative_to(RESULTS)


def below(path: str) -> str:
    """A path of a result, below results/."""
    return PurePath(path).relative_to(RESULTS).as_posix()


def modules_of(step: str, settings: Mapping) -> list[str]:
    """Modules that a step runs: its own, and the figure, the study or the topics of theory that its settings name."""
    rooms = {"figure": "figures", "study": "studies"}
    named = [f"{rooms[key]}.{settings[key]}" for key in rooms if key in settings]
    return [f"steps.{step}", *named, *(f"predict.{topic}" for topic in settings.get("topics", ()))]


def declared(module: str, name: str, default=None):
    """The value of a constant that is written out in a module, dotted below slippulse; a default where it has none."""
    text = _text(_file(module))
    if f"\n{name} = " in text:
        for node in ast.parse(text).body:
            if isinstance(node, ast.Assign) and any(
                getattr(at, "id", "") == name for at in node.targets
            ):
                return ast.literal_eval(node.value)
    return default


def needs_of(room: str) -> dict[str, dict]:
    """The NEEDS of all modules of a room that have them, by name."""
    names = sorted(path.stem for path in (PACKAGE / room).glob("*.py"))
    found = {name: declared(f"{room}.{name}", "NEEDS") for name in names}
    return {name: needs for name, needs in found.items() if needs is not None}


def sources(*modules: str) -> list[str]:
    """Files that any of some modules, dotted below slippulse, reaches by its imports, and their FILES, sorted."""
    reached: set[Path] = set()
    pending = [_file(module) for module in modules]
    while pending:
        path = pending.pop()
        if path not in reached:
            reached.add(path)
            pending += _imported(path)
    for path in [*reached]:
        module = ".".join(path.relative_to(PACKAGE).with_suffix("").parts)
        for pattern in declared(module, "FILES", ()):
            reached.update(PACKAGE.glob(pattern))
    return sorted(path.relative_to(ROOT).as_posix() for path in reached)


def digest_of_files(paths: Iterable[str | Path]) -> str:
    """Short digest of names and contents of files of the project, whatever their order."""
    digest = hashlib.sha256()
    for path in sorted({str(path) for path in paths}):
        digest.update(path.encode() + b"\0" + _content(ROOT / path) + b"\0")
    return digest.hexdigest()[:16]


@cache
def _source_digest(modules: tuple[str, ...], texts: tuple[str, ...]) -> str:
    """Of all that some modules reach, of texts of the project that they read, and of the lock."""
    return digest_of_files([*sources(*modules), *texts, LOCK])


@cache
def _content(path: Path) -> bytes:
    return hashlib.sha256(path.read_bytes()).digest()


@cache
def _text(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def _file(module: str) -> Path:
    """The file of a module or package below slippulse; empty for slippulse itself."""
    path = PACKAGE.joinpath(*module.split(".")) if module else PACKAGE
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


@cache
def _imported(path: Path) -> list[Path]:
    """Files of the package that a file imports, with the packages that they are in."""
    inside = path.relative_to(PACKAGE).parent.parts
    found = [_file(".".join(inside[:depth])) for depth in range(len(inside) + 1)]
    for dots, module, several, one in IMPORT.findall(_text(path)):
        home = PACKAGE.joinpath(
            *inside[: len(inside) - len(dots) + 1], *module.split(".") if module else ()
        )
        found.append(home / "__init__.py" if home.is_dir() else home.with_suffix(".py"))
        for name in re.findall(r"\w+", re.sub(r"#.*| as \w+", "", several or one)):
            # Of a package it cannot be seen from here which of its names are used.
            found += (home / name).rglob("*.py")
            found += [home / f"{name}.py"] if (home / f"{name}.py").exists() else []
    return found
