"""Change of the motion by an event: a release, a stick, or a kink in the law of friction.

The sliding lattice is linear. An event therefore adds a polynomial in time, the difference, to the
Taylor polynomial of each block. The lowest derivative of the difference that is not zero is the
second one, at the block of the event. (If the event is a kink of the law, it is the third one.)
Each further derivative reaches one block further, since damping couples neighbours through their
velocities:

    derivative 2            x
    derivative 3          x x x
    derivative 4        x x x x x

Without damping, two derivatives are needed for each block. The difference ends at the order of the
step, so only a few blocks change, and they change exactly as in a new expansion of the whole
lattice.

All times are counted from the start of the step: ``now`` is the time of the event, and ``h`` is the
end of the step. ``top`` is the order of the highest time derivative of slip.
"""

import numpy as np

from .arrays import ACCELERATION, CENTRE_COLUMN, COLUMN_COUNT, SLIP, VELOCITY, EventEffect
from .event_prediction import (
    RECIPROCALS,
    drop_predicted_events,
    predict_law_kinks,
    predict_releases,
    predict_sticks,
)
from .friction_terms import (
    add_weakening,
    begin_weakening,
    friction_at_stick,
    subtract_rate_strengthening,
    switch_weakening,
)
from .jit import inlined_kernel, kernel_function
from .segments import count_sliding_neighbours
from .stencils import block_range, next_derivative


@kernel_function()
def shift_polynomial(derivatives, lowest, last, top, s):
    """Replace derivatives lowest..last of a polynomial at time 0 by those at a time s.

    derivatives : derivative k of the polynomial at index k, up to its degree ``top``
    """
    # Horner's rule for each of them. Only higher derivatives are read, which are not replaced yet.
    for m in range(lowest, last + 1):
        value = derivatives[top]
        for j in range(top - 1, m - 1, -1):
            value = derivatives[j] + s * RECIPROCALS[j - m + 1] * value
        derivatives[m] = value


@kernel_function(inline=True)
def velocity_at(w, i, top, s):
    """Return the velocity of block i at a time s after the step began, from its Taylor series.

    w : time derivatives of slip at the start of the step, up to derivative ``top``
    """
    # The series of the velocity begins with derivative 1 and is summed by Horner's rule.
    value = w[top, i]
    for k in range(top - 1, 0, -1):
        value = w[k, i] + s * RECIPROCALS[k] * value
    return value


@kernel_function(inline=True)
def start_sliding(centre, medium, motion, block, now, top):
    """Release a block at the time ``now``, and return its friction.

    centre : receives the time derivatives of its slip at that time
    top : order of the highest derivative of slip that the step keeps
    """
    w, offset = motion.w, motion.offset
    strain = motion.strain
    inverse_dx2, damping = medium.inverse_dx2, medium.damping
    # The equation of motion of the block at the start of the step, with the changes of slip by
    # earlier events of the step (offset). The block itself does not move yet.
    curvature = (offset[block + 1] - offset[block]) - (offset[block] - offset[block - 1])
    elastic = (strain[block] - strain[block - 1]) / medium.dx + inverse_dx2 * curvature
    force = elastic + motion.tau[block]
    force -= medium.leaf_stiffness * (w[SLIP, block] + offset[block])
    centre[ACCELERATION] = force + damping * (w[VELOCITY, block - 1] + w[VELOCITY, block + 1])
    friction = begin_weakening(motion, medium.law_kink, block)
    centre[ACCELERATION] -= friction
    # Its higher time derivatives contain only those of the two neighbours. The shift to the time of
    # the event needs two more derivatives than the step keeps.
    for k in range(1, top + 1):
        centre[k + 2] = inverse_dx2 * (w[k, block - 1] + w[k, block + 1])
        if k < top:
            centre[k + 2] += damping * (w[k + 1, block - 1] + w[k + 1, block + 1])
    shift_polynomial(centre, np.int64(2), top, top + 2, now)
    return friction


@kernel_function(inline=True)
def hold_block(centre, w, offset, block, now, top):
    """Stop a block at the time ``now`` since the step began, and return the velocity that it had.

    centre : receives the changes of derivatives 2 to ``top`` of slip at that time, which are minus
        their values before the stop
    w : time derivatives of slip at the start of the step; those of the block are set to 0
    offset : changes of slip by the events of the step; the slip of the block until now is added
    """
    # Move the derivatives of the block from w to centre, and shift them to the time ``now``.
    centre[SLIP] = 0.0
    for k in range(1, top + 1):
        centre[k] = w[k, block]
        w[k, block] = 0.0
    shift_polynomial(centre, np.int64(0), top, top, now)
    # centre[SLIP] is now the slip since the start of the step, which the block keeps.
    offset[block] += centre[SLIP]
    for k in range(2, top + 1):
        centre[k] = -centre[k]
    return centre[VELOCITY]


@kernel_function(inline=True)
def change_weakening(centre, motion, law_kink, block, now, top):
    """Change the slope of a block's friction when the block passes the kink of its law.

    Friction falls by the slope times its argument, which is the slip or the slip rate (see
    `LawKink`). If the slope changes by s, derivative k of slip therefore changes by s times
    derivative k - 2 of the argument. Friction is continuous at the kink, so derivative 2 does not
    change.

    Returns the change of the time derivative of the power of friction (friction times velocity).

    centre : receives the changes of derivatives 2 to ``top`` of slip
    now : time of the event since the step began
    """
    if law_kink is not None:
        for k in range(1, top + 1):
            centre[k] = motion.w[k, block]
        shift_polynomial(centre, np.int64(1), top, top, now)
        velocity, slope_before = centre[VELOCITY], motion.weakening_slope[block]
        switch_weakening(motion, law_kink, block)
        slope_change = motion.weakening_slope[block] - slope_before
        # From the highest derivative down, because lower ones are read before they are overwritten.
        for k in range(top, 2, -1):
            centre[k] = slope_change * centre[k - 2 + law_kink.rate]
        centre[ACCELERATION] = 0.0
        # The time derivative of friction changes by minus the change of derivative 3 of slip.
        return -centre[3] * velocity
    return 0.0


@kernel_function(inline=True)
def spread_difference(difference, medium, motion, event, left, right, top):
    """Compute the time derivatives of the difference that an event makes, at the time of the event.

    They follow from the derivatives at the block of the event, which are in ``difference.centre``.

    left, right : numbers of adjacent sliding blocks on each side of the event, which limit its
        reach
    top : order of the highest derivative
    """
    rows, centre = difference.rows, difference.centre
    # Column p of the difference is the block p + column of the lattice.
    column = np.uint64(event.block) - np.uint64(CENTRE_COLUMN)
    for k in range(2, top + 1):
        for p in range(np.uint64(COLUMN_COUNT)):
            rows[k, p] = 0.0
        # Number of blocks on each side that derivative k reaches (see the module docstring).
        reach = k - 2 if medium.damping != 0.0 else (k - 2) // 2
        first, last = CENTRE_COLUMN - min(left, reach), CENTRE_COLUMN + min(right, reach) + 1
        for p in block_range(first, last):
            rows[k, p] = next_derivative(
                rows, k, p, medium.inverse_dx2, medium.leaf_stiffness, medium.damping
            )
        if medium.alpha != 0.0:
            subtract_rate_strengthening(rows, k, first, last, medium.alpha)
        add_weakening(rows, k, first, last, column, motion, medium.law_kink)
        # After a stick the block is held, so the difference of its neighbours does not move it.
        rows[k, CENTRE_COLUMN] = centre[k] + (0.0 if event.is_stick else rows[k, CENTRE_COLUMN])
    if event.is_stick:
        # The polynomial of the block itself was changed when the block was stopped.
        for k in range(2, top + 1):
            rows[k, CENTRE_COLUMN] = 0.0


@kernel_function(inline=True)
def evaluate_difference(out, rows, lowest, top, s):
    """Compute a time derivative of the difference at a time s after the event, in ``out``.

    rows : derivatives at the event, one row for each up to ``top``, and one column for each block
    lowest : order of the derivative that is computed
    """
    # Horner's rule sums the Taylor series of all blocks at once. The last column is left out,
    # because it lies beyond the reach of every event and is always 0.
    columns = np.uint64(COLUMN_COUNT - 1)
    for p in range(columns):
        out[p] = rows[top, p]
    for k in range(top - 1, lowest - 1, -1):
        weight = s * RECIPROCALS[k + 1 - lowest]
        for p in range(columns):
            out[p] = rows[k, p] + weight * out[p]


@kernel_function(inline=True)
def add_difference(motion, difference, first, last, block, now, h, top):
    """Add the difference that an event makes to the motion of blocks first..last-1.

    It changes their velocities at the end of the step, and the time derivatives of their slip at
    its start.

    block, now : block and time of the event, since the step began
    h : time of the end of the step
    top : order of the highest time derivative
    """
    w, offset = motion.w, motion.offset
    velocity = motion.velocity
    rows, values = difference.rows, difference.values
    # Block i of the lattice is column i + column of the difference.
    column = np.uint64(CENTRE_COLUMN) - np.uint64(block)
    # The velocity is derivative 1. The end of the step is the time h - now, counted from the event.
    evaluate_difference(values, rows, 1, top, h - now)
    for i in block_range(first, last):
        velocity[i] += values[i + column]
    # Slip is derivative 0. The start of the step is the time -now, counted from the event.
    evaluate_difference(values, rows, 0, top, -now)
    for i in block_range(first, last):
        offset[i] += values[i + column]
    for m in range(1, top + 1):
        evaluate_difference(values, rows, m, top, -now)
        for i in block_range(first, last):
            w[m, i] += values[i + column]


@kernel_function(inline=True)
def change_of_loss_slope(medium, w, block, acceleration_change, now, top):
    """Return the sum of dv da over the two pairs of a block and a neighbour, at an event.

    Here dv is the difference of the two slip velocities, and da is the change of the difference of
    the two accelerations. At a release or a stick the velocity of the block is 0, and only its own
    acceleration changes. The time derivative of the viscous dissipation is proportional to the sum.
    """
    if medium.beta <= 0.0:
        return 0.0
    neighbour_velocities = velocity_at(w, block + 1, top, now)
    is_on_axis = medium.is_mirrored and block == 1
    if not is_on_axis:
        neighbour_velocities += velocity_at(w, block - 1, top, now)
    return -acceleration_change * neighbour_velocities


@kernel_function(inline=True)
def update_mirror_image(medium, motion, first, top):
    """Return the first block that an event changed, and update block 0 if it is one of them.

    On a mirrored lattice, block 0 is the mirror image of block 2.

    first : first changed block, if mirror images are not counted
    """
    if not medium.is_mirrored or first > 2:
        return first
    w, offset = motion.w, motion.offset
    offset[0] = offset[2]
    for m in range(1, top + 1):
        w[m, 0] = w[m, 2]
    return np.int64(0)


@inlined_kernel
def apply_event(medium, motion, segments, prediction, difference, event, h, top):
    """Change the motion within reach of an event, and predict the next events of these blocks.

    Returns an `EventEffect`.

    event : `Event`, its time counted from the start of the step
    h : time of the end of the step, until which events are predicted
    top : order of the highest time derivative of slip
    """
    w, offset = motion.w, motion.offset
    velocity = motion.velocity
    centre, law_kink = difference.centre, medium.law_kink
    block, now, is_stick, at_law_kink = event
    left, right = count_sliding_neighbours(segments, block)
    if medium.is_mirrored and block == 1:
        # The block on the axis has the mirror images of its right neighbours on its left.
        left = right
    # First the block of the event itself.
    velocity_before = work_slope_change = friction = 0.0
    if is_stick:
        velocity_before = hold_block(centre, w, offset, block, now, top)
        velocity[block] = 0.0
        friction = friction_at_stick(motion, law_kink, block)
    elif at_law_kink:
        work_slope_change = change_weakening(centre, motion, law_kink, block, now, top)
    else:
        friction = start_sliding(centre, medium, motion, block, now, top)
    acceleration_change = centre[ACCELERATION]
    loss_slope_change = change_of_loss_slope(medium, w, block, acceleration_change, now, top)
    # The power of friction is friction times velocity. Its time derivative changes by friction
    # times the change of acceleration. At a kink of the law `change_weakening` returns its change.
    work_slope_change += friction * acceleration_change

    # Then all blocks within its reach.
    spread_difference(difference, medium, motion, event, left, right, top)
    reach = top - 2 if medium.damping != 0.0 else (top - 2) // 2
    first, last = max(block - min(left, reach), 1), block + min(right, reach) + 1
    add_difference(motion, difference, first, last, block, now, h, top)
    first_changed = update_mirror_image(medium, motion, first, top)

    # Last, the next events of these blocks. Their neighbours at rest feel a different stress, too.
    lowest_stress = predict_releases(
        medium, motion, segments, prediction, first - 1, last + 1, now, h
    )
    drop_predicted_events(prediction, first, last)
    suspects = last - first
    is_finite = predict_sticks(motion, prediction, first, last, suspects, now, h, top)
    predict_law_kinks(motion, law_kink, prediction, first, last, now, h, top)
    return EventEffect(
        is_finite,
        first_changed,
        last,
        velocity_before,
        lowest_stress,
        loss_slope_change,
        work_slope_change,
    )
