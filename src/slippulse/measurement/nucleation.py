"""Measurement of a rupture that does not start at x = 0.

Fronts, pulses and regimes are measured relative to x = 0, where the rupture of the paper starts. If
a rupture starts elsewhere, `seen_from_nucleation` moves its run, so that the nucleation is at
x = 0. `positions_from_zero` moves the measured positions back.
"""

from typing import Any

import numpy as np

from ..data.points import AnyRun, Recorded

# Name of the attribute of a moved run that has the position of its nucleation before it was moved.
NUCLEATION_POSITION = "nucleation_position"
# Arrays and attributes of a run that are positions.
POSITION_ARRAYS = ("x", "sample_position")
POSITION_ATTRIBUTES = ("first_stick_position", "limit_position")
# Measured numbers that are positions along x. The intercept of the left front is measured in the
# opposite direction. The position of the trailing edge is measured at several times.
POSITIONS = ("first_stick_position", "pulse_front", "front_intercept_right")
TRAILING_EDGE_PREFIX = "trailing_edge_"


def nucleation_position(x: np.ndarray, prestress: np.ndarray, release_time: np.ndarray) -> float:
    """Return the position at which a rupture starts.

    It is 0 if the rupture starts at x = 0, if it starts at several places, or if nothing moves.
    Otherwise it is the position with the highest pre-stress, or the middle of such positions.

    x, prestress, release_time : arrays with one value for each block
    """
    was_released = np.isfinite(release_time)
    if not was_released.any():
        return 0.0
    starts = prestress >= 1.0
    # The rupture of an exact solution may start between two blocks.
    if not starts.any():
        starts = release_time == np.min(release_time[was_released])
    first, last = np.flatnonzero(starts)[[0, -1]]
    starts_at_several_places = not starts[first : last + 1].all()
    if starts_at_several_places or x[first] <= 0.0 <= x[last]:
        return 0.0
    highest_blocks = first + np.flatnonzero(
        prestress[first : last + 1] == np.max(prestress[first : last + 1])
    )
    # If there are two blocks in the middle, the one nearer to x = 0 is taken.
    ends = highest_blocks[0] + highest_blocks[-1]
    middle = ends // 2 if x[first] > 0.0 else (ends + 1) // 2
    return float(x[middle])


def seen_from_nucleation(run: AnyRun) -> AnyRun:
    """Return a run with positions relative to its nucleation; unchanged if this is at x = 0.

    The attributes that describe its pre-stress are not changed. The attribute NUCLEATION_POSITION
    of a moved run has the position of its nucleation.
    """
    fields = [np.asarray(run[name]) for name in ("x", "prestress", "release_time")]
    position = nucleation_position(*fields)
    if position == 0.0:
        return run
    names = [*map(str, run if isinstance(run, Recorded) else run.variables)]
    arrays = {name: np.asarray(run[name]) for name in names}
    arrays |= {name: arrays[name] - position for name in POSITION_ARRAYS if name in arrays}
    attributes = dict(run.attrs)
    for name in POSITION_ATTRIBUTES:
        if name in attributes:
            attributes[name] -= position
    return Recorded(arrays, attributes | {NUCLEATION_POSITION: position})


def position_of_nucleation(run: AnyRun) -> float:
    """Return the position of the nucleation of a moved run; 0 for a run that was not moved."""
    return float(run.attrs.get(NUCLEATION_POSITION, 0.0))


def positions_from_zero(numbers: dict[str, Any], run: AnyRun) -> dict[str, Any]:
    """Return the measured numbers of a run with all positions relative to x = 0.

    run : the run, as `seen_from_nucleation` has returned it
    """
    position = position_of_nucleation(run)
    if position == 0.0:
        return numbers
    moved = dict(numbers)
    for name in numbers:
        if name in POSITIONS or name.startswith(TRAILING_EDGE_PREFIX):
            moved[name] += position
    if "front_intercept_left" in moved:
        moved["front_intercept_left"] -= position
    return moved
