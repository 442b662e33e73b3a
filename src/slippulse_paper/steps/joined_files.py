"""Joining of the files of the chunks of a sweep.

A joined file is equal, byte by byte, to the file of the same sweep without chunks. Neighbouring
runs are in different chunks. A run has two numbers: one in its chunk, and one in the sweep.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from slippulse.data.files import UnreadableFile
from slippulse.data.points import Recorded, runs_in
from slippulse.data.store import load_dataset
from slippulse.data.sweeps import combine
from slippulse.data.tables import load_table, save_table
from slippulse.data.variables import with_descriptions
from slippulse.measurement.table import run_columns
from slippulse.measurement.uncertainty import studied_columns

from ..configuration.chunks import runs_of

NOT_ONE_SWEEP = "the chunks do not contain the runs of one sweep"


def join_datasets(paths: Sequence[str | Path], record: Sequence[str]) -> xr.Dataset:
    """Return the data of a sweep, joined from the files of its chunks.

    Parameters
    ----------
    paths : sequence of paths
        files of all chunks, in the order of the chunks
    record : sequence of str
        kinds of data that the runs have
    """
    chunks = [load_dataset(path) for path in paths]
    run_numbers = _run_numbers(paths, [chunk.sizes["point"] for chunk in chunks])
    # The runs of all chunks by their numbers in the sweep.
    runs: dict[int, Recorded] = {}
    for chunk, numbers in zip(chunks, run_numbers, strict=True):
        runs.update(zip(numbers, runs_in(chunk), strict=True))
    in_order = [runs[number] for number in sorted(runs)]
    return with_descriptions(combine(in_order, record))


def join_tables(paths: Sequence[str | Path], joined: str | Path) -> None:
    """Join the tables of the chunks of a sweep, which have one row for each run.

    A table of coarser lattices has one row for each run and lattice, sorted by the lattice first.
    The last column ``factor`` of such a table has the factor by which the spacing of the lattice is
    larger.
    """
    chunks = _read_as_text(paths)
    has_factor = "factor" in chunks[0]
    lattice_count = chunks[0]["factor"].nunique() if has_factor else 1
    run_numbers = _run_numbers(paths, [len(chunk) // lattice_count for chunk in chunks])
    for path, chunk, numbers in zip(paths, chunks, run_numbers, strict=True):
        if len(chunk) != lattice_count * len(numbers):
            raise UnreadableFile(path, NOT_ONE_SWEEP)
        # Each row gets the number of its lattice, and the number of its run in the sweep.
        chunk.index = pd.MultiIndex.from_product([range(lattice_count), numbers])
    # The columns of the joined table have the order of the first chunk in this list. It must be the
    # chunk with the first run of the sweep.
    chunks.sort(key=lambda chunk: chunk.index[0])
    # A chunk lacks the columns of numbers that were measured in none of its runs.
    table = pd.concat(chunks).sort_index().fillna("")
    if has_factor:
        # Move the column to the end.
        table["factor"] = table.pop("factor")
    save_table(table, joined)


def join_grid_studies(paths: Sequence[str], finest: str, joined: str) -> None:
    """Join the tables of uncertainties of the chunks of a sweep.

    Such a table has one row for each run and quantity.

    Parameters
    ----------
    paths : sequence of str
        tables of all chunks, in the order of the chunks
    finest : str
        joined table of the measured numbers on the finest lattice
    joined : str
        path of the table that is written
    """
    chunks = _read_as_text(paths)
    # The column `point` has the number of the run in the chunk, from 0. Every run has rows.
    counts = [int(chunk["point"].astype(int).max()) + 1 for chunk in chunks]
    run_numbers = _run_numbers(paths, counts)
    measured = load_table(finest)
    if sum(counts) != len(measured):
        raise UnreadableFile(paths[0], NOT_ONE_SWEEP)
    for chunk, numbers in zip(chunks, run_numbers, strict=True):
        # Replace the number of the run in the chunk by its number in the sweep.
        chunk["point"] = np.array(numbers)[chunk["point"].astype(int)]
    # Remove the columns that identify a run. The rows that are added next would have no values in
    # them. At the end they are inserted again, for all rows.
    keys = run_columns(measured.columns)
    study = pd.concat(chunks).set_index(["point", "quantity"]).drop(columns=keys)
    # A chunk has no row for a quantity that was measured in none of its runs. The joined table gets
    # all rows that a table of the undivided sweep has; the added ones are empty.
    quantities = studied_columns(measured, keys)
    rows = pd.MultiIndex.from_product([range(len(measured)), quantities], names=study.index.names)
    table = study.reindex(rows, fill_value="").fillna("").reset_index()
    # Insert the columns that identify a run after the first column.
    (measured_as_text,) = _read_as_text([finest])
    key_columns = measured_as_text[keys].iloc[table["point"]].reset_index(drop=True)
    columns = [table[["point"]], key_columns, table.drop(columns="point")]
    save_table(pd.concat(columns, axis=1), joined)


def _read_as_text(paths: Sequence[str | Path]) -> list[pd.DataFrame]:
    """Read tables as text, so that each number keeps its form.

    A column may have integers in one chunk and fractions in another.
    """
    return [pd.read_csv(path, dtype=str, keep_default_na=False) for path in paths]


def _run_numbers(paths: Sequence[str | Path], counts: Sequence[int]) -> list[list[int]]:
    """Return, for each chunk, the numbers that its runs have in the whole sweep.

    Raises UnreadableFile if the chunks of one sweep cannot have these numbers of runs.

    paths, counts : the file of each chunk, and the number of runs in it
    """
    chunk_count, run_count = len(counts), sum(counts)
    run_numbers = []
    for chunk, count in enumerate(counts, start=1):
        numbers = [*runs_of(chunk, chunk_count, run_count)]
        if len(numbers) != count:
            raise UnreadableFile(paths[0], NOT_ONE_SWEEP)
        run_numbers.append(numbers)
    return run_numbers
