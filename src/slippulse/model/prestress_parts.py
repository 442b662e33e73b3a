"""Conversion and checks of the parts of a pre-stress: steps, bumps, and a table of points."""

from typing import Any

import numpy as np

from .checks import check_number, check_that, index_of_first_true, refusal, short_repr

# Allowed ranges, in the form that `check_number` takes. A side level of 1 would release infinitely
# many blocks at t = 0.
LEVEL_RANGE: dict[str, Any] = {"below": 1.0}
# The numbers of a step and of a bump, in order, with their allowed ranges.
PART_RANGES: dict[str, dict[str, dict[str, Any]]] = {
    "steps": {"position": {}, "level": LEVEL_RANGE},
    "bumps": {"centre": {}, "amplitude": {}, "width": {"above": 0.0}},
}
# A table of more points would take more memory than the lattice itself.
MAX_TABLE_POINTS = 100_000


def convert_part(name: str, rows: Any) -> tuple[tuple[float, ...], ...]:
    """Convert the steps or the bumps to tuples of floats.

    Raises ValueError if a row has another length, or if a number is outside its range.

    name : "steps" or "bumps"
    rows : sequence with one row of numbers for each step or bump
    """
    # The ranges are those of the numbers in a row, by their names.
    key, ranges = f"prestress.{name}", PART_RANGES[name]
    allowed = f"a list of [{', '.join(ranges)}]"
    try:
        named_rows = [dict(zip(ranges, row, strict=True)) for row in rows]
    except (TypeError, ValueError):
        raise ValueError(f"{key}: {short_repr(rows)}; allowed: {allowed}") from None
    for named_row in named_rows:
        for column, value in named_row.items():
            check_number(f"{key} {column}", value, **ranges[column])
    return tuple(tuple(map(float, named_row.values())) for named_row in named_rows)


def convert_points(rows: Any) -> tuple[tuple[float, float], ...]:
    """Convert the points of a table to pairs of floats; return an empty tuple if there are none."""
    try:
        pairs = [(x, tau) for x, tau in rows]
    except (TypeError, ValueError):
        allowed = "a list of [x, tau]"
        raise ValueError(f"prestress.points: {short_repr(rows)}; allowed: {allowed}") from None
    if not pairs:
        return ()
    x, tau = zip(*pairs, strict=True)
    return tuple(zip(convert_column("x", x), convert_column("tau", tau), strict=True))


def convert_column(name: str, values: Any) -> list[float]:
    """Convert one column of a table to floats.

    Raises ValueError if the column is too short or too long. If a value is not a finite number, the
    message names the first such row.

    name : "x" or "tau"
    """
    key = f"prestress.points {name}"
    is_array = hasattr(values, "__array__")
    try:
        column = list(np.asarray(values).tolist() if is_array else values)
    except TypeError:
        # A single number is not a column. It counts as an empty one, which the check refuses.
        column = []
    size = len(column)
    check_that(2 <= size <= MAX_TABLE_POINTS, key, size, f"2 to {MAX_TABLE_POINTS} numbers")
    # A check of the whole list is much faster than one of each value.
    if all(type(value) is float for value in column) and np.all(np.isfinite(column)):
        return column
    for row, value in enumerate(column, start=1):
        check_number(f"{key} in row {row}", value)
    return [float(value) for value in column]


def check_order(x: np.ndarray) -> None:
    """Raise ValueError if positions decrease, or if more than two points have the same position.

    Rows are counted from 1 in the messages.
    """
    before = index_of_first_true(np.diff(x) < 0.0)
    if before is not None:
        too_low = before + 1
        allowed = f">= {x[before]:.10g}, the x of the row before"
        raise refusal(f"prestress.points x in row {too_low + 1}", float(x[too_low]), allowed)
    first_of_three = index_of_first_true(x[2:] == x[:-2])
    if first_of_three is not None:
        third = first_of_three + 2
        allowed = "at most 2 rows with the same x; the pre-stress jumps between them"
        raise refusal(f"prestress.points x in row {third + 1}", float(x[third]), allowed)
