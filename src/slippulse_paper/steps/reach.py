"""Source files that a module reaches by its imports; constants and digests of source files."""

import ast
from functools import cache
from pathlib import Path

import grimp

PACKAGE = Path(__file__).resolve().parents[1]
SOURCES = PACKAGE.parent
ROOT = SOURCES.parent
PACKAGES = ("slippulse", "slippulse_paper")


@cache
def _graph() -> grimp.ImportGraph:
    """Imports among all modules of both packages, as the sources are now."""
    return grimp.build_graph(*PACKAGES, cache_dir=None, exclude_type_checking_imports=True)


@cache
def sources(*modules: str) -> list[str]:
    """List the files that modules of both packages reach by imports, and their FILES."""
    names = {_full_name(module) for module in modules}
    for name in [*names]:
        names |= _graph().find_upstream_modules(name)
    parents = {
        name.rsplit(".", depth)[0] for name in names for depth in range(1, name.count(".") + 1)
    }
    reached = {_module_file(SOURCES.joinpath(*name.split("."))) for name in names | parents}
    for path in [*reached]:
        for pattern in _constant(path, "FILES") or ():
            reached.update(PACKAGE.glob(pattern))
    return sorted(str(path).removeprefix(f"{ROOT}/") for path in reached)


def _full_name(module: str) -> str:
    return module if module.split(".")[0] in PACKAGES else f"slippulse_paper.{module}"


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
