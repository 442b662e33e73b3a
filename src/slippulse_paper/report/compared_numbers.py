"""Compare the measured numbers of joined runs within their uncertainties."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from pandas.api.types import is_numeric_dtype

from slippulse.data.files import UnreadableFile
from slippulse.data.tables import load_table

from .joined_runs import LATTICE_COLUMNS, RUN_COLUMNS, columns_in_both, describe_pair

TEXT_COLUMNS = ("boundary", "release", "quantity")
# Relative difference that is always allowed, since numbers in tables have nine digits.
TABLE_PRECISION = 1e-8
# Difference that is allowed between numbers from equal lattices if they have no uncertainty. It is
# relative to the number or to 1, whichever is larger.
EQUAL_LATTICE_TOLERANCE = 1e-6
# Outcomes of the comparison of a number. Numbers of altered runs are not judged.
AGREES = "agrees"
DIFFERS = "differs"
UNKNOWN = "no uncertainty"
ALTERED = "altered run"


@dataclass(frozen=True)
class MeasuredRuns:
    """The runs of one table of one folder, with the uncertainties of their numbers.

    table : all columns
    numbers : the columns with compared numbers
    uncertainties : the uncertainties of these numbers, in columns of the same names

    The three tables have the same rows, one for each run.
    """

    table: pd.DataFrame
    numbers: pd.DataFrame
    uncertainties: pd.DataFrame

    def select(self, rows: pd.Series) -> "MeasuredRuns":
        """Return the runs with these row labels, in this order."""
        return MeasuredRuns(
            self.table.loc[rows], self.numbers.loc[rows], self.uncertainties.loc[rows]
        )


@dataclass(frozen=True)
class ComparedColumns:
    """Columns of measured results that two tables have in common."""

    numbers: list[str]
    texts: list[str]


def compared_columns(new: pd.DataFrame, old: pd.DataFrame) -> ComparedColumns:
    """Return the columns that are compared: measured numbers, and texts.

    A column that has text in one of the tables counts as text. Parameters are not compared.
    """
    numbers, texts = [], []
    for name in columns_in_both(new, old, new.columns):
        # The runs were paired by the parameters of RUN_COLUMNS.
        if name in RUN_COLUMNS:
            continue
        if not (is_numeric_dtype(new[name]) and is_numeric_dtype(old[name])):
            texts.append(name)
        # Paired runs may have different lattices.
        elif name not in LATTICE_COLUMNS:
            numbers.append(name)
    return ComparedColumns(numbers, texts)


def read_runs(path: Path) -> pd.DataFrame:
    """Read a table of measured runs. Raises ValueError if it lacks a parameter of the runs."""
    table = _read_table(path, RUN_COLUMNS)
    # Runs are joined by the texts of their parameters. A column that has only whole numbers in one
    # of the tables would have other texts there if it were not converted.
    return table.astype(dict.fromkeys(table.select_dtypes("number"), float))


def with_uncertainties(table: pd.DataFrame, numbers: list[str], study: Path) -> MeasuredRuns:
    """Return measured runs with the uncertainties of some numbers, read from their grid study."""
    values = table[numbers].astype(float)
    return MeasuredRuns(table, values, _read_uncertainties(study, values))


def differing_texts(new: MeasuredRuns, old: MeasuredRuns, columns: list[str]) -> Iterator[str]:
    """Yield a line for each text in some columns that differs between runs on equal lattices.

    new, old : the paired runs, in the same order
    """
    new_texts = new.table[columns].astype(object).fillna("")
    old_texts = old.table[columns].astype(object).fillna("")
    is_same_lattice = _is_same_lattice(new, old)
    # The tables have the paired runs at equal positions. The index of the new one is reported.
    for position, point in enumerate(new_texts.index):
        if not is_same_lattice[position]:
            continue
        for column in columns:
            new_text = new_texts[column].iat[position]
            old_text = old_texts[column].iat[position]
            if new_text != old_text:
                yield f"point {point}, {column}: new {new_text!r}, old {old_text!r}"


def compare_numbers(
    new: MeasuredRuns, old: MeasuredRuns, parameters: Iterable[str]
) -> pd.DataFrame:
    """Compare the numbers of runs that are the same in both folders.

    The result has one row for each number of each run, with its outcome: the numbers agree, or they
    differ, or it is unknown because different lattices gave them and they have no uncertainty. If
    only one of the two runs has a number, it counts as different on equal lattices only.

    new, old : the paired runs, in the same order
    parameters : columns that describe a run
    """
    # The column "allowed" has the largest difference that the uncertainties allow.
    numbers = _list_numbers(new, old, parameters)
    # A run has one row for each of its numbers.
    is_same_lattice = np.repeat(_is_same_lattice(new, old), len(new.numbers.columns))
    has_uncertainty = numbers[["old_uncertainty", "new_uncertainty"]].notna().any(axis=1)
    # Equal lattices should give equal numbers, even if no study gives their uncertainty.
    should_be_equal = is_same_lattice & ~has_uncertainty
    tolerance = EQUAL_LATTICE_TOLERANCE * numbers["new"].abs().clip(lower=1.0)
    numbers["allowed"] = numbers["allowed"].mask(should_be_equal, tolerance)

    # An infinite number agrees only with an equal one.
    numbers.loc[np.isinf(numbers["new"]), "allowed"] = 0.0
    difference = (numbers["new"] - numbers["old"]).abs()
    agrees = (difference <= numbers["allowed"]) | (numbers["new"] == numbers["old"])
    is_unknown = ~agrees & ~is_same_lattice & ~has_uncertainty
    numbers["outcome"] = DIFFERS
    numbers.loc[agrees, "outcome"] = AGREES
    numbers.loc[is_unknown, "outcome"] = UNKNOWN

    # On a coarser lattice some numbers cannot be measured. A missing number is no difference then.
    has_both = numbers[["new", "old"]].notna().all(axis=1)
    has_one = numbers[["new", "old"]].notna().any(axis=1)
    return numbers[has_both | (has_one & is_same_lattice)]


def list_altered_numbers(
    new: MeasuredRuns, old: MeasuredRuns, parameters: Iterable[str]
) -> pd.DataFrame:
    """Return the numbers of altered runs in the form of `compare_numbers`, but without judging.

    The arguments are those of `compare_numbers`.
    """
    numbers = compare_numbers(new, old, parameters)
    return numbers.dropna(subset=["new", "old"]).assign(outcome=ALTERED)


def _list_numbers(new: MeasuredRuns, old: MeasuredRuns, parameters: Iterable[str]) -> pd.DataFrame:
    """Return one row for each number of each pair of runs, with the allowed difference.

    The allowed difference is the sum of both uncertainties, and a little more for rounding. The
    arguments are those of `compare_numbers`.
    """
    quantities = new.numbers.columns
    parameters = list(parameters)
    runs = [
        describe_pair(new_run, old_run, parameters)
        for new_run, old_run in zip(
            new.table.to_dict("records"), old.table.to_dict("records"), strict=True
        )
    ]
    # The numbers of the first run come first, then those of the second run, and so on.
    numbers = pd.DataFrame(
        {
            "point": np.repeat(new.table.index, len(quantities)),
            "run": np.repeat(np.array(runs, object), len(quantities)),
            "quantity": np.tile(quantities, len(runs)),
            "old": old.numbers.to_numpy().ravel(),
            "old_uncertainty": old.uncertainties.to_numpy().ravel(),
            "new": new.numbers.to_numpy().ravel(),
            "new_uncertainty": new.uncertainties.to_numpy().ravel(),
        }
    )
    uncertainty = numbers["new_uncertainty"].fillna(0.0) + numbers["old_uncertainty"].fillna(0.0)
    numbers["allowed"] = uncertainty + TABLE_PRECISION * numbers["new"].abs()
    return numbers


def _is_same_lattice(new: MeasuredRuns, old: MeasuredRuns) -> np.ndarray:
    """Return for each pair of runs whether both runs have the same lattice."""
    columns = columns_in_both(new.table, old.table, LATTICE_COLUMNS)
    is_equal = new.table[columns].to_numpy() == old.table[columns].to_numpy()
    return is_equal.all(axis=1)


def _read_table(path: Path, required: Iterable[str]) -> pd.DataFrame:
    """Read a table.

    Raises ValueError if a required column is missing, or if it has text instead of numbers.
    """
    with named_in_errors(path):
        table = load_table(path)
        for column in required:
            if column not in table:
                raise ValueError(f"no column {column}")
            if column not in TEXT_COLUMNS and not is_numeric_dtype(table[column]):
                raise ValueError(f"text in column {column}")
    return table


def _read_uncertainties(path: Path, numbers: pd.DataFrame) -> pd.DataFrame:
    """Return the uncertainty of each number by a grid study.

    The uncertainty is NaN if the study does not have the number, or has another value for it.

    path : table of the grid study, which may not exist
    numbers : table with one row for each run (point) and one column for each quantity
    """
    if not path.exists():
        return numbers * np.nan
    table = _read_table(path, ["point", "quantity", "value", "uncertainty"])
    with named_in_errors(path):
        study = table.pivot(index="point", columns="quantity", values=["value", "uncertainty"])
        study = study.astype(float)
        studied_numbers = study["value"].reindex_like(numbers)
        uncertainties = study["uncertainty"].reindex_like(numbers)
    # If the study has another value of the number, it belongs to an older run and does not apply.
    is_another_number = (numbers - studied_numbers).abs() > TABLE_PRECISION * numbers.abs()
    return uncertainties.mask(is_another_number)


@contextmanager
def named_in_errors(path: Path) -> Iterator[None]:
    """Turn an error inside the with block into an UnreadableFile error that names the file."""
    try:
        yield
    except UnreadableFile:
        raise
    # The text of a LookupError is only the name of what is missing.
    except LookupError as error:
        raise UnreadableFile(path, f"no {error}") from None
    except (OSError, ValueError, TypeError, RecursionError) as error:
        raise UnreadableFile(path, getattr(error, "strerror", None) or error) from None
