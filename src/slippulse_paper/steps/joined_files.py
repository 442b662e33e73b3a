"""Joining of the chunks of a sweep.

A joined file is equal, byte by byte, to the file of the same sweep without chunks.
"""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from slippulse.data.files import UnreadableFile
from slippulse.data.points import Recorded, runs_in
from slippulse.data.store import load_dataset
from slippulse.data.sweeps import combine
from slippulse.data.tables import load_table, save_table
from slippulse.data.variables import described

from ..configuration.chunks import runs_of

NOT_ONE_SWEEP = "this chunk and the others do not have the runs of one sweep"


def join_datasets(paths: Sequence[str | Path], record: Sequence[str]) -> xr.Dataset:
    """Join the data of chunks, which are given in order, to one Dataset of the sweep."""
    chunks = [load_dataset(path) for path in paths]
    numbers = _run_numbers(paths, [chunk.sizes["point"] for chunk in chunks])
    runs: dict[int, Recorded] = {}
    for chunk, chunk_numbers in zip(chunks, numbers, strict=True):
        runs.update(zip(chunk_numbers, runs_in(chunk), strict=True))
    return described(combine([runs[number] for number in sorted(runs)], record))


def join_tables(paths: Sequence[str | Path], joined: str | Path) -> None:
    """Join tables with one row for each run, or with such a block for each value of ``factor``."""
    chunks = _read_as_text(paths)
    last_column = ["factor"] if "factor" in chunks[0] else []
    blocks = len(chunks[0][last_column].drop_duplicates()) if last_column else 1
    runs = _run_numbers(paths, [len(chunk) // blocks for chunk in chunks])
    for path, chunk, numbers in zip(paths, chunks, runs, strict=True):
        if len(chunk) != blocks * len(numbers):
            raise UnreadableFile(path, NOT_ONE_SWEEP)
        chunk.index = pd.MultiIndex.from_product([range(blocks), numbers])
    # The chunk with the first run determines the order of the columns.
    ordered = sorted(zip(runs, chunks, strict=True), key=lambda pair: pair[0][0])
    table = pd.concat([chunk for _, chunk in ordered]).sort_index().fillna("")
    save_table(table[[*table.columns.drop(last_column), *last_column]], joined)


def join_grid_studies(
    paths: Sequence[str], finest: str, keys: Sequence[str], quantities: Callable, joined: str
) -> None:
    """Join the grid studies of the chunks of a sweep.

    ``finest`` is the path of the joined measurements. ``keys`` are the columns that identify a run,
    and ``quantities`` is a function of the measurements and the keys that returns the numbers with
    a grid study.
    """
    (measured,) = _read_as_text([finest])
    chunks = _read_as_text(paths)
    runs = _run_numbers(paths, [int(chunk["point"].astype(int).max()) + 1 for chunk in chunks])
    if sum(map(len, runs)) != len(measured):
        raise UnreadableFile(paths[0], NOT_ONE_SWEEP)
    for chunk, numbers in zip(chunks, runs, strict=True):
        chunk["point"] = np.array(numbers)[chunk["point"].astype(int)]
    study = pd.concat(chunks).set_index(["point", "quantity"]).drop(columns=[*keys])
    # A chunk has no row for a number that none of its runs has. The joined study has the rows that
    # a study of the whole sweep would have.
    names = quantities(load_table(finest), keys)
    rows = pd.MultiIndex.from_product([range(len(measured)), names], names=study.index.names)
    table = study.reindex(rows, fill_value="").fillna("").reset_index()
    run_names = measured[list(keys)].iloc[table["point"]].reset_index(drop=True)
    columns = [table[["point"]], run_names, table.drop(columns="point")]
    save_table(pd.concat(columns, axis=1), joined)


def _read_as_text(paths: Sequence[str | Path]) -> list[pd.DataFrame]:
    """Read tables as text. A column may have integers in one chunk and fractions in another."""
    return [pd.read_csv(path, dtype=str, keep_default_na=False) for path in paths]


def _run_numbers(paths: Sequence[str | Path], counts: Sequence[int]) -> list[list[int]]:
    """Return the numbers of the runs in each chunk.

    Raises UnreadableFile if the counts are not those of the chunks of one sweep.
    """
    runs = [[*runs_of(chunk, len(counts), sum(counts))] for chunk in range(1, len(counts) + 1)]
    if [len(numbers) for numbers in runs] != [*counts]:
        raise UnreadableFile(paths[0], NOT_ONE_SWEEP)
    return runs
