"""Tables as CSV files."""

from collections.abc import Collection
from pathlib import Path

import pandas as pd

from .files import UnreadableFile, write_text


def save_table(table: pd.DataFrame, path: str | Path, digits: int = 9) -> None:
    """Write a table as CSV, to some significant digits."""
    write_text(table.to_csv(index=False, float_format=f"%.{digits}g", lineterminator="\n"), path)


def load_table(path: str | Path, integers: Collection[str] | None = None) -> pd.DataFrame:
    """Read a table; where ``integers`` are given, only these columns hold integers."""
    try:
        table = pd.read_csv(path, low_memory=False)
        if integers is not None:
            # The table is read again, since -0 as an integer has lost its sign.
            fractions = table.select_dtypes("integer").columns.difference([*integers])
            table = pd.read_csv(path, low_memory=False, dtype=dict.fromkeys(fractions, float))
        return table
    except ValueError as error:
        raise UnreadableFile(path, error) from error
