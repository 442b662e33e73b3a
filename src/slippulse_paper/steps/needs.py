"""Constants that the rules of the workflow read from modules of figures, studies and steps.

Examples are NEEDS, the inputs of a figure or study, and DRAWS, its conditions on simulations.
"""

import ast
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]


@cache
def declared(module: str, name: str):
    """Read a constant of a module, dotted below slippulse_paper, without importing the module.

    Snakemake needs these constants at every start, and importing the modules would take seconds.
    Returns None if the module does not have the constant.
    """
    text = PACKAGE.joinpath(*module.split(".")).with_suffix(".py").read_text(encoding="utf-8")
    # Parsing is slow, and so only modules that contain the constant are parsed.
    for node in ast.parse(text).body if f"\n{name} = " in text else ():
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == name:
            return ast.literal_eval(node.value)
    return None


def needs_of(folder: str) -> dict[str, dict]:
    """Read the NEEDS of all modules in a folder that have this constant, by module name."""
    names = sorted(path.stem for path in (PACKAGE / folder).glob("*.py"))
    needs = {name: declared(f"{folder}.{name}", "NEEDS") for name in names}
    return {name: value for name, value in needs.items() if value is not None}
