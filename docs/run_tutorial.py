"""Run a notebook as a script, by default the tutorial.

It prints the value of each cell, as a notebook shows it, and saves the pictures in a folder.

python docs/run_tutorial.py results/tutorial
"""

import ast
import sys
from pathlib import Path

import jupytext
from matplotlib.figure import Figure

TUTORIAL = Path(__file__).with_name("tutorial.md")


def run(folder: str | Path, notebook: Path = TUTORIAL) -> dict:
    """Run every cell in order, save pictures in a folder, and return the names of the cells."""
    folder, names = Path(folder), {}
    folder.mkdir(parents=True, exist_ok=True)
    for number, cell in enumerate(jupytext.read(notebook).cells):
        if cell.cell_type != "code":
            print(cell.source.splitlines()[0])
            continue
        value = _run_cell(cell.source, f"{notebook.stem}, cell {number}", names)
        if isinstance(value, Figure):
            value.savefig(folder / f"{number:02d}.png")
            print(f"    {folder}/{number:02d}.png")
        elif value is not None:
            print(f"    {value}")
    return names


def _run_cell(source: str, name: str, names: dict) -> object:
    """Run a cell and return the value of its last line, as a notebook shows it."""
    body = ast.parse(source).body
    last = body.pop() if isinstance(body[-1], ast.Expr) else None
    exec(compile(ast.Module(body, []), name, "exec"), names)
    if last is None:
        return None
    return eval(compile(ast.Expression(last.value), name, "eval"), names)


if __name__ == "__main__":
    run(sys.argv[1])
