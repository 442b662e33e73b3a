"""Compare two folders of results: do their numbers agree within their uncertainties?

python -m slippulse_paper.report.compare results other/results [results/compare.html]

With a third argument it also writes the page of old beside new, and its numbers as CSV beside it.
"""

import json
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import pandas as pd

from slippulse.data.files import UnreadableFile
from slippulse.data.tables import load_table

from ..records.job_records import RecordedFiles
from ..records.provenance import changes
from .joined_runs import (
    LATTICE_COLUMNS,
    RUN_COLUMNS,
    JoinedRuns,
    describe_pair,
    describe_run,
    join_runs,
    varying_parameters,
)

TEXT_COLUMNS = ("boundary", "release", "quantity")
# Relative difference that is always allowed, since tables have nine digits.
TABLE_PRECISION = 1e-8
# Difference allowed between numbers without an uncertainty from equal lattices, relative to the
# number or to 1, whichever is larger.
EQUAL_LATTICE_TOLERANCE = 1e-6
MAX_SHOWN_LINES = 10
Tables: TypeAlias = Sequence[pd.DataFrame]
# Outcomes of comparing a number that is in both folders.
AGREES, DIFFERS, UNKNOWN, ALTERED = "agrees", "differs", "no uncertainty", "altered run"
# Lines about a difference between two files of one name.
DIFFERENCE_LINES = {
    "provenance.json": "configuration: {key}: {here!r} against {shipped!r}",
    "claims.json": "{key}: verdict {here!r} against {shipped!r}",
}


@dataclass
class Comparison:
    """Joined numbers, and lines about differing numbers and about what cannot be compared.

    ``numbers`` has one row per number that is in both folders, and ``runs`` one row per table.
    ``changes`` has the differences of the configuration and of the verdicts by the file's name.
    ``older`` has by this name the folders in which the file was not made again after a change of
    other results, so that it does not describe them.
    """

    apart: list[str] = field(default_factory=list)
    other: list[str] = field(default_factory=list)
    numbers: pd.DataFrame = field(default_factory=pd.DataFrame)
    runs: list[dict[str, Any]] = field(default_factory=list)
    changes: dict[str, list[dict]] = field(default_factory=dict)
    older: dict[str, list[Path]] = field(default_factory=dict)

    def count(self, *outcomes: str) -> int:
        """Return the number of numbers with one of these outcomes."""
        return int(self.numbers["outcome"].isin(outcomes).sum()) if len(self.numbers) else 0

    @property
    def compared(self) -> int:
        """Number of numbers of the same runs."""
        return self.count(AGREES, DIFFERS, UNKNOWN)

    @property
    def agree(self) -> int:
        """Number of numbers that agree."""
        return self.count(AGREES)

    @property
    def unknown(self) -> int:
        """Number of numbers that differ between lattices and have no uncertainty."""
        return self.count(UNKNOWN)

    def older_files(self, name: str) -> str:
        """List the paths of a file of this name that is older than other results."""
        return " and ".join(str(folder / name) for folder in self.older[name])

    def summary(self) -> str:
        """Say in one sentence how many numbers agree."""
        agree = (
            f"{self.agree} of {self.compared} numbers agree within the sum of both uncertainties"
        )
        return f"{agree}; {self.unknown} differ and have no uncertainty"


def compare(here: Path, other: Path) -> Comparison:
    """Compare measured tables, configurations and verdicts; ValueError for a broken folder."""
    result, trees = Comparison(), (here, other)
    names = []
    for tree in trees:
        names.append({path.name for path in (tree / "measurements").glob("*.csv")})
        if not names[-1]:
            raise ValueError(f"{tree}/measurements: no tables; allowed: a finished tree of results")
    result.other += [f"{name}: in one tree only" for name in sorted(names[0] ^ names[1])]
    older = {tree: RecordedFiles(tree).older_than_inputs() for tree in trees}
    for name, line in DIFFERENCE_LINES.items():
        contents = [_content(tree / name) for tree in trees if (tree / name).exists()]
        result.older[name] = [tree for tree in trees if str(tree / name) in older[tree]]
        if result.older[name]:
            newer = f"other results are newer than {result.older_files(name)}"
            result.other.append(f"{name}: not compared, since {newer}")
        elif len(contents) < 2:
            result.other.append(f"{name}: missing in one tree; not compared")
        else:
            result.changes[name] = changes(contents[1], contents[0])
            result.other += [line.format(**change) for change in result.changes[name]]
    numbers = [_compare_tables(result, trees, name) for name in sorted(names[0] & names[1])]
    result.numbers = pd.concat(numbers, ignore_index=True) if numbers else pd.DataFrame()
    return result


def _compare_tables(result: Comparison, trees: Sequence[Path], name: str) -> pd.DataFrame:
    """Compare one table of measured numbers, with the grid studies of both folders."""
    tables = [_table(tree / "measurements" / name, RUN_COLUMNS) for tree in trees]
    joined, varying = join_runs(*tables), varying_parameters(*tables)
    _list_runs(result, name, tables, joined, varying)
    for column in sorted({*tables[0]} ^ {*tables[1]}):
        result.other.append(f"{name}: columns in one tree only: {column}")
    studies = [tree / "uncertainties" / name for tree in trees]
    if len({path.exists() for path in studies}) > 1:
        result.other.append(f"{name}: uncertainties in one tree only")
    common = tables[0].columns.intersection(tables[1].columns, sort=False)
    common = common.difference(RUN_COLUMNS, sort=False)
    plain = ["number", "bool"]
    with_text = {column for table in tables for column in table.select_dtypes(exclude=plain)}
    numbers = common.difference([*with_text, *LATTICE_COLUMNS], sort=False)
    sides = []
    for table, path in zip(tables, studies, strict=True):
        values = table[numbers].astype(float)
        sides.append(_Side(table, values, _uncertainties(path, values)))
    same, altered = (
        [side.take(pairs[:, column]) for column, side in enumerate(sides)]
        for pairs in (joined.same, joined.altered)
    )
    _compare_texts(result, name, same, [column for column in common if column in with_text])
    compared = [_compare_numbers(same, varying), _compare_numbers(altered, varying, altered=True)]
    long = pd.concat([rows for rows in compared if len(rows)] or compared[:1], ignore_index=True)
    long.insert(0, "table", Path(name).stem)
    for row in long[long["outcome"] == DIFFERS].itertuples():
        pair = f"{row.new:.6g} against {row.old:.6g}"
        limit = f"allowed: a difference of {row.allowed:.2g}"
        result.apart.append(f"{name}: point {row.point}, {row.quantity}: {pair}; {limit}")
    return long


def _list_runs(
    result: Comparison, name: str, tables: Tables, joined: JoinedRuns, varying: list[str]
) -> None:
    """Record in the result how many runs were joined, and which runs are in one folder only.

    name : file name of the table
    tables : the table of the new folder and the table of the old folder
    varying : parameters that describe a run
    """
    unmatched: dict[str, list[str]] = {}
    for side, tree, table, rows in (
        ("new", "this", tables[0], joined.only_new),
        ("old", "the other", tables[1], joined.only_old),
    ):
        unmatched[side] = [describe_run(table.loc[row].to_dict(), varying) for row in rows]
        result.other += [f"{name}: only in {tree} tree: {run}" for run in unmatched[side]]
    counts = {"same": len(joined.same), "altered": len(joined.altered)}
    result.runs.append({"table": Path(name).stem, **counts, "keys": joined.keys, **unmatched})
    altered = counts["altered"]
    if altered:
        pairs = "1 pair of runs differs" if altered == 1 else f"{altered} pairs of runs differ"
        result.other.append(f"{name}: {pairs} in {', '.join(joined.keys)}")


@dataclass
class _Side:
    """Runs of one folder: their parameters, numbers, and uncertainties of these."""

    table: pd.DataFrame
    values: pd.DataFrame
    errors: pd.DataFrame

    def take(self, rows: np.ndarray) -> "_Side":
        """Return these rows, in this order."""
        return _Side(self.table.loc[rows], self.values.loc[rows], self.errors.loc[rows])


def _same_lattice(new: _Side, old: _Side) -> np.ndarray:
    """Return whether the two runs of each pair have the same lattice, as a column."""
    lattice = new.table.columns.intersection(old.table.columns).intersection(LATTICE_COLUMNS)
    return (new.table[lattice].to_numpy() == old.table[lattice].to_numpy()).all(axis=1)[:, None]


def _compare_texts(result: Comparison, name: str, sides: Sequence[_Side], texts: list[str]) -> None:
    """Add a line for each text that differs between runs with the same lattice."""
    ours, theirs = (side.table[texts].astype(object).fillna("") for side in sides)
    differs = (ours.to_numpy() != theirs.to_numpy()) & _same_lattice(*sides)
    for row, column in np.argwhere(differs):
        pair = f"{ours.iat[row, column]!r} against {theirs.iat[row, column]!r}"
        result.apart.append(f"{name}: point {ours.index[row]}, {texts[column]}: {pair}")


def _compare_numbers(
    sides: Sequence[_Side], varying: list[str], altered: bool = False
) -> pd.DataFrame:
    """Return one row per number; it is unknown where lattices differ and no study was made."""
    new, old = (side.values.to_numpy() for side in sides)
    new_error, old_error = (side.errors.to_numpy() for side in sides)
    no_study, size = np.isnan(new_error) & np.isnan(old_error), np.abs(new)
    same_lattice = _same_lattice(*sides)
    allowed = np.nan_to_num(new_error) + np.nan_to_num(old_error) + TABLE_PRECISION * size
    allowed = np.where(
        no_study & same_lattice, EQUAL_LATTICE_TOLERANCE * np.maximum(size, 1.0), allowed
    )
    known = ~np.isnan([new, old])
    compared = known.all(axis=0) | (known.any(axis=0) & same_lattice & (not altered))
    differs = ~(np.abs(new - old) <= allowed)
    outcome = np.where(differs, np.where(no_study & ~same_lattice, UNKNOWN, DIFFERS), AGREES)
    records = [side.table.to_dict("records") for side in sides]
    runs = [describe_pair(ours, theirs, varying) for ours, theirs in zip(*records, strict=True)]
    row, column = np.nonzero(compared)
    columns = {
        "point": sides[0].table.index.to_numpy()[row],
        "run": np.array(runs, object)[row],
        "quantity": sides[0].values.columns.to_numpy()[column],
        "old": old[row, column],
        "old_uncertainty": old_error[row, column],
        "new": new[row, column],
        "new_uncertainty": new_error[row, column],
        "allowed": allowed[row, column],
        "outcome": ALTERED if altered else outcome[row, column],
    }
    return pd.DataFrame(columns)


def _table(path: Path, needed: Iterable[str]) -> pd.DataFrame:
    """Read a table; ValueError if a needed column is missing or a column of numbers has text."""
    with _readable(path):
        table = load_table(path)
        for column in needed:
            if column not in table:
                raise ValueError(f"no column {column}")
            if table[column].dtype.kind not in "biuf" and column not in TEXT_COLUMNS:
                raise ValueError(f"text in column {column}")
    return table


def _uncertainties(path: Path, values: pd.DataFrame) -> pd.DataFrame:
    """Return the uncertainty of every number; NaN without a study of exactly this number."""
    if not path.exists():
        return values * np.nan
    table = _table(path, ["point", "quantity", "value", "uncertainty"])
    parts = ["value", "uncertainty"]
    with _readable(path):
        study = table.pivot(index="point", columns="quantity", values=parts).astype(float)
        studied, uncertainty = (study[part].reindex_like(values) for part in parts)
    return uncertainty.mask((values - studied).abs() > TABLE_PRECISION * values.abs())


def _content(path: Path) -> dict:
    """Return what a file has to compare: the configuration, or the verdicts by claim.

    The preset is left out, because the uncertainties cover its lattices.
    """
    with _readable(path):
        content = json.loads(path.read_text(encoding="utf-8"))
        if path.stem == "provenance":
            return dict(content["config"]) | {"preset": None}
        return {str(claim["id"]): claim["verdict"] for claim in content}


@contextmanager
def _readable(path: Path) -> Iterator[None]:
    """Turn an error inside the block into one that names the unreadable file."""
    try:
        yield
    except UnreadableFile:
        raise
    except LookupError as error:
        raise UnreadableFile(path, f"no {error}") from None
    except (OSError, ValueError, TypeError, RecursionError) as error:
        raise UnreadableFile(path, getattr(error, "strerror", None) or error) from None


def main(arguments: Sequence[str]) -> int:
    """Compare two folders, and write the page if its path is given; returns the exit code."""
    here, other, *pages = map(Path, arguments)
    try:
        result = compare(here, other)
        if pages:
            from .compare_page import write_comparison

            write_comparison(result, here, other, pages[0])
    except ValueError as error:
        print(error)
        return 1
    print(result.summary())
    for title, lines in (("Apart", result.apart), ("Not in both, or altered", result.other)):
        if lines:
            rest = (
                [f"... and {len(lines) - MAX_SHOWN_LINES} more"]
                if len(lines) > MAX_SHOWN_LINES
                else []
            )
            print("\n  ".join([f"{title}:", *lines[:MAX_SHOWN_LINES], *rest]))
    if pages:
        print(f"Open {pages[0]}")
        return 0
    return 0 if result.compared and not (result.apart or result.other) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
