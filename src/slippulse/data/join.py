"""The chunks of a sweep put together again: the bytes are those of the sweep in one piece."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from .chunks import runs_of
from .points import runs_in
from .store import load_dataset
from .sweeps import combine
from .tables import load_table, save_table
from .variables import described


class ChunksDiffer(ValueError):
    """Files that are not the chunks of one sweep."""

    def __init__(self, paths: Sequence[str | Path]) -> None:
        others = f"{paths[0]} and the other {len(paths) - 1}"
        super().__init__(f"{others}: not the runs of one sweep; delete them and run again")


def join_datasets(paths: Sequence[str | Path], record: Sequence[str]) -> xr.Dataset:
    """All runs in the order of the sweep, from the data of its chunks in the order of their numbers."""
    chunks = [load_dataset(path) for path in paths]
    of_chunks = zip(chunks, _runs(paths, [chunk.sizes["point"] for chunk in chunks]), strict=True)
    found = {
        number: run
        for chunk, own in of_chunks
        for number, run in zip(own, runs_in(chunk), strict=True)
    }
    return described(combine([found[number] for number in sorted(found)], record))


def join_tables(paths: Sequence[str | Path], joined: str | Path, last: Sequence[str] = ()) -> None:
    """Put tables of one row a run together, or several below each other, which the columns ``last`` tell apart."""
    chunks = _texts(paths)
    keys = [name for name in last if name in chunks[0]]
    blocks = [chunk.groupby(keys or (lambda row: 0), sort=False).ngroup() for chunk in chunks]
    if len({block.max() for block in blocks}) > 1:
        raise ChunksDiffer(paths)
    runs = _runs(paths, [int((block == 0).sum()) for block in blocks])
    for chunk, block, numbers in zip(chunks, blocks, runs, strict=True):
        if len(chunk) != len(numbers) * (block.max() + 1):
            raise ChunksDiffer(paths)
        chunk.index = pd.MultiIndex.from_arrays([block, np.tile(numbers, block.max() + 1)])
    ordered = sorted(zip(runs, chunks, strict=True), key=lambda pair: pair[0][0])
    table = pd.concat([chunk for _, chunk in ordered]).sort_index().fillna("")
    columns = [
        *(name for name in table if name not in last),
        *(name for name in last if name in table),
    ]
    save_table(table[columns], joined)


def join_grid_studies(
    paths: Sequence[str], finest: str, keys: Sequence[str], quantities: Callable, joined: str
) -> None:
    """Put the grid studies of the chunks of a sweep together; ``finest`` is the joined table of measured numbers.

    keys : columns that name a run
    quantities : names what the grid study of a table has a row for; that of a chunk may have more, or fewer
    """
    (named,) = _texts([finest])
    chunks = _texts(paths)
    runs = _runs(paths, [int(chunk["point"].astype(int).max()) + 1 for chunk in chunks])
    if sum(map(len, runs)) != len(named):
        raise ChunksDiffer(paths)
    for chunk, own in zip(chunks, runs, strict=True):
        chunk["point"] = np.array(own)[chunk["point"].astype(int)]
    study = pd.concat(chunks).set_index(["point", "quantity"]).drop(columns=[*keys])
    of_each = quantities(load_table(finest), keys)
    rows = pd.MultiIndex.from_product([range(len(named)), of_each], names=study.index.names)
    table = study.reindex(rows, fill_value="").fillna("").reset_index()
    of_runs = named[list(keys)].iloc[table["point"]].reset_index(drop=True)
    save_table(pd.concat([table[["point"]], of_runs, table.drop(columns="point")], axis=1), joined)


def _texts(paths: Sequence[str | Path]) -> list[pd.DataFrame]:
    # A column of whole numbers in one chunk may be one of fractions in the next.
    return [pd.read_csv(path, dtype=str, keep_default_na=False) for path in paths]


def _runs(paths: Sequence[str | Path], counts: Sequence[int]) -> list[list[int]]:
    """The runs of each chunk, which has as many as counted."""
    runs = [[*runs_of(number, len(counts), sum(counts))] for number in range(1, len(counts) + 1)]
    if [len(own) for own in runs] != [*counts]:
        raise ChunksDiffer(paths)
    return runs
