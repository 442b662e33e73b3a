"""The names that editors see of the package are those that it loads when they are used."""

import ast
from pathlib import Path

import pytest

import slippulse
from slippulse import theory


@pytest.mark.parametrize("package", [slippulse, theory])
def test_editors_see_the_names_that_are_loaded_when_used(package):
    tree = ast.parse(Path(package.__file__).read_text(encoding="utf-8"))
    block = next(node for node in tree.body if isinstance(node, ast.If))
    seen = {}
    for statement in block.body:
        seen |= {name.name: statement.module for name in statement.names}
    assert {*seen} == {*package.__all__}
    for name, module in seen.items():
        # A module itself has no __module__.
        home = f"{module}.{name}" if name == "theory" else module
        assert getattr(package, name) is not None
        assert home.endswith(f".{package._HOMES[name].lstrip('.')}"), name
