"""The localised scheme: Taylor steps over the sliding blocks, with releases and sticks inside them.

Between events the sliding lattice is linear with constant coefficients. Its Taylor polynomial is
therefore cheap to compute, and it gives the motion at any time of the step. One step of `advance`:

1. Compute the time derivatives of slip of all sliding blocks (`fill_derivatives`).
2. The stress of a stuck neighbour and the velocity of a sliding block are polynomials in the time
   since the step began. Find their first root, which is the next event (`event_prediction`).
3. Add the change that the event makes to the polynomials of the blocks within its reach, and
   predict the events of these blocks again (`events`). Go back to 2 until no event is left.
4. Advance slip, velocity and strain to the end of the step (`finish_step`).

If two events are so close that each would change the other, the step ends early, and they happen
together at its end. Only segments of sliding blocks and their neighbours are touched, since the
derivatives of all other blocks are zero.

Arguments such as ``medium``, ``motion`` and ``tally`` are groups of numbers and arrays, which
`arrays` defines. Row k of ``w``, which is ``motion.derivatives``, is time derivative k of slip; its
columns are blocks. Segment r of sliding blocks begins with the block ``edges[2 r]`` and ends before
the block ``edges[2 r + 1]``.
"""

import math
from typing import NamedTuple

import numpy as np

from . import event_prediction, stencils
from . import friction_terms as friction
from .arrays import (
    ACCELERATION,
    ALL_STUCK,
    BLOWN_UP,
    EDGE_BLOCKS,
    END_REACHED,
    LATTICE_TOO_SHORT,
    MAX_EVENTS_PER_STEP,
    SLIP,
    SLIP_INCREMENT,
    STEPS_DONE,
    VELOCITY,
)
from .event_prediction import find_next_event, has_simultaneous_event
from .events import apply_event
from .jit import inlined_kernel, kernel_entry, kernel_function
from .segments import contains_block, toggle_block

# Neighbouring events closer in time than this fraction of the largest step happen together. The
# fronts of a symmetric scene, for example, meet at one instant.
SIMULTANEITY_TOLERANCE = 1e-11
# A velocity above this multiple of the largest one that the pre-stress can drive is a blow-up.
BLOW_UP_FACTOR = 100.0


@kernel_function(inline=True)
def next_step(limits, start):
    """Return the length of the step that begins at a time ``start``, and the time at its end.

    The last step ends exactly at the end of the run, without rounding.
    """
    time_left = limits.end_time - start
    length = min(limits.largest_step, time_left)
    return length, limits.end_time if length == time_left else start + length


@kernel_function()
def record_release(history, block, time):
    """Record the release of a block at a time.

    Only the time of its first release is kept. A later release removes its stick time.
    """
    if math.isnan(history.release_time[block]):
        history.release_time[block] = time
    else:
        history.tally.re_releases += 1
        history.stick_time[block] = math.nan
    history.tally.releases += 1


@kernel_function()
def record_stick(history, block, time):
    """Record the stick of a block at a time. For the first stick of all blocks, note the block."""
    history.stick_time[block] = time
    if history.tally.sticks == 0:
        history.tally.first_stick_time = time
        history.tally.first_stuck_block = block
    history.tally.sticks += 1


@kernel_function()
def take_samples(recorder, motion, tally, start, end, order):
    """Record slip and velocity at all sample times up to ``end`` that are not recorded yet.

    Both are computed from the Taylor polynomials around ``start``, the time at which the step
    began. The polynomial of slip has the degree ``order`` + 1, and that of velocity ``order``.
    """
    times, blocks = recorder.times, recorder.blocks
    w = motion.derivatives
    while tally.samples_taken < times.shape[0] and times[tally.samples_taken] <= end:
        n = tally.samples_taken
        # Time of the sample since the step began, kept within the step in spite of rounding.
        s = min(max(times[n], start), end) - start
        for p in range(blocks.shape[0]):
            i = blocks[p]
            # Positions outside the lattice have no block.
            if i < 0:
                continue
            # Changes since the step began, by Horner's rule. An event changes the velocity and the
            # higher derivatives in ``w`` at once. The slip that it adds at the start of the step is
            # kept in ``event_slip`` until the step ends.
            slip_change, velocity_change = 0.0, 0.0
            for k in range(order + 1, 0, -1):
                slip_change = s / k * (w[k, i] + slip_change)
            for k in range(order, 0, -1):
                velocity_change = s / k * (w[k + 1, i] + velocity_change)
            recorder.slip[n, p] = w[SLIP, i] + motion.event_slip[i] + slip_change
            recorder.velocity[n, p] = w[VELOCITY, i] + velocity_change
        tally.samples_taken += 1


class Dissipation(NamedTuple):
    """Energy that is lost per unit time at the start of a step, and its time derivatives."""

    viscous: float  # lost to damping and to friction alpha v
    viscous_slope: float
    friction: float  # lost to piecewise linear friction
    friction_slope: float


@inlined_kernel
def compute_dissipation(medium, motion, segments):
    """Return the power that damping and friction alpha v dissipate, and its time derivative.

    Damping dissipates beta dx times the sum of ((v_{i+1} - v_i)/dx)^2 over all pairs of neighbours.
    Friction alpha v dissipates alpha dx times the sum of v_i^2 over all blocks.
    """
    # Sums of dv^2 and dv da over pairs of neighbours, and of v^2 and v a over blocks, where a is
    # the acceleration. They leave out mirror images, and are doubled on a mirrored lattice below.
    dv_squared, dv_da = 0.0, 0.0
    v_squared, v_a = 0.0, 0.0
    w = motion.derivatives
    for r in range(segments.count.n):
        first, last = segments.edges[2 * r], segments.edges[2 * r + 1]
        at_axis = medium.is_mirrored and first == 1
        # The pair of the first block and its left neighbour is a mirror image if it is at the axis.
        first_pair = first if at_axis else first - 1
        square, product = stencils.sum_strain_rate_products(w, first_pair, last)
        dv_squared += square
        dv_da += product
        if medium.alpha != 0.0:
            square, product = friction.sum_velocity_products(w, first, last)
            # Block 1 at x = 0 has no mirror image. Half of it is removed, because it is doubled.
            excess = 0.5 if at_axis else 0.0
            v_squared += square - excess * w[VELOCITY, 1] * w[VELOCITY, 1]
            v_a += product - excess * w[VELOCITY, 1] * w[ACCELERATION, 1]
    sides = 2.0 if medium.is_mirrored else 1.0
    viscous_factor = sides * medium.beta / medium.dx
    drag_factor = sides * medium.alpha * medium.dx
    power = viscous_factor * dv_squared + drag_factor * v_squared
    return power, 2.0 * (viscous_factor * dv_da + drag_factor * v_a)


@kernel_function()
def clear_slope_changes(slope_changes):
    """Set the three sums to 0 that `add_slope_change` makes over the events of a step."""
    slope_changes.moment_0 = 0.0
    slope_changes.moment_1 = 0.0
    slope_changes.moment_2 = 0.0


@inlined_kernel
def begin_step_events(scratch, segments):
    """Empty the list of the events of a step, and start the list of all blocks that move in it.

    At first, the blocks that move are those that slide. Events add others.
    """
    moved, step_events = scratch.moved, scratch.step_events
    for q in range(2 * segments.count.n):
        moved.edges[q] = segments.edges[q]
    moved.count.n = segments.count.n
    step_events.count.n = 0
    clear_slope_changes(step_events.loss_slope_changes)
    clear_slope_changes(step_events.work_slope_changes)


@kernel_function()
def add_slope_change(slope_changes, change, time):
    """Add an event that changes the time derivative (slope) of a dissipation.

    Of all events of a step, only the sums of k, k s and k s^2 are kept, where k is the change and s
    the time of an event since the step began. `loss_of_step` needs no more.
    """
    slope_changes.moment_0 += change
    slope_changes.moment_1 += change * time
    slope_changes.moment_2 += change * time * time


@kernel_function()
def loss_of_step(h, dissipation, slope, slope_changes):
    """Return the energy lost in a step of length h, without the part from the end of the step.

    Let D_0 and D_0' be the dissipation and its slope at the start of the step, and D_1 the
    dissipation at its end. The loss is h (2 D_0 + D_1)/3 + h^2 D_0'/6, correct to third order in h.
    The part h D_1/3 is added at the start of the next step, where D_1 is computed. An event at time
    s that changes the slope by k adds k (h - s)^2/2 to the loss. Since D_1 contains the event
    already, h k (h - s)/3 is subtracted again.

    dissipation, slope : D_0 and D_0'
    slope_changes : moments, the sums of k, k s and k s^2 over the events of the step
    """
    without_events = h * 2.0 * dissipation / 3.0 + h * h * slope / 6.0
    # The sums of k (h - s) and of k (h - s)^2 over the events of the step.
    sum_of_first_powers = slope_changes.moment_0 * h - slope_changes.moment_1
    sum_of_squares = (
        slope_changes.moment_0 * h * h - 2.0 * slope_changes.moment_1 * h + slope_changes.moment_2
    )
    return without_events + sum_of_squares / 2.0 - h * sum_of_first_powers / 3.0


@inlined_kernel
def complete_losses(medium, motion, segments, tally):
    """Complete the energy losses of the previous step, and return the present dissipation.

    The losses of a step of length h contain h/3 times the dissipation at its end (this formula is
    in `loss_of_step`). `add_losses` could not add this part, because the dissipation at the end was
    not known yet. The previous step has ended now, so the present dissipation is the missing one,
    and h is ``pending_step``. The present slopes are returned because the losses of the next step
    need them.
    """
    viscous, viscous_slope = 0.0, 0.0
    if medium.beta > 0.0 or medium.alpha != 0.0:
        viscous, viscous_slope = compute_dissipation(medium, motion, segments)
        tally.viscous_loss += tally.pending_step * viscous / 3.0
    power, power_slope = friction.friction_power(medium, motion, segments, medium.law_kink)
    tally.friction_loss += tally.pending_step * power / 3.0
    tally.pending_step = 0.0
    return Dissipation(viscous, viscous_slope, power, power_slope)


@inlined_kernel
def add_losses(medium, tally, step_events, dissipation, h):
    """Add the energy losses of a step of length h, apart from one part.

    The part that is left out is h/3 times the dissipation at the end of the step. It is not known
    yet, and `complete_losses` adds it at the start of the next step.

    step_events : contains the sums of the jumps that events made in the slopes of the dissipation
    dissipation : `Dissipation` at the start of the step
    """
    if medium.beta > 0.0 or medium.alpha != 0.0:
        tally.viscous_loss += loss_of_step(
            h, dissipation.viscous, dissipation.viscous_slope, step_events.loss_slope_changes
        )
    tally.friction_loss += loss_of_step(
        h, dissipation.friction, dissipation.friction_slope, step_events.work_slope_changes
    )
    tally.pending_step = h


@kernel_function(inline=True)
def fill_derivatives(medium, motion, segments, alpha, top):
    """Compute the time derivatives 2 to ``top`` of the slip of all sliding blocks.

    The equation of motion gives derivative 2, the acceleration. Each of its time derivatives gives
    a higher one from the two before it. Friction is alpha v, or a piecewise linear law.

    alpha : ``medium.alpha``, or the constant 0.0, for which the compiler leaves out this friction
    """
    # Row k of w is time derivative k. On a mirrored lattice, block 0 is the mirror image of block
    # 2, and is updated before each derivative that reads it.
    w, is_mirrored = motion.derivatives, medium.is_mirrored
    leaf_stiffness, damping = medium.leaf_stiffness, medium.damping
    for r in range(segments.count.n):
        first, last = segments.edges[2 * r], segments.edges[2 * r + 1]
        if is_mirrored and first == 1:
            w[VELOCITY, 0] = w[VELOCITY, 2]
        strain, tau = motion.strain, motion.tau
        stencils.compute_accelerations(
            w, strain, tau, first, last, medium.inverse_dx, leaf_stiffness, damping
        )
        if alpha != 0.0:
            friction.subtract_rate_strengthening(w, 2, first, last, alpha)
        friction.subtract_piecewise_linear_friction(motion, first, last, medium.law_kink)
        for k in range(3, top + 1):
            if is_mirrored and first == 1:
                w[k - 1, 0] = w[k - 1, 2]
            for i in stencils.block_range(first, last):
                w[k, i] = stencils.next_derivative(
                    w, k, i, medium.inverse_dx2, leaf_stiffness, damping
                )
            if alpha != 0.0:
                friction.subtract_rate_strengthening(w, k, first, last, alpha)
            # The same for piecewise linear friction. Column 0 of w is block 0 of the lattice.
            friction.add_weakening(w, k, first, last, np.uint64(0), motion, medium.law_kink)
    if is_mirrored:
        for k in range(1, top + 1):
            w[k, 0] = w[k, 2]


@kernel_function()
def fill_rate_strengthened_derivatives(medium, motion, segments, top):
    """Compute the time derivatives of slip with friction alpha v, as `fill_derivatives` does.

    It is a separate function so that the compiler can leave out this friction in the common case,
    where alpha is 0.
    """
    fill_derivatives(medium, motion, segments, medium.alpha, top)


@inlined_kernel
def predict_events(medium, motion, segments, prediction, tally, h, top):
    """Compute all velocities at time h, the end of the step, and predict the events until then.

    All times are counted from the start of the step. Returns False if a velocity is not finite.

    top : order of the highest time derivative of slip
    """
    prediction.event_count.n = 0
    for r in range(segments.count.n):
        first, last = segments.edges[2 * r], segments.edges[2 * r + 1]
        may_stick_count = stencils.compute_velocities(
            motion.end_velocity, motion.derivatives, first, last, h, top - 1
        )
        if may_stick_count > 0 and not event_prediction.predict_sticks(
            motion, prediction, first, last, may_stick_count, 0.0, h, top
        ):
            return False
        event_prediction.predict_law_kinks(
            motion, medium.law_kink, prediction, first, last, 0.0, h, top
        )
    # Releases are predicted for all blocks of the lattice that can be released.
    start, end = np.int64(0), motion.tau.shape[0]
    lowest_stress = event_prediction.predict_releases(
        medium, motion, segments, prediction, start, end, 0.0, h
    )
    tally.min_stuck_stress = min(tally.min_stuck_stress, lowest_stress)
    return True


@inlined_kernel
def set_velocities_at_early_end(motion, scratch, h, order):
    """Compute the velocities at the time h, at which a step ends early, of all blocks that moved.

    Predicted velocities are those at the end of the full step. The polynomials of the blocks
    (``order`` is the degree) contain all earlier events of the step.
    """
    moved, step_events = scratch.moved, scratch.step_events
    for r in range(moved.count.n):
        first, last = moved.edges[2 * r], moved.edges[2 * r + 1]
        stencils.compute_velocities(motion.end_velocity, motion.derivatives, first, last, h, order)
    for q in range(step_events.count.n):
        # The velocity of a block that was just released can be negative by rounding. Such blocks
        # are among those that the events of the step have changed.
        for i in range(step_events.first[q], step_events.last[q]):
            motion.end_velocity[i] = max(motion.end_velocity[i], 0.0)


@inlined_kernel
def take_event(medium, motion, segments, scratch, history, event, instant, h):
    """Let one event happen, and add it to the history, to the energy losses and to the counters.

    Returns False if a velocity is not finite.

    event : `Event` (release, stick or kink of the law), its time counted from the start of the step
    instant : the time of the event since the start of the run
    h : duration of the step
    """
    top = motion.derivatives.shape[0] - 1
    step_events, tally = scratch.step_events, history.tally
    block, is_stick = event.block, event.is_stick
    # The lists of the blocks that slide, and the history.
    if is_stick:
        toggle_block(segments, block)
        record_stick(history, block, instant)
    elif not event.is_law_kink:
        toggle_block(segments, block)
        # The blocks that slid at any time of the step.
        if not contains_block(scratch.moved, block):
            toggle_block(scratch.moved, block)
        record_release(history, block, instant)
    # The motion, and then the energy losses and the counters.
    effect = apply_event(
        medium, motion, segments, scratch.prediction, scratch.difference, event, h, top
    )
    if not effect.is_finite:
        return False
    tally.min_stuck_stress = min(tally.min_stuck_stress, effect.lowest_stress)
    if is_stick:
        tally.min_velocity = min(tally.min_velocity, effect.velocity_before)
    # The event changes the slopes (time derivatives) of the viscous dissipation and of the power of
    # friction. The first power is beta/dx times the sum of (dv)^2 over all pairs of neighbours, and
    # its slope is 2 beta/dx times the sum of dv da, of which ``effect`` has the change. On a
    # mirrored lattice each pair counts twice, and each block too, except block 1 on the axis.
    sides = 2.0 if medium.is_mirrored else 1.0
    loss_slope_change = effect.loss_slope_change * (sides * 2.0 * medium.beta / medium.dx)
    add_slope_change(step_events.loss_slope_changes, loss_slope_change, event.time)
    weight = 2.0 if medium.is_mirrored and block > 1 else 1.0
    work_slope_change = weight * medium.dx * effect.work_slope_change
    add_slope_change(step_events.work_slope_changes, work_slope_change, event.time)
    # Note which blocks the event has changed. `finish_step` completes their slip.
    n = step_events.count.n
    step_events.first[n], step_events.last[n] = effect.first, effect.last
    step_events.stuck_block[n] = block if is_stick else -1
    step_events.count.n = n + 1
    tally.event_updates += effect.last - effect.first
    return True


@inlined_kernel
def finish_step(medium, motion, scratch, tally, order, h):
    """Advance slip, velocity and strain of all blocks that moved to the end of the step.

    The accelerations are no longer needed. Until the end of this function, their row of ``w`` holds
    the change of slip in the step, and is called SLIP_INCREMENT.

    Returns the largest velocity at the ends and the middles of the segments, which shows a blow-up.

    order : degree of the Taylor polynomial of the velocity
    h : duration of the step
    """
    w, event_slip = motion.derivatives, motion.event_slip
    moved, step_events = scratch.moved, scratch.step_events
    fastest = 0.0
    # Advance the slip by the Taylor polynomials, and set the velocity to that at the end of the
    # step. `advance_slip` also writes the change of slip into the row SLIP_INCREMENT.
    for r in range(moved.count.n):
        first, last = moved.edges[2 * r], moved.edges[2 * r + 1]
        stencils.advance_slip(w, motion.end_velocity, first, last, h, order)
        tally.block_updates += last - first
        middle = (first + last) // 2
        fastest = max(fastest, w[VELOCITY, first], w[VELOCITY, middle], w[VELOCITY, last - 1])
    # Add the slip by events of the step. This slip is cleared at once, because a block may be in
    # the reach of several events, and would get it more than once.
    for q in range(step_events.count.n):
        for i in range(step_events.first[q], step_events.last[q]):
            w[SLIP, i] += event_slip[i]
            w[SLIP_INCREMENT, i] += event_slip[i]
            event_slip[i] = 0.0
    # The strain of a block, (u_{i+1} - u_i)/dx, also changes in the block before a segment. On a
    # mirrored lattice, the block before block 1 has the strain of a mirror image, which is set
    # below. (UNSIGNED_ONE is 1. The block numbers of `block_range` are unsigned integers.)
    first_bond = 1 if medium.is_mirrored else 0
    for r in range(moved.count.n):
        first, last = moved.edges[2 * r], moved.edges[2 * r + 1]
        for i in stencils.block_range(max(first - 1, first_bond), last):
            change = w[SLIP_INCREMENT, i + stencils.UNSIGNED_ONE] - w[SLIP_INCREMENT, i]
            motion.strain[i] += medium.inverse_dx * change
    if medium.is_mirrored:
        motion.strain[0] = -motion.strain[1]
    # The row is the acceleration again. The next step computes it for sliding blocks, and a block
    # that has stuck has none.
    for q in range(step_events.count.n):
        if step_events.stuck_block[q] >= 0:
            w[SLIP_INCREMENT, step_events.stuck_block[q]] = 0.0
    return fastest


@inlined_kernel
def apply_simultaneous_events(medium, motion, segments, scratch, history, end, latest, top):
    """Let all events until the time ``latest`` happen together, after a step that ended early.

    end : time of these events since the start of the run
    latest : the same time since the start of the step, plus a tolerance
    top : order of the highest time derivative of slip
    """
    prediction, tally = scratch.prediction, history.tally
    # The list of due blocks uses the memory of an array that is no longer needed in this step.
    due = scratch.step_events.first
    due_count = event_prediction.list_due_releases(segments, prediction, latest, due)
    # Sticks and kinks of the law.
    for q in range(prediction.event_count.n):
        if prediction.event_time[q] <= latest:
            block = prediction.event_block[q]
            if prediction.is_law_kink[q]:
                friction.switch_weakening(motion, medium.law_kink, block)
                continue
            tally.min_velocity = min(tally.min_velocity, motion.derivatives[VELOCITY, block])
            for k in range(1, top + 1):
                motion.derivatives[k, block] = 0.0
            toggle_block(segments, block)
            record_stick(history, block, end)
    # Releases. The next step computes the motion of these blocks.
    for q in range(due_count):
        toggle_block(segments, due[q])
        friction.begin_weakening(motion, medium.law_kink, due[q])
        record_release(history, due[q], end)


# The branches of this function are the algorithm. Smaller functions would share all of its state.
@kernel_entry
def advance(  # noqa: C901, PLR0912
    medium, motion, segments, scratch, history, recorder, limits
):
    """Advance until a limit, and return the reason why it stopped.

    Each step goes through the numbered stages of the module docstring. The energy losses of a step
    are completed at the start of the next one, where the accelerations are computed, too. The end
    of the run is noticed only after that, so that both are those at the final time.

    limits : step size, end of the scene, and largest number of steps of one call
    """
    # ``top`` is the order of the highest time derivative of slip.
    order, top = limits.order, limits.order + 1
    size = motion.tau.shape[0]
    time_tolerance = SIMULTANEITY_TOLERANCE * limits.largest_step
    tally, prediction = history.tally, scratch.prediction
    step_events = scratch.step_events
    for _ in range(limits.max_steps):
        # Stage 1: the derivatives at the start of the step, and the end of the run.
        start = tally.time
        if medium.alpha == 0.0:
            # With the constant 0.0, the compiler leaves out the friction alpha v.
            fill_derivatives(medium, motion, segments, 0.0, top)
        else:
            fill_rate_strengthened_derivatives(medium, motion, segments, top)
        dissipation = complete_losses(medium, motion, segments, tally)
        if segments.count.n == 0:
            return ALL_STUCK
        if start >= limits.end_time:
            return END_REACHED
        # The events of a step may reach beyond the end of the lattice.
        last = segments.edges[2 * segments.count.n - 1]
        first = segments.edges[0]
        if last >= size - EDGE_BLOCKS or (first <= EDGE_BLOCKS and not medium.is_mirrored):
            return LATTICE_TOO_SHORT

        # The step lasts from `start` to `end`, and has the length h.
        h, end = next_step(limits, start)
        # Stage 2: the events that will happen within the step.
        if not predict_events(medium, motion, segments, prediction, tally, h, top):
            return BLOWN_UP
        begin_step_events(scratch, segments)

        # Stage 3: one event after another. The step ends early at an event that has to happen
        # together with others, or after the largest number of events.
        ends_early = False
        while True:
            event = find_next_event(segments, prediction)
            if event.time == math.inf:
                break
            latest = event.time + time_tolerance
            ends_early = step_events.count.n == MAX_EVENTS_PER_STEP or has_simultaneous_event(
                segments, prediction, medium, event.block, latest
            )
            instant = min(start + event.time, end)
            if ends_early:
                h, end = event.time, instant
                set_velocities_at_early_end(motion, scratch, h, order)
                break
            take_samples(recorder, motion, tally, start, instant, order)
            if not take_event(medium, motion, segments, scratch, history, event, instant, h):
                return BLOWN_UP
        take_samples(recorder, motion, tally, start, end, order)

        # Stage 4: the end of the step.
        add_losses(medium, tally, step_events, dissipation, h)
        fastest = finish_step(medium, motion, scratch, tally, order, h)
        if ends_early:
            latest = h + time_tolerance
            apply_simultaneous_events(medium, motion, segments, scratch, history, end, latest, top)
        tally.steps += 1
        tally.time = end
        # The largest force alone would drive a block from rest to the velocity largest_force * end.
        # This form of the condition is also met by a velocity that is NaN.
        if not fastest <= BLOW_UP_FACTOR * (1.0 + limits.largest_force * end):
            return BLOWN_UP
    return STEPS_DONE
