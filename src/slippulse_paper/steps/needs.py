"""Constants that the rules of the workflow read from modules of figures, studies and steps.

For example, NEEDS lists the inputs of a figure or study, and DRAWS the conditions that a figure has
on its simulations.
"""

import ast
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]


@cache
def declared(module: str, name: str):
    """Return the value of a constant of a module in slippulse_paper, without importing the module.

    ``module`` is a dotted name such as figures.fig05_scaling. Snakemake needs these constants at
    every start, and importing the modules would take seconds. The value is None if the module does
    not have the constant.
    """
    path = PACKAGE.joinpath(*module.split(".")).with_suffix(".py")
    text = path.read_text(encoding="utf-8")
    # Parsing is slow, and so modules without the constant are not parsed.
    if f"\n{name} = " not in text:
        return None
    for node in ast.parse(text).body:
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == name:
            return ast.literal_eval(node.value)
    return None


def needs_of(folder: str) -> dict[str, dict]:
    """Return the constant NEEDS of each module in a folder, by the name of the module.

    Modules without this constant are left out.
    """
    needs = {}
    for path in sorted((PACKAGE / folder).glob("*.py")):
        value = declared(f"{folder}.{path.stem}", "NEEDS")
        if value is not None:
            needs[path.stem] = value
    return needs
