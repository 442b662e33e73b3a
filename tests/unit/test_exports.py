"""The names that editors see of the package are those that it loads when they are used."""

import ast
from importlib import import_module
from importlib.util import resolve_name
from pathlib import Path

import pytest

import slippulse
from slippulse import theory


@pytest.mark.parametrize("package", [slippulse, theory])
def test_editors_see_the_names_that_are_loaded_when_used(package):
    stub = ast.parse(Path(package.__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
    seen = {}
    for statement in stub.body:
        if isinstance(statement, ast.ImportFrom):
            home = resolve_name("." * statement.level + (statement.module or ""), package.__name__)
            seen |= {name.name: import_module(home) for name in statement.names}
    assert {*seen} == {*package.__all__}
    for name, module in seen.items():
        assert getattr(package, name) is getattr(module, name), name
