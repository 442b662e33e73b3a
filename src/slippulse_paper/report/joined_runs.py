"""Join the runs of two tables by their parameters.

`compare` uses this to find, for each measured run of the new results, the same run of the old
results. The old runs may have another order, other lattices, or altered parameters.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import pandas as pd

# Runs with equal values in these columns are the same run, even on different lattices.
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
# Parameters that tables of older versions do not have.
NEWER_RUN_COLUMNS = ["peak", "steps_and_bumps", "friction"]
# Numerical parameters. If the tables have a run on several lattices, those on equal lattices are
# joined.
LATTICE_COLUMNS = ["scheme", "dx", "order", "max_step"]
# These parameters follow from others. If the others are altered as well, only those are named.
DERIVED_COLUMNS = ["beta", "duration"]
# Number of parameters that describe a run if all runs have the same parameters.
DEFAULT_PARAMETER_COUNT = 4


@dataclass(frozen=True)
class JoinedRuns:
    """Pairs of runs of a new and an old table, and the runs without a counterpart.

    A table of pairs has the columns ``new`` and ``old``, which contain row labels of the new and of
    the old table.
    """

    same_runs: pd.DataFrame
    # Pairs of runs that differ only in the parameters `altered_parameters`.
    altered_runs: pd.DataFrame
    altered_parameters: list[str]
    # Row labels of the runs that are in one table only.
    only_new: pd.Index
    only_old: pd.Index


def join_runs(new: pd.DataFrame, old: pd.DataFrame) -> JoinedRuns:
    """Join the runs that are the same, and then runs that differ only in altered parameters.

    Of the same runs, those on equal lattices are joined first.
    """
    parameters = columns_in_both(new, old, [*RUN_COLUMNS, *NEWER_RUN_COLUMNS])
    lattice = columns_in_both(new, old, LATTICE_COLUMNS)

    on_equal_lattices = pair_rows(new, old, [*parameters, *lattice])
    unpaired_new = new.drop(on_equal_lattices["new"])
    unpaired_old = old.drop(on_equal_lattices["old"])

    on_other_lattices = pair_rows(unpaired_new, unpaired_old, parameters)
    unpaired_new = unpaired_new.drop(on_other_lattices["new"])
    unpaired_old = unpaired_old.drop(on_other_lattices["old"])

    altered_parameters, altered_runs = _pair_altered_runs(unpaired_new, unpaired_old, parameters)
    same_runs = pd.concat([on_equal_lattices, on_other_lattices])
    return JoinedRuns(
        same_runs=same_runs.sort_values("new", kind="stable"),
        altered_runs=altered_runs,
        altered_parameters=altered_parameters,
        only_new=unpaired_new.index.difference(altered_runs["new"]),
        only_old=unpaired_old.index.difference(altered_runs["old"]),
    )


def _pair_altered_runs(
    new: pd.DataFrame, old: pd.DataFrame, parameters: list[str]
) -> tuple[list[str], pd.DataFrame]:
    """Return the altered parameters, and pairs of runs that differ only in them.

    A parameter is altered if it has one value in all new runs, and another value in all old runs.
    If a parameter has changed in another way, there are no pairs.
    """
    # A parameter has changed if none of its values occurs in both tables.
    is_kept = {name: new[name].isin(old[name]).any() for name in parameters}
    changed = [name for name in parameters if not is_kept[name]]
    # Derived parameters count only if no other one has changed.
    independent = [name for name in changed if name not in DERIVED_COLUMNS]
    altered_parameters = independent or changed
    if have_one_value_in_each_table(new, old, altered_parameters):
        unchanged = [name for name in parameters if is_kept[name]]
        return altered_parameters, pair_rows(new, old, unchanged)
    return altered_parameters, pd.DataFrame({"new": [], "old": []}, dtype=int)


def columns_in_both(new: pd.DataFrame, old: pd.DataFrame, names: Iterable[str]) -> list[str]:
    """Return the names that are columns of both tables."""
    return [name for name in names if name in new and name in old]


def have_one_value_in_each_table(
    new: pd.DataFrame, old: pd.DataFrame, parameters: list[str]
) -> bool:
    """Return True if each parameter has one value in all new runs and one in all old runs.

    If a parameter had several values, it would be unclear which runs belong together. Returns False
    if there are no parameters.
    """
    if not parameters:
        return False
    new_counts = new[parameters].nunique(dropna=False)
    old_counts = old[parameters].nunique(dropna=False)
    return bool((new_counts == 1).all() and (old_counts == 1).all())


def pair_rows(new: pd.DataFrame, old: pd.DataFrame, columns: list[str]) -> pd.DataFrame:
    """Pair the rows of two tables that have equal values in some columns.

    Returns the labels of the paired rows in the columns new and old. Several equal rows of one
    table are paired in their order: their keys have the numbers 0, 1, ... as "occurrence".
    """
    new_keys = _row_keys(new, columns).assign(new=new.index)
    old_keys = _row_keys(old, columns).assign(old=old.index)
    return new_keys.merge(old_keys, on=[*columns, "occurrence"])[["new", "old"]]


def _row_keys(table: pd.DataFrame, columns: list[str]) -> pd.DataFrame:
    """Return some columns as text, and for each row the number of equal rows above it (occurrence).

    Together they identify a row.
    """
    # Numbers are compared as text, since the files of both tables have nine digits.
    keys = table[columns].astype(str)
    return keys.assign(occurrence=keys.groupby(columns).cumcount())


def describe_run(run: Mapping, names: Iterable[str]) -> str:
    """Return some parameters of a run as text, such as "left 0.5, gamma 0.3"."""
    texts = []
    for name in names:
        value = run[name]
        if not pd.isna(value):
            text = f"{value:g}" if isinstance(value, float) else str(value)
            texts.append(f"{name} {text}")
    return ", ".join(texts)


def describe_pair(new: Mapping, old: Mapping, names: Iterable[str]) -> str:
    """Return the parameters of a new run as text, and in brackets the differing old values.

    An example is "left 0.5, gamma 0.3 (old: gamma 0.65)".
    """
    names = list(names)
    text = describe_run(new, names)
    # As texts, two values that are NaN are equal.
    differing = [name for name in names if str(new[name]) != str(old[name])]
    return f"{text} (old: {describe_run(old, differing)})" if differing else text


def varying_parameters(new: pd.DataFrame, old: pd.DataFrame) -> list[str]:
    """Return the parameters that describe a run of two tables.

    The parameters that have several values describe a run. The derived ones (beta and duration)
    count only if no other one varies. If none varies, the first few parameters describe a run.
    """
    names = columns_in_both(new, old, [*RUN_COLUMNS, *NEWER_RUN_COLUMNS, "dx"])
    value_counts = pd.concat([new[names], old[names]]).nunique(dropna=False)
    varying = [name for name in names if value_counts[name] > 1]
    independent = [name for name in varying if name not in DERIVED_COLUMNS]
    return independent or varying or names[:DEFAULT_PARAMETER_COUNT]
