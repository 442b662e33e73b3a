"""Run the tutorial as a script: print what each cell shows, and save its pictures.

python docs/run_tutorial.py results/tutorial
"""

import ast
import sys
from pathlib import Path

import jupytext
from matplotlib.figure import Figure


def run(folder: str | Path) -> dict:
    """Run every cell in order; pictures go to a folder. Returns the names that the cells have made."""
    folder, names = Path(folder), {}
    folder.mkdir(parents=True, exist_ok=True)
    for number, cell in enumerate(jupytext.read(Path(__file__).with_name("tutorial.md")).cells):
        if cell.cell_type != "code":
            print(cell.source.splitlines()[0])
            continue
        *body, last = ast.parse(cell.source).body
        shown = isinstance(last, ast.Expr)
        exec(
            compile(
                ast.Module([*body, *([] if shown else [last])], []),
                f"tutorial, cell {number}",
                "exec",
            ),
            names,
        )
        value = (
            eval(compile(ast.Expression(last.value), f"tutorial, cell {number}", "eval"), names)
            if shown
            else None
        )
        if isinstance(value, Figure):
            value.savefig(folder / f"{number:02d}.png")
            print(f"    {folder}/{number:02d}.png")
        elif value is not None:
            print(f"    {value}")
    return names


if __name__ == "__main__":
    run(sys.argv[1])
