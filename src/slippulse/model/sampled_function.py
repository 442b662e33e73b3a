"""Sampling of a function until linear interpolation between the samples is accurate."""

from collections.abc import Callable
from typing import Any

import numpy as np

from .checks import check_number, check_that
from .prestress import MOST_POINTS

# Samples to begin with, which must show every feature of the function; positions within each
# interval at which it is compared with the line; and the fraction of the whole range below which an
# interval is not divided further, since the function jumps there.
FIRST_SAMPLES = 257
INSIDE = np.array([0.25, 0.5, 0.75])
SHORTEST = 1e-12


def sample_function(
    function: Callable[[float], Any], start: float, stop: float, tolerance: float
) -> tuple[np.ndarray, np.ndarray]:
    """Positions and values such that the lines between them are within a tolerance."""
    check_number("start", start)
    check_number("stop", stop, above=start)
    check_number("tolerance", tolerance, above=0.0)
    check_that(callable(function), "function", function, "a function of the position")

    def evaluate(positions: np.ndarray) -> np.ndarray:
        values = []
        for position in positions.ravel().tolist():
            value = function(position)
            number = value.item() if hasattr(value, "item") else value
            check_number(f"function({position:.10g})", number)
            values.append(number)
        return np.array(values, dtype=float).reshape(positions.shape)

    x = np.linspace(start, stop, FIRST_SAMPLES)
    tau = evaluate(x)
    unsure = np.arange(x.size - 1)
    while unsure.size:
        ends, lengths = x[unsure], x[unsure + 1] - x[unsure]
        inside = ends[:, None] + lengths[:, None] * INSIDE
        values = evaluate(inside)
        line = tau[unsure, None] + (tau[unsure + 1] - tau[unsure])[:, None] * INSIDE
        wrong = np.max(np.abs(values - line), axis=1) > tolerance
        divided = wrong & (lengths > SHORTEST * (stop - start))
        positions = np.append(x, inside[divided].ravel())
        check_that(
            positions.size <= MOST_POINTS,
            "tolerance",
            tolerance,
            f"one that {MOST_POINTS} samples meet",
        )
        order = np.argsort(positions, kind="stable")
        left_ends = x[unsure[divided]]
        x, tau = positions[order], np.append(tau, values[divided].ravel())[order]
        first = np.searchsorted(x, left_ends)
        unsure = (first[:, None] + np.arange(INSIDE.size + 1)).ravel()
    return x, tau
