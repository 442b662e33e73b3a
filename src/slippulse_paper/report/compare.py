"""Compare two folders of results: do their numbers agree within their uncertainties?

python -m slippulse_paper.report.compare results other/results [results/compare.html]

The first folder has the new results, and the second has the old ones. With a third argument, the
program also writes a page that shows both, and a CSV file with all compared numbers.
"""

import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd

from ..records.job_records import RecordedFiles
from ..records.provenance import changes
from .compared_numbers import (
    AGREES,
    DIFFERS,
    UNKNOWN,
    MeasuredRuns,
    compare_numbers,
    compared_columns,
    differing_texts,
    list_altered_numbers,
    named_in_errors,
    read_runs,
    with_uncertainties,
)
from .joined_runs import JoinedRuns, describe_run, join_runs, varying_parameters

MAX_SHOWN_LINES = 10
# The files that are compared beside the tables, and the line about a difference in each of them.
CHANGE_LINES = {
    "provenance.json": "configuration: {key}: new {here!r}, old {shipped!r}",
    "claims.json": "{key}: new verdict {here!r}, old verdict {shipped!r}",
}


@dataclass(frozen=True)
class TableRuns:
    """The runs of one table: how many are in both folders, and descriptions of the others.

    A pair of altered runs is a new and an old run that differ only in ``altered_parameters``. Each
    of these parameters has one value in all new runs and another value in all old runs.
    """

    table: str
    same_count: int
    altered_count: int
    altered_parameters: list[str]
    only_new: list[str]
    only_old: list[str]


@dataclass
class Comparison:
    """Result of comparing a new and an old folder of results.

    numbers : one row for each number that is in both folders
    runs : one entry for each table
    changes : changed values of the configuration ("provenance.json") and changed verdicts
        ("claims.json")
    older : for each of these two files, the folders in which it is older than other results and
        therefore does not describe them
    disagreements : lines about results of the same run that differ
    other_differences : lines about everything that is altered, or in one folder only
    """

    numbers: pd.DataFrame = field(default_factory=pd.DataFrame)
    runs: list[TableRuns] = field(default_factory=list)
    changes: dict[str, list[dict]] = field(default_factory=dict)
    older: dict[str, list[Path]] = field(default_factory=dict)
    disagreements: list[str] = field(default_factory=list)
    other_differences: list[str] = field(default_factory=list)

    def count(self, outcome: str) -> int:
        """Return how many numbers have an outcome of `compared_numbers`, such as "agrees"."""
        return int((self.numbers["outcome"] == outcome).sum()) if len(self.numbers) else 0

    @property
    def agree(self) -> int:
        """Return how many numbers agree."""
        return self.count(AGREES)

    @property
    def unknown(self) -> int:
        """Return how many numbers differ between different lattices and have no uncertainty."""
        return self.count(UNKNOWN)

    @property
    def compared(self) -> int:
        """Return how many numbers belong to runs that are in both folders."""
        return self.agree + self.unknown + self.count(DIFFERS)

    def older_files(self, name: str) -> str:
        """Return the paths at which a file is older than other results, as text."""
        return " and ".join(str(folder / name) for folder in self.older[name])

    def summary(self) -> str:
        """Return a sentence on how many numbers agree."""
        agreement = f"{self.agree} of {self.compared} numbers agree"
        unknown = f"{self.unknown} numbers differ and have no uncertainty"
        return f"{agreement} within the sum of old and new uncertainty; {unknown}"


def compare(new: Path, old: Path) -> Comparison:
    """Compare the measured tables, configurations and verdicts of two folders of results.

    Raises ValueError if a folder is not complete or a file cannot be read.
    """
    result = Comparison()
    new_tables, old_tables = _table_names(new), _table_names(old)
    for name in sorted(new_tables ^ old_tables):
        result.other_differences.append(f"{name}: only one folder has this table")
    # Compare the configurations and the verdicts, in the files that CHANGE_LINES names. A file that
    # is older than its inputs does not describe the other results of its folder.
    outdated_files = {folder: RecordedFiles(folder).older_than_inputs() for folder in (new, old)}
    for name in CHANGE_LINES:
        result.older[name] = [
            folder for folder in (new, old) if str(folder / name) in outdated_files[folder]
        ]
        _compare_contents(result, new, old, name)
    numbers = [_compare_tables(result, new, old, name) for name in sorted(new_tables & old_tables)]
    if numbers:
        result.numbers = pd.concat(numbers, ignore_index=True)
    return result


def _table_names(results: Path) -> set[str]:
    """Return the file names of the tables of measured numbers in a folder of results."""
    names = {path.name for path in (results / "measurements").glob("*.csv")}
    if not names:
        allowed = "a folder of results that are finished"
        raise ValueError(f"{results}/measurements: no tables; allowed: {allowed}")
    return names


def _compare_contents(result: Comparison, new: Path, old: Path, name: str) -> None:
    """Record in the result how the configurations or the verdicts of both folders differ.

    The contents are not compared if a file is missing or older than other results.

    name : "provenance.json" for the configurations, "claims.json" for the verdicts
    """
    if result.older[name]:
        newer = f"other results are newer than {result.older_files(name)}"
        result.other_differences.append(f"{name}: not compared, since {newer}")
        return
    new_path, old_path = new / name, old / name
    if not (new_path.exists() and old_path.exists()):
        result.other_differences.append(f"{name}: not compared, since one folder does not have it")
        return
    # `changes` names its arguments for another use: here, the old content is in place of the
    # shipped configuration.
    result.changes[name] = changes(shipped=_read_content(old_path), config=_read_content(new_path))
    line = CHANGE_LINES[name]
    result.other_differences += [line.format(**change) for change in result.changes[name]]


def _read_content(path: Path) -> dict:
    """Return the part of a file that is compared: the configuration, or the verdict of each claim.

    The preset is left out, because the uncertainties of the numbers cover the differences between
    the lattices of presets.
    """
    with named_in_errors(path):
        content = json.loads(path.read_text(encoding="utf-8"))
        if path.name == "provenance.json":
            return dict(content["config"]) | {"preset": None}
        return {str(claim["id"]): claim["verdict"] for claim in content}


def _compare_tables(result: Comparison, new: Path, old: Path, name: str) -> pd.DataFrame:
    """Compare one table of both folders, record what differs, and return the numbers of its runs.

    result : the comparison in which the differences are recorded
    name : file name of the table
    """
    new_table = read_runs(new / "measurements" / name)
    old_table = read_runs(old / "measurements" / name)
    # The columns that distinguish the runs. Messages describe a run by them.
    parameters = varying_parameters(new_table, old_table)
    # Find the runs that are in both folders, pairs of altered runs, and the other runs.
    joined = join_runs(new_table, old_table)
    runs = TableRuns(
        table=Path(name).stem,
        same_count=len(joined.same_runs),
        altered_count=len(joined.altered_runs),
        altered_parameters=joined.altered_parameters,
        only_new=_describe_rows(new_table, joined.only_new, parameters),
        only_old=_describe_rows(old_table, joined.only_old, parameters),
    )
    result.runs.append(runs)
    differences = _differences_of_runs(runs) + _differences_of_columns(new_table, old_table)
    # Files of the grid studies, which give the uncertainties of the numbers.
    new_study, old_study = new / "uncertainties" / name, old / "uncertainties" / name
    if new_study.exists() != old_study.exists():
        differences.append("only one folder has uncertainties")
    result.other_differences += [f"{name}: {difference}" for difference in differences]

    # Compare the numbers and texts of the joined runs.
    columns = compared_columns(new_table, old_table)
    new_runs = with_uncertainties(new_table, columns.numbers, new_study)
    old_runs = with_uncertainties(old_table, columns.numbers, old_study)
    numbers = _numbers_of_joined_runs(joined, new_runs, old_runs, parameters)
    new_same = new_runs.select(joined.same_runs["new"])
    old_same = old_runs.select(joined.same_runs["old"])
    disagreements = [*differing_texts(new_same, old_same, columns.texts)]
    disagreements += _differing_numbers(numbers)
    result.disagreements += [f"{name}: {disagreement}" for disagreement in disagreements]
    return numbers.assign(table=runs.table)[["table", *numbers.columns]]


def _numbers_of_joined_runs(
    joined: JoinedRuns, new: MeasuredRuns, old: MeasuredRuns, parameters: Sequence[str]
) -> pd.DataFrame:
    """Compare the numbers of runs that are the same, and list the numbers of altered runs.

    A pair of altered runs is a new and an old run that differ only in parameters that were changed
    for the whole table. Their numbers are not judged, because they are expected to differ.

    joined : pairs of runs of the two tables, as labels of their rows
    new, old : all runs of the new and of the old table
    parameters : columns that describe a run
    """
    new_same, old_same = new.select(joined.same_runs["new"]), old.select(joined.same_runs["old"])
    compared = compare_numbers(new_same, old_same, parameters)
    new_altered = new.select(joined.altered_runs["new"])
    old_altered = old.select(joined.altered_runs["old"])
    altered = list_altered_numbers(new_altered, old_altered, parameters)
    return pd.concat([compared, altered])


def _describe_rows(table: pd.DataFrame, rows: pd.Index, parameters: Sequence[str]) -> list[str]:
    """Return a description of each run in some rows of a table.

    rows : labels of the rows
    parameters : columns that the descriptions contain
    """
    return [describe_run(run, parameters) for run in table.loc[rows].to_dict("records")]


def _differences_of_runs(runs: TableRuns) -> list[str]:
    """Return lines about the runs that are in one folder only, and about altered runs."""
    lines = [f"only in the new folder: {run}" for run in runs.only_new]
    lines += [f"only in the old folder: {run}" for run in runs.only_old]
    count = runs.altered_count
    if count:
        pairs = "1 pair of runs differs" if count == 1 else f"{count} pairs of runs differ"
        lines.append(f"{pairs} in {', '.join(runs.altered_parameters)}")
    return lines


def _differences_of_columns(new: pd.DataFrame, old: pd.DataFrame) -> list[str]:
    """Return a line for each column that only one of two tables has."""
    columns = sorted(new.columns.symmetric_difference(old.columns))
    return [f"only one folder has the column {column}" for column in columns]


def _differing_numbers(numbers: pd.DataFrame) -> list[str]:
    """Return a line for each number that differs by more than its uncertainty allows."""
    lines = []
    for row in numbers[numbers["outcome"] == DIFFERS].itertuples():
        pair = f"new {row.new:.6g}, old {row.old:.6g}"
        allowed = f"allowed: a difference of {row.allowed:.2g}"
        lines.append(f"point {row.point}, {row.quantity}: {pair}; {allowed}")
    return lines


def _print_lines(title: str, lines: Sequence[str]) -> None:
    """Print a title and the first MAX_SHOWN_LINES lines, or nothing if there are no lines."""
    if not lines:
        return
    print(f"{title}:")
    for line in lines[:MAX_SHOWN_LINES]:
        print(f"  {line}")
    if len(lines) > MAX_SHOWN_LINES:
        print(f"  ... and {len(lines) - MAX_SHOWN_LINES} more")


def main(arguments: Sequence[str]) -> int:
    """Compare two folders, write the page if its path is given, and return the exit code.

    The exit code is 1 after an error. Without a page, it is also 1 if the folders differ or have no
    run in common. With a page, differences do not count as a failure.
    """
    paths = [Path(argument) for argument in arguments]
    new, old = paths[:2]
    page = paths[2] if len(paths) > 2 else None
    try:
        result = compare(new, old)
        if page is not None:
            # compare_page imports this module, so that it cannot be imported at the top.
            from .compare_page import write_comparison

            write_comparison(result, new, old, page)
    except ValueError as error:
        print(error)
        return 1
    print(result.summary())
    _print_lines("Results that disagree", result.disagreements)
    _print_lines("Other differences", result.other_differences)
    if page is not None:
        print(f"Open {page}")
        return 0
    has_differences = bool(result.disagreements or result.other_differences)
    return 0 if result.compared and not has_differences else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
