"""Write and read tables as CSV files."""

from collections.abc import Mapping
from pathlib import Path

import pandas as pd

from .files import UnreadableFile, write_text


def save_table(table: pd.DataFrame, path: str | Path, digits: int = 9) -> None:
    """Write a table as CSV, with numbers rounded to a number of significant digits."""
    write_text(table.to_csv(index=False, float_format=f"%.{digits}g", lineterminator="\n"), path)


def load_table(path: str | Path, types: Mapping[str, type] | None = None) -> pd.DataFrame:
    """Read a table from a CSV file.

    types : the types of some columns; the types of the others are inferred

    Raises UnreadableFile if the file is damaged.
    """
    try:
        return pd.read_csv(path, low_memory=False, dtype=types)
    except ValueError as error:
        raise UnreadableFile(path, error) from error
