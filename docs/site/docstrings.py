"""Equations of docstrings as they were typed: an indented block before the first section."""

import re

from sphinx.application import Sphinx

UNDERLINE = re.compile(r"-{3,}$")


def keep_equations(
    _app: Sphinx, _kind: str, _name: str, _object: object, _options: dict, lines: list[str]
) -> None:
    """Mark indented blocks as literal, in place, up to the first section."""
    found: list[str] = []
    for number, line in enumerate(lines):
        if UNDERLINE.match(line):
            found += lines[number:]
            break
        if line.startswith("    ") and number and not lines[number - 1]:
            found += ["::", ""]
        found.append(line)
    lines[:] = found


def setup(app: Sphinx) -> dict:
    """Run before numpydoc, which knows nothing of equations."""
    app.connect("autodoc-process-docstring", keep_equations, priority=100)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
