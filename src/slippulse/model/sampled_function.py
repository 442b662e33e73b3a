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
from .prestress import MAX_TABLE_POINTS

# Number of equidistant samples at the start. Narrower features of the function may be missed.
FIRST_SAMPLES = 257
# Positions within an interval, as fractions of its length, at which function and line are compared.
TEST_FRACTIONS = np.array([0.25, 0.5, 0.75])
# An interval is not divided if it is shorter than this fraction of the whole range. The function
# has a jump there.
MIN_INTERVAL_FRACTION = 1e-12


def sample_function(
    function: Callable[[float], Any], start: float, stop: float, tolerance: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return positions and values whose linear interpolation is accurate to a tolerance."""
    check_number("start", start)
    check_number("stop", stop, above=start)
    check_number("tolerance", tolerance, above=0.0)
    check_that(callable(function), "function", function, "a function of the position")

    def evaluate(positions: np.ndarray) -> np.ndarray:
        """Return the function at positions; ValueError if a value is not a finite number."""
        values = []
        for position in positions.ravel().tolist():
            value = function(position)
            number = value.item() if hasattr(value, "item") else value
            check_number(f"function({position:.10g})", number)
            values.append(number)
        return np.array(values, dtype=float).reshape(positions.shape)

    x = np.linspace(start, stop, FIRST_SAMPLES)
    tau = evaluate(x)
    # Indices of the left ends of the intervals that are still to be tested.
    untested = np.arange(x.size - 1)
    while untested.size:
        left_ends, lengths = x[untested], x[untested + 1] - x[untested]
        test_positions = left_ends[:, None] + lengths[:, None] * TEST_FRACTIONS
        values = evaluate(test_positions)
        changes = tau[untested + 1] - tau[untested]
        line = tau[untested, None] + changes[:, None] * TEST_FRACTIONS
        inaccurate = np.max(np.abs(values - line), axis=1) > tolerance
        divided = inaccurate & (lengths > MIN_INTERVAL_FRACTION * (stop - start))
        positions = np.append(x, test_positions[divided].ravel())
        check_that(
            positions.size <= MAX_TABLE_POINTS,
            "tolerance",
            tolerance,
            f"a tolerance that {MAX_TABLE_POINTS} samples can meet",
        )
        order = np.argsort(positions, kind="stable")
        x, tau = positions[order], np.append(tau, values[divided].ravel())[order]
        first = np.searchsorted(x, left_ends[divided])
        untested = (first[:, None] + np.arange(TEST_FRACTIONS.size + 1)).ravel()
    return x, tau
