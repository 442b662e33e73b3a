"""The localised scheme: Taylor steps of any order over all that slides, with releases and sticks inside them.

Between events the sliding lattice is linear with constant coefficients, so its Taylor polynomial is cheap, and it
is its own dense output: the stress of a stuck neighbour and the velocity of a sliding block are polynomials in the
step, and the next event is the first root of either (`foresight`). What an event changes is added to the polynomials
within its reach (`events`). Only the runs of sliding blocks and their neighbours are touched; everything else is at
rest and its derivatives are zero.

What paid for narrow pulses: events inside the step; no reference counts (a factor of 1.7); the difference that an event
makes instead of a new expansion around it; rows that begin at different places of their pages. What did not: passes
written by hand for order 4, ending steps at events.
"""

from __future__ import annotations

import math

import numpy as np

from .events import COLUMNS, change_course
from .foresight import crowded, due_releases, find_sticks, foresee_releases, next_event
from .jit import compiled
from .segments import holds, release_block, stick_block
from .stencils import (
    advance_slip,
    advance_strain,
    first_acceleration,
    next_derivative,
    stretching,
    velocity_after,
)

# Why `advance` came back.
DONE, CONTINUE, GROW, UNSTABLE, ALL_STUCK = 0, 1, 2, 3, 4
# Places in `counts`.
RUNS, STEPS, BLOCK_UPDATES, EVENT_UPDATES, RELEASES, STICKS, RE_RELEASES, NEXT_SAMPLE, FIRST_STUCK = range(9)
# Places in `totals`.
TIME, VISCOUS_LOSS, PENDING_STEP, MIN_VELOCITY, MIN_STUCK_STRESS, FIRST_STICK, STICK_LOSS = range(7)

# A step ends early at the next event after this many.
MOST_EVENTS = 64
# Room for the events of one step beyond the outermost block that slides.
ROOM = COLUMNS + MOST_EVENTS
# Events closer than this share of the largest step are one: fronts of a symmetric scene that meet.
SIMULTANEOUS = 1e-11
# Velocities beyond this many times the largest that any pre-stress could have driven by now mean a blow-up.
BLOW_UP = 100.0


def scratch(order):
    """What `advance` works in besides arrays over the lattice, from ``difference`` to ``stopped``."""
    top = order + 1
    return (
        np.zeros((top + 1, COLUMNS)),
        np.zeros(top + 3),
        np.zeros(COLUMNS),
        np.zeros(top + 1),
        np.zeros(top + 1),
        np.zeros(3),
        *np.zeros((3, MOST_EVENTS), dtype=np.int64),
    )


@compiled()
def derivatives(w, strain, tau, starts, ends, n_runs, mirror, top, dx, leaf, beta):
    """Fill w[2..top] with the time derivatives of slip on all runs."""
    per_dx, per_dx2, damping = 1.0 / dx, 1.0 / (dx * dx), beta / (dx * dx)
    for r in range(n_runs):
        a, b = starts[r], ends[r]
        if mirror and a == 1:
            w[1, 0] = w[1, 2]
        first_acceleration(w, strain, tau, a, b, per_dx, leaf, damping)
        for k in range(3, top + 1):
            if mirror and a == 1:
                w[k - 1, 0] = w[k - 1, 2]
            next_derivative(w, k, a, b, per_dx2, leaf, damping)
    if mirror:
        for k in range(1, top + 1):
            w[k, 0] = w[k, 2]


@compiled()
def viscous_rate(w, starts, ends, n_runs, mirror, dx, beta):
    """Viscous dissipation of all runs, and its rate of change."""
    square, product = 0.0, 0.0
    for r in range(n_runs):
        a, b = starts[r], ends[r]
        left = 1 if mirror and a == 1 else a - 1
        s, p = stretching(w, left, b)
        square += s
        product += p
    scale = (2.0 if mirror else 1.0) * beta / dx
    return scale * square, 2.0 * scale * product


@compiled()
def viscous_loss(step, rate, change, kinks):
    """Viscous loss of a step, but for the third of ``step`` times the dissipation at its end, which comes later.

    Third order in the step from the rate D and its derivative at the start and D at the end, which is the next
    start since velocities are continuous: h (2 D_0 + D_1)/3 + h^2 D_0'/6. An event at s that changes D' by k adds
    k (h - s)^2/2 and takes h k (h - s)/3 out of what D_1 stands for; ``kinks`` are the sums of k, k s and k s^2.
    """
    smooth = step * 2.0 * rate / 3.0 + step * step * change / 6.0
    first = kinks[0] * step - kinks[1]
    second = kinks[0] * step * step - 2.0 * kinks[1] * step + kinks[2]
    return smooth + second / 2.0 - step * first / 3.0


@compiled()
def sample(w, offset, blocks, step, order, slip, velocity):
    """Slip and slip velocity at the requested blocks (-1: outside the lattice, at rest) ``step`` into this step."""
    for p in range(blocks.shape[0]):
        i = blocks[p]
        if i < 0:
            continue
        u, v = 0.0, 0.0
        for k in range(order + 1, 0, -1):
            u = step / k * (w[k, i] + u)
        for k in range(order, 0, -1):
            v = step / k * (w[k + 1, i] + v)
        slip[p] = w[0, i] + offset[i] + u
        velocity[p] = w[1, i] + v


@compiled()
def take_samples(
    w, offset, start, end, order, counts, sample_times, sample_blocks, sample_slip, sample_velocity
):  # fmt: skip
    """Take the samples that are due by ``end``, from polynomials about ``start``."""
    while counts[NEXT_SAMPLE] < sample_times.shape[0] and sample_times[counts[NEXT_SAMPLE]] <= end:
        s = counts[NEXT_SAMPLE]
        into = min(max(sample_times[s], start), end) - start
        sample(w, offset, sample_blocks, into, order, sample_slip[s], sample_velocity[s])
        counts[NEXT_SAMPLE] += 1


@compiled()
def near_the_end(starts, ends, n, size, mirror):
    """Whether a front is so near the end of the lattice that the events of a step may reach beyond it."""
    return ends[n - 1] >= size - ROOM or (starts[0] <= ROOM and not mirror)


@compiled()
def note_stick(block, instant, stick_time, counts, totals):
    """Keep the time of a stick, and of the first one its place too."""
    stick_time[block] = instant
    if counts[STICKS] == 0:
        totals[FIRST_STICK] = instant
        counts[FIRST_STUCK] = block
    counts[STICKS] += 1


@compiled()
def note_release(block, instant, release_time, stick_time, counts):
    """Keep the time of a first release; a later one takes back the stick."""
    if math.isnan(release_time[block]):
        release_time[block] = instant
    else:
        counts[RE_RELEASES] += 1
        stick_time[block] = math.nan
    counts[RELEASES] += 1


@compiled()
def foresee_sticks(
    w, velocity, starts, ends, n, stopping_block, stopping_time, coefficients, slopes, order, h
):
    """Velocity of all runs after h, and when each block that passes 0 until then does so.

    Returns how many there are, or -1 where a velocity is not finite.
    """
    # Not a literal, for which everything that is called would be compiled once more.
    n_stopping = np.int64(0)
    for r in range(n):
        suspects = velocity_after(velocity, w, starts[r], ends[r], h, order)
        if suspects > 0:
            n_stopping = find_sticks(
                w, velocity, starts[r], ends[r], suspects, stopping_block, stopping_time, n_stopping, coefficients,
                slopes, 0.0, order + 1, h,
            )  # fmt: skip
            if n_stopping < 0:
                break
    return n_stopping


@compiled()
def take_over(
    w, offset, strain, velocity, starts, ends, n, changed_first, changed_last, stopped, n_events, order, h, mirror, dx
):  # fmt: skip
    """Advance slip, velocity and strain of all that moved by h. Returns the largest velocity among a few."""
    fastest = 0.0
    for r in range(n):
        a, b = starts[r], ends[r]
        advance_slip(w, velocity, a, b, h, order)
        fastest = max(fastest, w[1, a], w[1, (a + b) // 2], w[1, b - 1])
    for q in range(n_events):
        for i in range(changed_first[q], changed_last[q]):
            w[0, i] += offset[i]
            w[2, i] += offset[i]
            offset[i] = 0.0
    for r in range(n):
        a, b = starts[r], ends[r]
        advance_strain(strain, w, 1 if mirror and a == 1 else a - 1, b, 1.0 / dx)
    if mirror:
        strain[0] = -strain[1]
    for q in range(n_events):
        if stopped[q] >= 0:
            w[2, stopped[q]] = 0.0
    return fastest


@compiled(entry=True)
def advance(
    w, offset, strain, velocity, tau, starts, ends, moved_starts, moved_ends, release_at, stopping_block,
    stopping_time, difference, own, values, coefficients, slopes, kinks, changed_first, changed_last, stopped,
    release_time, stick_time, counts, totals,
    sample_times, sample_blocks, sample_slip, sample_velocity,
    mirror, total, dx, leaf, beta, order, largest_step, end_time, largest_force, call_steps,
):  # fmt: skip
    """Advance the lattice by at most ``call_steps`` steps, to ``end_time`` at most. Returns why it stopped."""
    top = order + 1
    size = tau.shape[0]
    same = SIMULTANEOUS * largest_step
    for _ in range(call_steps):
        n = counts[RUNS]
        t = totals[TIME]
        if n == 0:
            return ALL_STUCK
        if t >= end_time:
            return DONE
        if near_the_end(starts, ends, n, size, mirror):
            return GROW
        derivatives(w, strain, tau, starts, ends, n, mirror, top, dx, leaf, beta)
        rate, slope = 0.0, 0.0
        kinks[:] = 0.0
        if beta > 0.0:
            rate, slope = viscous_rate(w, starts, ends, n, mirror, dx, beta)
            totals[VISCOUS_LOSS] += totals[PENDING_STEP] * rate / 3.0

        h = min(largest_step, end_time - t)
        end = end_time if h == end_time - t else t + h
        n_stopping = foresee_sticks(
            w, velocity, starts, ends, n, stopping_block, stopping_time, coefficients, slopes, order, h
        )
        if n_stopping < 0:
            return UNSTABLE
        lowest = foresee_releases(
            release_at, coefficients, slopes, w, offset, strain, tau, starts, ends, n, 0.0, h, mirror, dx, leaf, beta,
            total, top, np.int64(0), size,
        )  # fmt: skip
        totals[MIN_STUCK_STRESS] = min(totals[MIN_STUCK_STRESS], lowest)
        n_moved = n
        for r in range(n):
            moved_starts[r], moved_ends[r] = starts[r], ends[r]

        n_events, early = np.int64(0), False
        while True:
            block, now, stuck = next_event(
                release_at, starts, ends, n, mirror, stopping_block, stopping_time, n_stopping
            )
            if now == math.inf:
                break
            early = n_events == MOST_EVENTS or crowded(
                release_at, starts, ends, n, mirror, stopping_block, stopping_time, n_stopping, block, now + same
            )  # fmt: skip
            if early:
                h = now
                end = min(t + now, end)
                for r in range(n_moved):
                    velocity_after(velocity, w, moved_starts[r], moved_ends[r], h, order)
                for q in range(n_events):
                    # Released a moment ago: nothing but rounding is below 0.
                    for i in range(changed_first[q], changed_last[q]):
                        velocity[i] = max(velocity[i], 0.0)
                break
            instant = min(t + now, end)
            take_samples(
                w, offset, t, instant, order, counts, sample_times, sample_blocks, sample_slip, sample_velocity
            )  # fmt: skip
            if stuck:
                n = stick_block(starts, ends, n, block)
                note_stick(block, instant, stick_time, counts, totals)
            else:
                n = release_block(starts, ends, n, block)
                if not holds(moved_starts, moved_ends, n_moved, block):
                    n_moved = release_block(moved_starts, moved_ends, n_moved, block)
                note_release(block, instant, release_time, stick_time, counts)
            n_stopping, first, last, speed, lowest, kink = change_course(
                w, offset, strain, tau, velocity, starts, ends, n, block, stuck, now, h, release_at, stopping_block,
                stopping_time, n_stopping, difference, own, values, coefficients, slopes, mirror, total, dx, leaf,
                beta, top,
            )  # fmt: skip
            if n_stopping < 0:
                return UNSTABLE
            totals[MIN_STUCK_STRESS] = min(totals[MIN_STUCK_STRESS], lowest)
            if stuck:
                totals[MIN_VELOCITY] = min(totals[MIN_VELOCITY], speed)
            kink *= (2.0 if mirror else 1.0) * 2.0 * beta / dx
            kinks[0] += kink
            kinks[1] += kink * now
            kinks[2] += kink * now * now
            changed_first[n_events], changed_last[n_events] = first, last
            stopped[n_events] = block if stuck else -1
            counts[EVENT_UPDATES] += last - first
            n_events += 1
        take_samples(
            w, offset, t, end, order, counts, sample_times, sample_blocks, sample_slip, sample_velocity
        )

        if beta > 0.0:
            totals[VISCOUS_LOSS] += viscous_loss(h, rate, slope, kinks)
            totals[PENDING_STEP] = h
        for r in range(n_moved):
            counts[BLOCK_UPDATES] += moved_ends[r] - moved_starts[r]
        fastest = take_over(
            w, offset, strain, velocity, moved_starts, moved_ends, n_moved, changed_first, changed_last, stopped,
            n_events, order, h, mirror, dx,
        )  # fmt: skip
        if early:
            n_due = due_releases(release_at, starts, ends, n, mirror, h + same, changed_first)
            for q in range(n_stopping):
                if stopping_time[q] <= h + same:
                    block = stopping_block[q]
                    totals[MIN_VELOCITY] = min(totals[MIN_VELOCITY], w[1, block])
                    for k in range(1, top + 1):
                        w[k, block] = 0.0
                    n = stick_block(starts, ends, n, block)
                    note_stick(block, end, stick_time, counts, totals)
            for q in range(n_due):
                n = release_block(starts, ends, n, changed_first[q])
                note_release(changed_first[q], end, release_time, stick_time, counts)
        counts[RUNS] = n
        counts[STEPS] += 1
        totals[TIME] = end
        if not fastest <= BLOW_UP * (1.0 + largest_force * end):
            return UNSTABLE
    return CONTINUE


@compiled(entry=True)
def finish(w, strain, tau, starts, ends, counts, totals, mirror, dx, leaf, beta):
    """Leave the acceleration of the end in w[2] and close the viscous loss."""
    n = counts[RUNS]
    derivatives(w, strain, tau, starts, ends, n, mirror, np.int64(2), dx, leaf, beta)
    if beta > 0.0:
        rate, _ = viscous_rate(w, starts, ends, n, mirror, dx, beta)
        totals[VISCOUS_LOSS] += totals[PENDING_STEP] * rate / 3.0
        totals[PENDING_STEP] = 0.0
