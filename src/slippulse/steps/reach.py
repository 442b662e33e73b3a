"""Source files that a module reaches by its imports; constants and digests of source files."""

import ast
import re
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]
ROOT = PACKAGE.parents[1]
# An import as ruff formats it: the dots, the module, and its names in parentheses or without.
# To parse every module would take a second of each start of Snakemake.
IMPORT = re.compile(r"^ *from (\.+)([\w.]*) import (?:\(([^)]*)\)|(.*))", re.M)


@cache
def sources(*modules: str) -> list[str]:
    """List the files that modules, dotted below slippulse, reach by imports; and their FILES."""
    reached: set[Path] = set()
    pending = [_module_file(PACKAGE.joinpath(*module.split("."))) for module in modules]
    while pending:
        path = pending.pop()
        if path not in reached:
            reached.add(path)
            pending += _imported(path)
    for path in [*reached]:
        for pattern in _constant(path, "FILES") or ():
            reached.update(PACKAGE.glob(pattern))
    return sorted(str(path).removeprefix(f"{ROOT}/") for path in reached)


def declared(module: str, name: str):
    """Read a constant that is written out in a module, without importing the module."""
    return _constant(_module_file(PACKAGE.joinpath(*module.split("."))), name)


def needs_of(room: str) -> dict[str, dict]:
    """Read the NEEDS of the modules of a room, by name, where they have them."""
    names = sorted(path.stem for path in (PACKAGE / room).glob("*.py"))
    needs = {name: declared(f"{room}.{name}", "NEEDS") for name in names}
    return {name: value for name, value in needs.items() if value is not None}


@cache
def _constant(path: Path, name: str):
    """Value of a constant at the top of a module; None where it has none."""
    text = path.read_text(encoding="utf-8")
    # Few modules have the constant: only these are parsed.
    for node in ast.parse(text).body if f"\n{name} = " in text else ():
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == name:
            return ast.literal_eval(node.value)
    return None


def _module_file(path: Path) -> Path:
    """File of a module or package, whose path has no ending."""
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


@cache
def _imported(path: Path) -> list[Path]:
    """List the files of the package that a module imports, with the packages that it is in."""
    parents = path.relative_to(PACKAGE).parents
    files = [PACKAGE / parent / "__init__.py" for parent in parents]
    text = path.read_text(encoding="utf-8")
    for dots, module, in_parentheses, on_the_line in IMPORT.findall(text):
        # One dot is the folder of the module, two are the folder above.
        home = path.parents[len(dots) - 1].joinpath(*module.split("."))
        files.append(_module_file(home))
        names = re.sub(r"#.*| as \w+", "", in_parentheses or on_the_line)
        for name in re.findall(r"\w+", names):
            # The text does not tell which modules of an imported package are used: all count.
            files += [*(home / name).rglob("*.py"), *home.glob(f"{name}.py")]
    return files
