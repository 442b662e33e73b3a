"""Adaptive sampling of a function, so that linear interpolation between samples is accurate.

The function is first sampled at equal distances. In each interval it is then compared with the
straight line between the two samples, at three positions. Where they differ by more than the
tolerance, these positions become samples, and the new, shorter intervals are tested in the same
way.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from .checks import check_number, check_that
from .prestress_parts import MAX_TABLE_POINTS

# Number of equidistant samples at the start. Narrower features of the function may be missed.
FIRST_SAMPLES = 257
# Positions within an interval, as fractions of its length, at which function and line are compared.
TEST_FRACTIONS = np.array([0.25, 0.5, 0.75])
# An interval that is shorter than this fraction of the whole range is not divided, because the
# function has a jump there.
MIN_INTERVAL_FRACTION = 1e-12


def sample_function(
    function: Callable[[float], Any], start: float, stop: float, tolerance: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return positions and values whose linear interpolation is accurate to a tolerance.

    An interval between two samples is divided as long as the function differs from the straight
    line by more than the tolerance at one of the TEST_FRACTIONS of the interval.
    """
    check_number("start", start)
    check_number("stop", stop, above=start)
    check_number("tolerance", tolerance, above=0.0)
    check_that(callable(function), "function", function, "a function of the position")
    min_length = MIN_INTERVAL_FRACTION * (stop - start)
    positions = np.linspace(start, stop, FIRST_SAMPLES)
    values = _evaluate(function, positions)
    # The ends of the untested intervals, and the values there.
    left, right = positions[:-1], positions[1:]
    left_values, right_values = values[:-1], values[1:]
    while left.size:
        # Arrays with one row for each untested interval, and one column for each test position.
        lengths, rises = right - left, right_values - left_values
        test_positions = left[:, None] + lengths[:, None] * TEST_FRACTIONS
        test_values = _evaluate(function, test_positions)
        values_on_line = left_values[:, None] + rises[:, None] * TEST_FRACTIONS
        errors = np.max(np.abs(test_values - values_on_line), axis=1)
        is_divided = (errors > tolerance) & (lengths > min_length)
        # The test positions of a divided interval become samples.
        positions = np.append(positions, test_positions[is_divided].ravel())
        values = np.append(values, test_values[is_divided].ravel())
        check_that(
            positions.size <= MAX_TABLE_POINTS,
            "tolerance",
            tolerance,
            f"a larger tolerance, which {MAX_TABLE_POINTS} samples can meet",
        )
        # The parts of the divided intervals are tested next.
        ends = np.column_stack([left, test_positions, right])[is_divided]
        end_values = np.column_stack([left_values, test_values, right_values])[is_divided]
        left, right = ends[:, :-1].ravel(), ends[:, 1:].ravel()
        left_values, right_values = end_values[:, :-1].ravel(), end_values[:, 1:].ravel()
    order = np.argsort(positions, kind="stable")
    return positions[order], values[order]


def _evaluate(function: Callable[[float], Any], positions: np.ndarray) -> np.ndarray:
    """Return the values of a function; raise ValueError if one is not a finite number."""
    values = []
    for position in positions.ravel().tolist():
        value = function(position)
        # A NumPy number is converted to one of Python.
        number = value.item() if hasattr(value, "item") else value
        check_number(f"function({position:.10g})", number)
        values.append(number)
    return np.array(values, dtype=float).reshape(positions.shape)
