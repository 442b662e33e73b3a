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

    The module docstring describes the algorithm.
    """
    check_number("start", start)
    check_number("stop", stop, above=start)
    check_number("tolerance", tolerance, above=0.0)
    check_that(callable(function), "function", function, "a function of the position")
    x = np.linspace(start, stop, FIRST_SAMPLES)
    tau = _evaluate(function, x)
    # An interval has the same index as the sample at its left end.
    untested = np.arange(x.size - 1)
    while untested.size:
        left_ends, lengths = x[untested], x[untested + 1] - x[untested]
        # Arrays with one row for each untested interval, and one column for each test position.
        test_positions = left_ends[:, None] + lengths[:, None] * TEST_FRACTIONS
        test_values = _evaluate(function, test_positions)
        rises = tau[untested + 1] - tau[untested]
        values_on_line = tau[untested, None] + rises[:, None] * TEST_FRACTIONS
        errors = np.max(np.abs(test_values - values_on_line), axis=1)
        min_length = MIN_INTERVAL_FRACTION * (stop - start)
        is_divided = (errors > tolerance) & (lengths > min_length)
        # The test positions of a divided interval become samples.
        positions = np.append(x, test_positions[is_divided].ravel())
        values = np.append(tau, test_values[is_divided].ravel())
        check_that(
            positions.size <= MAX_TABLE_POINTS,
            "tolerance",
            tolerance,
            f"a tolerance that {MAX_TABLE_POINTS} samples can meet",
        )
        order = np.argsort(positions, kind="stable")
        x, tau = positions[order], values[order]
        # The parts of a divided interval are tested next. The first one has the same left end.
        first_parts = np.searchsorted(x, left_ends[is_divided])
        parts_per_interval = TEST_FRACTIONS.size + 1
        untested = (first_parts[:, None] + np.arange(parts_per_interval)).ravel()
    return x, tau


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
