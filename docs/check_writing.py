"""Check rules of docs/writing.md that a program can check; run by `make check`.

    python docs/check_writing.py [FOLDER]      in the folder of the project, or with its path

In the files that git tracks, the program looks for docstrings whose first word begins a fragment,
for words that docs/writing.md replaces, and for functions in src/ that return a tuple of three or
more values instead of a NamedTuple or a dataclass. It prints one line for each problem. Its exit
code is 1 if there is a problem, and otherwise 0.
"""

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

FRAGMENT_WORDS = ("What", "Whatever", "Whether", "How", "Where", "Those", "That", "Of", "By")
REPLACED_WORDS = ("anew",)
# The rules and their check name the words that they refuse.
EXEMPT_FILES = ("docs/writing.md", "docs/check_writing.py", "tests/docs/test_writing.py")
TEXT_ENDINGS = (".py", ".md", ".yaml", ".yml", ".smk")
FEWEST_NAMED_VALUES = 3

FRAGMENT = re.compile(rf"\s*({'|'.join(FRAGMENT_WORDS)})\b")
# Snakemake's files are not Python, but their functions have docstrings of the same form.
SNAKEMAKE_DOCSTRING = re.compile(r'^ *"""(.*)', re.MULTILINE)
REPLACED = re.compile(rf"\b({'|'.join(REPLACED_WORDS)})\b", re.IGNORECASE)
DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


def docstring_problems(text: str) -> Iterator[tuple[int, str]]:
    """Yield line and problem of each Python docstring that begins with a refused word."""
    for node in ast.walk(ast.parse(text)):
        if not isinstance(node, DOCUMENTED):
            continue
        begin = FRAGMENT.match(ast.get_docstring(node) or "")
        if begin:
            yield node.body[0].lineno, f"a docstring begins with {begin[1]}"


def snakemake_problems(text: str) -> Iterator[tuple[int, str]]:
    """Yield line and problem of each docstring of a Snakemake file with a refused first word."""
    for docstring in SNAKEMAKE_DOCSTRING.finditer(text):
        begin = FRAGMENT.match(docstring[1])
        if begin:
            line = text.count("\n", 0, docstring.start()) + 1
            yield line, f"a docstring begins with {begin[1]}"


def word_problems(text: str) -> Iterator[tuple[int, str]]:
    """Yield line and problem of each word that docs/writing.md replaces."""
    for number, line in enumerate(text.splitlines(), start=1):
        for word in REPLACED.findall(line):
            yield number, f"the word {word}"


def tuple_problems(text: str) -> Iterator[tuple[int, str]]:
    """Yield line and problem of each tuple of three or more values that a function returns."""
    for node in ast.walk(ast.parse(text)):
        values = node.value if isinstance(node, ast.Return) else None
        if isinstance(values, ast.Tuple) and len(values.elts) >= FEWEST_NAMED_VALUES:
            problem = f"{len(values.elts)} values returned as a tuple"
            yield node.lineno, f"{problem}; allowed: a NamedTuple or a dataclass"


def file_problems(name: str, text: str) -> Iterator[tuple[int, str]]:
    """Yield line and problem of everything that a file of the project may not contain.

    ``name`` is the path of the file below the project, with which the rules for it are chosen.
    """
    if name in EXEMPT_FILES:
        return
    yield from word_problems(text)
    if name.endswith(".py"):
        yield from docstring_problems(text)
    if name.endswith(".smk") or name == "Snakefile":
        yield from snakemake_problems(text)
    if name.startswith("src/") and name.endswith(".py"):
        yield from tuple_problems(text)


def tracked_files(project: Path) -> list[str]:
    """Return the paths below the project of all tracked files that contain our text."""
    command = ["git", "ls-files", "-z", "--", "Snakefile", *(f"*{end}" for end in TEXT_ENDINGS)]
    listed = subprocess.run(command, cwd=project, check=True, capture_output=True, text=True)
    return [name for name in listed.stdout.split("\0") if name and (project / name).is_file()]


def main(project: Path) -> int:
    """Print all problems of a project, and return the exit code."""
    lines = []
    for name in tracked_files(project):
        text = (project / name).read_text(encoding="utf-8")
        lines += [f"{name}:{line}: {problem}" for line, problem in file_problems(name, text)]
    if lines:
        print(*lines, "docs/writing.md explains these rules.", sep="\n")
    return int(bool(lines))


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path()))
