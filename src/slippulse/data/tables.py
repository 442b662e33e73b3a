"""Tables as CSV files."""

import csv
from collections.abc import Collection
from io import StringIO
from pathlib import Path

import pandas as pd

from .files import UnreadableFile, write_text


def save_table(table: pd.DataFrame, path: str | Path, digits: int = 9) -> None:
    """Write a table as CSV, to some significant digits."""
    form, columns = f"%.{digits}g", []
    # By columns, in two thirds of the time that `to_csv` takes. A missing value is unequal to itself.
    for _, column in table.items():
        values = column.tolist()
        texts = map(form.__mod__, values) if column.dtype.kind == "f" else values
        columns.append(
            [text if value == value else None for text, value in zip(texts, values, strict=True)]
        )
    lines = StringIO()
    csv.writer(lines, lineterminator="\n").writerows([table.columns, *zip(*columns, strict=True)])
    write_text(lines.getvalue(), path)


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
