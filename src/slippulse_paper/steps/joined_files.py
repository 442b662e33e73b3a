"""Joining of the chunks of a sweep: the joined file has the bytes of the sweep in one piece."""

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

DIFFERENT = "with the other chunks, it has not the runs of one sweep"


def join_datasets(paths: Sequence[str | Path], record: Sequence[str]) -> xr.Dataset:
    """Join the data of the chunks, in the order of their numbers, to one Dataset of the sweep."""
    chunks = [load_dataset(path) for path in paths]
    numbers = _run_numbers(paths, [chunk.sizes["point"] for chunk in chunks])
    runs: dict[int, Recorded] = {}
    for chunk, chunk_numbers in zip(chunks, numbers, strict=True):
        runs.update(zip(chunk_numbers, runs_in(chunk), strict=True))
    return described(combine([runs[number] for number in sorted(runs)], record))


def join_tables(paths: Sequence[str | Path], joined: str | Path) -> None:
    """Join tables of one row a run, or of a block of them for each value of the column factor."""
    chunks = _texts(paths)
    last = ["factor"] if "factor" in chunks[0] else []
    blocks = len(chunks[0][last].drop_duplicates()) if last else 1
    runs = _run_numbers(paths, [len(chunk) // blocks for chunk in chunks])
    for path, chunk, numbers in zip(paths, chunks, runs, strict=True):
        if len(chunk) != blocks * len(numbers):
            raise UnreadableFile(path, DIFFERENT)
        chunk.index = pd.MultiIndex.from_product([range(blocks), numbers])
    # The chunk with the first run says the order of the columns.
    ordered = sorted(zip(runs, chunks, strict=True), key=lambda pair: pair[0][0])
    table = pd.concat([chunk for _, chunk in ordered]).sort_index().fillna("")
    save_table(table[[*table.columns.drop(last), *last]], joined)


def join_grid_studies(
    paths: Sequence[str], finest: str, keys: Sequence[str], quantities: Callable, joined: str
) -> None:
    """Join the grid studies of the chunks of a sweep whose joined measurements are ``finest``."""
    (measured,) = _texts([finest])
    chunks = _texts(paths)
    runs = _run_numbers(paths, [int(chunk["point"].astype(int).max()) + 1 for chunk in chunks])
    if sum(map(len, runs)) != len(measured):
        raise UnreadableFile(paths[0], DIFFERENT)
    for chunk, numbers in zip(chunks, runs, strict=True):
        chunk["point"] = np.array(numbers)[chunk["point"].astype(int)]
    study = pd.concat(chunks).set_index(["point", "quantity"]).drop(columns=[*keys])
    # The joined study has the rows of all runs; a chunk may have others.
    names = quantities(load_table(finest), keys)
    rows = pd.MultiIndex.from_product([range(len(measured)), names], names=study.index.names)
    table = study.reindex(rows, fill_value="").fillna("").reset_index()
    run_names = measured[list(keys)].iloc[table["point"]].reset_index(drop=True)
    columns = [table[["point"]], run_names, table.drop(columns="point")]
    save_table(pd.concat(columns, axis=1), joined)


def _texts(paths: Sequence[str | Path]) -> list[pd.DataFrame]:
    """Read tables as text: whole numbers in one chunk may be fractions in the next."""
    return [pd.read_csv(path, dtype=str, keep_default_na=False) for path in paths]


def _run_numbers(paths: Sequence[str | Path], counts: Sequence[int]) -> list[list[int]]:
    """Numbers of the runs of each chunk, whose counts must be those of the chunks of one sweep."""
    runs = [[*runs_of(chunk, len(counts), sum(counts))] for chunk in range(1, len(counts) + 1)]
    if [len(numbers) for numbers in runs] != [*counts]:
        raise UnreadableFile(paths[0], DIFFERENT)
    return runs
