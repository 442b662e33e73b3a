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

All times are counted from the start of the step: ``now`` is the time of the event, and ``step_end``
is the end of the step. ``top`` is the order of the highest time derivative of slip. Arguments such
as ``medium`` and ``motion`` are groups of numbers and arrays, which `arrays` defines. Row k of
``w``, which is ``motion.derivatives``, is time derivative k of slip; its columns are blocks.
"""

import numpy as np

from .arrays import ACCELERATION, CENTRE_COLUMN, COLUMN_COUNT, SLIP, VELOCITY, EventEffect
from .event_prediction import (
    INVERSE_INTEGERS,
    drop_predicted_events,
    elastic_force,
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
def advance_derivatives(derivatives, lowest, last, top, s):
    """Replace some derivatives of a polynomial at time 0 by those at a time s.

    derivatives : derivative k of the polynomial at index k, up to its degree ``top``
    lowest, last : orders of the first and the last derivative that are replaced
    """
    # Horner's rule sums the Taylor series of each derivative, in ascending order. Each sum contains
    # only this derivative and higher ones, which are not replaced yet.
    for m in range(lowest, last + 1):
        value = derivatives[top]
        for j in range(top - 1, m - 1, -1):
            value = derivatives[j] + s * INVERSE_INTEGERS[j - m + 1] * value
        derivatives[m] = value


@kernel_function(inline=True)
def velocity_at(w, i, top, s):
    """Return the velocity of block i at a time s after the step began, from its Taylor series.

    w : time derivatives of slip at the start of the step, up to derivative ``top``
    """
    # The series of the velocity begins with derivative 1 and is summed by Horner's rule.
    value = w[top, i]
    for k in range(top - 1, 0, -1):
        value = w[k, i] + s * INVERSE_INTEGERS[k] * value
    return value


@kernel_function(inline=True)
def start_sliding(block_change, medium, motion, block, now, top):
    """Release a block at the time ``now`` since the step began, and return its friction.

    block_change : receives the time derivatives of the block's slip at that time, from the second
        one on
    top : order of the highest derivative of slip that the step keeps
    """
    w = motion.derivatives
    inverse_dx2, damping = medium.inverse_dx2, medium.damping
    # The acceleration that the block would have at the start of the step, from the equation of
    # motion. The block itself is at rest, but earlier events of the step may have added slip.
    force = elastic_force(medium, motion, block) + motion.tau[block]
    force -= medium.leaf_stiffness * (w[SLIP, block] + motion.event_slip[block])
    block_change[ACCELERATION] = force + damping * (w[VELOCITY, block - 1] + w[VELOCITY, block + 1])
    friction = begin_weakening(motion, medium.law_kink, block)
    block_change[ACCELERATION] -= friction
    # The higher derivatives of the block's slip come only from the motion of the two neighbours:
    # derivative k + 2 follows from derivative k of their slip, and from derivative k + 1 because of
    # the damping. The two derivatives above ``top`` only make the others more exact when they are
    # advanced in time.
    for k in range(1, top + 1):
        block_change[k + 2] = inverse_dx2 * (w[k, block - 1] + w[k, block + 1])
        # Row ``top`` is the last row of w.
        if k < top:
            block_change[k + 2] += damping * (w[k + 1, block - 1] + w[k + 1, block + 1])
    # Advance them from the start of the step to the time of the release.
    advance_derivatives(block_change, np.int64(2), top, top + 2, now)
    return friction


@kernel_function(inline=True)
def hold_block(block_change, w, event_slip, block, now, top):
    """Stop a block at the time ``now`` since the step began, and return the velocity that it had.

    block_change : receives the changes of derivatives 2 to ``top`` of slip at that time, which are
        minus their values before the stop
    w : time derivatives of slip at the start of the step; those of the block are set to 0
    event_slip : slip by events of the step; the slip of the block in the step until now is added
    """
    # Move the derivatives of the block from w to block_change, and replace derivatives 0 to ``top``
    # there by their values at the time ``now``. Derivative 0 begins as 0, and becomes the slip
    # since the start of the step.
    block_change[SLIP] = 0.0
    for k in range(1, top + 1):
        block_change[k] = w[k, block]
        w[k, block] = 0.0
    advance_derivatives(block_change, np.int64(0), top, top, now)
    event_slip[block] += block_change[SLIP]
    for k in range(2, top + 1):
        block_change[k] = -block_change[k]
    return block_change[VELOCITY]


@kernel_function(inline=True)
def change_weakening(block_change, motion, law_kink, block, now, top):
    """Change the slope of a block's friction when the block passes the kink of its law.

    Friction falls by the slope times its argument, which is the slip or the slip rate. If the slope
    changes by s, derivative k of slip therefore changes by s times derivative k - 2 of the
    argument. Friction is continuous at the kink, so derivative 2 does not change.

    Returns the change of the time derivative of the power of friction (friction times velocity).

    block_change : receives the changes of derivatives 2 to ``top`` of slip
    now : time of the event since the step began
    """
    if law_kink is not None:
        # At first, block_change holds the derivatives of slip themselves, at the time of the event.
        for k in range(1, top + 1):
            block_change[k] = motion.derivatives[k, block]
        advance_derivatives(block_change, np.int64(1), top, top, now)
        velocity, slope_before = block_change[VELOCITY], motion.weakening_slope[block]
        switch_weakening(motion, law_kink, block)
        slope_change = motion.weakening_slope[block] - slope_before
        # Replace them by their changes, from the highest one down: each follows from a lower one,
        # which must not be replaced yet. Derivative j of the argument is the derivative
        # j + argument_row of slip.
        for k in range(top, 2, -1):
            block_change[k] = slope_change * block_change[k - 2 + law_kink.argument_row]
        block_change[ACCELERATION] = 0.0
        # The time derivative of friction changes by minus the change of derivative 3 of slip.
        return -block_change[3] * velocity
    return 0.0


@kernel_function(inline=True)
def spread_difference(difference, medium, motion, event, left, right, top):
    """Compute the change that an event makes in the motion of all blocks within its reach.

    The change of the block of the event itself, ``difference.block_change``, spreads to its
    neighbours by the equation of motion. ``difference.derivatives`` receives the time derivatives
    of the change of slip, at the time of the event. At a stick, the block itself gets 0 there,
    because `hold_block` has already stopped it.

    left, right : numbers of adjacent sliding blocks on each side, which limit the reach
    top : order of the highest time derivative
    """
    rows, block_change = difference.derivatives, difference.block_change
    # Column p of the difference is the block p + block_of_column_0 of the lattice. Loops over
    # unsigned integers are faster (see `stencils`).
    block_of_column_0 = np.uint64(event.block) - np.uint64(CENTRE_COLUMN)
    # Each derivative follows from the two before it. Derivatives 0 and 1 do not change.
    for k in range(2, top + 1):
        for p in range(np.uint64(COLUMN_COUNT)):
            rows[k, p] = 0.0
        # Derivative k reaches this number of blocks on each side (see the module docstring).
        reach = k - 2 if medium.damping != 0.0 else (k - 2) // 2
        first, last = CENTRE_COLUMN - min(left, reach), CENTRE_COLUMN + min(right, reach) + 1
        for p in block_range(first, last):
            rows[k, p] = next_derivative(
                rows, k, p, medium.inverse_dx2, medium.leaf_stiffness, medium.damping
            )
        if medium.alpha != 0.0:
            subtract_rate_strengthening(rows, k, first, last, medium.alpha)
        add_weakening(rows, k, first, last, block_of_column_0, motion, medium.law_kink)
        if event.is_stick:
            # The block is held, so the changes of its neighbours, computed above, do not move it.
            # Its own change is needed in the loop, because it spreads to the neighbours.
            rows[k, CENTRE_COLUMN] = block_change[k]
        else:
            # The block slides, and also feels the changes of its neighbours.
            rows[k, CENTRE_COLUMN] += block_change[k]
    if event.is_stick:
        # The change has spread. It is removed from the block itself, so that it is not added to the
        # motion of the block once more.
        for k in range(2, top + 1):
            rows[k, CENTRE_COLUMN] = 0.0


@kernel_function(inline=True)
def evaluate_difference(out, rows, m, top, s):
    """Compute time derivative m of the difference at a time s after the event, in ``out``.

    The difference is the change of slip that the event makes in some blocks. Column p of ``rows``
    is one of these blocks, and row k is time derivative k at the time of the event, up to ``top``.
    """
    # Horner's rule sums the Taylor series of derivative m, rows[m] + s (rows[m + 1] + s/2 (...)),
    # for all blocks at once. The last column is left out, because it lies beyond the reach of every
    # event and is always 0.
    columns = np.uint64(COLUMN_COUNT - 1)
    for p in range(columns):
        out[p] = rows[top, p]
    for k in range(top - 1, m - 1, -1):
        weight = s * INVERSE_INTEGERS[k + 1 - m]
        for p in range(columns):
            out[p] = rows[k, p] + weight * out[p]


@kernel_function(inline=True)
def add_difference(motion, difference, first, last, block, now, step_end, top):
    """Add the change that an event makes to the motion of blocks first..last-1.

    The event changes the velocities of these blocks at the end of the step, the slip that events
    add in this step (``motion.event_slip``), and the time derivatives of slip, which the lattice
    keeps for the start of the step.

    difference : the change of slip by the event, as time derivatives at the time of the event
    block, now : block and time of the event, since the step began
    top : order of the highest time derivative
    """
    w, event_slip = motion.derivatives, motion.event_slip
    end_velocity = motion.end_velocity
    rows, values = difference.derivatives, difference.values
    # Block i of the lattice is column i + column_of_block_0 of the difference.
    column_of_block_0 = np.uint64(CENTRE_COLUMN) - np.uint64(block)
    # Counted from the event, the step begins at the time -now, and ends at this time.
    time_to_end = step_end - now
    evaluate_difference(values, rows, VELOCITY, top, time_to_end)
    for i in block_range(first, last):
        end_velocity[i] += values[i + column_of_block_0]
    # The added slip is kept apart from the slip in ``w`` until the step ends.
    evaluate_difference(values, rows, SLIP, top, -now)
    for i in block_range(first, last):
        event_slip[i] += values[i + column_of_block_0]
    for m in range(VELOCITY, top + 1):
        evaluate_difference(values, rows, m, top, -now)
        for i in block_range(first, last):
            w[m, i] += values[i + column_of_block_0]


@kernel_function(inline=True)
def change_of_loss_slope(medium, w, block, acceleration_change, now, top):
    """Return the change of the time derivative of the viscous dissipation by an event of a block.

    The result is the sum of dv da over the pairs of the block and its two neighbours: dv is the
    difference of the two velocities, and da the change of the difference of the two accelerations.
    `take_event` multiplies it by 2 beta/dx, and doubles it on a mirrored lattice.

    acceleration_change : change of the block's acceleration by the event
    """
    if medium.beta <= 0.0:
        return 0.0
    # At a release or a stick the velocity of the block is 0, and only its own acceleration changes.
    # In both pairs, dv da is therefore minus the velocity of the neighbour times this change. (At a
    # kink of the law the change is 0.)
    neighbour_velocities = velocity_at(w, block + 1, top, now)
    # The left pair of the block on the axis is the mirror image of the right one.
    is_on_axis = medium.is_mirrored and block == 1
    if not is_on_axis:
        neighbour_velocities += velocity_at(w, block - 1, top, now)
    return -acceleration_change * neighbour_velocities


@kernel_function(inline=True)
def update_mirror_image(motion, top):
    """Copy the change of block 2 by an event to block 0, its mirror image on a mirrored lattice.

    An event does not change the slip at the start of the step, row SLIP of ``w``. The slip that it
    adds is kept in ``motion.event_slip`` until the step ends.
    """
    w, event_slip = motion.derivatives, motion.event_slip
    event_slip[0] = event_slip[2]
    for m in range(VELOCITY, top + 1):
        w[m, 0] = w[m, 2]


@inlined_kernel
def predict_events_again(medium, motion, segments, prediction, first, last, now, step_end):
    """Predict the events of blocks first..last-1, whose motion an event has changed at ``now``.

    Returns two values: False if a velocity is not finite at ``step_end``, and the lowest stress at
    ``now`` of the blocks at rest for which a release was predicted.
    """
    top = motion.derivatives.shape[0] - 1
    # The motion of these blocks also changes the stress of the block on either side of them.
    lowest_stress = predict_releases(
        medium, motion, segments, prediction, first - 1, last + 1, now, step_end
    )
    # Replace the sticks and kinks that were predicted before the event. Any number of these blocks
    # may stick.
    drop_predicted_events(prediction, first, last)
    may_stick_count = last - first
    is_finite = predict_sticks(motion, prediction, first, last, may_stick_count, now, step_end, top)
    predict_law_kinks(motion, medium.law_kink, prediction, first, last, now, step_end, top)
    return is_finite, lowest_stress


@inlined_kernel
def apply_event(medium, motion, segments, prediction, difference, event, step_end, top):
    """Change the motion within reach of an event, and predict the next events of these blocks.

    Returns the changes as an `EventEffect`. For the energy balance, it contains the changes of the
    slopes (time derivatives) of two powers: the viscous dissipation, called loss, and the work
    against friction per unit time.

    event : `Event`, its time counted from the start of the step
    step_end : time of the end of the step, until which events are predicted
    top : order of the highest time derivative of slip
    """
    w = motion.derivatives
    block_change, law_kink = difference.block_change, medium.law_kink
    block, now, is_stick, at_law_kink = event
    left, right = count_sliding_neighbours(segments, block)
    if medium.is_mirrored and block == 1:
        # The block on the axis has the mirror images of its right neighbours on its left.
        left = right

    # Stage 1: the block of the event. ``block_change`` receives the changes of the time derivatives
    # of its slip.
    velocity_before = work_slope_change = friction = 0.0
    if is_stick:
        velocity_before = hold_block(block_change, w, motion.event_slip, block, now, top)
        motion.end_velocity[block] = 0.0
        friction = friction_at_stick(motion, law_kink, block)
    elif at_law_kink:
        work_slope_change = change_weakening(block_change, motion, law_kink, block, now, top)
    else:
        friction = start_sliding(block_change, medium, motion, block, now, top)
    acceleration_change = block_change[ACCELERATION]
    loss_slope_change = change_of_loss_slope(medium, w, block, acceleration_change, now, top)
    # The power of friction is friction times velocity. At a release or a stick, where the velocity
    # is 0, its slope changes by friction times the change of acceleration. At a kink of the law,
    # where the acceleration does not change, `change_weakening` has returned the change.
    work_slope_change += friction * acceleration_change

    # Stage 2: all blocks that the change reaches in the derivatives up to ``top``. With damping
    # each derivative after the second one reaches one block further, otherwise every other one.
    spread_difference(difference, medium, motion, event, left, right, top)
    reach = top - 2 if medium.damping != 0.0 else (top - 2) // 2
    first, last = max(block - min(left, reach), 1), block + min(right, reach) + 1
    add_difference(motion, difference, first, last, block, now, step_end, top)
    first_changed = first
    if medium.is_mirrored and first <= 2:
        update_mirror_image(motion, top)
        first_changed = np.int64(0)

    # Stage 3: the next events of these blocks.
    is_finite, lowest_stress = predict_events_again(
        medium, motion, segments, prediction, first, last, now, step_end
    )
    return EventEffect(
        is_finite=is_finite,
        first=first_changed,
        last=last,
        velocity_before=velocity_before,
        lowest_stress=lowest_stress,
        loss_slope_change=loss_slope_change,
        work_slope_change=work_slope_change,
    )
