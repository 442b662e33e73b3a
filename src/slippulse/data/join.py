"""The chunks of a sweep put together again: the bytes are those of the sweep in one piece."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack
from itertools import groupby, islice
from operator import itemgetter
from pathlib import Path

import pandas as pd
import xarray as xr

from .chunks import dealing
from .points import combine, point

# The last columns of a grid study: what was measured, and the study of it.
STUDY = ("quantity", "value", "extrapolated", "observed_order", "uncertainty")


class ChunksDiffer(ValueError):
    """Files that are not the chunks of one sweep."""

    def __init__(self, paths: Sequence[str | Path]) -> None:
        super().__init__(
            f"{paths[0]} and the other {len(paths) - 1}: not the runs of one sweep; delete them and run again"
        )


def join_datasets(paths: Sequence[str | Path], record: Sequence[str]) -> xr.Dataset:
    """All runs in the order of the sweep.

    Parameters
    ----------
    paths : the data of each chunk, in the order of their numbers
    record : what the sweep keeps, as for `run_sweep`
    """
    from .store import load_dataset

    chunks = [load_dataset(path) for path in paths]
    left = [iter(range(chunk.sizes["point"])) for chunk in chunks]
    runs = sum(chunk.sizes["point"] for chunk in chunks)
    order = [(number, _next(left[number - 1], paths)) for number in islice(dealing(len(chunks)), runs)]
    return combine([point(chunks[number - 1], index) for number, index in order], record)


def joined_table(paths: Sequence[str | Path], runs: int, last: Sequence[str] = ()) -> Iterator[Sequence[str]]:
    """The header and then each row, as text, of tables with one row a run or several rows below each other.

    Cells are not read as numbers: a column of whole numbers in one chunk may be one of fractions in the next.
    A column that no run of a chunk has is empty there; it stands behind those of the chunk that has the first run.

    Parameters
    ----------
    paths : the table of each chunk, in the order of their numbers
    runs : how many the sweep has
    last : columns that stand behind all others
    """
    with ExitStack() as stack:
        readers = [_reader(stack, path) for path in paths]
        headers = [next(reader) for reader in readers]
        first = next(dealing(len(paths))) - 1
        found = dict.fromkeys(name for header in (headers[first], *headers) for name in header)
        columns = [name for name in found if name not in last] + list(last)
        yield columns
        places = [[header.index(name) if name in header else None for name in columns] for header in headers]
        ahead: list[list[str] | None] = [next(reader, None) for reader in readers]
        while any(ahead):
            for number in islice(dealing(len(paths)), runs):
                row = ahead[number - 1]
                if row is None:
                    raise ChunksDiffer(paths)
                ahead[number - 1] = next(readers[number - 1], None)
                yield ["" if place is None else row[place] for place in places[number - 1]]


def joined_grid_study(
    paths: Sequence[str | Path], finest: pd.DataFrame, keys: Sequence[str], quantities: Sequence[str]
) -> Iterator[Sequence[str]]:
    """The header and then each row, as text, of the grid study of a sweep.

    Parameters
    ----------
    paths : the grid study of each chunk, in the order of their numbers
    finest : the joined table of measured numbers
    keys : columns that name a run
    quantities : what the grid study of the sweep has a row for; a chunk may have more, and lack what none of its
        runs has
    """
    yield ["point", *keys, *STUDY]
    named = io.StringIO(finest[list(keys)].to_csv(index=False, header=False, float_format="%.9g"))
    with ExitStack() as stack:
        studies = [groupby(_rows(stack, path), key=itemgetter(0)) for path in paths]
        for index, (number, names) in enumerate(zip(dealing(len(paths)), csv.reader(named), strict=False)):
            rows = {row[-len(STUDY)]: row for row in _next(studies[number - 1], paths)[1]}
            for name in quantities:
                study = rows[name][-len(STUDY) + 1 :] if name in rows else [""] * (len(STUDY) - 1)
                yield [str(index), *names, name, *study]
        if any(next(study, None) for study in studies):
            raise ChunksDiffer(paths)


def count_rows(paths: Sequence[str | Path]) -> int:
    """Rows of all tables together, without their headers."""
    total = 0
    for path in paths:
        with open(path, "rb") as file:
            total += sum(1 for _ in file) - 1
    return total


def save_rows(rows: Iterable[Sequence[str]], path: str | Path) -> None:
    """Write rows of text as CSV, as `save_table` does, one after the other."""
    from .files import write_whole

    def write(part: Path) -> None:
        with open(part, "w", encoding="utf-8", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows(rows)

    write_whole(path, write)


def _next(items: Iterator, paths: Sequence[str | Path]):
    try:
        return next(items)
    except StopIteration:
        raise ChunksDiffer(paths) from None


def _reader(stack: ExitStack, path: str | Path) -> Iterator[list[str]]:
    return csv.reader(stack.enter_context(open(path, encoding="utf-8", newline="")))


def _rows(stack: ExitStack, path: str | Path) -> Iterator[list[str]]:
    reader = _reader(stack, path)
    next(reader)
    return reader
