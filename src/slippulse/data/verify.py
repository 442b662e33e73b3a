"""Whether results are as a complete run would make them here and now."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from .records import Origin, Tree, record_path

# Folders of results in which no rule makes what stands there.
BESIDE = ("logs", "benchmarks", "reference")


def problems_of(
    results: str | Path, origins: Mapping[str, Origin], complete: Iterable[str]
) -> tuple[list[str], int]:
    """One line for each file that is not as a complete run would make it here and now.

    Parameters
    ----------
    results : folder
    origins : what each result is made by, by path below it
    complete : what a complete run makes, and all that this is made from; other results are compared where they are
        there

    Returns
    -------
    the lines, and how many files were compared
    """
    tree, results = Tree(results, origins), Path(results)
    wanted = {*complete}
    there = {
        path.relative_to(results).as_posix()
        for path in sorted(results.rglob("*"))
        if path.is_file() and path.relative_to(results).parts[0] not in BESIDE
    }
    records = {record_path(origin.record) for origin in origins.values()}
    compared = [name for name in origins if name in wanted or name in there]
    problems = [f"{results / name}: {reason}" for name, reason in tree.faults(compared).items()]
    unknown = sorted(name for name in there - origins.keys() - records if not Path(name).name.startswith("."))
    problems += [f"{results / name}: not known; no rule makes it" for name in unknown]
    return problems, len(compared)
