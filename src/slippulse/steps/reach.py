"""Which source files a step depends on, from its imports; and what a module declares, without loading it."""

from __future__ import annotations

import ast
import hashlib
import re
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]
# Import statements as ruff formats them. To parse every module would take a second of each start of Snakemake.
IMPORT = re.compile(r"^ *from (\.+)([\w.]*) import (?:\(([^)]*)\)|(.*))", re.M)


def declared(module: str, name: str, default=None):
    """The value of a constant of a module of the package, which must be written out there.

    Parameters
    ----------
    module : dotted, below slippulse
    name : of the constant
    default : where the module has none
    """
    text = _text(_file(module))
    if f"\n{name} = " not in text:
        return default
    for node in ast.parse(text).body:
        if isinstance(node, ast.Assign) and any(getattr(target, "id", "") == name for target in node.targets):
            return ast.literal_eval(node.value)
    return default


def sources(*modules: str) -> list[str]:
    """Files that any of some modules reaches by its imports, at its top or inside, and the data files they name.

    Parameters
    ----------
    modules : dotted, below slippulse

    Returns
    -------
    paths relative to the project, sorted
    """
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
    root = PACKAGE.parents[1]
    return sorted(path.relative_to(root).as_posix() for path in reached)


def modules_of(step: str, settings: Mapping) -> list[str]:
    """Modules that a step runs: its own, and the figure or study that its settings name."""
    rooms = {"figure": "figures", "study": "studies"}
    named = [f"{room}.{settings[key]}" for key, room in rooms.items() if key in settings]
    return [f"steps.{step}", *named]


def digest_of_files(paths: Iterable[str | Path]) -> str:
    """Short digest of names and contents of files of the project, whatever their order."""
    digest, root = hashlib.sha256(), PACKAGE.parents[1]
    for path in sorted({str(path) for path in paths}):
        digest.update(path.encode() + b"\0" + _content(root / path) + b"\0")
    return digest.hexdigest()[:16]


def _file(module: str) -> Path:
    """The file of a module or package below slippulse; empty for slippulse itself."""
    path = PACKAGE.joinpath(*module.split(".")) if module else PACKAGE
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


@cache
def _content(path: Path) -> bytes:
    return hashlib.sha256(path.read_bytes()).digest()


@cache
def _text(path: Path) -> str:
    return path.read_text(encoding="utf-8")


@cache
def _imported(path: Path) -> tuple[Path, ...]:
    """Files of the package that a file imports, with the packages that they are in."""
    inside = path.relative_to(PACKAGE).parent.parts
    found = []
    for dots, module, several, one in IMPORT.findall(_text(path)):
        base = [*inside[: len(inside) - len(dots) + 1], *(module.split(".") if module else [])]
        names = re.sub(r"#.*| as \w+", "", several or one)
        found += _targets(base, re.findall(r"\w+", names))
    packages = [_file(".".join(inside[:depth])) for depth in range(len(inside) + 1)]
    return (*packages, *found)


def _targets(base: list[str], names: list[str]) -> list[Path]:
    """Files behind ``from base import names``."""
    home = PACKAGE.joinpath(*base)
    if not home.is_dir():
        return [home.with_suffix(".py")]
    found = [home / "__init__.py"]
    for name in names:
        if (home / name).is_dir():
            # Which of its names are used cannot be seen from here.
            found += (home / name).rglob("*.py")
        elif (home / f"{name}.py").exists():
            found.append(home / f"{name}.py")
    return found
