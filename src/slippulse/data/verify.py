"""Whether results are what they were, and whether two trees of results agree within their uncertainties.

python -m slippulse.data.verify results                         against what its jobs noted
python -m slippulse.data.verify results --against other/results
"""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from .alterations import changes
from .records import changed_since_made, file_digest, outdated
from .store import UnreadableFile, load_table
from .variables import VARIABLES

# What makes a run the same run in another tree, whatever its lattice.
SAME = ("boundary", "left", "right", "width", "gamma", "damping_ratio", "duration", "release")
# What a number without uncertainty depends on besides.
LATTICE = ("scheme", "dx", "order", "max_step")
# Numbers that agree to this need no uncertainty: tables have nine digits. On one lattice those without agree to so much
# of themselves, or of 1.
DIGITS, ROUNDING = 1e-8, 1e-6
SHOWN = 10


def problems_of(results: str | Path) -> list[str]:
    """One line for each file that is missing, changed, or older than what it was made from.

    Raises
    ------
    ValueError
        Without a readable checksums.txt.
    """
    results = Path(results)
    problems = [*_unlike_checksums(results)]
    listed = {line.split(": ")[0] for line in problems}
    for name in changed_since_made(results):
        if str(results / name) not in listed:
            problems.append(f"{results / name}: not what its job wrote")
    problems += [
        f"{results / name}: older than {cause}, which it is made from"
        for name, cause in outdated(results).items()
    ]
    return problems


def _unlike_checksums(results: Path) -> list[str]:
    listing = results / "checksums.txt"
    try:
        lines = listing.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or error
        raise ValueError(f"{listing}: {reason}; allowed: a finished tree of results") from None
    problems = []
    for number, line in enumerate(lines, start=1):
        match = re.fullmatch(r"([0-9a-f]{64})  (\S.*)", line)
        if not match or ".." in Path(match[2]).parts or Path(match[2]).is_absolute():
            problems.append(f"{listing}: line {number} is not a checksum and a path inside the results")
            continue
        try:
            if file_digest(results / match[2]) != match[1]:
                problems.append(f"{results / match[2]}: not what it was")
        except OSError as error:
            problems.append(f"{results / match[2]}: {error.strerror}")
    return problems if lines else [f"{listing}: 0 files"]


@dataclass(frozen=True)
class Comparison:
    """Numbers of two trees of results.

    Attributes
    ----------
    compared, agree : how many measured numbers both have, and how many differ by no more than both uncertainties
    unknown : how many differ, are of two lattices, and have no uncertainty on either side
    apart : one line for each number or text that differs otherwise
    verdicts : one line for each claim with another verdict
    other : what is not comparable: other configurations, other runs, tables in one tree only, outdated files
    """

    compared: int
    agree: int
    unknown: int
    apart: tuple[str, ...]
    verdicts: tuple[str, ...]
    other: tuple[str, ...]


def compare(here: str | Path, there: str | Path) -> Comparison:
    """Compare the measured tables, the configurations and the verdicts of two trees.

    Raises
    ------
    ValueError
        If one has no measured tables, or a file that cannot be read.
    """
    trees = [Path(here), Path(there)]
    names = []
    for tree in trees:
        names.append({path.name for path in (tree / "measurements").glob("*.csv")})
        if not names[-1]:
            raise ValueError(f"{tree}/measurements: no tables; allowed: a finished tree of results")
    other = [f"{name}: in one tree only" for name in sorted(names[0] ^ names[1])] + _configurations(*trees)
    compared = agree = unknown = 0
    apart: list[str] = []
    for name in sorted(names[0] & names[1]):
        one, two = (_table(tree, name) for tree in trees)
        if not one[list(SAME)].equals(two[list(SAME)]):
            other.append(f"{name}: other runs")
            continue
        if missing := sorted(set(one) ^ set(two)):
            other.append(f"{name}: columns in one tree only: {', '.join(missing)}")
        if len({(tree / "uncertainties" / name).exists() for tree in trees}) > 1:
            other.append(f"{name}: uncertainties in one tree only")
        lattice = [column for column in LATTICE if column in one and column in two]
        alike = (one[lattice] == two[lattice]).all(axis=1)
        both = _numbers(trees[0], name, one).merge(
            _numbers(trees[1], name, two), on=["point", "quantity"], suffixes=("", "_there")
        )
        value, there = both["value"], both["value_there"]
        same = alike.to_numpy()[both["point"]]
        counted = (value.notna() & there.notna()) | (same & (value.notna() | there.notna()))
        allowed = (
            both["uncertainty"].fillna(0.0) + both["uncertainty_there"].fillna(0.0) + DIGITS * value.abs()
        )
        known = both["uncertainty"].notna() | both["uncertainty_there"].notna()
        exact = same & ~known
        allowed = allowed.mask(exact, ROUNDING * np.maximum(value.abs(), 1.0))
        within = (value - there).abs() <= allowed
        uncertain = counted & ~within & ~known & ~same
        compared += int(counted.sum())
        agree += int((counted & within).sum())
        unknown += int(uncertain.sum())
        for index in np.flatnonzero(counted & ~within & ~uncertain):
            row = both.iloc[index]
            apart.append(
                f"{name}: point {row['point']}, {row['quantity']}: {row['value']:.6g} against"
                f" {row['value_there']:.6g}; allowed: a difference of {allowed.iloc[index]:.2g}"
            )
        texts = [
            column
            for column in one
            if column in two
            and column not in SAME
            and "O" in (one[column].dtype.kind, two[column].dtype.kind)
        ]
        ours, theirs = (table[texts].astype(object).fillna("") for table in (one, two))
        apart += [
            f"{name}: point {point}, {column}: {ours[column][point]!r} against {theirs[column][point]!r}"
            for column in texts
            for point in np.flatnonzero(alike & (ours[column] != theirs[column]))
        ]
    for tree in trees:
        other += [f"{tree / name}: older than {cause}" for name, cause in outdated(tree).items()]
    return Comparison(compared, agree, unknown, tuple(apart), tuple(_verdicts(*trees)), tuple(other))


def _table(tree: Path, name: str) -> pd.DataFrame:
    """A measured table."""
    with _readable(tree / "measurements" / name) as path:
        table = load_table(path)
        _check_columns(table, SAME)
    return table


def _numbers(tree: Path, name: str, measured: pd.DataFrame) -> pd.DataFrame:
    """Every number of a measured table: point, quantity, value, uncertainty (NaN: not known)."""
    quantities = [c for c in measured if measured[c].dtype.kind in "biuf" and c not in (*SAME, *LATTICE)]
    values = measured[quantities].astype(float).assign(point=np.arange(len(measured)))
    values = values.melt(["point"], quantities, "quantity", "value")
    if not (tree / "uncertainties" / name).exists():
        return values.assign(uncertainty=np.nan)
    with _readable(tree / "uncertainties" / name) as path:
        study = load_table(path)
        columns = ["point", "quantity", "value", "uncertainty"]
        _check_columns(study, columns)
        study = study[columns]
    found = values.merge(study, on=["point", "quantity"], how="left", suffixes=("", "_studied"))
    # A study of other values tells nothing of these.
    stale = (found["value"] - found["value_studied"]).abs() > DIGITS * found["value"].abs()
    return found.assign(uncertainty=found["uncertainty"].mask(stale)).drop(columns="value_studied")


def _check_columns(table: pd.DataFrame, needed: Iterable[str]) -> None:
    """Refuse a table without these columns, or with text in a column of numbers."""
    for column in needed:
        if column not in table:
            raise ValueError(f"no column {column}")
    for column in table:
        if table[column].dtype.kind not in "biuf" and VARIABLES.get(column, ("text",))[0] != "text":
            raise ValueError(f"text in column {column}")


@contextmanager
def _readable(path: Path) -> Iterator[Path]:
    """Name the file that cannot be read, or does not hold what a run writes."""
    try:
        yield path
    except UnreadableFile:
        raise
    except (OSError, ValueError, LookupError, TypeError, RecursionError) as error:
        reason = (
            f"no {error}" if isinstance(error, LookupError) else getattr(error, "strerror", None) or error
        )
        raise UnreadableFile(path, reason) from None


def _configurations(here: Path, there: Path) -> list[str]:
    """Keys at which the configurations differ, but for the preset, whose lattices the uncertainties cover."""
    found = []
    for tree in (here, there):
        path = tree / "provenance.json"
        if not path.exists():
            return [f"{path}: missing; configurations not compared"]
        with _readable(path):
            found.append(dict(json.loads(path.read_text(encoding="utf-8"))["config"]))
    return [
        f"configuration: {change['key']}: {change['here']!r} against {change['shipped']!r}"
        for change in changes(found[1], found[0])
        if change["key"] != "preset"
    ]


def _verdicts(here: Path, there: Path) -> list[str]:
    found = []
    for tree in (here, there):
        path = tree / "claims.json"
        if not path.exists():
            return [f"{path}: missing; verdicts not compared"]
        with _readable(path):
            claims = json.loads(path.read_text(encoding="utf-8"))
            found.append({str(claim["id"]): claim["verdict"] for claim in claims})
    one, two = found
    return [
        f"{name}: {one.get(name, 'no such claim')!r} against {two.get(name, 'no such claim')!r}"
        for name in sorted({*one, *two})
        if one.get(name) != two.get(name)
    ]


def main(arguments: Sequence[str]) -> int:
    """Verify or compare; returns the exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m slippulse.data.verify", description=__doc__.splitlines()[0]
    )
    parser.add_argument("results", type=Path)
    parser.add_argument("--against", type=Path, help="another tree of results, to compare numbers with")
    chosen = parser.parse_args(arguments)
    try:
        if chosen.against is None:
            problems = problems_of(chosen.results)
            count = len((chosen.results / "checksums.txt").read_text(encoding="utf-8").splitlines())
            print("\n".join(problems) or f"{count} files are what they were")
            return 1 if problems else 0
        result = compare(chosen.results, chosen.against)
    except ValueError as error:
        print(error)
        return 1
    print(
        f"{result.agree} of {result.compared} numbers agree within both uncertainties together;"
        f" {result.unknown} differ and have no uncertainty"
    )
    for title, lines in (
        ("Apart", result.apart),
        ("Other verdicts", result.verdicts),
        ("Not comparable", result.other),
    ):
        if lines:
            rest = [f"... and {len(lines) - SHOWN} more"] if len(lines) > SHOWN else []
            print("\n  ".join([f"{title}:", *lines[:SHOWN], *rest]))
    return 0 if result.compared and not (result.apart or result.verdicts or result.other) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
