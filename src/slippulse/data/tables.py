"""Tables as CSV files."""

from collections.abc import Collection
from pathlib import Path

import pandas as pd

from .files import UnreadableFile, write_whole


def save_table(table: pd.DataFrame, path: str | Path, digits: int = 9) -> None:
    """Write a table as CSV, to some significant digits."""
    form = f"%.{digits}g"
    write_whole(path, lambda part: table.to_csv(part, index=False, float_format=form, lineterminator="\n"))


def load_table(path: str | Path, whole: Collection[str] | None = None) -> pd.DataFrame:
    """Read a table; of ``whole``, only these columns hold whole numbers. Raises UnreadableFile."""
    try:
        table = pd.read_csv(path, low_memory=False)
        if whole is None:
            return table
        # Read again, since -0 as a whole number has lost its sign.
        fractions = [name for name in table if table[name].dtype.kind == "i" and name not in whole]
        return pd.read_csv(path, low_memory=False, dtype=dict.fromkeys(fractions, float))
    except ValueError as error:
        raise UnreadableFile(path, error) from error
