"""Write the reference of the Python interface from its docstrings: `make reference`."""

import sys
from pathlib import Path

import pdoc

import slippulse
from slippulse import theory


def main(folder: str) -> None:
    """Write HTML pages of what `slippulse` and `slippulse.theory` export into a folder."""
    # These packages load a name when it is first used, and pdoc only sees names that are loaded.
    for package in (slippulse, theory):
        for name in package.__all__:
            setattr(package, name, getattr(package, name))
    pdoc.render.configure(docformat="numpy", show_source=False, math=False)
    pdoc.pdoc("slippulse", output_directory=Path(folder))
    print(f"Open {folder}/index.html")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        print("usage: python docs/reference.py FOLDER", file=sys.stderr)
        sys.exit(2)
    try:
        main(sys.argv[1])
    except OSError as error:
        sys.exit(f"{sys.argv[1]}: {error.strerror}; allowed: a folder that can be written")
