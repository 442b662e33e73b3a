"""The names that editors see of `slippulse.theory` are those that it loads when they are used."""

import ast
from pathlib import Path

from slippulse import theory


def test_editors_see_the_names_that_are_loaded_when_used():
    tree = ast.parse(Path(theory.__file__).read_text(encoding="utf-8"))
    block = next(node for node in tree.body if isinstance(node, ast.If))
    seen = {}
    for statement in block.body:
        seen |= {name.name: statement.module for name in statement.names}
    assert {*seen} == {*theory.__all__}
    for name, module in seen.items():
        assert getattr(theory, name).__module__.startswith("slippulse."), name
        assert theory._HOMES[name].strip(".").split(".")[-1] == module.split(".")[-1], name
