"""The localised scheme: Taylor steps of any order over all that slides, with releases and sticks inside them.

Between events the sliding lattice is linear with constant coefficients, so its Taylor polynomial is cheap, and it
is its own dense output: the stress of a stuck neighbour and the velocity of a sliding block are polynomials in the
time since the step began, and the next event is the first root of either (`foresight`). What an event changes is added
to the polynomials within its reach (`events`). Only the segments of sliding blocks and their neighbours are touched;
everything else is at rest and its derivatives are zero.
"""

import math

import numpy as np

from .arrays import ALL_STUCK, CONTINUE, DONE, GROW, MOST_EVENTS, ROOM, UNSTABLE
from .events import change_course
from .foresight import due_releases, find_sticks, foresee_releases, next_event, simultaneous
from .jit import entry, inner
from .notes import dissipation, note_release, note_stick, take_samples, viscous_loss
from .segments import holds, release_block, stick_block
from .stencils import (
    advance_slip,
    advance_strain,
    first_acceleration,
    next_derivative,
    strengthen,
    velocity_after,
)

# Events closer than this fraction of the largest step are one: fronts of a symmetric scene that meet.
SIMULTANEOUS = 1e-11
# Velocities beyond this many times the largest that any pre-stress could have driven by now mean a blow-up.
BLOW_UP = 100.0


@inner(inline=True)
def derivatives(medium, motion, segments, alpha, top):
    """Fill w[2..top] with the time derivatives of slip on all segments."""
    w, mirror = motion.w, medium.mirror
    for r in range(segments.count.n):
        a, b = segments.starts[r], segments.ends[r]
        if mirror and a == 1:
            w[1, 0] = w[1, 2]
        first_acceleration(w, motion.strain, motion.tau, a, b, medium.per_dx, medium.leaf, medium.damping)
        if alpha != 0.0:
            strengthen(w, 2, a, b, alpha)
        for k in range(3, top + 1):
            if mirror and a == 1:
                w[k - 1, 0] = w[k - 1, 2]
            next_derivative(w, k, a, b, medium.per_dx2, medium.leaf, medium.damping)
            if alpha != 0.0:
                strengthen(w, k, a, b, alpha)
    if mirror:
        for k in range(1, top + 1):
            w[k, 0] = w[k, 2]


@inner()
def strengthened_derivatives(medium, motion, segments, top):
    """The same where friction depends on slip rate, out of the way of other runs."""
    derivatives(medium, motion, segments, medium.alpha, top)


@inner(inline=True)
def foresee(medium, motion, segments, forecast, tally, h, top):
    """Velocity at h of all segments, the sticks and releases until then. Returns whether all velocities are finite."""
    forecast.sticks.n = 0
    for r in range(segments.count.n):
        a, b = segments.starts[r], segments.ends[r]
        suspects = velocity_after(motion.velocity, motion.w, a, b, h, top - 1)
        if suspects > 0 and not find_sticks(motion, forecast, a, b, suspects, 0.0, h, top):
            return False
    size = motion.tau.shape[0]
    lowest = foresee_releases(medium, motion, segments, forecast, np.int64(0), size, 0.0, h, top)
    tally.min_stuck_stress = min(tally.min_stuck_stress, lowest)
    return True


@inner(inline=True)
def end_early(motion, scratch, h, order):
    """Velocities at h of all that moved, where the step ends before its time."""
    moved, changed = scratch.moved, scratch.changed
    for r in range(moved.count.n):
        velocity_after(motion.velocity, motion.w, moved.starts[r], moved.ends[r], h, order)
    for q in range(changed.count.n):
        # Released a moment ago: nothing but rounding is below 0.
        for i in range(changed.first[q], changed.last[q]):
            motion.velocity[i] = max(motion.velocity[i], 0.0)


@inner(inline=True)
def take_event(medium, motion, segments, scratch, history, event, instant, h, top):
    """Let one event happen. Returns whether all velocities are finite."""
    changed, tally = scratch.changed, history.tally
    block, stick = event.block, event.stick
    if stick:
        stick_block(segments, block)
        note_stick(history, block, instant)
    else:
        release_block(segments, block)
        if not holds(scratch.moved, block):
            release_block(scratch.moved, block)
        note_release(history, block, instant)
    finite, first, last, speed, lowest, kink = change_course(
        medium, motion, segments, scratch.forecast, scratch.difference, event, h, top
    )
    if not finite:
        return False
    tally.min_stuck_stress = min(tally.min_stuck_stress, lowest)
    if stick:
        tally.min_velocity = min(tally.min_velocity, speed)
    k, s = kink * ((2.0 if medium.mirror else 1.0) * 2.0 * medium.beta / medium.dx), event.time
    changed.kinks.k += k
    changed.kinks.ks += k * s
    changed.kinks.kss += k * s * s
    n = changed.count.n
    changed.first[n], changed.last[n], changed.stuck[n] = first, last, block if stick else -1
    changed.count.n = n + 1
    tally.event_updates += last - first
    return True


@inner(inline=True)
def take_over(medium, motion, scratch, order, h):
    """Advance slip, velocity and strain of all that moved by h. Returns the largest velocity among a few."""
    w, offset, moved, changed = motion.w, motion.offset, scratch.moved, scratch.changed
    fastest = 0.0
    for r in range(moved.count.n):
        a, b = moved.starts[r], moved.ends[r]
        advance_slip(w, motion.velocity, a, b, h, order)
        fastest = max(fastest, w[1, a], w[1, (a + b) // 2], w[1, b - 1])
    for q in range(changed.count.n):
        for i in range(changed.first[q], changed.last[q]):
            w[0, i] += offset[i]
            w[2, i] += offset[i]
            offset[i] = 0.0
    for r in range(moved.count.n):
        a, b = moved.starts[r], moved.ends[r]
        advance_strain(motion.strain, w, 1 if medium.mirror and a == 1 else a - 1, b, medium.per_dx)
    if medium.mirror:
        motion.strain[0] = -motion.strain[1]
    for q in range(changed.count.n):
        if changed.stuck[q] >= 0:
            w[2, changed.stuck[q]] = 0.0
    return fastest


@inner(inline=True)
def take_events_at_once(medium, motion, segments, scratch, history, end, latest, top):
    """At the end of a step that ended early: release and hold all blocks that are due until ``latest``."""
    forecast, tally = scratch.forecast, history.tally
    due = scratch.changed.first
    n_due = due_releases(segments, forecast, latest, due)
    for q in range(forecast.sticks.n):
        if forecast.stick_time[q] <= latest:
            block = forecast.stick_block[q]
            tally.min_velocity = min(tally.min_velocity, motion.w[1, block])
            for k in range(1, top + 1):
                motion.w[k, block] = 0.0
            stick_block(segments, block)
            note_stick(history, block, end)
    for q in range(n_due):
        release_block(segments, due[q])
        note_release(history, due[q], end)


@entry
def advance(medium, motion, segments, scratch, history, recorder, limits):
    """Advance the lattice by at most ``limits.steps`` steps, to ``limits.end_time`` at most.

    At the end the viscous loss is complete and w[2] holds the accelerations.

    Returns why it stopped: DONE, CONTINUE (all steps are done), GROW, UNSTABLE or ALL_STUCK.
    """
    order, top = limits.order, limits.order + 1
    size = motion.tau.shape[0]
    same = SIMULTANEOUS * limits.largest_step
    tally, moved, forecast, changed = history.tally, scratch.moved, scratch.forecast, scratch.changed
    kinks, lossy = changed.kinks, medium.beta > 0.0 or medium.alpha != 0.0
    for _ in range(limits.steps):
        t = tally.time
        if medium.alpha == 0.0:
            derivatives(medium, motion, segments, 0.0, top)
        else:
            strengthened_derivatives(medium, motion, segments, top)
        rate, change = 0.0, 0.0
        if lossy:
            rate, change = dissipation(medium, motion, segments)
            tally.viscous_loss += tally.pending_step * rate / 3.0
            tally.pending_step = 0.0
        if segments.count.n == 0:
            return ALL_STUCK
        if t >= limits.end_time:
            return DONE
        # The events of a step may reach beyond the end of the lattice.
        last = segments.ends[segments.count.n - 1]
        if last >= size - ROOM or (segments.starts[0] <= ROOM and not medium.mirror):
            return GROW
        kinks.k, kinks.ks, kinks.kss = 0.0, 0.0, 0.0

        h = min(limits.largest_step, limits.end_time - t)
        end = limits.end_time if h == limits.end_time - t else t + h
        if not foresee(medium, motion, segments, forecast, tally, h, top):
            return UNSTABLE
        for r in range(segments.count.n):
            moved.starts[r], moved.ends[r] = segments.starts[r], segments.ends[r]
        moved.count.n = segments.count.n
        changed.count.n = 0

        early = False
        while True:
            event = next_event(segments, forecast)
            if event.time == math.inf:
                break
            early = changed.count.n == MOST_EVENTS or simultaneous(
                segments, forecast, medium.mirror, event.block, event.time + same
            )
            if early:
                h, end = event.time, min(t + event.time, end)
                end_early(motion, scratch, h, order)
                break
            instant = min(t + event.time, end)
            take_samples(recorder, motion, tally, t, instant, order)
            if not take_event(medium, motion, segments, scratch, history, event, instant, h, top):
                return UNSTABLE
        take_samples(recorder, motion, tally, t, end, order)

        if lossy:
            tally.viscous_loss += viscous_loss(h, rate, change, kinks)
            tally.pending_step = h
        updates = 0
        for r in range(moved.count.n):
            updates += moved.ends[r] - moved.starts[r]
        fastest = take_over(medium, motion, scratch, order, h)
        if early:
            take_events_at_once(medium, motion, segments, scratch, history, end, h + same, top)
        tally.block_updates += updates
        tally.steps += 1
        tally.time = end
        if not fastest <= BLOW_UP * (1.0 + limits.largest_force * end):
            return UNSTABLE
    return CONTINUE
