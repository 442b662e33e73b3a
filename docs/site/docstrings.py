"""Show equations of docstrings as they were typed.

An equation is an indented block before the first section of a docstring.
"""

import re

from sphinx.application import Sphinx

UNDERLINE = re.compile(r"-{3,}$")


def keep_equations(
    _app: Sphinx, _kind: str, _name: str, _object: object, _options: dict, lines: list[str]
) -> None:
    """Mark indented blocks as literal up to the first section, by changing the list of lines."""
    marked: list[str] = []
    previous_line = None
    in_first_section = False
    for line in lines:
        in_first_section = in_first_section or UNDERLINE.match(line) is not None
        begins_block = line.startswith("    ") and previous_line == ""
        if begins_block and not in_first_section:
            marked += ["::", ""]
        marked.append(line)
        previous_line = line
    lines[:] = marked


def setup(app: Sphinx) -> dict:
    """Register the function so that it runs before numpydoc, which does not keep equations."""
    app.connect("autodoc-process-docstring", keep_equations, priority=100)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
