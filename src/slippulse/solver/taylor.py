"""The localised scheme: Taylor steps over the sliding blocks, with releases and sticks inside them.

Between events the sliding lattice is linear with constant coefficients, so its Taylor polynomial is
cheap to compute and gives the motion at any time of the step. The stress of a stuck neighbour and
the velocity of a sliding block are polynomials in the time since the step began; the next event is
the first root of these (`foresight`). The change that an event makes is added to the polynomials
within its reach (`events`). Only segments of sliding blocks and their neighbours are touched: the
derivatives of all other blocks are zero.
"""

import math

import numpy as np

from . import foresight, stencils
from . import friction_terms as friction
from .arrays import ALL_STUCK, CONTINUE, DONE, GROW, MOST_EVENTS, ROOM, UNSTABLE
from .events import change_course
from .jit import entry, inner, once
from .segments import contain, flip

# Events closer than this fraction of the largest step are one, as where the fronts of a symmetric
# scene meet.
SIMULTANEOUS = 1e-11
# A velocity beyond this many times the largest that the pre-stress can have driven is a blow-up.
BLOW_UP = 100.0


@inner()
def note_release(history, block, time):
    """Keep the time of a first release. A later release removes the stick."""
    if math.isnan(history.release_time[block]):
        history.release_time[block] = time
    else:
        history.tally.re_releases += 1
        history.stick_time[block] = math.nan
    history.tally.releases += 1


@inner()
def note_stick(history, block, time):
    """Keep the time of a stick, and the block of the first one."""
    history.stick_time[block] = time
    if history.tally.sticks == 0:
        history.tally.first_stick_time = time
        history.tally.first_stuck_block = block
    history.tally.sticks += 1


@inner()
def take_samples(recorder, motion, tally, start, end, order):
    """Take the samples that are due by ``end``, from polynomials about ``start``."""
    times, blocks = recorder.times, recorder.blocks
    w = motion.w
    while tally.samples_taken < times.shape[0] and times[tally.samples_taken] <= end:
        n = tally.samples_taken
        s = min(max(times[n], start), end) - start
        for p in range(blocks.shape[0]):
            i = blocks[p]
            if i < 0:
                continue
            u, v = 0.0, 0.0
            for k in range(order + 1, 0, -1):
                u = s / k * (w[k, i] + u)
            for k in range(order, 0, -1):
                v = s / k * (w[k + 1, i] + v)
            recorder.slip[n, p] = w[0, i] + motion.offset[i] + u
            recorder.velocity[n, p] = w[1, i] + v
        tally.samples_taken += 1


@once
def dissipation(medium, motion, segments):
    """Dissipation D = beta dx sum of ((v_{i+1} - v_i)/dx)^2, with that by slip rate, and dD/dt."""
    square, product = 0.0, 0.0
    rate, change = 0.0, 0.0
    for r in range(segments.count.n):
        start, end = segments.edges[2 * r], segments.edges[2 * r + 1]
        at_axis = medium.mirror and start == 1
        s, p = stencils.stretching(motion.w, start if at_axis else start - 1, end)
        square += s
        product += p
        if medium.alpha != 0.0:
            # The block at x = 0 has no mirror image.
            half, w = 0.5 if at_axis else 0.0, motion.w
            s, p = friction.sums_of_motion(w, start, end)
            rate += s - half * w[1, 1] * w[1, 1]
            change += p - half * w[1, 1] * w[2, 1]
    sides = 2.0 if medium.mirror else 1.0
    viscous, drag = sides * medium.beta / medium.dx, sides * medium.alpha * medium.dx
    return viscous * square + drag * rate, 2.0 * (viscous * product + drag * change)


@inner()
def add_kink(kinks, k, s):
    """Add the change k of a derivative of the dissipation at a time s."""
    kinks.k += k
    kinks.ks += k * s
    kinks.kss += k * s * s


@inner()
def loss_of_step(h, rate, change, kinks):
    """Energy lost in a step h to damping, or to friction with a bend, but for its part h D_1/3.

    The loss h (2 D_0 + D_1)/3 + h^2 D_0'/6 is of third order in h. It is made of the dissipation
    D_0 and its derivative D_0' at the start, and D_1 at the end. D_1 is known at the next start,
    since velocities are continuous, and its part is added then. An event at s that changes D' by k
    adds k (h - s)^2/2, and subtracts h k (h - s)/3, its part of h D_1/3.
    """
    without_events = h * 2.0 * rate / 3.0 + h * h * change / 6.0
    first = kinks.k * h - kinks.ks
    second = kinks.k * h * h - 2.0 * kinks.ks * h + kinks.kss
    return without_events + second / 2.0 - h * first / 3.0


@inner(inline=True)
def derivatives(medium, motion, segments, alpha, top):
    """Fill w[2..top] with the time derivatives of slip on all segments."""
    w, mirror = motion.w, medium.mirror
    leaf, damping = medium.leaf, medium.damping
    for r in range(segments.count.n):
        a, b = segments.edges[2 * r], segments.edges[2 * r + 1]
        if mirror and a == 1:
            w[1, 0] = w[1, 2]
        strain, tau = motion.strain, motion.tau
        stencils.first_acceleration(w, strain, tau, a, b, medium.per_dx, leaf, damping)
        if alpha != 0.0:
            friction.strengthen(w, 2, a, b, alpha)
        friction.resist(motion, a, b, medium.bend)
        for k in range(3, top + 1):
            if mirror and a == 1:
                w[k - 1, 0] = w[k - 1, 2]
            for i in stencils.blocks(a, b):
                w[k, i] = stencils.derivative(w, k, i, medium.per_dx2, leaf, damping)
            if alpha != 0.0:
                friction.strengthen(w, k, a, b, alpha)
            friction.fall(w, k, a, b, np.uint64(0), motion, medium.bend)
    if mirror:
        for k in range(1, top + 1):
            w[k, 0] = w[k, 2]


@inner()
def strengthened_derivatives(medium, motion, segments, top):
    """Fill w[2..top] with rate-dependent friction, in a function apart so that others are fast."""
    derivatives(medium, motion, segments, medium.alpha, top)


@once
def foresee(medium, motion, segments, forecast, tally, h, top):
    """Velocity of all segments at h, sticks and releases until then. Returns False at a blow-up."""
    forecast.sticks.n = 0
    for r in range(segments.count.n):
        a, b = segments.edges[2 * r], segments.edges[2 * r + 1]
        suspects = stencils.velocity_after(motion.velocity, motion.w, a, b, h, top - 1)
        if suspects > 0 and not foresight.find_sticks(
            motion, forecast, a, b, suspects, 0.0, h, top
        ):
            return False
        foresight.find_bends(motion, medium.bend, forecast, a, b, 0.0, h, top)
    first, last = np.int64(0), motion.tau.shape[0]
    lowest = foresight.foresee_releases(medium, motion, segments, forecast, first, last, 0.0, h)
    tally.min_stuck_stress = min(tally.min_stuck_stress, lowest)
    return True


@once
def end_early(motion, scratch, h, order):
    """Velocities of all blocks that moved, where the step ends early at h."""
    moved, changed = scratch.moved, scratch.changed
    for r in range(moved.count.n):
        a, b = moved.edges[2 * r], moved.edges[2 * r + 1]
        stencils.velocity_after(motion.velocity, motion.w, a, b, h, order)
    for q in range(changed.count.n):
        # A block that was released a moment ago is below 0 only by rounding.
        for i in range(changed.first[q], changed.last[q]):
            motion.velocity[i] = max(motion.velocity[i], 0.0)


@once
def take_event(medium, motion, segments, scratch, history, event, instant, h):
    """Let one event happen. Returns False where a velocity is not finite."""
    top = motion.w.shape[0] - 1
    changed, tally = scratch.changed, history.tally
    block, stick = event.block, event.stick
    if stick:
        flip(segments, block)
        note_stick(history, block, instant)
    elif not event.bends:
        flip(segments, block)
        if not contain(scratch.moved, block):
            flip(scratch.moved, block)
        note_release(history, block, instant)
    finite, first, last, speed, lowest, kink, bent = change_course(
        medium, motion, segments, scratch.forecast, scratch.difference, event, h, top
    )
    if not finite:
        return False
    tally.min_stuck_stress = min(tally.min_stuck_stress, lowest)
    if stick:
        tally.min_velocity = min(tally.min_velocity, speed)
    k = kink * ((2.0 if medium.mirror else 1.0) * 2.0 * medium.beta / medium.dx)
    add_kink(changed.kinks, k, event.time)
    weight = 2.0 if medium.mirror and block > 1 else 1.0
    add_kink(changed.work_kinks, weight * medium.dx * bent, event.time)
    n = changed.count.n
    changed.first[n], changed.last[n] = first, last
    changed.stuck[n] = block if stick else -1
    changed.count.n = n + 1
    tally.event_updates += last - first
    return True


@once
def take_over(medium, motion, scratch, tally, order, h):
    """Advance slip, velocity and strain of all that moved. Returns the largest of some speeds."""
    w, offset = motion.w, motion.offset
    moved, changed = scratch.moved, scratch.changed
    fastest, first = 0.0, 1 if medium.mirror else 0
    for r in range(moved.count.n):
        a, b = moved.edges[2 * r], moved.edges[2 * r + 1]
        stencils.advance_slip(w, motion.velocity, a, b, h, order)
        tally.block_updates += b - a
        fastest = max(fastest, w[1, a], w[1, (a + b) // 2], w[1, b - 1])
    for q in range(changed.count.n):
        for i in range(changed.first[q], changed.last[q]):
            w[0, i] += offset[i]
            w[2, i] += offset[i]
            offset[i] = 0.0
    for r in range(moved.count.n):
        a, b = moved.edges[2 * r], moved.edges[2 * r + 1]
        for i in stencils.blocks(max(a - 1, first), b):
            motion.strain[i] += medium.per_dx * (w[2, i + stencils.ONE] - w[2, i])
    if medium.mirror:
        motion.strain[0] = -motion.strain[1]
    for q in range(changed.count.n):
        if changed.stuck[q] >= 0:
            w[2, changed.stuck[q]] = 0.0
    return fastest


@once
def take_events_at_once(medium, motion, segments, scratch, history, end, latest, top):
    """Release and hold all blocks that are due until ``latest``, after a step that ended early."""
    forecast, tally = scratch.forecast, history.tally
    due = scratch.changed.first
    count = foresight.due_releases(segments, forecast, latest, due)
    for q in range(forecast.sticks.n):
        if forecast.stick_time[q] <= latest:
            block = forecast.stick_block[q]
            if forecast.bends[q]:
                friction.turn(motion, medium.bend, block)
                continue
            tally.min_velocity = min(tally.min_velocity, motion.w[1, block])
            for k in range(1, top + 1):
                motion.w[k, block] = 0.0
            flip(segments, block)
            note_stick(history, block, end)
    for q in range(count):
        flip(segments, due[q])
        friction.begin_to_fall(motion, medium.bend, due[q])
        note_release(history, due[q], end)


# The branches of this function are the algorithm; parted, they would share all of its state.
@entry
def advance(  # noqa: C901, PLR0912, PLR0915
    medium, motion, segments, scratch, history, recorder, limits
):
    """Advance until a limit. Returns why; then the loss is complete and w[2] is acceleration."""
    order, top = limits.order, limits.order + 1
    size = motion.tau.shape[0]
    instantly = SIMULTANEOUS * limits.largest_step
    tally, forecast = history.tally, scratch.forecast
    moved, changed = scratch.moved, scratch.changed
    kinks, work_kinks = changed.kinks, changed.work_kinks
    lossy = medium.beta > 0.0 or medium.alpha != 0.0
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
        power, growth = friction.power(medium, motion, segments, medium.bend)
        tally.friction_loss += tally.pending_step * power / 3.0
        tally.pending_step = 0.0
        if segments.count.n == 0:
            return ALL_STUCK
        if t >= limits.end_time:
            return DONE
        # The events of a step may reach beyond the end of the lattice.
        last = segments.edges[2 * segments.count.n - 1]
        if last >= size - ROOM or (segments.edges[0] <= ROOM and not medium.mirror):
            return GROW
        kinks.k = kinks.ks = kinks.kss = 0.0
        work_kinks.k = work_kinks.ks = work_kinks.kss = 0.0

        h = min(limits.largest_step, limits.end_time - t)
        end = limits.end_time if h == limits.end_time - t else t + h
        if not foresee(medium, motion, segments, forecast, tally, h, top):
            return UNSTABLE
        for q in range(2 * segments.count.n):
            moved.edges[q] = segments.edges[q]
        moved.count.n = segments.count.n
        changed.count.n = 0

        early = False
        while True:
            event = foresight.next_event(segments, forecast)
            if event.time == math.inf:
                break
            early = changed.count.n == MOST_EVENTS or foresight.simultaneous(
                segments, forecast, medium, event.block, event.time + instantly
            )
            if early:
                h, end = event.time, min(t + event.time, end)
                end_early(motion, scratch, h, order)
                break
            instant = min(t + event.time, end)
            take_samples(recorder, motion, tally, t, instant, order)
            if not take_event(medium, motion, segments, scratch, history, event, instant, h):
                return UNSTABLE
        take_samples(recorder, motion, tally, t, end, order)

        if lossy:
            tally.viscous_loss += loss_of_step(h, rate, change, kinks)
        tally.friction_loss += loss_of_step(h, power, growth, work_kinks)
        tally.pending_step = h
        fastest = take_over(medium, motion, scratch, tally, order, h)
        if early:
            take_events_at_once(medium, motion, segments, scratch, history, end, h + instantly, top)
        tally.steps += 1
        tally.time = end
        if not fastest <= BLOW_UP * (1.0 + limits.largest_force * end):
            return UNSTABLE
    return CONTINUE
