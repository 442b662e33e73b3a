"""Runs of two tables, joined by their parameters."""

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd

# These columns make a run the same run in another tree, whatever its lattice.
RUN_COLUMNS = [
    "boundary",
    "left",
    "right",
    "width",
    "gamma",
    "damping_ratio",
    "duration",
    "release",
]
# Tables of today have these parameters too.
FURTHER_COLUMNS = ["peak", "steps_and_bumps", "friction"]
# A number without uncertainty depends on these as well. Among runs with equal parameters, those
# with the same lattice belong together.
LATTICE_COLUMNS = ["scheme", "dx", "order", "max_step"]
# A parameter that follows from altered ones is no alteration of its own.
DERIVED_COLUMNS = ["beta", "duration"]


class JoinedRuns(NamedTuple):
    """Row numbers of runs in two tables, and what differs between the runs of a pair."""

    same: np.ndarray  # pairs of the same run: (number, 2), row in the new and in the old table
    altered: np.ndarray  # pairs of runs that differ in `keys` alone
    keys: list[str]
    only_new: np.ndarray
    only_old: np.ndarray


def join_runs(new: pd.DataFrame, old: pd.DataFrame) -> JoinedRuns:
    """Join the same runs, then the runs that differ only in parameters whose one value changed."""
    parameters = RUN_COLUMNS + [name for name in FURTHER_COLUMNS if name in new and name in old]
    lattice = [name for name in LATTICE_COLUMNS if name in new and name in old]
    left = [new[[*parameters, *lattice]], old[[*parameters, *lattice]]]
    found = []
    for keys in ([*parameters, *lattice], parameters):
        pairs = _pairs(left, keys)
        found.append(pairs)
        left = [
            rows.drop(rows.index[rows.index.isin(taken)])
            for rows, taken in zip(left, pairs.T, strict=True)
        ]
    same = np.concatenate(found)
    same = same[np.argsort(same[:, 0], kind="stable")]
    changed = [name for name in parameters if not {*left[0][name]} & {*left[1][name]}]
    keys = [name for name in changed if name not in DERIVED_COLUMNS]
    altered = np.empty((0, 2), int)
    # Only one value in place of one other says which runs belong together.
    if keys and all(rows[name].nunique(dropna=False) == 1 for rows in left for name in keys):
        altered = _pairs(left, [name for name in parameters if name not in changed])
    only = [rows.index.difference(taken) for rows, taken in zip(left, altered.T, strict=True)]
    return JoinedRuns(same, altered, keys, *(rows.to_numpy() for rows in only))


def describe_run(run: Mapping, keys: Iterable[str]) -> str:
    """Write the parameters of a run as text, such as "left 0.5, gamma 0.3"."""
    known = {key: run[key] for key in keys if not pd.isna(run[key])}
    texts = {key: f"{value:g}" if isinstance(value, float) else f"{value}"
             for key, value in known.items()}  # fmt: skip
    return ", ".join(f"{key} {text}" for key, text in texts.items())


def describe_pair(new: Mapping, old: Mapping, keys: Iterable[str]) -> str:
    """Write the parameters of the new run, and those that are others in the old run."""
    keys = list(keys)
    other = [key for key in keys if str(new[key]) != str(old[key])]
    text = describe_run(new, keys)
    return f"{text} (old: {describe_run(old, other)})" if other else text


def varying_parameters(*tables: pd.DataFrame) -> list[str]:
    """Return the parameters that tell the runs of these tables apart."""
    names = [
        name
        for name in [*RUN_COLUMNS, *FURTHER_COLUMNS, "dx"]
        if all(name in table for table in tables)
    ]
    joined = pd.concat([table[names] for table in tables])
    varying = [name for name in names if joined[name].nunique(dropna=False) > 1]
    independent = [name for name in varying if name not in DERIVED_COLUMNS]
    return independent or varying or names[:4]


def _pairs(tables: Sequence[pd.DataFrame], keys: list[str]) -> np.ndarray:
    """Return the index pairs of rows with equal keys; equal rows are paired in their order."""
    sides = []
    for rows, name in zip(tables, ("new", "old"), strict=True):
        # Equal text is an equal number: tables are read back from files of nine digits.
        texts = rows[keys].astype(str)
        sides.append(texts.assign(copy=texts.groupby(keys).cumcount(), **{name: rows.index}))
    joined = sides[0].merge(sides[1], on=[*keys, "copy"])
    return joined[["new", "old"]].to_numpy(int)
