"""Compare two folders of results: do their numbers agree within their uncertainties?

python -m slippulse_paper.report.compare results other/results
"""

import json
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeAlias

import numpy as np
import pandas as pd

from slippulse.data.files import UnreadableFile
from slippulse.data.tables import load_table

from ..records.provenance import changes

# Two runs with equal values in these columns are the same run, even on different lattices.
RUN_COLUMNS = [
    "boundary",
    "left",
    "right",
    "width",
    "gamma",
    "damping_ratio",
    "duration",
    "release",
]
# Numbers without an uncertainty are compared only if these columns are equal, too.
LATTICE_COLUMNS = ["scheme", "dx", "order", "max_step"]
TEXT_COLUMNS = ("boundary", "release", "quantity")
# Relative difference that is always allowed, since tables have nine digits.
TABLE_PRECISION = 1e-8
# Difference allowed between numbers without an uncertainty from equal lattices, relative to the
# number or to 1, whichever is larger.
EQUAL_LATTICE_TOLERANCE = 1e-6
MAX_SHOWN_LINES = 10
Tables: TypeAlias = Sequence[pd.DataFrame]
# The line that reports a difference between two files of the same name.
DIFFERENCE_LINES = {
    "provenance.json": "configuration: {key}: {here!r} against {shipped!r}",
    "claims.json": "{key}: verdict {here!r} against {shipped!r}",
}


@dataclass
class Comparison:
    """Counts of the compared numbers, and one line for each difference.

    compared, agree : numbers in both folders, and those of them that agree
    unknown : numbers that differ, but have no uncertainty to judge the difference by
    apart : a line for each number that differs by more than is allowed
    other : a line for everything that cannot be compared
    """

    compared: int = 0
    agree: int = 0
    unknown: int = 0
    apart: list[str] = field(default_factory=list)
    other: list[str] = field(default_factory=list)


def compare(here: Path, other: Path) -> Comparison:
    """Compare measured tables, configurations and verdicts; ValueError for an incomplete folder."""
    result, trees = Comparison(), (here, other)
    names = []
    for tree in trees:
        names.append({path.name for path in (tree / "measurements").glob("*.csv")})
        if not names[-1]:
            raise ValueError(f"{tree}/measurements: no tables; allowed: a finished tree of results")
    result.other += [f"{name}: in one tree only" for name in sorted(names[0] ^ names[1])]
    for name, line in DIFFERENCE_LINES.items():
        contents = [_content(tree / name) for tree in trees if (tree / name).exists()]
        if len(contents) < 2:
            result.other.append(f"{name}: missing in one tree; not compared")
        else:
            result.other += [line.format(**change) for change in changes(contents[1], contents[0])]
    for name in sorted(names[0] & names[1]):
        _compare_tables(result, trees, name)
    return result


def _compare_tables(result: Comparison, trees: Sequence[Path], name: str) -> None:
    """Compare one table of measured numbers, with the uncertainties from both grid studies."""
    ours, theirs = tables = [_table(tree / "measurements" / name, RUN_COLUMNS) for tree in trees]
    if not ours[RUN_COLUMNS].equals(theirs[RUN_COLUMNS]):
        result.other.append(f"{name}: other runs")
        return
    for column in sorted({*ours} ^ {*theirs}):
        result.other.append(f"{name}: columns in one tree only: {column}")
    studies = [tree / "uncertainties" / name for tree in trees]
    if len({path.exists() for path in studies}) > 1:
        result.other.append(f"{name}: uncertainties in one tree only")
    common = ours.columns.intersection(theirs.columns, sort=False).difference(
        RUN_COLUMNS, sort=False
    )
    lattice = common.intersection(LATTICE_COLUMNS)
    same_lattice = (ours[lattice] == theirs[lattice]).all(axis=1).to_numpy()[:, None]
    plain = ["number", "bool"]
    with_text = [*ours.select_dtypes(exclude=plain), *theirs.select_dtypes(exclude=plain)]
    texts = common.intersection(with_text, sort=False)
    numbers = common.difference([*with_text, *LATTICE_COLUMNS], sort=False)
    values = [table[numbers].astype(float) for table in tables]
    _compare_numbers(result, name, values, [*map(_uncertainties, studies, values)], same_lattice)
    ours, theirs = (table[texts].astype(object).fillna("") for table in tables)
    for row, column in np.argwhere(((ours != theirs) & same_lattice).to_numpy()):
        pair = f"{ours.iat[row, column]!r} against {theirs.iat[row, column]!r}"
        result.apart.append(f"{name}: point {row}, {ours.columns[column]}: {pair}")


def _compare_numbers(
    result: Comparison, name: str, values: Tables, uncertainties: Tables, same_lattice: np.ndarray
) -> None:
    """Count the numbers that agree, and report each that does not.

    A difference stays unknown if the lattices differ and neither folder has an uncertainty.
    """
    ours, theirs = (table.to_numpy() for table in values)
    uncertainty = uncertainties[0].add(uncertainties[1], fill_value=0.0).to_numpy()
    no_study, size = np.isnan(uncertainty), np.abs(ours)
    allowed = np.nan_to_num(uncertainty) + TABLE_PRECISION * size
    allowed = np.where(
        no_study & same_lattice, EQUAL_LATTICE_TOLERANCE * np.maximum(size, 1.0), allowed
    )
    known = ~np.isnan([ours, theirs])
    compared = known.all(axis=0) | (known.any(axis=0) & same_lattice)
    differs = compared & ~(np.abs(ours - theirs) <= allowed)
    unknown = differs & no_study & ~same_lattice
    result.compared += int(compared.sum())
    result.agree += int((compared & ~differs).sum())
    result.unknown += int(unknown.sum())
    for row, column in np.argwhere(differs & ~unknown):
        pair = f"{ours[row, column]:.6g} against {theirs[row, column]:.6g}"
        limit = f"allowed: a difference of {allowed[row, column]:.2g}"
        result.apart.append(f"{name}: point {row}, {values[0].columns[column]}: {pair}; {limit}")


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
    """Compare two folders, print the differences, and return the exit code."""
    try:
        result = compare(*map(Path, arguments))
    except ValueError as error:
        print(error)
        return 1
    agree = (
        f"{result.agree} of {result.compared} numbers agree within the sum of both uncertainties"
    )
    print(f"{agree}; {result.unknown} differ and have no uncertainty")
    for title, lines in (("Apart", result.apart), ("Not comparable", result.other)):
        if lines:
            rest = (
                [f"... and {len(lines) - MAX_SHOWN_LINES} more"]
                if len(lines) > MAX_SHOWN_LINES
                else []
            )
            print("\n  ".join([f"{title}:", *lines[:MAX_SHOWN_LINES], *rest]))
    return 0 if result.compared and not (result.apart or result.other) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
